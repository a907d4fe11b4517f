"""What textures become: images as they are, vertex colours, and bakes of the rest."""
import math

import bpy
import numpy as np
from support import MaterialTest, Shaders, diffuse, image

CHECK = [[[1, 0, 0, 1], [0, 1, 0, 0]], [[0, 0, 1, 0], [1, 1, 1, 1]]]


class Textures(MaterialTest):
    def test_an_image_keeps_its_factor_mapping_and_uv_map(self):
        m = Shaders("wood")
        place = m.add("UVMap")
        place.uv_map = "second"
        mapping = m.add("Mapping", Vector=place.outputs[0], Scale=(4, 4, 1))
        texture = m.add("TexImage", Vector=mapping.outputs[0])
        texture.image = image("check", CHECK)
        tint = m.nodes.new("ShaderNodeMix")
        tint.data_type, tint.blend_type = "RGBA", "MULTIPLY"
        m.set(tint.inputs[0], 1)
        m.set(tint.inputs[6], texture.outputs["Color"])
        m.set(tint.inputs[7], (0.5, 0.25, 1, 1))
        square = self.add_square("square", m.show(m.add("BsdfPrincipled", Base_Color=tint.outputs[2])))
        square.data.uv_layers.new(name="second")
        self.add_mesh("empty slot", [(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)]).data.materials.append(None)
        exported = self.export()
        found = exported.material("square")
        self.assert_base(found, (0.5, 0.25, 1))
        texture = found["pbrMetallicRoughness"]["baseColorTexture"]
        self.assertEqual(texture["texCoord"], 1)
        self.assertEqual(texture["extensions"]["KHR_texture_transform"]["scale"], [4, 4])

    def test_mappings_place_the_image_as_cycles_does(self):
        pixels = np.random.default_rng(1).random((4, 4, 4))
        pixels[..., 3] = 1
        for kind, scale in (("POINT", (2, 0.5, 1)), ("TEXTURE", (0.5, 0.5, 1)), ("VECTOR", (1, 2, 1))):
            with self.subTest(kind):
                self.setUp()
                m = Shaders("placed")
                mapping = m.add("Mapping", Vector=m.add("TexCoord").outputs["UV"], Rotation=(0, 0, 0.7), Scale=scale)
                mapping.vector_type = kind
                if kind != "VECTOR":
                    m.set(mapping.inputs["Location"], (0.3, 0.1, 0))
                texture = m.add("TexImage", Vector=mapping.outputs[0])
                texture.image, texture.interpolation = image("random", pixels), "Closest"
                exported, found = self.of(m.show(m.add("Emission", Color=texture.outputs[0])))
                info = found["emissiveTexture"]["extensions"]["KHR_texture_transform"]
                turn, (sx, sy) = info.get("rotation", 0), info.get("scale", (1, 1))
                ox, oy = info.get("offset", (0, 0))
                rows, columns = np.mgrid[:64, :64]
                u, v = (columns + 0.5) / 64, 1 - (rows + 0.5) / 64
                s = ox + math.cos(turn) * sx * u + math.sin(turn) * sy * v
                t = oy - math.sin(turn) * sx * u + math.cos(turn) * sy * v
                file = exported.image(found, "emissiveTexture")
                want = file[(np.floor((1 - t) * 4) % 4).astype(int), (np.floor(s * 4) % 4).astype(int), :3]
                want = np.where(want <= 0.04045, want / 12.92, ((want + 0.055) / 1.055) ** 2.4)
                camera = self.add_camera()
                camera.data.type, camera.data.ortho_scale = "ORTHO", 2
                differ = np.abs(self.cycles(64, 64, 4) - want).max(axis=2) > 0.02
                self.assertLess(differ.mean(), 0.3, "pixels differ on the edges of texels alone")

    def test_alpha_is_a_mask(self):
        m = Shaders("leaf")
        texture = m.add("TexImage")
        texture.image = image("check", CHECK)
        clear, leaf = m.add("BsdfTransparent"), m.add("BsdfDiffuse", Color=texture.outputs["Color"])
        mix = m.add("MixShader", _0=texture.outputs["Alpha"], _1=clear.outputs[0], _2=leaf.outputs[0])
        exported, found = self.of(m.show(mix))
        self.assertEqual(found["alphaMode"], "MASK")
        self.assertIn(exported.image(found)[0, 1, 3], (0, 1))
        self.assertEqual(exported.image(found).shape[0], 2)

    def test_procedural_textures_are_baked(self):
        m = Shaders("steps")
        axes = m.add("SeparateXYZ", Vector=m.add("TexCoord").outputs["Generated"])
        half = m.add("Math", _0=axes.outputs["X"], _1=0.5)
        half.operation = "GREATER_THAN"
        exported, found = self.of(m.show(m.add("BsdfDiffuse", Color=half.outputs[0])))
        pixels = exported.image(found)
        self.assertEqual(pixels.shape[:2], (64, 64))
        uv = exported.accessor(exported.mesh("square")["primitives"][0]["attributes"]
                               [f"TEXCOORD_{found['pbrMetallicRoughness']['baseColorTexture'].get('texCoord', 0)}"])
        points = exported.positions("square")
        for corner, place in zip(points, uv):
            x, y = (place * 0.98 + 0.01) * 64
            self.assertEqual(round(float(pixels[int(63.99 - y), int(x), 0])), int(corner[0] > 0))

    def test_an_image_on_a_mesh_without_uv_map_shows_what_cycles_shows(self):
        m = Shaders("lost")
        texture = m.add("TexImage")
        texture.image, texture.interpolation = image("check", CHECK), "Closest"
        self.add_cube("cube", m.show(m.add("BsdfDiffuse", Color=texture.outputs[0])))
        exported = self.export()
        pixels = exported.image(exported.material("cube"))
        np.testing.assert_allclose(pixels[..., :3].max(axis=(0, 1)), (1, 0, 0), atol=0.01)

    def test_baked_emission_keeps_its_strength(self):
        m = Shaders("glow")
        axes = m.add("SeparateXYZ", Vector=m.add("TexCoord").outputs["Generated"])
        exported, found = self.of(m.show(m.add("Emission", Color=axes.outputs["X"], Strength=20)))
        strength = found["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"]
        pixels = exported.image(found, "emissiveTexture")[..., :3]
        linear = np.where(pixels <= 0.04045, pixels / 12.92, ((pixels + 0.055) / 1.055) ** 2.4)
        self.assertAlmostEqual(linear.mean() * strength / 10, 1, 1)
        self.assertGreater(strength, 19)

    def test_images_of_roughness_and_metallic_are_kept(self):
        m = Shaders("worn")
        texture = m.add("TexImage")
        texture.image = image("data", [[[0, 0.5, 1, 1]] * 2] * 2, "Non-Color")
        parts = m.add("SeparateColor", _0=texture.outputs[0])
        found = self.of(m.show(m.add("BsdfPrincipled", Roughness=parts.outputs[1], Metallic=parts.outputs[2])))
        pixels = found[0].image(found[1], "metallicRoughnessTexture")
        np.testing.assert_allclose(pixels[0, 0, 1:3], (0.5, 1), atol=0.01)

    def test_an_alpha_image_of_its_own_is_baked_with_the_colour(self):
        m = Shaders("fence")
        texture = m.add("TexImage")
        texture.image, texture.interpolation = image("grey", [[[0] * 3 + [1], [1] * 4]], "Non-Color"), "Closest"
        clear = m.add("BsdfTransparent")
        fence = m.add("BsdfDiffuse", Color=m.add("VertexColor").outputs[0])
        square = self.add_square("square", m.show(m.add("MixShader", _0=texture.outputs[0], _1=clear.outputs[0],
                                                        _2=fence.outputs[0])))
        colors = square.data.color_attributes.new("Col", "FLOAT_COLOR", "CORNER")
        colors.data.foreach_set("color", [0.25, 0.5, 1, 1] * 4)
        exported = self.export()
        found = exported.material("square")
        self.assertEqual(found["alphaMode"], "MASK")
        self.assertNotIn("COLOR_0", exported.mesh("square")["primitives"][0]["attributes"])
        pixels = exported.image(found)
        np.testing.assert_allclose(pixels[32, [16, 48], 3], (0, 1), atol=0.01)
        np.testing.assert_allclose(pixels[32, 48, :3], (0.537, 0.735, 1), atol=0.01)

    def test_a_procedural_material_is_baked_for_each_mesh(self):
        m = Shaders("noise")
        material = m.show(m.add("BsdfDiffuse", Color=m.add("TexNoise").outputs["Color"]))
        self.add_square("a", material)
        self.add_cube("b", material, (5, 0, 0))
        exported = self.export()
        self.assertEqual(len(exported.gltf["images"]), 2)
        self.assertEqual(exported.material("a")["name"], "noise")

    def test_vertex_colors_apply_where_the_material_reads_them(self):
        m = Shaders("painted")
        material = m.show(m.add("BsdfDiffuse", Color=m.add("VertexColor").outputs[0]))
        for name, used in (("painted", material), ("plain", diffuse("plain"))):
            obj = self.add_square(name, used)
            colors = obj.data.color_attributes.new("Col", "FLOAT_COLOR", "CORNER")
            colors.data.foreach_set("color", [0.25, 0.5, 1, 1] * 4)
        exported = self.export()
        attributes = [exported.mesh(name)["primitives"][0]["attributes"] for name in ("painted", "plain")]
        self.assertNotIn("COLOR_0", attributes[1])
        values = exported.accessor(attributes[0]["COLOR_0"]).astype(float)
        np.testing.assert_allclose(values[0][:3] / values[0][2], (0.25, 0.5, 1), atol=1e-3)

    def test_a_missing_image_is_named(self):
        m = Shaders("lost")
        texture = m.add("TexImage")
        texture.image = bpy.data.images.new("brick", 4, 4)
        texture.image.source, texture.image.filepath = "FILE", "/nowhere/brick.png"
        exported, found = self.of(m.show(m.add("BsdfDiffuse", Color=texture.outputs[0])))
        self.assert_base(found, (1, 0, 1))
        self.assert_warned(exported, "'lost'", "/nowhere/brick.png")
