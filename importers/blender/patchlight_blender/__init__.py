"""Exports what Cycles would render of a Blender scene to a glTF file and a Patchlight job.

`command` is the entry. `capture` reads the scene as the render sees it, `nodes`, `materials` and `bake` reduce
materials, `lights`, `world` and `cameras` the rest, and `build` and `glb` write the file. `addon` is the add-on.
"""

bl_info = {
    "name": "Patchlight",
    "description": "Renders with Patchlight: radiosity solved once, for many cameras, frames and lightings",
    "author": "The Patchlight developers",
    "version": (1, 0, 0),
    "blender": (3, 4, 0),
    "location": "Properties > Render > Patchlight",
    "category": "Render",
}


def register():
    from . import addon
    addon.register()


def unregister():
    from . import addon
    addon.unregister()
