"""Installing, registering, light groups, and finding the program."""
import os
import pathlib
import subprocess
import tempfile

import bpy
import patchlight_blender
from patchlight_blender import addon, record
from patchlight_blender.addon import groups, preferences
from patchlight_blender.addon.session import Problem
from support import PROGRAM, AddonTest

ZIP = pathlib.Path(PROGRAM).parents[1] / "share/patchlight/patchlight_blender.zip"
INSTALL = f"""
import bpy
bpy.ops.preferences.addon_install(filepath=r"{ZIP}")
bpy.ops.preferences.addon_enable(module="patchlight_blender")
from patchlight_blender import command
print("installed in", bpy.types.PATCHLIGHT_OT_render, command.__file__)
"""


class Register(AddonTest):
    def test_the_archive_installs(self):
        with tempfile.TemporaryDirectory() as scripts:
            done = subprocess.run(
                [bpy.app.binary_path, "-b", "--factory-startup", "--python-exit-code", "1", "--python-expr", INSTALL],
                capture_output=True, text=True, check=False, env=dict(os.environ, BLENDER_USER_SCRIPTS=scripts))
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            self.assertIn(f"{scripts}/addons/patchlight_blender/command.py", done.stdout)

    def test_nothing_is_left_after_unregistering(self):
        panels = bpy.types.Panel.__subclasses__()
        def known():
            return {panel for panel in panels if "PATCHLIGHT" in getattr(panel, "COMPAT_ENGINES", ())}
        self.assertIn(bpy.types.CYCLES_MATERIAL_PT_surface, known())
        self.assertNotIn(bpy.types.CYCLES_RENDER_PT_light_paths, known())
        patchlight_blender.unregister()
        try:
            self.assertEqual(known(), set())
            self.assertFalse(hasattr(bpy.types, "PATCHLIGHT_OT_render"))
            self.assertFalse(hasattr(bpy.types.Scene, "patchlight"))
            self.assertFalse(hasattr(bpy.types.WindowManager, "patchlight_progress"))
        finally:
            patchlight_blender.register()
        self.assertIn(bpy.types.CYCLES_MATERIAL_PT_surface, known())

    def test_an_old_blender_is_refused(self):
        self.assertEqual(patchlight_blender.bl_info["blender"], addon.OLDEST)
        oldest, addon.OLDEST = addon.OLDEST, (99, 0, 0)
        try:
            with self.assertRaisesRegex(RuntimeError, "is too old for Patchlight: install Blender"):
                patchlight_blender.register()
        finally:
            addon.OLDEST = oldest

    def test_the_program_is_found(self):
        self.assertEqual(preferences.program(), os.environ["PATCHLIGHT"])
        path, named = os.environ["PATH"], os.environ.pop("PATCHLIGHT")
        try:
            os.environ["PATH"] = str(self.folder)
            self.assertEqual(preferences.program(), str(self.folder / "patchlight"))
            os.environ["PATH"] = ""
            (self.folder / "patchlight").unlink()
            try:
                self.assertNotIn(str(self.folder), preferences.program())
            except Problem as problem:
                self.assertIn("install Patchlight", str(problem))
        finally:
            os.environ["PATH"], os.environ["PATCHLIGHT"] = path, named

    def test_light_groups_are_those_of_the_exporter(self):
        names = lambda: groups.of_scene(self.scene, bpy.context.view_layer)
        self.assertEqual(names(), ["lamp", "panel"])
        self.lamp["light_group"] = "a/b"
        self.floor.node_tree.nodes["Principled BSDF"].inputs["Emission"].default_value = (1, 0, 0, 1)
        self.scene.world = bpy.data.worlds.new("world")
        self.assertEqual(names(), ["a_b", "environment", "floor", "panel"])
        del self.lamp["light_group"]
        self.scene.world.color = (0, 0, 0)
        for obj, name in ((self.lamp, "left"), (self.panel, "right"), (self.camera, "right")):
            collection = bpy.data.collections.get(name) or bpy.data.collections.new(name)
            if name not in self.scene.collection.children:
                self.scene.collection.children.link(collection)
            collection.objects.link(obj)
        self.assertEqual(names(), ["floor", "left", "right"])

    def test_frames_are_no_inputs_of_an_export(self):
        self.save()
        image = bpy.data.images.new("frame", 4, 4)
        image.filepath_raw, image.file_format = str(self.folder / "frame.png"), "PNG"
        image.save()
        self.assertEqual(record.inputs(), ["frame.png"])
        image[record.FRAME_OF] = "Camera"
        self.assertEqual(record.inputs(), [])
