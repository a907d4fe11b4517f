"""Entry of `blender -b SCENE.blend --python export.py -- --output DIR`: writes DIR/SCENE.glb and DIR/SCENE.yaml."""
import os
import sys

import bpy

if bpy.app.version < (3, 4):  # asked before the package is read, since an old Python cannot read it
    sys.stderr.write("patchlight-export: error: Blender %s is too old: install Blender 3.4 or newer\n"
                     % bpy.app.version_string)
    sys.stderr.flush()
    os._exit(69)

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

from patchlight_blender import command  # noqa: E402

if __name__ == "__main__":
    command.main(sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else [])
