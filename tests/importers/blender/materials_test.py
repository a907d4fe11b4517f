"""What materials become: numbers, images, and bakes of the rest."""
import bpy
import numpy as np
from support import ExportTest, Shaders, diffuse

RED, BLUE, WHITE = (1, 0, 0, 1), (0, 0, 1, 1), (1, 1, 1, 1)


def image(name, pixels, color_space="sRGB"):
    """An image of a few pixels, rows from below, as the file has them."""
    pixels = np.asarray(pixels, np.float32)
    made = bpy.data.images.new(name, pixels.shape[1], pixels.shape[0], alpha=True)
    made.colorspace_settings.name = color_space
    made.pixels.foreach_set(pixels.ravel())
    made.update()
    made.pack()
    return made


CHECK = [[[1, 0, 0, 1], [0, 1, 0, 0]], [[0, 0, 1, 0], [1, 1, 1, 1]]]


class Materials(ExportTest):
    def of(self, material):
        """The export of a square with a material, and the material in it."""
        self.add_square("square", material)
        exported = self.export()
        return exported, exported.material("square")

    def assert_base(self, material, color, metallic=0.0):
        rough = material["pbrMetallicRoughness"]
        np.testing.assert_allclose(rough.get("baseColorFactor", [1, 1, 1, 1])[:3], color, atol=1e-3)
        self.assertAlmostEqual(rough.get("metallicFactor", 1.0), metallic, 3)

    def test_principled_keeps_its_numbers(self):
        m = Shaders("paint")
        exported, found = self.of(m.show(m.add("BsdfPrincipled", Base_Color=(0.2, 0.4, 0.6, 1), Roughness=0.3,
                                               Emission=(1, 0.5, 0, 1), Emission_Strength=8)))
        self.assert_base(found, (0.2, 0.4, 0.6))
        self.assertAlmostEqual(found["pbrMetallicRoughness"]["roughnessFactor"], 0.3, 5)
        np.testing.assert_allclose(found["emissiveFactor"], (1, 0.5, 0), atol=1e-6)
        self.assertAlmostEqual(found["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"], 8, 4)
        self.assertFalse([line for line in exported.warnings if "material" in line])

    def test_single_shaders(self):
        for kind, color, metallic in (("BsdfDiffuse", 0.5, 0), ("BsdfGlossy", 0.5, 1), ("BsdfTranslucent", 0.5, 0)):
            with self.subTest(kind):
                self.setUp()
                m = Shaders(kind)
                found = self.of(m.show(m.add(kind, Color=(color, color, color, 1))))[1]
                self.assert_base(found, (color,) * 3, metallic)

    def test_a_mix_is_the_mean_of_its_shaders(self):
        m = Shaders("mix")
        a, b = m.add("BsdfDiffuse", Color=RED), m.add("BsdfGlossy", Color=WHITE)
        found = self.of(m.show(m.add("MixShader", _0=0.25, _1=a.outputs[0], _2=b.outputs[0])))[1]
        self.assert_base(found, (1, 0.25, 0.25), 0.25 / (0.75 / 3 + 0.25))

    def test_a_fresnel_mix_is_a_coat(self):
        m = Shaders("plastic")
        a, b = m.add("BsdfDiffuse", Color=RED), m.add("BsdfGlossy", Color=WHITE, Roughness=0.1)
        factor = m.add("Fresnel", IOR=1.5)
        found = self.of(m.show(m.add("MixShader", _0=factor.outputs[0], _1=a.outputs[0], _2=b.outputs[0])))[1]
        self.assert_base(found, (1, 0, 0), 0)
        self.assertAlmostEqual(found["pbrMetallicRoughness"]["roughnessFactor"], 0.1, 5)

    def test_diffuse_and_emission_add(self):
        m = Shaders("lamp")
        a, b = m.add("BsdfDiffuse", Color=RED), m.add("Emission", Color=BLUE, Strength=3)
        found = self.of(m.show(m.add("AddShader", _0=a.outputs[0], _1=b.outputs[0])))[1]
        self.assert_base(found, (1, 0, 0), 0)
        np.testing.assert_allclose(found["emissiveFactor"], (0, 0, 1), atol=1e-6)

    def test_groups_and_muted_nodes(self):
        group = bpy.data.node_groups.new("group", "ShaderNodeTree")
        group.inputs.new("NodeSocketColor", "Tint").default_value = RED
        group.outputs.new("NodeSocketShader", "Shader")
        start, end = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
        shader = group.nodes.new("ShaderNodeBsdfDiffuse")
        group.links.new(start.outputs[0], shader.inputs["Color"])
        group.links.new(shader.outputs[0], end.inputs[0])
        m = Shaders("grouped")
        node = m.nodes.new("ShaderNodeGroup")
        node.node_tree = group
        dark = m.add("Gamma", Color=(0, 1, 0, 1), Gamma=9)
        dark.mute = True
        m.links.new(dark.outputs[0], node.inputs[0])
        self.assert_base(self.of(m.show(node))[1], (0, 1, 0))

    def test_constants_go_through_nodes(self):
        m = Shaders("computed")
        half = m.add("Gamma", Color=(0.25, 0.25, 0.25, 1), Gamma=0.5)
        found = self.of(m.show(m.add("BsdfDiffuse", Color=half.outputs[0])))[1]
        self.assert_base(found, (0.5,) * 3)

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

    def test_materials_without_nodes_and_of_the_object(self):
        plain = bpy.data.materials.new("plain")
        plain.diffuse_color = (0.1, 0.2, 0.3, 1)
        square = self.add_square("square", diffuse("of the mesh", RED))
        square.material_slots[0].link = "OBJECT"
        square.material_slots[0].material = plain
        self.add_square("bare", location=(5, 0, 0))
        exported = self.export()
        self.assert_base(exported.material("square"), (0.1, 0.2, 0.3))
        self.assert_base(exported.material("bare"), (0.8, 0.8, 0.8))

    def test_glass_and_what_light_passes_is_left_to_the_job(self):
        m = Shaders("pane")
        path, glass, clear = m.add("LightPath"), m.add("BsdfGlass"), m.add("BsdfTransparent")
        factor = m.add("Math", _0=path.outputs["Is Shadow Ray"], _1=path.outputs["Is Diffuse Ray"])
        factor.operation = "MAXIMUM"
        exported, found = self.of(m.show(m.add("MixShader", _0=factor.outputs[0], _1=glass.outputs[0],
                                               _2=clear.outputs[0])))
        self.assertEqual(found["extensions"]["KHR_materials_transmission"]["transmissionFactor"], 1)
        self.assertIn('"pane": {exclude: true}', exported.job)
        self.assert_warned(exported, "'pane'", "glass")

    def test_culling_by_nodes_gives_one_side(self):
        m = Shaders("front")
        side, front, clear = m.add("NewGeometry"), m.add("BsdfDiffuse"), m.add("BsdfTransparent")
        found = self.of(m.show(m.add("MixShader", _0=side.outputs["Backfacing"], _1=front.outputs[0],
                                     _2=clear.outputs[0])))[1]
        self.assertFalse(found.get("doubleSided", False))

    def test_a_missing_image_is_named(self):
        m = Shaders("lost")
        texture = m.add("TexImage")
        texture.image = bpy.data.images.new("brick", 4, 4)
        texture.image.source, texture.image.filepath = "FILE", "/nowhere/brick.png"
        exported, found = self.of(m.show(m.add("BsdfDiffuse", Color=texture.outputs[0])))
        self.assert_base(found, (1, 0, 1))
        self.assert_warned(exported, "'lost'", "/nowhere/brick.png")

    def test_bump_volume_and_displacement_are_named(self):
        m = Shaders("rough")
        noise = m.add("TexNoise")
        bump = m.add("Bump", Height=noise.outputs[0])
        material = m.show(m.add("BsdfDiffuse", Normal=bump.outputs[0]))
        output = material.node_tree.get_output_node("CYCLES")
        m.set(output.inputs["Volume"], m.add("VolumeScatter").outputs[0])
        exported = self.of(material)[0]
        self.assert_warned(exported, "'rough'", "Bump")
        self.assert_warned(exported, "'rough'", "volume")
