"""Entry of `blender -b SCENE.blend --python export.py -- --output DIR`: writes DIR/SCENE.glb and DIR/SCENE.yaml."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

from patchlight_blender import command  # noqa: E402

if __name__ == "__main__":
    command.main(sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else [])
