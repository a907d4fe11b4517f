"""What reflects light besides the diffuse surface: dielectrics, coats, glass and their textures, against Cycles."""
import bpy
import numpy as np
from support import MaterialTest, Shaders, diffuse, image

BLACK, HALF, WHITE = (0, 0, 0, 1), (0.5, 0.5, 0.5, 1), (1, 1, 1, 1)
SPECULAR, IOR, VOLUME = (f"KHR_materials_{name}" for name in ("specular", "ior", "volume"))


def reflectance(material):
    """(At normal incidence, at grazing incidence) of the dielectric reflection, as glTF defines it."""
    extensions = material.get("extensions", {})
    ior = extensions.get(IOR, {}).get("ior", 1.5)
    specular = extensions.get(SPECULAR, {})
    weight, color = specular.get("specularFactor", 1), np.array(specular.get("specularColorFactor", (1, 1, 1)))
    return weight * np.minimum(((ior - 1) / (ior + 1)) ** 2 * color, 1), weight


class Reflection(MaterialTest):
    def seen(self, degrees=0):
        """What Cycles shows of the square from a direction, below a sky of 1 W/(m2 sr)."""
        self.scene.world = bpy.data.worlds.new("world")
        sky = Shaders("", self.scene.world)
        sky.show(sky.add("Background", Color=WHITE), "OutputWorld")
        angle = np.radians(degrees)
        camera = self.add_camera(location=(0, -5 * np.sin(angle), 5 * np.cos(angle)))
        camera.rotation_euler.x = angle
        camera.data.type, camera.data.ortho_scale = "ORTHO", 0.01
        return self.cycles(4, 4, 64).mean(axis=(0, 1))

    def assert_reflects(self, material, normal, grazing=1.0):
        found = reflectance(material)
        np.testing.assert_allclose(found[0], np.broadcast_to(normal, 3), atol=1e-4)
        self.assertAlmostEqual(found[1], grazing, 4)

    def test_plain_diffuse_surfaces_have_no_dielectric_reflection(self):
        plain = bpy.data.materials.new("without nodes")
        for index, kind in enumerate(("BsdfDiffuse", "BsdfTranslucent", "BsdfVelvet", "BsdfToon", "Emission")):
            m = Shaders(kind)
            self.add_square(kind, m.show(m.add(kind)), (3 * index, 0, 0))
        m = Shaders("no specular")
        self.add_square("no specular", m.show(m.add("BsdfPrincipled", Specular=0)), (0, 3, 0))
        self.add_square("without nodes", plain, (3, 3, 0))
        self.add_square("without material", location=(6, 3, 0))
        self.add_lamp("area lamp", "AREA", 10)
        exported = self.export()
        self.assertEqual(len(exported.names()), 9)
        for name in exported.names():
            with self.subTest(name):
                self.assertEqual(exported.material(name)["extensions"][SPECULAR], {"specularFactor": 0})
        self.assertIn(SPECULAR, exported.gltf["extensionsUsed"])
        self.assertNotIn(IOR, exported.gltf["extensionsUsed"])

    def test_a_principled_reflects_as_in_cycles(self):
        for level in (0.2, 0.5, 1):
            with self.subTest(level):
                self.setUp()
                m = Shaders("paint")
                found = self.of(m.show(m.add("BsdfPrincipled", Base_Color=BLACK, Roughness=0, Specular=level)))[1]
                self.assert_reflects(found, 0.08 * level)
                self.assertEqual(SPECULAR in found.get("extensions", {}), level != 0.5, "0.5 is glTF's own")
                np.testing.assert_allclose(self.seen(), 0.08 * level, atol=1e-4)

    def test_a_tinted_reflection_has_the_colour_of_the_base(self):
        base, seen = (0.5, 0.25, 0, 1), []
        for level in (0, 0.5):
            self.setUp()
            m = Shaders("tinted")
            found = self.of(m.show(m.add("BsdfPrincipled", Base_Color=base, Specular=level, Specular_Tint=1,
                                         Roughness=0)))[1]
            seen.append(self.seen())
        self.assert_reflects(found, seen[1] - seen[0])

    def test_a_coat_reflects_as_in_cycles(self):
        m = Shaders("lacquer")
        found = self.of(m.show(m.add("BsdfPrincipled", Base_Color=BLACK, Specular=0, Clearcoat=0.8,
                                     Clearcoat_Roughness=0)))[1]
        coat = found["extensions"]["KHR_materials_clearcoat"]
        self.assertEqual(coat["clearcoatRoughnessFactor"], 0)
        np.testing.assert_allclose(self.seen(), 0.04 * coat["clearcoatFactor"], atol=1e-4)

    def test_a_mix_reflects_as_its_parts_do(self):
        m = Shaders("mix")
        plain, paint = m.add("BsdfDiffuse", Color=WHITE), m.add("BsdfPrincipled", Base_Color=BLACK, Roughness=0)
        mix = m.add("MixShader", _0=0.25, _1=plain.outputs[0], _2=paint.outputs[0])
        self.assert_reflects(self.of(m.show(mix))[1], 0.25 * 0.04, 0.25)

    def test_light_is_added_to_a_reflection(self):
        m = Shaders("screen")
        paint, light = m.add("BsdfPrincipled", Base_Color=BLACK, Specular=1), m.add("Emission", Strength=2)
        added = m.add("AddShader", _0=paint.outputs[0], _1=light.outputs[0])
        self.assert_reflects(self.of(m.show(added))[1], 0.08)

    def test_a_fresnel_mix_reflects_as_in_cycles(self):
        m = Shaders("varnish")
        under, gloss = m.add("BsdfDiffuse", Color=BLACK), m.add("BsdfGlossy", Color=(1, 0.5, 0.5, 1), Roughness=0)
        factor = m.add("Fresnel", IOR=1.8)
        mix = m.add("MixShader", _0=factor.outputs[0], _1=under.outputs[0], _2=gloss.outputs[0])
        found = self.of(m.show(mix))[1]
        self.assert_reflects(found, self.seen())
        np.testing.assert_allclose(reflectance(found)[0], np.array([1, 0.5, 0.5]) * (0.8 / 2.8) ** 2, atol=1e-4)

    def test_metals_are_left_to_their_base_colour(self):
        for kind, settings in (("BsdfGlossy", {}), ("BsdfPrincipled", {"Metallic": 1, "Specular": 0})):
            with self.subTest(kind):
                self.setUp()
                m = Shaders(kind)
                found = self.of(m.show(m.add(kind, **settings)))[1]
                self.assertNotIn("extensions", found)

    def test_glass_has_its_index_and_a_closed_body(self):
        for kind, settings in (("BsdfGlass", {}), ("BsdfPrincipled", {"Transmission": 1, "Specular": 0})):
            with self.subTest(kind):
                self.setUp()
                m = Shaders("glass")
                material = m.show(m.add(kind, IOR=1.7, Roughness=0, **settings))
                self.add_cube("body", material, size=3)
                self.add_cube("inside", diffuse("white"), size=1)
                self.add_square("pane", material, (9, 0, 0))
                exported = self.export()
                body, pane = (exported.material(name) for name in ("body", "pane"))
                for found in (body, pane):
                    self.assertEqual(found["extensions"]["KHR_materials_transmission"]["transmissionFactor"], 1)
                    self.assertAlmostEqual(found["extensions"][IOR]["ior"], 1.7, 5)
                    self.assert_reflects(found, (0.7 / 2.7) ** 2)
                self.assertEqual(body["extensions"][VOLUME], {"thicknessFactor": 3})
                self.assertNotIn(VOLUME, pane["extensions"])

    def test_part_of_glass_reflects_as_part(self):
        m = Shaders("wax")
        found = self.of(m.show(m.add("BsdfPrincipled", Transmission=0.5, Specular=0.5, IOR=2)))[1]
        self.assert_reflects(found, 0.5 * 0.04 + 0.5 / 9)

    def test_refraction_alone_reflects_nothing(self):
        m = Shaders("lens")
        self.assert_reflects(self.of(m.show(m.add("BsdfRefraction", IOR=1.45)))[1], 0, 0)

    def test_a_void_in_glass_has_the_index_of_glass(self):
        m = Shaders("bubble")
        exported, found = self.of(m.show(m.add("BsdfGlass", IOR=0.8)))
        self.assertAlmostEqual(found["extensions"][IOR]["ior"], 1.25, 5)
        self.assert_warned(exported, "'bubble'", "IOR of 0.8")

    def test_absorption_in_glass_is_kept(self):
        m = Shaders("wine")
        material = m.show(m.add("BsdfGlass"))
        density, color = 3.0, np.array([0.8, 0.1, 0.2])
        m.set(material.node_tree.get_output_node("CYCLES").inputs["Volume"],
              m.add("VolumeAbsorption", Color=(*color, 1), Density=density).outputs[0])
        self.add_cube("body", material)
        exported = self.export()
        volume = exported.material("body")["extensions"][VOLUME]
        passed = np.array(volume["attenuationColor"]) ** (0.5 / volume["attenuationDistance"])
        np.testing.assert_allclose(passed, np.exp(-0.5 * density * (1 - color)), rtol=1e-5)
        self.assertFalse([line for line in exported.warnings if "volume" in line])

    def test_numbers_that_vary_are_named(self):
        m = Shaders("worn")
        noise = m.add("TexNoise").outputs[0]
        exported = self.of(m.show(m.add("BsdfPrincipled", Specular=noise, Clearcoat=noise, IOR=noise,
                                        Transmission_Roughness=0.5)))[0]
        for words in ("its specular varies", "its clearcoat varies", "its IOR varies", "Transmission Roughness"):
            self.assert_warned(exported, "'worn'", words)

    def test_roughness_images_of_dielectrics_are_kept(self):
        m = Shaders("scuffed")
        texture = m.add("TexImage")
        texture.image = image("grey", [[[0.25] * 3 + [1], [0.75] * 3 + [1]]], "Non-Color")
        exported, found = self.of(m.show(m.add("BsdfPrincipled", Base_Color=HALF, Roughness=texture.outputs[0])))
        self.assert_base(found, (0.5,) * 3)
        self.assertEqual(found["pbrMetallicRoughness"].get("roughnessFactor", 1), 1)
        np.testing.assert_allclose(exported.image(found, "metallicRoughnessTexture")[0, :, 1], (0.25, 0.75), atol=0.01)

    def test_normal_maps_are_kept(self):
        m = Shaders("brick")
        place = m.add("UVMap")
        place.uv_map = "second"
        texture = m.add("TexImage", Vector=place.outputs[0])
        texture.image = image("normals", [[[0.5, 0.5, 1, 1], [0.75, 0.5, 0.9, 1]]], "Non-Color")
        bent = m.add("NormalMap", Strength=0.6, Color=texture.outputs[0])
        square = self.add_square("square", m.show(m.add("BsdfPrincipled", Normal=bent.outputs[0])))
        square.data.uv_layers.new(name="second")
        exported = self.export()
        found = exported.material("square")
        self.assertAlmostEqual(found["normalTexture"]["scale"], 0.6, 5)
        self.assertEqual(found["normalTexture"]["texCoord"], 1)
        np.testing.assert_allclose(exported.image(found, "normalTexture")[0, 1, :3], (0.75, 0.5, 0.9), atol=0.01)

    def test_what_light_passes_in_part_is_blended(self):
        m = Shaders("veil")
        exported, found = self.of(m.show(m.add("BsdfPrincipled", Base_Color=HALF, Alpha=0.4)))
        self.assertEqual(found["alphaMode"], "BLEND")
        self.assertAlmostEqual(found["pbrMetallicRoughness"]["baseColorFactor"][3], 0.4, 5)
        self.assertFalse([line for line in exported.warnings if "veil" in line])
        self.setUp()
        m = Shaders("smoke")
        texture = m.add("TexImage")
        texture.image = image("soft", [[[1, 1, 1, 0.2], [1, 1, 1, 0.6]]])
        exported, found = self.of(m.show(m.add("BsdfPrincipled", Base_Color=texture.outputs[0],
                                               Alpha=texture.outputs[1])))
        self.assertEqual(found["alphaMode"], "BLEND")
        np.testing.assert_allclose(exported.image(found)[0, :, 3], (0.2, 0.6), atol=0.01)
