"""A cloth falls on a proxy; how deep it gets into the input is measured frame by frame.

    blender -b --factory-startup -t 1 --python-exit-code 1 -P cloth.py -- JOB.json

The input is scaled to a diagonal of DIAGONAL metres and stood upright; everything else is in metres. There is no
ground: a cloth that slides off keeps falling.
"""
import json
import pathlib
import sys

import bpy
from mathutils import Matrix, Vector

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import stage

DIAGONAL = 2.0
OVERHANG = 1.3     # side of the cloth over the larger horizontal extent of the input
START = 0.05       # of the cloth above the input
GAP = 0.005        # that the solver keeps between cloth and collision surface, from each side
STEPS = 8          # of the solver in a frame
FRICTION = 5.0     # of the collision surface, Blender's default
COLLISION_STEPS = 4


def upright(path, up):
    """Moves the input to the origin, its centre line on the z axis, with the wanted diagonal."""
    raw = stage.load(path, Matrix())
    turn = Matrix.Rotation(1.5707963267948966, 4, "X") if up == "y" else Matrix()
    low, high = map(Vector, stage.bounds([turn @ p for p in stage.coordinates(raw.data)]))
    bpy.data.objects.remove(raw)
    centre = (low + high) / 2
    return Matrix.Scale(DIAGONAL / (high - low).length, 4) @ Matrix.Translation(-centre) @ turn


def make_cloth(solid, segments):
    widest = max(solid.high[k] - solid.low[k] for k in (0, 1))
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=segments, y_subdivisions=segments, size=OVERHANG * widest,
                                    location=(0, 0, solid.high[2] + START))
    cloth = bpy.context.object
    modifier = cloth.modifiers.new("cloth", "CLOTH")
    modifier.settings.quality = STEPS
    modifier.collision_settings.collision_quality = COLLISION_STEPS
    modifier.collision_settings.distance_min = GAP
    modifier.point_cache.frame_end = bpy.context.scene.frame_end
    return cloth, modifier.settings.mass


def make_collider(path, placement):
    collider = stage.load(path, placement)
    collider.modifiers.new("collision", "COLLISION")
    collider.collision.thickness_outer = GAP
    collider.collision.cloth_friction = FRICTION


def positions(cloth):
    shown = cloth.evaluated_get(bpy.context.evaluated_depsgraph_get())
    return [shown.matrix_world @ p for p in stage.coordinates(shown.data)]


def kinetic_energy(before, now, vertex_mass):
    squares = sum((q - p).length_squared for p, q in zip(before, now))
    return 0.5 * vertex_mass * squares * stage.FRAMES_PER_SECOND ** 2


def simulate(job):
    scene = stage.empty_scene(job["frames"])
    placement = upright(job["input"], job["up"])
    reference = stage.load(job["input"], placement)
    solid = stage.Solid(reference.data)
    bpy.data.objects.remove(reference)
    make_collider(job["proxy"], placement)
    cloth, vertex_mass = make_cloth(solid, job["segments"])
    faces = [tuple(face.vertices) for face in cloth.data.polygons]
    scene.frame_set(1)
    before, rows = positions(cloth), []
    for frame in range(2, job["frames"] + 1):
        seconds = stage.timed_frame(scene, frame)
        now = positions(cloth)
        depths = [depth for depth in map(solid.depth, now) if depth > 0]
        rows.append({"frame": frame, "seconds": seconds, "inside": len(depths),
                     "depth": max(depths, default=0) / DIAGONAL, "energy": kinetic_energy(before, now, vertex_mass)})
        if frame in job["pictures"]:
            stage.write_ply(f"{job['output']}-{frame}.ply", now, faces)
        before = now
    return {"job": job, "rows": rows, "points": len(before), "last": [[x / DIAGONAL for x in p] for p in before],
            "placement": [list(row) for row in placement]}


def main():
    job = stage.read_job()
    pathlib.Path(job["output"] + ".json").write_text(json.dumps(simulate(job)))


main()
