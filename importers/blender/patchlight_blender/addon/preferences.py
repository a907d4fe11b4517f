"""The program `patchlight`: where it is found, and the preference that names it."""
import os
import pathlib
import shutil

import bpy

from .session import Problem


PACKAGE = __package__.rpartition(".")[0]


class PatchlightPreferences(bpy.types.AddonPreferences):
    bl_idname = PACKAGE

    program: bpy.props.StringProperty(
        name="Program", subtype="FILE_PATH",
        description="The program patchlight. Empty: $PATCHLIGHT, else the one in $PATH or where it is installed")

    def draw(self, context):
        self.layout.prop(self, "program")
        try:
            self.layout.label(text=f"Uses {program()}", icon="CHECKMARK")
        except Problem as problem:
            self.layout.label(text=str(problem), icon="ERROR")


def program():
    """Path of the program `patchlight`."""
    addon = bpy.context.preferences.addons.get(PACKAGE)
    named = addon.preferences.program if addon else ""
    if named:
        return _program(bpy.path.abspath(named), "the add-on's preferences name")
    if os.environ.get("PATCHLIGHT"):
        return _program(os.environ["PATCHLIGHT"], "$PATCHLIGHT names")
    beside = pathlib.Path(__file__).resolve().parents[5] / "bin"  # of share/patchlight/blender/patchlight_blender/addon
    places = [os.environ.get("PATH", ""), beside, pathlib.Path.home() / ".local/bin", "/usr/local/bin", "/usr/bin"]
    found = shutil.which("patchlight", path=os.pathsep.join(map(str, places)))
    if not found:
        raise Problem("there is no program patchlight: install Patchlight, or name the program in Edit > Preferences > "
                      "Add-ons > Patchlight")
    return found


def _program(path, source):
    if not shutil.which(path):
        raise Problem(f"{source} '{path}', which is no program: name the program patchlight in Edit > Preferences > "
                      "Add-ons > Patchlight")
    return path


def register():
    bpy.utils.register_class(PatchlightPreferences)


def unregister():
    bpy.utils.unregister_class(PatchlightPreferences)
