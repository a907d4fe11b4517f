"""Builds a scene of what is exported, writes it with Blender's glTF exporter, and completes the file."""
import json

import bpy

from . import cameras, glb, meshes

PRIVATE = "patchlight_"
"""Custom properties that tell `complete` what to change in the file. They are not written."""


OWN = ("KHR_materials_specular", "KHR_materials_ior", "KHR_materials_volume",
       "KHR_materials_diffuse_transmission")
"""Extensions of materials that are written here, since Blender's exporter gives plain diffuse surfaces a reflection."""


class Build:
    """The scene to export."""

    def __init__(self, source, frame):
        self.scene = bpy.data.scenes.new("patchlight export")
        render = self.scene.render
        render.resolution_x, render.resolution_y, render.resolution_percentage = frame.width, frame.height, 100
        render.pixel_aspect_x, render.pixel_aspect_y = source.render.pixel_aspect_x, source.render.pixel_aspect_y
        render.fps, render.fps_base = source.render.fps, source.render.fps_base
        self.scene.frame_start, self.scene.frame_end = source.frame_start, source.frame_end

    def add(self, obj, name, matrix, source=None, extras=()):
        """Puts an object into the scene, with the source's custom properties and `extras`."""
        obj.matrix_world = matrix
        for key in source.keys() if source else ():
            if isinstance(source[key], (int, float, str)) and not key.startswith(PRIVATE) and key not in obj:
                obj[key] = source[key]
        for key, value in dict(extras).items():
            obj[key] = value
        obj[f"{PRIVATE}name"] = name
        self.scene.collection.objects.link(obj)

    def add_meshes(self, instances, materials, lamps, points, report):
        """Adds the meshes with their exported materials."""
        meshes.prepare(instances)
        closed = {mesh for mesh in {item.mesh for item in instances} if meshes.is_closed(mesh)}
        one_sided = closed - meshes.seen_from_inside(instances, closed, points)
        ready = {}
        for item in instances:
            if item.mesh not in ready:
                ready[item.mesh] = self._assign(item, materials, item.mesh in closed, item.mesh in one_sided, report)
            if ready[item.mesh]:
                group = lamps.group(item.source, item.instancer)
                obj = bpy.data.objects.new("patchlight mesh", item.mesh)
                extras = {"light_group": group} if group else {}
                if not item.source.visible_camera:
                    extras["visible_camera"] = False
                self.add(obj, item.name, item.matrix, item.source, extras)

    def _assign(self, item, materials, is_closed, one_sided, report):
        """Gives a mesh its exported materials, and removes the faces that have none. Whether faces are left."""
        mesh, colors, gone = item.mesh, set(), set()
        if not mesh.materials:
            mesh.materials.append(None)
        used = _used(mesh)
        made = [materials.get(original, mesh, index, item.matrix, is_closed, one_sided) if index in used else None
                for index, original in enumerate(list(mesh.materials))]
        for index, result in enumerate(made):
            if result is None:
                gone.add(index)
                mesh.materials[index] = None
            else:
                mesh.materials[index] = result.material
                if result.colors is not None:
                    result.material[f"{PRIVATE}colors"] = 1
                    colors.add(result.colors)
        if gone & used:
            meshes.remove_faces(mesh, gone)
        if not mesh.polygons:
            return False
        _keep_colors(mesh, colors, item.source.name, report)
        if mesh.uv_layers:
            mesh.uv_layers[0].active_render = True
        mesh[f"{PRIVATE}name"] = item.source.data.name if item.source.data else item.source.name
        return True

    def add_camera(self, source, frame, path):
        """Adds a camera; `path` has its matrices by frame, or is empty."""
        data = source.data.copy()
        obj = bpy.data.objects.new("patchlight camera", data)
        if data.animation_data:
            data.animation_data_clear()
        data[f"{PRIVATE}name"] = source.data.name
        data[f"{PRIVATE}yfov"] = cameras.vertical_angle(data, frame)
        data[f"{PRIVATE}size"] = cameras.magnification(data, frame)
        self.add(obj, source.name, cameras.place(source.matrix_world), source, cameras.extras(source, frame))
        obj.rotation_mode = "QUATERNION"
        last = None
        for number, matrix in path.items():
            obj.location, obj.rotation_quaternion = matrix.to_translation(), matrix.to_quaternion()
            if last and last.dot(obj.rotation_quaternion) < 0:
                obj.rotation_quaternion.negate()
            last = obj.rotation_quaternion.copy()
            obj.keyframe_insert("location", frame=number)
            obj.keyframe_insert("rotation_quaternion", frame=number)
        if path:
            for curve in obj.animation_data.action.fcurves:
                for key in curve.keyframe_points:
                    key.interpolation = "LINEAR"

    def write(self, path, animated):
        """Writes the scene to the binary glTF file `path`."""
        bpy.context.window.scene = self.scene
        bpy.context.view_layer.update()
        known = bpy.ops.export_scene.gltf.get_rna_type().properties
        lighting = next(key for key in ("export_import_convert_lighting_mode", "convert_lighting_mode") if key in known)
        bpy.ops.export_scene.gltf(
            filepath=str(path), export_format="GLB", check_existing=False, use_active_scene=True, export_yup=True,
            export_apply=False, export_cameras=True, export_lights=True, export_extras=True, export_colors=True,
            export_animations=animated, export_force_sampling=True, export_frame_range=True, export_skins=False,
            export_morph=False, export_texcoords=True, export_normals=True, **{lighting: "SPEC"})
        complete(path)


