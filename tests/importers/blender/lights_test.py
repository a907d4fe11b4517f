"""Lamps: strength, shape and groups, against Cycles and closed forms."""
import math

import bpy
import mathutils
import numpy as np
from patchlight_blender import ies
from support import ExportTest, Shaders, diffuse

IES = """IESNA:LM-63-2002
TILT=NONE
1 -1 {factor} 3 1 1 2 -0.1 0 0
1 1 20
0 90 180
0
100 100 {up}
"""


def strength(material):
    """Radiance of an emissive material, W/(m2 sr)."""
    factor = material.get("extensions", {}).get("KHR_materials_emissive_strength", {}).get("emissiveStrength", 1)
    return np.array(material["emissiveFactor"]) * factor


class Lights(ExportTest):
    def irradiance(self, half=0.05):
        """By Cycles, at the origin of a floor in the plane z = 0."""
        self.add_square("floor", diffuse("white", (1, 1, 1, 1)), size=0.2)
        camera = self.add_camera(location=(0, 0, 0.5))
        camera.data.type, camera.data.ortho_scale, camera.data.clip_start = "ORTHO", 2 * half, 0.01
        self.scene.cycles.max_bounces = 0
        return self.cycles(8, 8, 256).mean(axis=(0, 1)) * math.pi

    def test_area_lamps_have_the_radiance_of_cycles(self):
        for shape, sizes in (("SQUARE", (1, 1)), ("RECTANGLE", (1, 0.5)), ("DISK", (1, 1)), ("ELLIPSE", (1, 0.5))):
            with self.subTest(shape):
                self.setUp()
                lamp = self.add_lamp("lamp", "AREA", 40, shape=shape, size=sizes[0], size_y=sizes[1])
                lamp.location, lamp.scale = (0, 0, 10), (2, 1, 1)
                exported = self.export()
                material = exported.material("lamp")
                self.assertFalse(material.get("doubleSided", False))
                self.assertTrue(exported.node("lamp")["extras"]["intangible"], "rays pass it, as in Cycles")
                self.assertEqual(material["pbrMetallicRoughness"]["baseColorFactor"][:3], [0, 0, 0])
                points = exported.positions("lamp") * exported.node("lamp")["scale"]
                index = exported.accessor(exported.mesh("lamp")["primitives"][0]["indices"]).reshape(-1, 3)
                a, b, c = (points[index[:, k]] for k in range(3))
                normals = np.cross(b - a, c - a) / 2
                self.assertTrue(np.all(normals[:, 1] <= 0), "it shines downwards")
                area = np.linalg.norm(normals, axis=1).sum()
                self.assertAlmostEqual(strength(material)[0] * 4 * area, 40, 2)
                seen = strength(material)[0] * area / 100
                np.testing.assert_allclose(self.irradiance()[0], seen, rtol=0.012)

    def test_strength_and_colour_by_frame(self):
        self.scene.frame_start, self.scene.frame_end = 1, 5
        fading, steady = self.add_lamp("fading", "POINT", 0), self.add_lamp("steady", "POINT", 5)
        for frame, energy, green in ((1, 0, 1), (3, 100, 1), (5, 100, 0.5)):
            fading.data.energy, fading.data.color[1] = energy, green
            for path in ("energy", "color"):
                fading.data.keyframe_insert(path, frame=frame)
        for curve in fading.data.animation_data.action.fcurves:
            for key in curve.keyframe_points:
                key.interpolation = "LINEAR"
        steady.data.keyframe_insert("energy", frame=1)
        fading["light_group"] = "all"
        self.scene.frame_set(2)
        exported = self.export()
        self.assert_warned(exported, "'fading'", "a light group of its own instead of 'all'")
        self.assertIn('"fading": {scale: {1: 0, 3: 1, 5: 1}, color: {2: [1, 1, 1], 3: [1, 1, 1], 5: [1, 0.5, 1]}}',
                      exported.job)
        self.assertNotIn('"steady"', exported.job)
        self.assertIn("frames: 1-5", exported.job)
        self.assertAlmostEqual(exported.light("fading")["intensity"] / 683, 100 / (4 * math.pi), 4)
        self.assertEqual(exported.node("fading")["extras"]["light_group"], "fading")
        self.assertEqual(self.scene.frame_current, 2)

    def test_point_lamps_and_suns(self):
        point = self.add_lamp("point", "POINT", 100, color=(1, 0.5, 0.25), shadow_soft_size=0.05)
        point.location = (0, 0, 3)
        sun = self.add_lamp("sun", "SUN", 3, angle=math.radians(2))
        exported = self.export()
        light = exported.light("point")
        np.testing.assert_allclose(light["color"], (1, 0.5, 0.25), atol=1e-6)
        self.assertAlmostEqual(light["intensity"] / 683, 100 / (4 * math.pi), 4)
        self.assertAlmostEqual(exported.node("point")["extras"]["radius"], 0.05, 5)
        self.assertAlmostEqual(exported.light("sun")["intensity"] / 683, 3, 4)
        self.assertAlmostEqual(exported.node("sun")["extras"]["angle"], 2, 4)
        self.assertIn("punctual_units: blender", exported.job)
        sun.hide_render = True
        np.testing.assert_allclose(self.irradiance(), np.array([1, 0.5, 0.25]) * 100 / (4 * math.pi) / 9, rtol=0.01)

    def test_a_spot_has_the_flux_of_cycles(self):
        lamp = self.add_lamp("spot", "SPOT", 100, spot_size=math.radians(60), spot_blend=0.3)
        lamp.location = (0, 0, 3)
        exported = self.export()
        light, outer = exported.light("spot"), math.cos(math.radians(30))
        inner = math.cos(light["spot"]["innerConeAngle"])
        self.assertAlmostEqual(light["spot"]["outerConeAngle"], math.radians(30), 5)
        cosine = np.linspace(outer, 1, 10001)
        step = np.clip((cosine - outer) / ((1 - outer) * 0.3), 0, 1)
        flux = 100 / (4 * math.pi) * np.trapz(cosine * step * step * (3 - 2 * step), cosine)
        shape = np.clip((cosine - outer) / (inner - outer), 0, 1) ** 2
        self.assertAlmostEqual(light["intensity"] / 683 * np.trapz(shape, cosine) / flux, 1, 2)
        axis = exported.node("spot")["extras"]["axis_intensity"]
        np.testing.assert_allclose(self.irradiance()[0], axis / 9, rtol=0.01)

    def test_nodes_of_lamps_are_read(self):
        lamp = self.add_lamp("lamp", "POINT", 10, color=(1, 0.5, 1))
        nodes = Shaders("", lamp.data)
        warm = nodes.add("Blackbody", Temperature=3000)
        lamp.data = nodes.show(nodes.add("Emission", Color=warm.outputs[0], Strength=2), "OutputLight")
        lamp.location = (0, 0, 3)
        light = self.export().light("lamp")
        got = np.array(light["color"]) * light["intensity"] / 683 / 9
        np.testing.assert_allclose(self.irradiance(), got, rtol=0.02, atol=1e-4)

    def add_photometric(self, text, strength=1.0):
        """A lamp 3 m above the floor with a photometric file of this text."""
        path = self.folder / "down.ies"
        path.write_text(text)
        lamp = self.add_lamp("lamp", "POINT", 10)
        nodes = Shaders("", lamp.data)
        texture = nodes.add("TexIES", Strength=strength)
        texture.mode, texture.filepath = "EXTERNAL", str(path)
        nodes.show(nodes.add("Emission", Strength=texture.outputs[0]), "OutputLight")
        lamp.location = (0, 0, 3)
        return lamp, path

    def candela(self, exported):
        """(Vertical angles, planes) of the exported lamp's file."""
        file = exported.folder / exported.node("lamp")["extras"]["ies"]
        return ies.distribution(file.read_text())

    def test_photometric_files_have_the_intensity_of_the_lamp(self):
        _, path = self.add_photometric(IES.format(factor=2, up=100), 0.5)
        vertical, planes = self.candela(self.export())
        self.assertEqual(vertical, [0, 90, 180])
        np.testing.assert_allclose(self.irradiance()[0], planes[0][0] / 683 / 9, rtol=0.01)
        path.unlink()
        self.assert_warned(self.export(), "'lamp'", "down.ies")

    def test_photometric_files_turn_as_in_cycles(self):
        text = ("IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 3 5 1 2 0 0 0\n1 1 10\n0 60 90\n0 90 180 270 360\n"
                "100 100 0\n100 200 0\n100 300 0\n100 400 0\n100 100 0\n")
        tilt = math.radians(60)
        for turn in (0, 90, 180, 270):
            with self.subTest(turn):
                self.setUp()
                lamp, _ = self.add_photometric(text)
                planes = self.candela(self.export())[1]
                self.assertEqual(list(planes), [0, 90, 180, 270])
                angle = math.radians(turn)
                towards = mathutils.Vector((math.sin(tilt) * math.cos(angle), math.sin(tilt) * math.sin(angle),
                                            -math.cos(tilt)))
                lamp.data.shadow_soft_size = 0
                lamp.rotation_euler = towards.rotation_difference(mathutils.Vector((0, 0, -1))).to_euler()
                np.testing.assert_allclose(self.irradiance(0.005)[0], planes[turn][1] / 683 / 9, rtol=0.01)

    def test_light_groups(self):
        self.add_lamp("free", "POINT", 10)
        named = self.add_lamp("named", "POINT", 10)
        named["light_group"] = "mine"
        bpy.context.view_layer.lightgroups.add(name="own")
        self.add_lamp("grouped", "POINT", 10).lightgroup = "own"
        exported = self.export()
        group = lambda name: exported.node(name)["extras"]["light_group"]
        self.assertEqual([group(n) for n in ("free", "named", "grouped")], ["free", "mine", "own"])
        for name in ("kitchen", "hall"):
            collection = bpy.data.collections.new(name)
            self.scene.collection.children.link(collection)
            lamp = bpy.data.lights.new(name, "POINT")
            collection.objects.link(bpy.data.objects.new(f"{name} lamp", lamp))
        exported = self.export()
        self.assertEqual([group(n) for n in ("kitchen lamp", "hall lamp", "free", "grouped")],
                         ["kitchen", "hall", "free", "own"])

    def test_lamps_in_instances_shine_at_each_place(self):
        lamp = self.add_lamp("lamp", "POINT", 10)
        panel = self.add_lamp("panel", "AREA", 10, size=0.5)
        collection = bpy.data.collections.new("fitting")
        for obj in (lamp, panel):
            collection.objects.link(obj)
            self.scene.collection.objects.unlink(obj)
        for k in range(2):
            empty = self.add(None, f"place {k}", (3 * k, 0, 0))
            empty.instance_type, empty.instance_collection = "COLLECTION", collection
        exported = self.export()
        self.assertEqual(exported.names(), [f"place {k}/{name}" for k in (0, 1) for name in ("lamp", "panel")])
        self.assertEqual(exported.node("place 1/lamp")["translation"], [3, 0, 0])

    def test_what_lamps_lose_is_named(self):
        self.add_lamp("narrow", "AREA", 10, spread=math.radians(90))
        falloff = self.add_lamp("odd", "POINT", 10)
        nodes = Shaders("", falloff.data)
        nodes.show(nodes.add("Emission", Strength=nodes.add("LightFalloff").outputs["Linear"]), "OutputLight")
        portal = self.add_lamp("portal", "AREA", 10)
        portal.data.cycles.is_portal = True
        exported = self.export()
        self.assert_warned(exported, "'narrow'", "spread")
        self.assert_warned(exported, "'odd'", "falloff")
        self.assertNotIn("portal", exported.names())
