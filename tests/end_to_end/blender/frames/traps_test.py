"""What Blender's own glTF exporter gets wrong, through the whole way: frames of `patchlight run` against Cycles'."""
import math
import os
import subprocess

import bpy
import numpy as np
from patchlight_blender.addon import exr
from support import ExportTest, Shaders, diffuse

WIDTH, HEIGHT = 48, 32
ANGLES = range(0, 65, 5)
LAMP = "\n".join(["IESNA:LM-63-2002", "TILT=NONE", f"1 -1 1 {len(ANGLES)} 1 1 2 0 0 0", "1 1 10",
                  " ".join(map(str, ANGLES)), "0", " ".join(str(20 * (60 - angle)) for angle in ANGLES), ""])


class Traps(ExportTest):
    def setUp(self):
        super().setUp()
        self.said = ""

    def frame(self, width=WIDTH, height=HEIGHT):
        """The frame that the program makes of the scene: linear colours, rows from below. `said` is what it prints."""
        render = self.scene.render
        render.resolution_x, render.resolution_y, render.resolution_percentage = width, height, 100
        path = self.folder / "room.blend"
        bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)
        done = subprocess.run([os.environ["PATCHLIGHT"], "run", path, "--threads", "2"], capture_output=True, text=True,
                              check=False, env=dict(os.environ, BLENDER=bpy.app.binary_path))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.said = done.stderr
        frame, = (self.folder / "room.patchlight/frames").glob("*.exr")
        return exr.read(frame).pixels(["R", "G", "B"])

    def assert_frame_is_that_of_cycles(self, tolerance=0.02, samples=256, blocks=(4, 4)):
        """That blocks of the frame have the mean that they have in Cycles' frame."""
        means = []
        for image in (self.frame(), self.cycles(WIDTH, HEIGHT, samples)):
            rows, columns = blocks
            means.append(image.reshape(rows, HEIGHT // rows, columns, WIDTH // columns, 3).mean(axis=(1, 3)))
        self.assertGreater(means[1].mean(), 1e-3, "Cycles' frame is black")
        np.testing.assert_allclose(*means, rtol=tolerance, atol=tolerance * means[1].mean())
        self.assertNotIn("black", self.said)

    def add_floor(self, material=None):
        self.add_square("floor", material or diffuse("white"), size=6)
        self.add_camera(location=(0, 0, 5))

    def test_area_lamps_light_the_frame_as_brightly_as_in_cycles(self):
        self.add_floor()
        lamp = self.add_lamp("panel", "AREA", 50, size=0.5, color=(1, 0.8, 0.5))
        lamp.location, lamp.rotation_euler = (0.5, 0, 2), (0, 0.3, 0)
        lamp.visible_camera = False
        self.assert_frame_is_that_of_cycles()

    def test_the_world_lights_the_frame(self):
        self.add_floor()
        self.add_cube("box", diffuse("box"), (0.5, 0, 0.5))
        self.scene.world = bpy.data.worlds.new("world")
        self.scene.world.color = (0.2, 0.4, 0.8)
        self.assert_frame_is_that_of_cycles()

    def test_photometric_files_shape_the_light(self):
        self.add_floor()
        path = self.folder / "lamp.ies"
        path.write_text(LAMP)
        lamp = self.add_lamp("lamp", "POINT", 10, shadow_soft_size=0.01)
        lamp.location = (0, 0, 2)
        nodes = Shaders("", lamp.data)
        texture = nodes.add("TexIES")
        texture.mode, texture.filepath = "EXTERNAL", str(path)
        nodes.show(nodes.add("Emission", Strength=texture.outputs[0]), "OutputLight")
        self.assert_frame_is_that_of_cycles()

    def test_portraits_and_shifted_cameras_show_what_cycles_shows(self):
        lamp = Shaders("lamp")
        glow = lamp.show(lamp.add("Emission"))
        for k, place in enumerate(((0.3, 0.2, 0), (-0.2, 0.5, 0), (-0.3, -0.4, 0))):
            self.add_cube(f"lamp {k}", glow, place, 0.1)
        camera = self.add_camera(location=(0, 0, 3))
        camera.data.shift_x, camera.data.shift_y = 0.1, -0.15
        images = [self.frame(80, 120).sum(axis=2), self.cycles(80, 120, 64).sum(axis=2)]
        np.testing.assert_allclose(*(image.sum() for image in images), rtol=0.01)
        for axis in (0, 1):
            rise = [np.cumsum(image.sum(axis=axis)) / image.sum() for image in images]
            np.testing.assert_allclose(*rise, atol=0.01)  # a lamp is five pixels wide: a fifteenth of a pixel

    def test_modifiers_apply_and_hidden_cutters_do_not_fill_the_window(self):
        self.add_floor()
        wall = self.add_cube("wall", diffuse("wall"), (0, 0, 1), 1)
        wall.scale = (0.2, 4, 2)
        cutter = self.add_cube("cutter", diffuse("cutter"), (0, 0, 1), 1)
        cutter.hide_render = True
        boolean = wall.modifiers.new("window", "BOOLEAN")
        boolean.object, boolean.solver, boolean.show_viewport = cutter, "EXACT", False
        lamp = self.add_lamp("panel", "AREA", 100, size=0.5)
        lamp.location, lamp.rotation_euler = (2, 0, 1.5), (0, math.radians(70), 0)
        lamp.visible_camera = False
        self.assert_frame_is_that_of_cycles(0.04, 1024)
        self.assertGreater(self.cycles(WIDTH, HEIGHT)[:, :WIDTH // 3].mean(), 0.02, "light passes the window")

    def test_mixes_of_shaders_keep_their_colour(self):
        m = Shaders("mix")
        red, blue = (m.add("BsdfDiffuse", Color=color) for color in ((0.8, 0.1, 0.1, 1), (0.1, 0.1, 0.6, 1)))
        self.add_floor(m.show(m.add("MixShader", _0=0.3, _1=red.outputs[0], _2=blue.outputs[0])))
        self.add_lamp("lamp", "POINT", 100, shadow_soft_size=0.05).location = (1, 0, 3)
        self.assert_frame_is_that_of_cycles()

    def test_glass_shows_and_lights_what_is_behind_it(self):
        self.add_floor()
        self.add_cube("box", diffuse("box", (0.7, 0.2, 0.1, 1)), (0.6, 0, 0.25), 0.5)
        m = Shaders("glass")
        pane = self.add_cube("pane", m.show(m.add("BsdfGlass", IOR=1.45)), (0, 0, 1), 1)
        pane.scale = (2, 2, 0.02)
        self.scene.world = bpy.data.worlds.new("world")
        self.scene.world.color = (0.3, 0.5, 0.8)
        self.scene.cycles.blur_glossy = 0  # it would make the glass rough
        self.assert_frame_is_that_of_cycles(0.03, 512)

    def test_veils_let_a_part_of_the_light_pass(self):
        self.add_floor()
        m = Shaders("veil")
        clear, cloth = m.add("BsdfTransparent"), m.add("BsdfDiffuse", Color=(0.8, 0.6, 0.3, 1))
        veil = m.show(m.add("MixShader", _0=0.4, _1=clear.outputs[0], _2=cloth.outputs[0]))
        self.add_square("veil", veil, size=1.5, location=(0, 0, 1))
        lamp = self.add_lamp("panel", "AREA", 80, size=0.5)
        lamp.location, lamp.visible_camera = (0.3, 0.2, 2.5), False
        self.assert_frame_is_that_of_cycles(0.03, 512)

    def test_cloth_passes_light_to_its_other_side(self):
        self.add_floor()
        m = Shaders("cloth")
        there = m.add("BsdfDiffuse", Color=(0.8, 0.6, 0.3, 1)), m.add("BsdfTranslucent", Color=(0.9, 0.5, 0.2, 1))
        cloth = m.show(m.add("MixShader", _0=0.4, _1=there[0].outputs[0], _2=there[1].outputs[0]))
        self.add_square("cloth", cloth, size=1.5, location=(0, 0, 1))
        lamp = self.add_lamp("panel", "AREA", 80, size=0.5)
        lamp.location, lamp.visible_camera = (0.3, 0.2, 2.5), False
        self.assert_frame_is_that_of_cycles(0.03, 512)

    def test_black_frames_say_what_to_do(self):
        self.add_floor()
        self.add_lamp("hidden", "AREA", 50).hide_render = True
        self.assertFalse(self.frame().any())
        self.assertIn("warning: nothing gives light, so all frames are black: add a lamp, or light the world (lamps "
                      "hidden from rendering: 'hidden')", self.said)
        self.add_lamp("away", "AREA", 50).location = (0, 0, -3)
        self.assertFalse(self.frame().any())
        self.assertIn("warning: a frame is black (`camera`): no light reaches the surfaces in view", self.said)
