"""The add-on: a panel and operators that run the program `patchlight`, and a render engine.

`settings` and `groups` hold what the panel shows, `scene_file` finds or writes the file to render, `process` runs
programs, `pipeline` makes frames with them, `exr` and `pictures` read and show these, `operators`, `panel` and `engine`
are Blender's classes.
"""
import bpy

from . import compatibility, engine, main_thread, operators, panel, preferences, session, settings

OLDEST = (3, 4, 0)
MODULES = (session, preferences, settings, operators, panel, engine, main_thread, compatibility)


def register():
    if bpy.app.version < OLDEST:
        raise RuntimeError(f"Blender {bpy.app.version_string} is too old for Patchlight: install Blender 3.4 or newer")
    for module in MODULES:
        module.register()


def unregister():
    operators.cancel()
    for module in reversed(MODULES):
        module.unregister()
