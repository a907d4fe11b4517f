"""Light groups: those that the exporter will make, and those of frames."""
import bpy

from ..lights import Lamps, is_animated
from . import exr
from .session import redraw

LAYER = "Combined_"


def of_scene(scene, view_layer):
    """Names of the light groups that an export of the scene has, as far as that can be told without one."""
    lamps, found = Lamps(scene, "", None, None), set()
    for obj in view_layer.objects:
        if obj.hide_render:
            continue
        if obj.type == "LIGHT":
            found.add(obj.data.name if is_animated(obj.data) else lamps.group(obj) or obj.name)
        else:
            shining = [slot.material for slot in obj.material_slots if slot.material and _shines(slot.material)]
            found.update(lamps.group(obj) or material.name for material in shining)
    world = scene.world
    if world and (world.use_nodes and any(node.type == "BACKGROUND" and _is_on(node, "Strength", "Color")
                                          for node in world.node_tree.nodes) or
                  not world.use_nodes and any(world.color)):
        found.add(world.lightgroup or "environment")
    return sorted(name.replace("/", "_") for name in found)


def of_frame(path):
    """Names of the light groups that a frame has layers of."""
    return sorted({channel[len(LAYER):-2] for channel in exr.read(path).channels
                   if channel.startswith(LAYER) and channel.endswith(".R")})


def shown(scene, view_layer, found):
    """Names to show: those of the scene, those `found` in frames, and those that are changed."""
    changed = {item.name for item in scene.patchlight.groups if item.change()}
    return sorted({*of_scene(scene, view_layer), *found, *changed})


def keep(scene, names):
    """Gives each group its settings, soon: drawing must not write."""
    name = scene.name
    if any(group not in scene.patchlight.groups for group in names):
        bpy.app.timers.register(lambda: _add(bpy.data.scenes.get(name), names))


def _add(scene, names):
    for name in names if scene else ():
        if name not in scene.patchlight.groups:
            scene.patchlight.groups.add().name = name
    redraw()


def _shines(material):
    if not material.use_nodes or not material.node_tree:
        return False
    return any(node.type == "EMISSION" and _is_on(node, "Strength", "Color") or
               node.type == "BSDF_PRINCIPLED" and
               _is_on(node, "Emission Strength", "Emission" if "Emission" in node.inputs else "Emission Color")
               for node in _nodes(material.node_tree))


def _nodes(tree):
    for node in tree.nodes:
        yield node
        if node.type == "GROUP" and node.node_tree:
            yield from _nodes(node.node_tree)


def _is_on(node, strength, color):
    """Whether neither of two inputs is zero."""
    strength, color = node.inputs[strength], node.inputs[color]
    return bool((strength.is_linked or strength.default_value) and (color.is_linked or any(color.default_value[:3])))
