"""The world as the job's environment, against Cycles."""
import math

import bpy
import numpy as np
from support import ExportTest, Shaders, diffuse, read_image


class World(ExportTest):
    def shaders(self):
        self.scene.world = bpy.data.worlds.new("world")
        return Shaders("", self.scene.world)

    def show(self, shaders, color, strength=1.0):
        background = shaders.add("Background", Strength=strength)
        shaders.set(background.inputs["Color"], color)
        shaders.show(background, "OutputWorld")

    def setting(self, exported, key):
        return next((line.split(":", 1)[1].strip() for line in exported.job.splitlines()
                     if line.startswith(f"  {key}:")), None)

    def panorama(self, degrees=0):
        """What Cycles shows in all directions, with the direction at `degrees` from +X (towards +Y) in the middle."""
        camera = self.add_camera()
        camera.data.type = "PANO"
        camera.data.cycles.panorama_type = "EQUIRECTANGULAR"
        camera.rotation_euler = (math.pi / 2, 0, math.radians(degrees) - math.pi / 2)
        return self.cycles(64, 32, 16)

    def spots(self, name="spots", low=0.0):
        """A float image whose texels all differ."""
        image = bpy.data.images.new(name, 64, 32, float_buffer=True, is_data=True)
        values = np.ones((32, 64, 4), np.float32)
        values[..., 0], values[..., 1] = np.linspace(0, 1, 64), np.linspace(0, 1, 32)[:, None]
        values[..., 2] = 0.25
        values[0, 0, 2] = low
        image.pixels.foreach_set(values.ravel())
        image.filepath_raw, image.file_format = str(self.folder / f"{name}.exr"), "OPEN_EXR"
        image.save()
        bpy.data.images.remove(image)
        image = bpy.data.images.load(str(self.folder / f"{name}.exr"))
        image.colorspace_settings.name = "Linear"
        return image, values[..., :3]

    def test_a_plain_world_is_a_colour(self):
        self.show(self.shaders(), (0.5, 0.25, 1, 1), 2)
        exported = self.export()
        self.assertEqual(self.setting(exported, "color"), "[1, 0.5, 2]")
        bpy.context.view_layer.lightgroups.add(name="sky")
        self.scene.world.lightgroup = "sky"
        self.assertEqual(self.setting(self.export(), "light_group"), '"sky"')
        self.assertIsNone(self.setting(exported, "image"))

    def test_no_world_is_dark(self):
        self.scene.world = None
        self.assertNotIn("environment", self.export().job)

    def test_an_image_is_kept_with_its_turn(self):
        image, values = self.spots()
        for kind, sign in (("POINT", -1), ("TEXTURE", 1)):
            with self.subTest(kind):
                shaders = self.shaders()
                mapping = shaders.add("Mapping", Vector=shaders.add("TexCoord").outputs["Generated"],
                                      Rotation=(0, 0, math.radians(45)))
                mapping.vector_type = kind
                texture = shaders.add("TexEnvironment", Vector=mapping.outputs[0])
                texture.image = image
                self.show(shaders, texture.outputs[0], 1.5)
                exported = self.export()
                self.assertEqual(self.setting(exported, "strength"), "1.5")
                turn = float(self.setting(exported, "rotation"))
                self.assertAlmostEqual(turn, 45 * sign, 4)
                np.testing.assert_allclose(read_image(exported.folder / "scene_sky.exr")[..., :3], values, atol=1e-6)
                seen = self.panorama(turn)[8:24, 8:56] / 1.5
                np.testing.assert_allclose(seen, values[8:24, 8:56], atol=0.01)

    def test_other_trees_are_baked_in_the_same_directions(self):
        image, values = self.spots()
        shaders = self.shaders()
        texture = shaders.add("TexEnvironment")
        texture.image = image
        self.show(shaders, shaders.add("Gamma", Color=texture.outputs[0], Gamma=2).outputs[0], 3)
        exported = self.export()
        baked = read_image(exported.folder / "scene_sky.exr")[..., :3]
        self.assertEqual(baked.shape, (64, 128, 3))
        small = baked.reshape(32, 2, 64, 2, 3).mean(axis=(1, 3))
        np.testing.assert_allclose(small[2:-2, 2:-2], 3 * values[2:-2, 2:-2] ** 2, atol=0.05)
        np.testing.assert_allclose(small[2:-2, 2:-2], self.panorama()[2:-2, 2:-2], atol=0.06)

    def test_negative_texels_become_zero(self):
        image, values = self.spots("below", -0.5)
        shaders = self.shaders()
        texture = shaders.add("TexEnvironment")
        texture.image = image
        self.show(shaders, texture.outputs[0])
        exported = self.export()
        self.assert_warned(exported, "negative texels", "below")
        self.assertEqual(read_image(exported.folder / "scene_sky.exr")[..., :3].min(), 0)

    def test_the_disc_of_a_nishita_sky_becomes_a_sun(self):
        shaders = self.shaders()
        sky = shaders.add("TexSky")
        sky.sky_type, sky.sun_elevation, sky.sun_rotation = "NISHITA", math.radians(40), math.radians(70)
        sky.sun_size = math.radians(1)
        self.show(shaders, sky.outputs[0], 0.1)
        exported = self.export("--sky-resolution", "256")
        light, node = exported.light("Sky sun"), exported.node("Sky sun")
        self.assertAlmostEqual(node["extras"]["angle"], 1, 3)
        x, y, z, w = node["rotation"]
        toward = np.array([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)])
        self.assertAlmostEqual(toward[1], math.sin(math.radians(40)), 3)
        irradiance = np.array(light["color"]) * light["intensity"] / 683 * toward[1]
        baked = read_image(exported.folder / "scene_sky.exr")[..., :3]
        self.assertLess(baked.max(), 100)
        height, width = baked.shape[:2]
        level = (np.arange(height) + 0.5) / height * math.pi - math.pi / 2
        weight = np.clip(np.sin(level), 0, None) * np.cos(level) * (math.pi / height) * (2 * math.pi / width)
        irradiance = irradiance + (baked * weight[:, None, None]).sum(axis=(0, 1))
        self.add_square("floor", diffuse("white", (1, 1, 1, 1)), size=0.2)
        camera = self.add_camera(location=(0, 0, 0.5))
        camera.data.type, camera.data.ortho_scale, camera.data.clip_start = "ORTHO", 0.1, 0.01
        np.testing.assert_allclose(self.cycles(8, 8, 1024).mean(axis=(0, 1)) * math.pi, irradiance, rtol=0.015)
