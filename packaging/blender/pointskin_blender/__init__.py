"""Pointskin in Blender: point clouds in, watertight meshes out, with their colours. For Blender 3.1 and newer.

Needs the Python package `pointskin` where Blender's Python finds it: installed beside it, or its folder named in the add-on's
preferences. Objects > Reconstruct Surface, or the panel Pointskin of the sidebar."""
import os
import sys

import bpy
import numpy as np
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty

bl_info = {
    "name": "Pointskin",
    "author": "The Pointskin authors",
    "version": (0, 1, 0),
    "blender": (3, 1, 0),
    "location": "View3D > Object > Reconstruct Surface; File > Import > Points",
    "description": "Watertight meshes of point clouds",
    "category": "Mesh",
}

NORMALS = ("point_normal", "normal", "Normal", "N")  # attributes that are taken for normals; the first one is ours
COLOUR = "Color"


def package(context):
    """The Python package. Raises ImportError with what to do."""
    add_on = context.preferences.addons.get(__name__)
    folder = add_on.preferences.folder if add_on is not None else ""
    if folder and bpy.path.abspath(folder) not in sys.path:
        sys.path.insert(0, bpy.path.abspath(folder))
    try:
        import pointskin
    except ImportError as error:
        raise ImportError(f"the Python package pointskin was not found ({error}); name its folder in the add-on's preferences") from None
    return pointskin


class Preferences(bpy.types.AddonPreferences):
    bl_idname = __name__
    folder: StringProperty(name="Folder of the Python package", subtype="DIR_PATH",
                           description="Where the folder pointskin lies; empty if Blender's Python finds it")

    def draw(self, context):
        self.layout.prop(self, "folder")


# ---- Blender's data as arrays


def floats(collection, name, width):
    values = np.empty(len(collection) * width, dtype=np.float32)
    collection.foreach_get(name, values)
    return values.reshape(-1, width)


def is_cloud(item):
    """Objects of points: meshes without faces, and point clouds."""
    return item.type == "POINTCLOUD" or (item.type == "MESH" and len(item.data.polygons) == 0 and len(item.data.vertices) > 0)


def points_of(item):
    """Positions and normals in world coordinates (None without them), and colours as uint8 (None without them)."""
    data = item.data
    local = floats(data.vertices, "co", 3) if item.type == "MESH" else floats(data.points, "co", 3)
    matrix = np.array(item.matrix_world, dtype=np.float64)
    positions = local @ matrix[:3, :3].T + matrix[:3, 3]
    normals = colours = None
    attribute = next((data.attributes[name] for name in NORMALS if name in data.attributes), None)
    if attribute is not None and attribute.data_type == "FLOAT_VECTOR" and attribute.domain == "POINT":
        normals = floats(attribute.data, "vector", 3) @ np.linalg.inv(matrix[:3, :3])
    for attribute in data.attributes:
        if attribute.data_type in ("FLOAT_COLOR", "BYTE_COLOR") and attribute.domain == "POINT":
            colours = np.rint(255 * np.clip(floats(attribute.data, "color_srgb", 4)[:, :3], 0, 1)).astype(np.uint8)
            break
    return positions, normals, colours


def set_colours(data, rgb):
    """A colour a vertex, shown at once in solid view."""
    attribute = data.color_attributes.new(COLOUR, "BYTE_COLOR", "POINT")
    rgba = np.ones((len(rgb), 4), dtype=np.float32)
    rgba[:, :3] = np.asarray(rgb, dtype=np.float32) / 255
    attribute.data.foreach_set("color_srgb", rgba.ravel())
    data.color_attributes.active_color = attribute


def new_object(context, name, vertices, faces=None):
    """A mesh object in the scene's collection, selected and active."""
    data = bpy.data.meshes.new(name)
    data.vertices.add(len(vertices))
    data.vertices.foreach_set("co", np.ascontiguousarray(vertices, dtype=np.float32).ravel())
    if faces is not None:
        data.loops.add(3 * len(faces))
        data.loops.foreach_set("vertex_index", np.ascontiguousarray(faces, dtype=np.int32).ravel())
        data.polygons.add(len(faces))
        starts = np.arange(0, 3 * len(faces), 3, dtype=np.int32)
        data.polygons.foreach_set("loop_start", starts)
        if bpy.app.version < (4, 0, 0):
            data.polygons.foreach_set("loop_total", np.full(len(faces), 3, dtype=np.int32))
        data.polygons.foreach_set("use_smooth", np.ones(len(faces), dtype=bool))
    data.update(calc_edges=True)
    item = bpy.data.objects.new(name, data)
    context.scene.collection.objects.link(item)
    for other in context.selected_objects:
        other.select_set(False)
    item.select_set(True)
    context.view_layer.objects.active = item
    return item


# ---- Operators


