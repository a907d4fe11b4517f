"""Panels of Blender and of Cycles that are shown for the engine Patchlight too."""
import bpy

from .engine import ENGINE

CYCLES = ("PT_context_material", "LIGHT_PT_preview", "LIGHT_PT_light", "LIGHT_PT_nodes", "LIGHT_PT_beam_shape",
          "WORLD_PT_preview", "WORLD_PT_surface", "MATERIAL_PT_preview", "MATERIAL_PT_surface", "CAMERA_PT_dof",
          "CAMERA_PT_dof_aperture", "OBJECT_PT_lightgroup", "WORLD_PT_settings", "WORLD_PT_settings_light_group",
          "OBJECT_PT_visibility", "OBJECT_PT_visibility_ray_visibility")
"""Cycles' panels of what the exporter reads."""

LEFT_OUT = ("freestyle", "stereoscopy", "pencil")
"""Words in the names of panels of what Patchlight lacks."""

_kept = {}


def register():
    for panel in _panels():
        _kept[panel] = panel.__dict__.get("COMPAT_ENGINES")
        panel.COMPAT_ENGINES = panel.COMPAT_ENGINES | {ENGINE}


def unregister():
    for panel, engines in _kept.items():
        if engines is None:
            del panel.COMPAT_ENGINES
        else:
            panel.COMPAT_ENGINES = engines
    _kept.clear()


def _panels():
    for panel in bpy.types.Panel.__subclasses__():
        engines = getattr(panel, "COMPAT_ENGINES", ())
        if "BLENDER_RENDER" in engines and not any(word in panel.__name__ for word in LEFT_OUT):
            yield panel
    for name in CYCLES:
        panel = getattr(bpy.types, f"CYCLES_{name}", None)
        if panel:
            yield panel
