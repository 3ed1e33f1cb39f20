"""Draws the cloth on every proxy, one column a proxy and one row a frame, as in the paper's Fig. 18.

    blender -b --factory-startup --python-exit-code 1 -P picture.py -- JOB.json
"""
import json
import math
import pathlib
import sys

import bpy
from mathutils import Matrix, Vector

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import stage

COLUMN, ROW = 2.3, 2.2  # metres; the input has a diagonal of 2
PIXELS_A_METRE = 105
AZIMUTH, ELEVATION = math.radians(25), math.radians(20)
COLOURS = {"proxy": (0.55, 0.55, 0.55, 1), "cloth": (0.1, 0.3, 0.75, 1)}


def painted(name, thing):
    material = bpy.data.materials.get(name) or bpy.data.materials.new(name)
    material.use_nodes = True
    shader = material.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = COLOURS[name]
    shader.inputs["Roughness"].default_value = 0.8
    thing.data.materials.append(material)


def camera_axes():
    back = Vector((math.sin(AZIMUTH) * math.cos(ELEVATION), -math.cos(AZIMUTH) * math.cos(ELEVATION),
                   math.sin(ELEVATION)))
    right = Vector((0, 0, 1)).cross(back).normalized()
    return right, back.cross(right), back


def make_camera(scene, width, height, axes):
    right, up, back = axes
    data = bpy.data.cameras.new("camera")
    data.type, data.ortho_scale, data.clip_end = "ORTHO", max(width, height), 1000
    camera = bpy.data.objects.new("camera", data)
    place = Matrix((right, up, back)).transposed().to_4x4()
    place.translation = 100 * back
    camera.matrix_world = place
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.resolution_x, scene.render.resolution_y = (int(PIXELS_A_METRE * x) for x in (width, height))


def make_light(scene):
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.data.energy, sun.data.angle = 2.5, 0.3
    sun.matrix_world = Matrix.Rotation(0.6, 4, "Z") @ Matrix.Rotation(0.7, 4, "X")
    scene.collection.objects.link(sun)
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (1, 1, 1, 1)
    scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.6


def draw(job):
    scene = stage.empty_scene(1)
    axes = right, up, _ = camera_axes()
    columns, frames = job["columns"], job["frames"]
    for i, column in enumerate(columns):
        placement = Matrix(json.loads(pathlib.Path(column["output"] + ".json").read_text())["placement"])
        for j, frame in enumerate(frames):
            offset = Matrix.Translation((i - (len(columns) - 1) / 2) * COLUMN * right +
                                        ((len(frames) - 1) / 2 - j) * ROW * up)
            painted("proxy", stage.load(column["proxy"], offset @ placement))
            cloth = stage.load(f"{column['output']}-{frame}.ply", offset)
            cloth.data.polygons.foreach_set("use_smooth", [True] * len(cloth.data.polygons))
            painted("cloth", cloth)
    make_camera(scene, COLUMN * len(columns), ROW * len(frames), axes)
    make_light(scene)
    scene.render.engine, scene.cycles.samples, scene.cycles.seed = "CYCLES", 64, 0
    scene.cycles.use_denoising = False  # Debian builds Blender without a denoiser
    scene.view_settings.view_transform = "Standard"
    scene.render.image_settings.file_format, scene.render.image_settings.quality = "JPEG", 82
    scene.render.filepath = job["picture"]
    bpy.ops.render.render(write_still=True)


draw(stage.read_job())