class Reconstruct(bpy.types.Operator):
    """Make a watertight mesh of the selected point clouds"""

    bl_idname = "object.pointskin_reconstruct"
    bl_label = "Reconstruct Surface"
    bl_options = {"REGISTER", "UNDO"}

    automatic_depth: BoolProperty(name="Automatic Depth", default=True, description="The depth that the points support")
    depth: IntProperty(name="Depth", default=8, min=1, max=14, description="Octree depth: cells are the cube / 2^depth wide")
    trim: FloatProperty(name="Trim", default=0, min=0, max=0.99, description="Cut where points end; 0: closed")
    screening: FloatProperty(name="Screening", default=2, min=0, soft_max=20, description="Weight of the points")
    normals: EnumProperty(name="Normals", default="AUTO", items=(
        ("AUTO", "Automatic", "Given ones, repaired where they are wrong; estimated where there are none"),
        ("ESTIMATE", "Estimate", "Always estimated"), ("GIVEN", "Given", "As they are")))
    colours: BoolProperty(name="Colours", default=True, description="Carry the points' colours to the mesh")
    hide: BoolProperty(name="Hide Points", default=True, description="Hide the point clouds afterwards")

    @classmethod
    def poll(cls, context):
        return any(is_cloud(item) for item in context.selected_objects)

    def execute(self, context):
        try:
            ps = package(context)
            mesh = self.mesh_of(ps, [item for item in context.selected_objects if is_cloud(item)])
        except ImportError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        except Exception as error:  # the library's own errors are sentences for people
            if type(error).__module__.split(".")[0] != "pointskin":
                raise
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        clouds = [item for item in context.selected_objects if is_cloud(item)]
        made = new_object(context, clouds[0].name + " surface", mesh.vertices, mesh.faces)
        if self.colours and "rgb" in mesh.attributes:
            set_colours(made.data, mesh.attributes["rgb"])
        for item in clouds:
            item.hide_set(self.hide)
        self.report({"INFO"}, f"{len(mesh)} triangles")
        return {"FINISHED"}

    def mesh_of(self, ps, items):
        parts = [points_of(item) for item in items]
        with_normals = all(normals is not None for _, normals, _ in parts) and self.normals != "ESTIMATE"
        clouds = [ps.Cloud(positions, normals if with_normals else None, {} if colours is None else {"rgb": colours})
                  for positions, normals, colours in parts]
        cloud = ps.merge(*clouds)
        return ps.reconstruct(
            cloud, depth="auto" if self.automatic_depth else self.depth, trim=self.trim, screening=self.screening,
            attributes=self.colours,
            point_normals="given" if self.normals == "GIVEN" else "auto" if with_normals else "estimate")


class ImportPoints(bpy.types.Operator):
    """Import points, or a mesh, of any format that Pointskin reads"""

    bl_idname = "import_scene.pointskin"
    bl_label = "Import Points"
    bl_options = {"REGISTER", "UNDO"}

    filepath: StringProperty(subtype="FILE_PATH")

    def invoke(self, context, event):
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, context):
        try:
            ps = package(context)
            found = ps.read(self.filepath)
        except (ImportError, ValueError, OSError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        name = os.path.splitext(os.path.basename(self.filepath))[0]
        is_mesh = isinstance(found, ps.Mesh)
        made = new_object(context, name, found.vertices if is_mesh else found.points, found.faces if is_mesh else None)
        if found.normals is not None and not is_mesh:
            attribute = made.data.attributes.new(NORMALS[0], "FLOAT_VECTOR", "POINT")
            attribute.data.foreach_set("vector", np.ascontiguousarray(found.normals).ravel())
        if "rgb" in found.attributes and found.attributes["rgb"].dtype == np.uint8:
            set_colours(made.data, found.attributes["rgb"])
        return {"FINISHED"}


class Panel(bpy.types.Panel):
    bl_idname = "VIEW3D_PT_pointskin"
    bl_label = "Pointskin"
    bl_space_type, bl_region_type, bl_category = "VIEW_3D", "UI", "Pointskin"

    def draw(self, context):
        self.layout.operator(ImportPoints.bl_idname, icon="IMPORT")
        self.layout.operator(Reconstruct.bl_idname, icon="MESH_ICOSPHERE")


CLASSES = (Preferences, Reconstruct, ImportPoints, Panel)


def object_menu(self, _context):
    self.layout.operator(Reconstruct.bl_idname)


def import_menu(self, _context):
    self.layout.operator(ImportPoints.bl_idname, text="Points (Pointskin)")


def register():
    for entry in CLASSES:
        bpy.utils.register_class(entry)
    bpy.types.VIEW3D_MT_object.append(object_menu)
    bpy.types.TOPBAR_MT_file_import.append(import_menu)


def unregister():
    bpy.types.TOPBAR_MT_file_import.remove(import_menu)
    bpy.types.VIEW3D_MT_object.remove(object_menu)
    for entry in reversed(CLASSES):
        bpy.utils.unregister_class(entry)
