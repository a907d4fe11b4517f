"""Reads the scene as a final render sees it.

Blender hands the dependency graph of a final render only to render engines. So the scene is rendered once with an
engine that draws nothing and copies what it is given: meshes with the render settings of their modifiers, instances,
lights. Everything that is hidden from rendering is absent from that graph. Curves, texts, surfaces and metaballs appear
in it a second time, as meshes.
"""
import dataclasses

import bpy

from .report import ExportError, names

LEFT_OUT = {"CURVES": "hair curves", "POINTCLOUD": "a point cloud", "VOLUME": "a volume",
            "GPENCIL": "grease pencil", "GREASEPENCIL": "grease pencil"}
RAYS = ("camera", "diffuse", "glossy", "transmission", "shadow")


@dataclasses.dataclass
class Instance:
    """A mesh or lamp at a place. `source` is the original object, `instancer` the object that repeats it, or None."""
    name: str
    source: object
    instancer: object
    matrix: object
    mesh: object = None


@dataclasses.dataclass
class Capture:
    meshes: list = dataclasses.field(default_factory=list)
    lamps: list = dataclasses.field(default_factory=list)


class _Engine(bpy.types.RenderEngine):
    bl_idname = "PATCHLIGHT_CAPTURE"
    bl_label = "Patchlight capture"
    reader = None

    def update(self, data, depsgraph):
        if _Engine.reader:
            reader, _Engine.reader = _Engine.reader, None
            reader(depsgraph)

    def render(self, depsgraph):
        pass


def capture(scene, report):
    """Reads `scene` in its current frame. New meshes are left in `bpy.data.meshes`; the scene stays as it was."""
    layers = [layer for layer in scene.view_layers if layer.use]
    if not layers:
        raise ExportError("no view layer is used for rendering: tick 'Use for Rendering' in its properties", 65)
    if len(layers) > 1:
        report.warn(f"view layers {names(l.name for l in layers[1:])} are ignored: '{layers[0].name}' is exported")
    result, failure = Capture(), []

    def reader(depsgraph):
        try:
            _read(depsgraph, layers[0], result, report)
        except Exception as error:  # Blender would swallow it in its own render thread
            failure.append(error)

    _render_with(scene, reader)
    if failure:
        raise failure[0]
    return result


def _render_with(scene, reader):
    """Runs the capturing engine on `scene`, and restores the settings that it needs."""
    render, camera = scene.render, None
    kept = {key: getattr(render, key) for key in
            ("engine", "use_compositing", "use_sequencer", "resolution_x", "resolution_y", "resolution_percentage",
             "use_multiview", "use_border")}
    simple = dict(kept, engine=_Engine.bl_idname, use_compositing=False, use_sequencer=False, resolution_x=64,
                  resolution_y=64, resolution_percentage=100, use_multiview=False, use_border=False)
    bpy.utils.register_class(_Engine)
    try:
        if scene.camera is None:
            camera = bpy.data.objects.new("patchlight", bpy.data.cameras.new("patchlight"))
            scene.collection.objects.link(camera)
            scene.camera = camera
        for key, value in simple.items():
            setattr(render, key, value)
        _Engine.reader = reader
        bpy.ops.render.render(scene=scene.name)
    finally:
        for key, value in kept.items():
            setattr(render, key, value)
        if camera:
            data = camera.data
            bpy.data.objects.remove(camera)
            bpy.data.cameras.remove(data)
        bpy.utils.unregister_class(_Engine)


def _read(depsgraph, layer, result, report):
    meshes = {}
    for item in depsgraph.object_instances:
        obj = item.object
        source = obj.original
        instancer = item.parent.original if item.is_instance and item.parent else None
        if instancer == source:
            instancer = None
        name = f"{instancer.name}/{source.name}" if instancer else source.name
        if not item.show_self:
            continue
        if obj.type == "LIGHT":
            result.lamps.append(Instance(name, source, instancer, item.matrix_world.copy()))
        elif obj.type in LEFT_OUT:
            report.warn(f"object '{source.name}' is {LEFT_OUT[obj.type]} and is left out: convert it to a mesh")
        elif obj.type == "MESH" and _is_kept(source, obj, layer, report):
            key = (obj.data.as_pointer(), tuple(slot.material.as_pointer() if slot.material else 0
                                                for slot in obj.material_slots))
            if key not in meshes:
                meshes[key] = _copy_mesh(obj, layer)
            if meshes[key]:
                result.meshes.append(Instance(name, source, instancer, item.matrix_world.copy(), meshes[key]))


def _copy_mesh(obj, layer):
    """The evaluated mesh as new data, with the materials' originals; None for a mesh without faces."""
    mesh = bpy.data.meshes.new_from_object(obj)
    if mesh is None or not mesh.polygons:
        if mesh:
            bpy.data.meshes.remove(mesh)
        return None
    mesh.use_auto_texspace = False  # generated coordinates refer to the space of the mesh that Cycles sees
    mesh.texspace_location, mesh.texspace_size = obj.data.texspace_location, obj.data.texspace_size
    for index, slot in enumerate(obj.material_slots):
        if slot.link == "OBJECT" and index < len(mesh.materials):
            mesh.materials[index] = slot.material.original if slot.material else None
    if layer.material_override:
        override = layer.material_override
        for index in range(len(mesh.materials)):
            mesh.materials[index] = override
        if not mesh.materials:
            mesh.materials.append(override)
    return mesh


def _is_kept(source, obj, layer, report):
    """Whether the object is exported at all. Names what its settings for rays lose."""
    name = f"object '{source.name}'"
    if source.is_holdout or source.holdout_get(view_layer=layer):
        report.warn(f"{name} is a holdout and is left out")
        return False
    if source.is_shadow_catcher:
        report.warn(f"{name} is a shadow catcher and is left out")
        return False
    for modifier in obj.modifiers:
        if modifier.type == "PARTICLE_SYSTEM":
            settings = modifier.particle_system.settings
            if settings.type == "HAIR" and settings.render_type == "PATH":
                report.warn(f"hair '{modifier.particle_system.name}' of {name} is left out: convert it to a mesh")
    unseen = [ray for ray in RAYS if not getattr(source, f"visible_{ray}")]
    if len(unseen) == len(RAYS):
        return False
    unseen = [ray for ray in unseen if ray != "camera"]
    if unseen:
        report.warn(f"{name} is invisible to {', '.join(unseen)} rays in Cycles, but is exported visible to all: "
                    f"'nodes: {{\"{source.name}\": {{exclude: true}}}}' in the job leaves it out")
    return True
