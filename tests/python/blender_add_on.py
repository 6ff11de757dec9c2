"""Run by Blender without a window: the add-on makes meshes of points, with colours, and they can be undone.

    blender --background --factory-startup --python-exit-code 1 --python blender_add_on.py"""
import os
import pathlib
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "packaging" / "blender"), str(ROOT / "python")]

import bpy
import numpy as np
import pointskin as ps
import pointskin_blender


def ball(count=4000):
    i = np.arange(count)
    z = 1 - (2 * i + 1) / count
    r = np.sqrt(1 - z * z)
    return np.stack([r * np.cos(2.399963 * i), r * np.sin(2.399963 * i), z], axis=1).astype(np.float32)


def main():
    pointskin_blender.register()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    pointskin_blender.unregister()
    pointskin_blender.register()
    normals = ball()
    colours = np.rint(127 * (1 + normals)).astype(np.uint8)
    file = os.path.join(tempfile.mkdtemp(), "ball.ply")
    ps.Cloud(2 * normals, normals, {"rgb": colours}).save(file)

    assert bpy.ops.import_scene.pointskin(filepath=file) == {"FINISHED"}
    cloud = bpy.context.object
    assert len(cloud.data.vertices) == 4000 and pointskin_blender.is_cloud(cloud)
    cloud.location = (5, 0, 0)
    bpy.context.view_layer.update()
    before = set(bpy.data.objects.keys())
    bpy.ops.ed.undo_push(message="points")
    assert bpy.ops.object.pointskin_reconstruct("EXEC_DEFAULT", True, automatic_depth=False, depth=6) == {"FINISHED"}
    made = bpy.context.object
    assert made.name == "ball surface", made.name
    points = pointskin_blender.floats(made.data.vertices, "co", 3)
    assert np.allclose(np.linalg.norm(points - (5, 0, 0), axis=1), 2, atol=0.02), "in world coordinates, where the points are"
    assert len(made.data.polygons) > 5000 and made.data.validate() is False, "nothing for Blender to mend"
    faces = np.array([tuple(polygon.vertices) for polygon in made.data.polygons])
    assert ps.Mesh(points, faces).is_watertight
    rgb = 255 * pointskin_blender.floats(made.data.color_attributes["Color"].data, "color_srgb", 4)[:, :3]
    expected = 127 * (1 + (points - (5, 0, 0)) / 2)
    assert np.abs(rgb - expected).max() < 20, np.abs(rgb - expected).max()
    print("made", len(made.data.polygons), "faces; largest difference of a colour", np.abs(rgb - expected).max())

    bpy.ops.ed.undo()  # to what was pushed before the operator, which has pushed its own result
    assert set(bpy.data.objects.keys()) == before, "undo takes the surface away"
    bpy.ops.ed.redo()
    assert "ball surface" in bpy.data.objects, "redo brings it back"

    for item in bpy.data.objects:
        item.select_set(False)
    pointskin_blender.new_object(bpy.context, "bare", normals)
    assert bpy.ops.object.pointskin_reconstruct() == {"FINISHED"}, "without normals they are estimated"
    assert len(bpy.context.object.data.polygons) > 1000
    assert not bpy.ops.object.pointskin_reconstruct.poll(), "a surface is no cloud"
    print("the add-on works")


main()