def _used(mesh):
    last = max(len(mesh.materials) - 1, 0)
    return {min(int(k), last) for k in set(meshes.array(mesh.polygons, "material_index", 1, "int32"))}


def _keep_colors(mesh, wanted, name, report):
    """Leaves the one colour attribute that the materials use, since glTF multiplies all of a mesh's colours."""
    attributes = mesh.color_attributes
    chosen = None
    for layer in sorted(wanted):
        layer = layer or (attributes[attributes.render_color_index].name if len(attributes) else "")
        if layer not in attributes:
            report.warn(f"object '{name}': the colour attribute '{layer}' of its material is missing and is white")
        elif chosen and chosen != layer:
            report.warn(f"object '{name}': of its colour attributes only '{chosen}' is exported, not '{layer}'")
        else:
            chosen = layer
    for other in [a.name for a in attributes if a.name != chosen]:
        attributes.remove(attributes[other])
    if chosen:
        attributes.render_color_index = attributes.find(chosen)


def complete(path):
    """Puts the names, angles and texture coordinates into the file that Blender's exporter cannot write."""
    document, rest = glb.read(path)
    for kind in ("nodes", "meshes", "materials", "cameras"):
        for item in document.get(kind, []):
            private = glb.take_private(item, PRIVATE)
            item["name"] = private.get("name", item.get("name", ""))
            if "perspective" in item:
                item["perspective"]["yfov"] = private["yfov"]
            if "orthographic" in item:
                item["orthographic"]["xmag"], item["orthographic"]["ymag"] = private["size"]
            if "extensions" in private:
                glb.set_extensions(item, json.loads(private["extensions"]), OWN)
            for texture, index in private.get("uv", {}).items():
                glb.set_coordinates(item, texture, index)
            item["_colors"] = "colors" in private
    for mesh in document.get("meshes", []):
        for primitive in mesh["primitives"]:
            material = primitive.get("material")
            if material is None or not document["materials"][material]["_colors"]:
                primitive["attributes"].pop("COLOR_0", None)
    for kind in ("nodes", "meshes", "materials", "cameras"):
        for item in document.get(kind, []):
            item.pop("_colors", None)
    glb.list_extensions(document, OWN)
    glb.write(path, document, rest)
