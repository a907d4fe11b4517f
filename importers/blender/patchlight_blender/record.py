"""The record of an export: what it was made of and what it wrote, for programs that keep it."""
import json
import os

import bpy


def write(path, written):
    """Writes a JSON file with `inputs`, paths of files besides the scene's own, and `files`, names of those written."""
    path.write_text(json.dumps({"inputs": inputs(), "files": [file.name for file in written]}), encoding="utf-8")


def inputs():
    """Paths of the libraries, images, fonts, caches and photometric files that the scene's file names, relative to its
    folder; missing ones too, since they may come."""
    data = bpy.data
    named = [library.filepath for library in data.libraries]
    named += [image.filepath for image in data.images if image.source != "GENERATED" and not image.packed_file]
    named += [font.filepath for font in data.fonts if font.filepath != "<builtin>" and not font.packed_file]
    named += [cache.filepath for cache in data.cache_files]
    trees = [lamp.node_tree for lamp in data.lights if lamp.node_tree] + list(data.node_groups)
    named += [node.filepath for tree in trees for node in tree.nodes
              if node.type == "TEX_IES" and node.mode == "EXTERNAL"]
    folder = bpy.path.abspath("//")
    return sorted({os.path.relpath(bpy.path.abspath(path), folder) for path in named if path})
