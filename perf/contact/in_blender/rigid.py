"""Interlocking parts under gravity, each with a proxy as its collision shape; how deep the inputs get into each other.

    blender -b --factory-startup -t 1 --python-exit-code 1 -P rigid.py -- JOB.json

All parts of a scene are copies of one mesh, scaled to a diagonal of a metre. Mass, centre of mass and the tensor of
inertia by which the energy is measured are those of the input, whatever the proxy is. (Bullet has its own tensor, from
the collision shape.)
"""
import json
import pathlib
import sys

import bpy
from mathutils import Matrix, Vector

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import stage

MASS = 1.0
FRICTION = 0.5
SUBSTEPS = 20      # in a frame
ITERATIONS = 20    # of the solver in a substep
GROUND = 20.0      # its extent


def outer(a, b):
    return Matrix([[a[i] * b[j] for j in range(3)] for i in range(3)])


def mass_properties(mesh):
    """Centroid and tensor of inertia about it for the mass MASS, by tetrahedra between the origin and each face."""
    points = stage.coordinates(mesh)
    volume, moment, second = 0.0, Vector(), Matrix.Diagonal((0, 0, 0))
    for a, b, c in ([points[i] for i in t] for t in stage.triangles(mesh)):
        determinant, total = a.dot(b.cross(c)), a + b + c
        volume += determinant / 6
        moment += determinant / 24 * total
        second += (outer(a, a) + outer(b, b) + outer(c, c) + outer(total, total)) * (determinant / 120)
    centroid = moment / volume
    second -= outer(centroid, centroid) * volume
    trace = sum(second[k][k] for k in range(3))
    return centroid, (Matrix.Diagonal((trace, trace, trace)) - second) * (MASS / volume)


def make_rigid(kind, shape, margin):
    bpy.ops.rigidbody.object_add(type=kind)
    body = bpy.context.object.rigid_body
    body.collision_shape = shape
    body.friction, body.restitution, body.use_margin, body.collision_margin = FRICTION, 0.0, True, margin
    body.mass = MASS
    body.use_deactivation = False


def make_ground(height):
    bpy.ops.mesh.primitive_cube_add(size=1, location=(0, 0, height - 0.5))
    bpy.context.object.scale = (GROUND, GROUND, 1)
    make_rigid("PASSIVE", "BOX", 0.0)


def make_parts(job, shrink, centroid):
    """One object for each place; the origin, which is Blender's centre of mass, at the centroid of the input."""
    parts = []
    for place in job["places"]:
        part = stage.load(job["proxy"], Matrix.Translation(-centroid) @ shrink)
        where = Matrix(place["matrix"])
        where.translation = where.translation * job["scale"]
        part.matrix_world = where @ Matrix.Translation(centroid)
        make_rigid("PASSIVE" if place["fixed"] else "ACTIVE", "MESH", job["margin"])
        parts.append(part)
    return parts


def poses(parts):
    graph = bpy.context.evaluated_depsgraph_get()
    return [part.evaluated_get(graph).matrix_world.copy() for part in parts]


def kinetic_energy(before, now, inertia):
    """Of one part, by what it moved and turned since the last frame."""
    velocity = (now.translation - before.translation) * stage.FRAMES_PER_SECOND
    axis, angle = (now.to_quaternion() @ before.to_quaternion().inverted()).to_axis_angle()
    if angle > 3.141592653589793:
        angle -= 2 * 3.141592653589793
    spin = now.to_3x3().transposed() @ (axis * angle * stage.FRAMES_PER_SECOND)
    return 0.5 * MASS * velocity.length_squared + 0.5 * spin.dot(inertia @ spin)


def overlap(a, b):
    return all(a[0][k] <= b[1][k] and b[0][k] <= a[1][k] for k in range(3))


def world_box(solid, pose):
    corners = [Vector((x, y, z)) for x in (solid.low[0], solid.high[0]) for y in (solid.low[1], solid.high[1])
               for z in (solid.low[2], solid.high[2])]
    return stage.bounds([pose @ corner for corner in corners])


def penetrations(solid, now):
    """Depths of the vertices of each input in each other one."""
    boxes = [world_box(solid, pose) for pose in now]
    depths = []
    for i, pose in enumerate(now):
        for j, other in enumerate(now):
            if i != j and overlap(boxes[i], boxes[j]):
                change = other.inverted() @ pose
                depths += [depth for depth in (solid.depth(change @ p) for p in solid.points) if depth > 0]
    return depths


def simulate(job):
    scene = stage.empty_scene(job["frames"])
    bpy.ops.rigidbody.world_add()
    world = scene.rigidbody_world
    world.substeps_per_frame, world.solver_iterations = SUBSTEPS, ITERATIONS
    world.point_cache.frame_end = job["frames"]
    shrink = Matrix.Scale(job["scale"], 4)
    reference = stage.load(job["input"], shrink)
    centroid, inertia = mass_properties(reference.data)
    reference.data.transform(Matrix.Translation(-centroid))
    solid = stage.Solid(reference.data)
    bpy.data.objects.remove(reference)
    if job["ground"] is not None:
        make_ground(job["ground"] * job["scale"])
    parts = make_parts(job, shrink, centroid)
    scene.frame_set(1)
    before, rows = poses(parts), []
    start = before
    for frame in range(2, job["frames"] + 1):
        seconds = stage.timed_frame(scene, frame)
        now = poses(parts)
        depths = penetrations(solid, now)
        rows.append({"frame": frame, "seconds": seconds, "inside": len(depths), "depth": max(depths, default=0),
                     "energy": sum(kinetic_energy(p, q, inertia) for p, q in zip(before, now))})
        before = now
    return {"job": job, "rows": rows, "points": len(solid.points) * len(parts),
            "last": [list(pose.translation) for pose in before],
            "poses": [[list(row) for row in pose @ Matrix.Translation(-centroid)] for pose in before],
            "start": [[list(row) for row in pose @ Matrix.Translation(-centroid)] for pose in start]}


def main():
    job = stage.read_job()
    pathlib.Path(job["output"] + ".json").write_text(json.dumps(simulate(job)))


main()
