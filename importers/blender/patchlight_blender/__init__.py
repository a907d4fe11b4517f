"""Exports what Cycles would render of a Blender scene to a glTF file and a Patchlight job.

`command` is the entry. `capture` reads the scene as the render sees it, `nodes`, `materials` and `bake` reduce
materials, `lights`, `world` and `cameras` the rest, and `build` and `glb` write the file.
"""

VERSION = 1
"""Version of the export. It changes whenever the same scene gives other files."""
