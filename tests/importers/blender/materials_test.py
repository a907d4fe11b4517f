"""What shaders become: numbers of a Principled BSDF."""
import bpy
import numpy as np
from support import MaterialTest, Shaders, diffuse

RED, BLUE, WHITE = (1, 0, 0, 1), (0, 0, 1, 1), (1, 1, 1, 1)


class Materials(MaterialTest):
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
        for kind, color, metallic in (("BsdfDiffuse", 0.5, 0), ("BsdfGlossy", 0.5, 1)):
            with self.subTest(kind):
                self.setUp()
                m = Shaders(kind)
                found = self.of(m.show(m.add(kind, Color=(color, color, color, 1))))[1]
                self.assert_base(found, (color,) * 3, metallic)

    def test_translucent_shaders_pass_light_diffusely(self):
        m = Shaders("cloth")
        a, b = m.add("BsdfDiffuse", Color=RED), m.add("BsdfTranslucent", Color=(0.5, 1, 0.5, 1))
        found = self.of(m.show(m.add("MixShader", _0=0.25, _1=a.outputs[0], _2=b.outputs[0])))[1]
        self.assert_base(found, (1, 0, 0), 0)
        passing = found["extensions"]["KHR_materials_diffuse_transmission"]
        self.assertAlmostEqual(passing["diffuseTransmissionFactor"], 0.25, 5)
        np.testing.assert_allclose(passing["diffuseTransmissionColorFactor"], (0.5, 1, 0.5), atol=1e-6)

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

    def test_glass_stays_glass_and_what_only_light_passes_is_left_to_the_job(self):
        m = Shaders("pane")
        path, glass, clear = m.add("LightPath"), m.add("BsdfGlass"), m.add("BsdfTransparent")
        factor = m.add("Math", _0=path.outputs["Is Shadow Ray"], _1=path.outputs["Is Diffuse Ray"])
        factor.operation = "MAXIMUM"
        exported, found = self.of(m.show(m.add("MixShader", _0=factor.outputs[0], _1=glass.outputs[0],
                                               _2=clear.outputs[0])))
        self.assertEqual(found["extensions"]["KHR_materials_transmission"]["transmissionFactor"], 1)
        self.assertNotIn("exclude", exported.job)
        m = Shaders("ghost")
        path, seen, clear = m.add("LightPath"), m.add("BsdfDiffuse"), m.add("BsdfTransparent")
        exported, _ = self.of(m.show(m.add("MixShader", _0=path.outputs["Is Shadow Ray"], _1=seen.outputs[0],
                                           _2=clear.outputs[0])))
        self.assertIn('"ghost": {exclude: true}', exported.job)
        self.assert_warned(exported, "'ghost'", "shadow rays")

    def test_culling_by_nodes_gives_one_side(self):
        m = Shaders("front")
        side, front, clear = m.add("NewGeometry"), m.add("BsdfDiffuse"), m.add("BsdfTransparent")
        found = self.of(m.show(m.add("MixShader", _0=side.outputs["Backfacing"], _1=front.outputs[0],
                                     _2=clear.outputs[0])))[1]
        self.assertFalse(found.get("doubleSided", False))

    def test_a_volume_alone_has_no_surface(self):
        m = Shaders("smoke")
        m.add("OutputMaterial", Volume=m.add("VolumeScatter").outputs[0])
        self.add_square("plain", location=(5, 0, 0))
        self.add_square("square", m.data)
        exported = self.export()
        self.assertEqual(exported.names(), ["plain"])
        self.assert_warned(exported, "'smoke'", "volume")

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
