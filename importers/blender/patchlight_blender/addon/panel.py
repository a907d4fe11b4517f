"""The panel in the render properties: open for the engine Patchlight, closed for others."""
import textwrap

import bpy

from . import groups
from .engine import ENGINE
from .session import session

LETTER, MARGIN = 6.2, 70
"""Pixels of a letter, and of what stands beside a text in the panel, at a scale of 1."""


class _Panel:
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"
    is_engine = True
    """Whether the panel is that of the engine Patchlight."""

    @classmethod
    def poll(cls, context):
        return (context.engine == ENGINE) == cls.is_engine


class _Main(_Panel):
    bl_label = "Patchlight"

    def draw(self, context):
        layout, settings = self.layout, context.scene.patchlight
        layout.use_property_split, layout.use_property_decorate = True, False
        _draw_work(layout, context)
        if session.problem:
            _draw_messages(layout, context, [session.problem], "ERROR")
        column = layout.column()
        column.prop(settings, "quality")
        column.prop(settings, "patch_area")
        column = layout.column()
        column.row().prop(settings, "cameras", expand=True)
        column.row().prop(settings, "frames", expand=True)
        layout.prop(settings, "output")


class _Groups(_Panel):
    bl_label = "Light Groups"

    def draw(self, context):
        layout, scene = self.layout, context.scene
        names = groups.shown(scene, context.view_layer, session.groups)
        if not names:
            layout.label(text="The scene has no lamps", icon="INFO")
        groups.keep(scene, names)
        column = layout.column(align=True)
        for name in names:
            item = scene.patchlight.groups.get(name)
            row = column.row().split(factor=0.5)
            row.label(text=name)
            if item:
                values = row.row(align=True)
                values.prop(item, "strength", text="")
                values.prop(item, "color", text="")
        layout.operator("patchlight.relight", icon="LIGHT")


class _Warnings(_Panel):
    bl_label = "Warnings"

    @classmethod
    def poll(cls, context):
        return bool(session.warnings) and super().poll(context)

    def draw(self, context):
        _draw_messages(self.layout, context, session.warnings, "INFO")


def _draw_work(layout, context):
    row = layout.row(align=True)
    row.scale_y = 1.3
    if session.work:
        row.use_property_split = False
        row.prop(context.window_manager, "patchlight_progress", text=session.work.text, slider=True)
        row.operator("patchlight.cancel", text="", icon="X")
    else:
        row.operator("patchlight.render", text="Render", icon="RENDER_STILL")
        row.operator("patchlight.show", text="Show Frames", icon="IMAGE_DATA")


def _draw_messages(layout, context, messages, icon):
    pixels = context.region.width / context.preferences.system.ui_scale - MARGIN
    box = layout.box().column()
    for text in messages:
        lines = box.column(align=True)
        lines.alert = icon == "ERROR"
        for index, line in enumerate(textwrap.wrap(text[:1].upper() + text[1:], max(int(pixels / LETTER), 12))):
            lines.label(text=line, icon="BLANK1" if index else icon)


def _classes():
    """The panels for the engine Patchlight, and closed ones for the others."""
    for is_engine in (True, False):
        ending, options = ("", set()) if is_engine else ("_other", {"DEFAULT_CLOSED"})
        parent = f"PATCHLIGHT_PT_render{ending}"
        yield type(parent, (_Main, bpy.types.Panel), {"is_engine": is_engine, "bl_options": options})
        for name, base in (("groups", _Groups), ("warnings", _Warnings)):
            yield type(f"PATCHLIGHT_PT_{name}{ending}", (base, bpy.types.Panel),
                       {"is_engine": is_engine, "bl_parent_id": parent})


CLASSES = tuple(_classes())


def _progress(manager):
    return 100 * session.work.fraction if session.work else 0


def register():
    bpy.types.WindowManager.patchlight_progress = bpy.props.FloatProperty(
        name="Progress", description="Esc stops it", subtype="PERCENTAGE", min=0, max=100, precision=0, get=_progress)
    for cls in CLASSES:
        bpy.utils.register_class(cls)


def unregister():
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
    del bpy.types.WindowManager.patchlight_progress
