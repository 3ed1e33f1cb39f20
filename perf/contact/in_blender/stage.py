"""What the scripts that Blender runs have in common: jobs, meshes, solids to measure penetration against, the clock."""
import array
import json
import pathlib
import sys
import time

import bpy
from mathutils import Vector
from mathutils.bvhtree import BVHTree

FRAMES_PER_SECOND = 24

# Three directions along no axis and no diagonal, in which modelled faces and edges rarely lie.
DIRECTIONS = [Vector(d).normalized() for d in ((0.683, 0.271, 0.678), (-0.411, 0.853, -0.322), (0.177, -0.569, 0.803))]


def read_job():
    return json.loads(pathlib.Path(sys.argv[sys.argv.index("--") + 1]).read_text())


def empty_scene(frames):
    bpy.ops.object.select_all(action="SELECT")
    bpy.ops.object.delete()
    scene = bpy.context.scene
    scene.render.fps = FRAMES_PER_SECOND
    scene.frame_start, scene.frame_end = 1, frames
    return scene


def load(path, matrix):
    """The mesh of a PLY file as the active object, its vertices (not its frame) moved by `matrix`."""
    bpy.ops.import_mesh.ply(filepath=path)
    thing = bpy.context.object
    thing.data.transform(matrix)
    return thing


def triangles(mesh):
    mesh.calc_loop_triangles()
    return [tuple(t.vertices) for t in mesh.loop_triangles]


def coordinates(mesh):
    flat = array.array("f", bytes(12 * len(mesh.vertices)))
    mesh.vertices.foreach_get("co", flat)
    return [Vector(flat[i:i + 3]) for i in range(0, len(flat), 3)]


def bounds(points):
    return [min(p[k] for p in points) for k in range(3)], [max(p[k] for p in points) for k in range(3)]


class Solid:
    """A closed mesh in its own frame: how deep is a point in it?"""

    def __init__(self, mesh):
        self.points = coordinates(mesh)
        self.tree = BVHTree.FromPolygons(self.points, triangles(mesh))
        self.low, self.high = bounds(self.points)
        self.step = 1e-6 * (Vector(self.high) - Vector(self.low)).length

    def depth(self, p):
        """Distance to the surface, 0 outside."""
        return self.tree.find_nearest(p)[3] if self.holds(p) else 0.0

    def holds(self, p):
        """By the number of crossings; of three rays if two disagree, since a ray may graze an edge."""
        if any(p[k] <= self.low[k] or p[k] >= self.high[k] for k in range(3)):
            return False
        first, second = self.odd(p, DIRECTIONS[0]), self.odd(p, DIRECTIONS[1])
        return first if first == second else self.odd(p, DIRECTIONS[2])

    def odd(self, p, direction):
        crossings = 0
        while True:
            hit = self.tree.ray_cast(p, direction)[0]
            if hit is None:
                return crossings % 2 == 1
            crossings += 1
            p = hit + self.step * direction


def timed_frame(scene, frame):
    """Goes to the frame, which simulates it, and returns the processor time that this took."""
    start = time.process_time()
    scene.frame_set(frame)
    bpy.context.evaluated_depsgraph_get()
    return time.process_time() - start


def write_ply(path, points, faces):
    head = ["ply", "format ascii 1.0", f"element vertex {len(points)}",
            *(f"property float {axis}" for axis in "xyz"),
            f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header"]
    body = [" ".join(f"{x:.6g}" for x in p) for p in points]
    body += [f"{len(face)} " + " ".join(map(str, face)) for face in faces]
    pathlib.Path(path).write_text("\n".join(head + body) + "\n")
