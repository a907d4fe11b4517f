"""The command: reads its options, exports the open scene, and puts all files in place at once."""
import argparse
import os
import pathlib
import shutil
import sys
import tempfile
import traceback

import addon_utils
import bpy

from . import cameras, capture, job, motion, record
from .build import Build
from .lights import Lamps
from .materials import Materials
from .report import PREFIX, ExportError, Report, names
from .world import World

KINDS = ("scenes", "objects", "meshes", "materials", "images", "lights", "cameras", "worlds", "actions", "collections")
"""Collections of `bpy.data` that an export adds to."""


def main(arguments):
    """Exports as `arguments` say. Ends Blender with one sentence and an exit code of `pipeline/README.md` on errors."""
    try:
        options = parse(arguments)
        bpy.utils.register_class(_Engine)
        written = export(bpy.context.scene, options, Report())
        for path in written:
            print(f"{PREFIX}: wrote {path}")
        if options.record:
            record.write(options.record, written)
    except ExportError as error:
        fail(str(error), error.code)
    except Exception as error:
        traceback.print_exc()
        fail(f"internal fault ({error}): please report it with the scene", 70)


class _Engine(bpy.types.RenderEngine):
    """Stands for the add-on's engine, which is not loaded here, so that Blender knows the engine of its scenes."""
    bl_idname, bl_label = job.ENGINE, "Patchlight"


def fail(text, code):
    """Ends Blender, which itself would end with exit code 0."""
    print(f"{PREFIX}: error: {' '.join(text.split())}", file=sys.stderr, flush=True)
    sys.stdout.flush()
    os._exit(code)


def parse(arguments):
    parser = argparse.ArgumentParser(prog="blender -b SCENE.blend --python export.py --",
                                     description="Exports what Cycles would render to glTF and a Patchlight job.")
    parser.add_argument("--output", type=pathlib.Path, help="folder of the files; default: the folder of the scene")
    parser.add_argument("--name", help="name of the files; default: that of the scene's file")
    parser.add_argument("--resolution", type=int, nargs=2, metavar=("WIDTH", "HEIGHT"),
                        help="pixels of the frame; default: the scene's. Blender's angle of view depends on them")
    parser.add_argument("--bake-resolution", type=int, default=1024, help="pixels of a side of baked textures")
    parser.add_argument("--sky-resolution", type=int, default=1024, help="pixels of a row of a baked sky")
    parser.add_argument("--record", type=pathlib.Path, help="JSON file to write: the files that were read and written")
    parser.add_argument("--threads", type=int, default=0, help="threads of Cycles for baking; default: all")
    try:
        return parser.parse_args(arguments)
    except SystemExit as end:
        sys.stdout.flush()
        os._exit(64 if end.code else 0)


def export(scene, options, report):
    """Exports `scene` and returns the paths of the files. The scene and its data stay as they were."""
    for addon in ("cycles", "io_scene_gltf2"):
        if not addon_utils.check(addon)[1] and not addon_utils.enable(addon):
            raise ExportError(f"Blender's add-on '{addon}' is missing: install Blender with its add-ons", 69)
    blend = pathlib.Path(bpy.data.filepath) if bpy.data.filepath else None
    name = options.name or (blend.stem if blend else "untitled")
    folder = options.output or (blend.parent if blend else pathlib.Path.cwd())
    try:
        folder.mkdir(parents=True, exist_ok=True)
        work = pathlib.Path(tempfile.mkdtemp(prefix=f".{name}.", dir=folder))
    except OSError as error:
        raise ExportError(f"cannot write to '{folder}' ({error.strerror}): choose another with --output", 73) from error
    window = bpy.context.window
    shown, before = window.scene, everything()
    try:
        window.scene = scene
        write_all(scene, work, name, options, report)
        written = sorted(work.iterdir(), key=lambda path: (path.suffix == ".yaml", path.name))
        used = {os.path.realpath(os.path.join(bpy.path.abspath("//"), path)) for path in record.inputs()}
        for path in written:
            if os.path.realpath(folder / path.name) in used:
                raise ExportError(f"'{folder / path.name}' is a file of the scene: choose another folder with --output", 73)
        for path in written:
            os.replace(path, folder / path.name)
        return [folder / path.name for path in written]
    finally:
        window.scene = shown
        bpy.data.batch_remove(everything() - before)
        shutil.rmtree(work, ignore_errors=True)


def everything():
    return {item for kind in KINDS for item in getattr(bpy.data, kind)}


def _add_lamp(build, lamps, item):
    """Adds a lamp. Whether it gives light."""
    lamp = lamps.add(item)
    if lamp:
        build.add(lamp, item.name, item.matrix, item.source)
    return bool(lamp)


def warn_of_darkness(scene, found, report):
    """Names the lamps of a scene in which nothing gives light."""
    seen = {item.source for item in found.lamps}
    hidden = [obj.name for obj in scene.objects if obj.type == "LIGHT" and obj not in seen]
    dark = [obj.name for obj in seen if not obj.data.cycles.is_portal]
    which = "; ".join(f"{text}: {names(lamps)}" for text, lamps in
                      (("hidden from rendering", hidden), ("without strength", dark)) if lamps)
    report.warn("nothing gives light, so all frames are black: add a lamp, or light the world" +
                (f" (lamps {which})" if which else ""))


def write_all(scene, folder, name, options, report):
    """Writes all files of an export into `folder`."""
    for library in bpy.data.libraries:
        if not os.path.exists(bpy.path.abspath(library.filepath)):
            report.warn(f"the library '{library.filepath}' is missing, with all that is linked from it: "
                        "find it with File > External Data")
    job.warn_of_render(scene, report)
    frame = cameras.Frame(scene.render, options.resolution)
    views = [obj for obj in scene.objects if obj.type == "CAMERA" and cameras.warn_of(obj, scene, report)]
    paths = motion.paths(scene, views, cameras.place)
    found = capture.capture(scene, report)
    motion.warn(found, scene, report)
    materials = Materials(scene, report, options.bake_resolution, options.threads)
    lamps = Lamps(scene, name, materials.baker, report)
    lamps.follow(found.lamps)
    world = World(scene, folder, name, options, materials.baker, report)
    build = Build(scene, frame)
    points = [obj.matrix_world.translation for obj in views] + [item.matrix.translation for item in found.lamps]
    build.add_meshes(found.meshes, materials, lamps, points, report)
    made = {item.source for item in found.lamps if _add_lamp(build, lamps, item)}
    for obj in world.suns():
        build.add(obj, obj.name, obj.matrix_world.copy())
    if not (made or world.environment or materials.shines):
        warn_of_darkness(scene, found, report)
    for obj in views:
        build.add_camera(obj, frame, paths.get(obj, {}))
    build.write(folder / f"{name}.glb", bool(paths))
    for file, data in lamps.files.items():
        (folder / file).write_bytes(data)
    used = [obj for obj in cameras.active(scene, report) if obj in views]
    (folder / f"{name}.yaml").write_text(
        job.text(name, frame, used, bool(lamps.settings) or any(obj in paths for obj in used), materials.excluded,
                 world.environment, lamps.settings, job.view_settings(scene, report), scene), encoding="utf-8")
