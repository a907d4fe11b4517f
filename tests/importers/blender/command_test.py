"""The command: files, the job's other keys, and errors."""
import ast
import io
import os
import pathlib
import shutil
import subprocess
import sys
import unittest

import bpy
from patchlight_blender import command, record
from patchlight_blender.report import Report
from support import ExportTest, Shaders, diffuse

IMPORTER = os.environ.get("PATCHLIGHT_IMPORT")
ENTRY = pathlib.Path(command.__file__).parents[1] / "export.py"


class Command(ExportTest):
    def run_blender(self, *arguments):
        return subprocess.run([bpy.app.binary_path, "-b", *arguments], capture_output=True, text=True, check=False)

    def test_files_stand_beside_each_other_and_nothing_else_is_left(self):
        self.add_square("square", diffuse("white"))
        self.add_camera()
        bpy.ops.wm.save_as_mainfile(filepath=str(self.folder / "room.blend"))
        done = self.run_blender(str(self.folder / "room.blend"), "--python", str(ENTRY))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(sorted(path.name for path in self.folder.iterdir()), ["room.blend", "room.glb", "room.yaml"])

    def test_a_folder_that_cannot_be_written_is_an_error(self):
        (self.folder / "file").write_text("")
        done = self.run_blender("--factory-startup", "--python", str(ENTRY), "--", "--output",
                                str(self.folder / "file" / "out"))
        self.assertEqual(done.returncode, 73)
        lines = [line for line in done.stderr.splitlines() if line.startswith("patchlight-export: error: ")]
        self.assertEqual(len(lines), 1, done.stderr)
        self.assertIn("--output", lines[0])

    @unittest.skipUnless(IMPORTER, "PATCHLIGHT_IMPORT does not name the program patchlight-import")
    def test_the_importer_accepts_the_files(self):
        m = Shaders('a "noisy" pane*')
        noise = m.add("TexNoise")
        self.add_square("square", m.show(m.add("BsdfGlass", Color=noise.outputs["Color"])))
        self.add_cube("cube", diffuse("white"), (3, 0, 0))
        self.add_lamp("panel", "AREA", 10)
        self.add_lamp("spot", "SPOT", 10)
        self.add_camera().keyframe_insert("location", frame=1)
        world = Shaders("", bpy.data.worlds.new("world"))
        self.scene.world = world.data
        world.show(world.add("Background", Color=world.add("TexSky").outputs[0]), "OutputWorld")
        folder = self.export().folder
        done = subprocess.run([IMPORTER, "scene.yaml"], cwd=folder, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_an_old_blender_is_an_error(self):
        (self.folder / "bpy.py").write_text("class app:\n    version, version_string = (2, 79, 0), '2.79'\n")
        text = ENTRY.read_text()
        first = text[:text.index("from patchlight_blender")]
        self.assertFalse([node for node in ast.walk(ast.parse(first)) if isinstance(node, ast.JoinedStr)],
                         "Python 3.5 cannot read it")
        done = subprocess.run([shutil.which("python3"), ENTRY], capture_output=True, text=True, check=False,
                              env=dict(os.environ, PYTHONPATH=str(self.folder)))
        self.assertEqual(done.returncode, 69, done.stderr)
        self.assertEqual(done.stderr,
                         "patchlight-export: error: Blender 2.79 is too old: install Blender 3.4 or newer\n")

    def test_a_scene_without_light_is_named(self):
        self.add_square("square", diffuse("white"))
        self.add_lamp("hidden", "POINT", 10).hide_render = True
        self.add_lamp("weak", "AREA", 0)
        self.assert_warned(self.export(), "nothing gives light", "hidden from rendering: 'hidden'",
                           "without strength: 'weak'")
        glow = Shaders("glow")
        self.add_square("lamp", glow.show(glow.add("Emission")))
        self.assertFalse([line for line in self.export().warnings if "nothing gives light" in line])

    def test_exports_by_one_thread_are_equal(self):
        """More threads add up the normals of a mesh in any order, so that its bytes differ."""
        bpy.ops.mesh.primitive_monkey_add()
        bpy.ops.object.shade_smooth()
        bpy.context.object.modifiers.new("fine", "SUBSURF").render_levels = 3
        wall, cutter = self.add_cube("wall", location=(5, 0, 0), size=2), self.add_cube("cutter", location=(5, 0, 1))
        cutter.hide_render = True
        boolean = wall.modifiers.new("window", "BOOLEAN")
        boolean.object, boolean.solver = cutter, "EXACT"
        bpy.ops.wm.save_as_mainfile(filepath=str(self.folder / "room.blend"))
        for name in ("a", "b"):
            done = self.run_blender("--threads", "1", str(self.folder / "room.blend"), "--python", str(ENTRY), "--",
                                    "--output", str(self.folder / name))
            self.assertEqual(done.returncode, 0, done.stderr)
        first, second = ((self.folder / name / "room.glb").read_bytes() for name in ("a", "b"))
        self.assertEqual(first, second)

    def test_a_failed_export_leaves_the_old_files(self):
        self.add_square("square")
        self.export()
        before = (self.folder / "out" / "scene.glb").read_bytes()
        write, command.job.text = command.job.text, None
        try:
            with self.assertRaises(TypeError):
                self.export()
        finally:
            command.job.text = write
        self.assertEqual((self.folder / "out" / "scene.glb").read_bytes(), before)
        self.assertEqual(len(list((self.folder / "out").iterdir())), 2)

    def test_resolution_and_view_go_to_the_job(self):
        self.add_camera('the "best" view')
        render = self.scene.render
        render.resolution_x, render.resolution_y, render.resolution_percentage = 800, 600, 50
        self.scene.view_settings.view_transform, self.scene.view_settings.exposure = "Standard", 1.5
        text = self.export().job
        self.assertIn("resolution: [400, 300]", text)
        self.assertIn("view: sRGB", text)
        self.assertIn("exposure: 1.5", text)
        self.assertIn('cameras: ["the \\"best\\" view"]', text)
        render.resolution_x, render.resolution_percentage = 100, 29  # 100 x 0.29 is just below 29
        self.assertIn("resolution: [29, 174]", self.export().job)
        self.assertIn("resolution: [300, 400]", self.export("--resolution", "300", "400").job)
        self.scene.view_settings.view_transform = "Filmic"
        self.scene.view_settings.look, self.scene.view_settings.gamma = "High Contrast", 1.2
        text = self.export().job
        for line in ('view: "Filmic"', 'look: "High Contrast"', "gamma: 1.2", "config.ocio"):
            self.assertIn(line, text)

    def test_the_record_names_files_of_libraries_by_their_folder(self):
        library = self.folder / "library"
        library.mkdir()
        lamp = self.add_lamp("lamp", "POINT", 10)
        lamp.data.use_nodes = True
        texture = lamp.data.node_tree.nodes.new("ShaderNodeTexIES")
        texture.mode, texture.filepath = "EXTERNAL", "//down.ies"
        bpy.ops.wm.save_as_mainfile(filepath=str(library / "lamps.blend"))
        self.setUp()
        bpy.ops.wm.save_as_mainfile(filepath=str(self.folder / "room.blend"))
        with bpy.data.libraries.load(str(library / "lamps.blend"), link=True) as (_, target):
            target.objects = ["lamp"]
        self.assertEqual(record.inputs(), [os.path.join(self.path_of(library), name)
                                           for name in ("down.ies", "lamps.blend")])

    def test_linked_lamps_have_their_photometric_files(self):
        library = self.folder / "library"
        library.mkdir()
        (library / "down.ies").write_text("IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 2 1 1 2 0 0 0\n1 1 9\n0 90\n0\n100 0\n")
        lamp = self.add_lamp("lamp", "POINT", 10)
        lamp.data.use_nodes = True
        tree = lamp.data.node_tree
        texture = tree.nodes.new("ShaderNodeTexIES")
        texture.mode, texture.filepath = "EXTERNAL", "//down.ies"
        tree.links.new(texture.outputs[0], tree.nodes["Emission"].inputs["Strength"])
        bpy.ops.wm.save_as_mainfile(filepath=str(library / "lamps.blend"))
        self.setUp()
        bpy.ops.wm.save_as_mainfile(filepath=str(self.folder / "room.blend"))
        with bpy.data.libraries.load(str(library / "lamps.blend"), link=True, relative=True) as (_, target):
            target.objects = ["lamp"]
        self.scene.collection.objects.link(bpy.data.objects["lamp"])
        self.add_square("square", diffuse("white"))
        exported = self.export()
        self.assertTrue((exported.folder / exported.node("lamp")["extras"]["ies"]).is_file())

    def path_of(self, folder):
        return os.path.relpath(folder, bpy.path.abspath("//"))

    def test_files_of_the_scene_are_not_replaced(self):
        self.add_square("square", diffuse("white"))
        image = bpy.data.images.new("sky", 8, 8, float_buffer=True)
        image.filepath_raw, image.file_format = str(self.folder / "room.glb"), "OPEN_EXR"
        image.source, image.use_fake_user = "FILE", True
        bpy.ops.wm.save_as_mainfile(filepath=str(self.folder / "room.blend"))
        done = self.run_blender(str(self.folder / "room.blend"), "--python", str(ENTRY))
        self.assertEqual(done.returncode, 73, done.stderr)
        self.assertIn("is a file of the scene", done.stderr)

    def test_missing_libraries_are_named(self):
        self.add_square("linked", diffuse("white"))
        path = self.folder / "library.blend"
        bpy.ops.wm.save_as_mainfile(filepath=str(path))
        self.setUp()
        with bpy.data.libraries.load(str(path), link=True) as (source, target):
            target.objects = ["linked"]
        self.scene.collection.objects.link(bpy.data.objects["linked"])
        path.unlink()
        self.assert_warned(self.export(), "library.blend")

    def test_settings_of_the_render_that_are_lost_are_named(self):
        self.scene.render.use_motion_blur = self.scene.render.use_border = self.scene.render.film_transparent = True
        self.scene.cycles.film_exposure = 2
        exported = self.export()
        for word in ("motion blur", "render region", "transparent film", "film exposure"):
            self.assert_warned(exported, word)

    def test_each_warning_is_one_line_and_comes_once(self):
        stream = io.StringIO()
        report = Report(stream)
        report.warn("two\nlines")
        report.warn("two lines")
        self.assertEqual(stream.getvalue(), "patchlight-export: warning: two lines\n")
