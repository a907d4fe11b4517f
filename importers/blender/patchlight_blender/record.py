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
    named = [(library.filepath, library.parent) for library in data.libraries]
    named += [(path, image.library) for image in data.images if image.source != "GENERATED" and not image.packed_file
              for path in _parts(image)]
    named += [(font.filepath, font.library) for font in data.fonts
              if font.filepath != "<builtin>" and not font.packed_file]
    named += [(cache.filepath, cache.library) for cache in data.cache_files]
    trees = [(lamp.node_tree, lamp.library) for lamp in data.lights if lamp.node_tree]
    trees += [(tree, tree.library) for tree in data.node_groups]
    named += [(node.filepath, library) for tree, library in trees for node in tree.nodes
              if node.type == "TEX_IES" and node.mode == "EXTERNAL"]
    folder = bpy.path.abspath("//")
    return sorted({os.path.relpath(bpy.path.abspath(path, library=library), folder) for path, library in named if path})


def _parts(image):
    """Paths of an image's files: more than one if it has tiles."""
    if image.source != "TILED":
        return [image.filepath]
    return [image.filepath.replace("<UDIM>", str(tile.number)) for tile in image.tiles]
