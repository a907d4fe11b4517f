"""The render engine on the command line: `blender -b room.blend -f 1`."""
import pathlib
import shutil
import signal
import subprocess
import tempfile

import numpy as np
from patchlight_blender.addon import exr, settings
from support import PROGRAM, AddonTest, read_image

DOUBLE = "import bpy; [setattr(lamp, 'energy', 2 * lamp.energy) for lamp in bpy.data.lights]"


class Engine(AddonTest):
    """`rendered` is a folder with the scene as it is and its first frame, which the tests copy."""
    rendered = None

    def setUp(self):
        super().setUp()
        if Engine.rendered is None:
            Engine.holder = tempfile.TemporaryDirectory()
            self.addClassCleanup(Engine.holder.cleanup)
            Engine.rendered = pathlib.Path(Engine.holder.name)
            folder = self.folder
            self.use(Engine.rendered)
            self.save()
            self.start("-f", "1")
            self.use(folder)

    def copy_rendered(self):
        """Continues in a copy of the rendered folder. Returns the picture."""
        shutil.copytree(self.rendered, self.folder, dirs_exist_ok=True)
        self.use(self.folder)
        self.said()
        return self.picture()

    def test_pixels_are_those_of_the_program(self):
        picture = self.copy_rendered()
        arguments = settings.arguments(self.scene, [self.camera], 1)
        subprocess.run([PROGRAM, "run", self.output / "blend/room.yaml", *map(str, arguments), "--set",
                        "trace.layers=[]", "--output", self.folder / "plain"], check=True, capture_output=True)
        expected = read_image(self.folder / "plain/frames/Camera.0001.exr")[..., :3]
        self.assertGreater(expected.mean(), 0.1)
        np.testing.assert_array_equal(picture, expected)

    def test_a_second_render_makes_nothing(self):
        picture, time = self.copy_rendered(), self.time_of_export()
        (self.folder / "picture_0001.exr").unlink()
        self.start("-f", "1")
        self.assertNotIn(" runs: ", self.said())
        self.assertEqual(self.time_of_export(), time)
        np.testing.assert_array_equal(self.picture(), picture)

    def test_an_animation_exports_and_solves_once(self):
        self.move_camera()
        self.save()
        self.start("-a")
        said = self.said()
        self.assertEqual([said.count(f"{stage} runs: ") for stage in ("import", "solve", "trace")], [1, 1, 3])
        self.assertLess(self.time_of_export(), (self.output / "frames/Camera.0001.exr").stat().st_mtime_ns)
        pictures = [self.picture(frame) for frame in (1, 2, 3)]
        for number, picture in enumerate(pictures, 1):
            frame = exr.read(self.output / f"frames/Camera.{number:04}.exr").pixels(["R", "G", "B"])
            np.testing.assert_array_equal(picture, frame)
        self.assertTrue((pictures[0] != pictures[1]).any() and (pictures[1] != pictures[2]).any())
        self.assertIn("frame 9 is outside", self.start("-f", "9", code=1))
        self.assertFalse((self.folder / "picture_0009.exr").exists())

    def test_an_edited_material_casts_no_rays(self):
        before = self.copy_rendered()
        self.floor.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (0.2, 0.8, 0.8, 1)
        self.save()
        said = self.start("-f", "1")
        self.assertNotIn("render engine is", said)
        said = self.said()
        self.assertIn("solve runs: ", said)
        self.assertNotIn("million rays", said)
        self.assertLess(self.picture()[..., 0].mean(), 0.5 * before[..., 0].mean())

    def test_what_a_script_changes_is_rendered(self):
        before = self.copy_rendered()
        self.start("--python-expr", DOUBLE, "-f", "1")
        np.testing.assert_allclose(self.picture(), 2 * before, rtol=2e-3)

    def test_light_groups_and_the_region_cast_no_ray(self):
        self.copy_rendered()
        self.change("lamp", strength=3)
        render = self.scene.render
        render.use_border = render.use_crop_to_border = True
        render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y = 0.25, 0.75, 0.5, 1
        self.save()
        self.start("-f", "1")
        said = self.said()
        self.assertIn("solve skipped: ", said)
        self.assertIn("trace skipped: ", said)
        frame = exr.read(self.output / "frames/Camera.0001.exr")
        expected = frame.pixels(["R", "G", "B"]) + 2 * frame.pixels([f"Combined_lamp.{c}" for c in "RGB"])
        np.testing.assert_allclose(self.picture(), expected[12:24, 8:24], rtol=2e-3)

    def test_the_scene_that_is_asked_for_is_rendered(self):
        before = self.copy_rendered()
        other = self.scene.copy()
        other.name, other.use_fake_user = "another", True
        other.collection.objects.unlink(self.panel)
        self.save()
        self.start("-S", "another", "-f", "1")
        self.assertLess(self.picture().mean(), 0.7 * before.mean())

    def test_an_interrupt_stops_the_program(self):
        self.save()
        with subprocess.Popen([*self.command(), "-f", "1"], stdout=subprocess.DEVNULL) as blender:
            self.wait_for_export()
            blender.send_signal(signal.SIGINT)
        self.assertIn("interrupted", self.said())
        self.assertEqual(self.exporters(), [])

    def test_a_missing_program_is_named(self):
        self.save()
        self.assertIn("which is no program", self.start("-f", "1", code=1, PATCHLIGHT="/nowhere/patchlight"))
        self.assertFalse((self.folder / "picture_0001.exr").exists())

    def test_a_scene_without_a_camera_is_refused(self):
        self.scene.camera = None
        self.save()
        self.assertIn("o camera", self.start("-f", "1", code=1))

    def test_errors_of_the_program_are_passed_on(self):
        self.scene.patchlight.output = "/dev/null/out"
        self.save()
        self.assertIn("/dev/null/out", self.start("-f", "1", code=1))
        self.assertFalse((self.folder / "picture_0001.exr").exists())
