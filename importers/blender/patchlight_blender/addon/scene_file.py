"""The file to render: the saved one, or a copy of what is open."""
import pathlib
import sys

import bpy

from .session import Problem


SCRIPTS = {"-P", "--python", "--python-expr", "--python-text", "--python-console"}


def output_folder(scene):
    """Folder of all files that the scene's renders make."""
    named = scene.patchlight.output
    if named.startswith("//") and not bpy.data.filepath:
        raise Problem(f"the output folder '{named}' is relative to a file that was never saved: save the file, or name "
                      "a whole path")
    if named:
        return pathlib.Path(bpy.path.abspath(named))
    blend = pathlib.Path(bpy.data.filepath or pathlib.Path(bpy.app.tempdir) / "untitled.blend")
    return blend.with_suffix(".patchlight")


def stem():
    """Name of the file, without its ending."""
    return pathlib.Path(bpy.data.filepath).stem or "untitled"


def is_saved(scene):
    """Whether the file on the disk has the scene as it is open. Blender marks no changes in background mode, where
    scripts of the command line may have made some. The exporter takes a file's active scene, so it must be the only."""
    changed = bpy.data.is_dirty or bpy.app.background and SCRIPTS & set(sys.argv)
    return bool(bpy.data.filepath) and not changed and len(bpy.data.scenes) == 1


def file_to_render(scene):
    """Path of the saved file, or of a copy in the output folder. Copies of the same data are the same bytes, once the
    collections have their lists of objects, of which a copy holds the address."""
    if is_saved(scene):
        return pathlib.Path(bpy.data.filepath)
    copy = output_folder(scene) / "unsaved" / f"{stem()}.blend"
    try:
        copy.parent.mkdir(parents=True, exist_ok=True)
        for collection in (scene.collection, *scene.collection.children_recursive):
            len(collection.all_objects)
        bpy.data.libraries.write(str(copy), {scene}, path_remap="RELATIVE_ALL")
    except (OSError, RuntimeError) as error:
        raise Problem(f"cannot write '{copy}' ({error}): choose another output folder") from error
    return copy
