"""The record of an export: what it was made of and what it wrote, for programs that keep it."""
import glob
import json
import os

import bpy


FRAME_OF = "patchlight_frame"
"""Custom property of images that show Patchlight's own frames: the camera."""


def write(path, written):
    """Writes a JSON file with `inputs`, paths of files besides the scene's own, and `files`, names of those written."""
    path.write_text(json.dumps({"inputs": inputs(), "files": [file.name for file in written]}), encoding="utf-8")


def inputs():
    """Paths of the files that the scene's file and its linked files name, relative to its folder; missing ones too,
    since they may come. Frames that the add-on shows are left out: they are made of the export."""
    folder = bpy.path.abspath("//")
    named = set(bpy.utils.blend_paths(absolute=True, packed=False, local=False))
    named -= {bpy.path.abspath(image.filepath) for image in bpy.data.images if FRAME_OF in image}
    return sorted({os.path.relpath(path, folder) for name in named if name for path in _parts(name)})


def _parts(path):
    """The files that a path stands for: more than one if it has tiles."""
    return glob.glob(glob.escape(path).replace("<UDIM>", "[0-9]" * 4)) if "<UDIM>" in path else [path]
