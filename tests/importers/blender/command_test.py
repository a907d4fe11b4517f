"""The command: files, the job's other keys, and errors."""
import io
import pathlib
import subprocess
import sys

import bpy
from patchlight_blender import command
from patchlight_blender.report import ExportError, Report
from support import ExportTest, diffuse

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

    def test_an_old_blender_is_an_error(self):
        newest, command.OLDEST = command.OLDEST, (99, 0, 0)
        try:
            with self.assertRaisesRegex(ExportError, "too old"):
                self.export()
        finally:
            command.OLDEST = newest

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
        camera = self.add_camera('the "best" view')
        render = self.scene.render
        render.resolution_x, render.resolution_y, render.resolution_percentage = 800, 600, 50
        self.scene.view_settings.view_transform, self.scene.view_settings.exposure = "Standard", 1.5
        text = self.export().job
        self.assertIn("resolution: [400, 300]", text)
        self.assertIn("view: sRGB", text)
        self.assertIn("exposure: 1.5", text)
        self.assertIn('cameras: ["the \\"best\\" view"]', text)
        self.assertIn("resolution: [300, 400]", self.export("--resolution", "300", "400").job)
        self.scene.view_settings.view_transform = "Filmic"
        self.assert_warned(self.export(), "Filmic", "OCIO")
        self.assertTrue(camera)

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
        self.scene.view_settings.gamma = 1.2
        exported = self.export()
        for word in ("motion blur", "render region", "transparent film", "film exposure", "gamma"):
            self.assert_warned(exported, word)

    def test_each_warning_is_one_line_and_comes_once(self):
        stream = io.StringIO()
        report = Report(stream)
        report.warn("two\nlines")
        report.warn("two lines")
        self.assertEqual(stream.getvalue(), "patchlight-export: warning: two lines\n")
        self.assertTrue(sys.stderr)
