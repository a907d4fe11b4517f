"""Builds the node tree of an exported material: a Principled BSDF that Blender's glTF exporter understands."""
import json

import bpy
import numpy as np

from . import nodes, textures


class Shader:
    """A new material. `uv` collects which UV map each glTF texture reads."""

    def __init__(self, name, two_sided):
        self.material = bpy.data.materials.new("patchlight material")
        self.material.use_nodes = True
        self.material.use_backface_culling = not two_sided
        self.material["patchlight_name"] = name
        self.tree = self.material.node_tree
        self.tree.nodes.clear()
        self.principled = self.tree.nodes.new("ShaderNodeBsdfPrincipled")
        output = self.tree.nodes.new("ShaderNodeOutputMaterial")
        self.tree.links.new(self.principled.outputs[0], output.inputs["Surface"])
        self.uv, self.extensions = {}, {}
        self.number("Emission Strength", 0)
        self.dielectric(0, 1, None)

    def translucence(self, part, color):
        """Lets the part `part` of the light that is not reflected by the coat pass, times a colour."""
        self.extensions["KHR_materials_diffuse_transmission"] = {
            "diffuseTransmissionFactor": float(part), "diffuseTransmissionColorFactor": [float(c) for c in color]}
        self._keep_extensions()

    def dielectric(self, weight, f0, ior, thickness=0, absorption=None):
        """Sets the dielectric reflection: its weight and its reflectance at normal incidence. `ior` is that of glass,
        else None; `thickness` that of the body below the surface, and `absorption` its absorption, 1/m."""
        found = self.extensions
        for name in ("KHR_materials_specular", "KHR_materials_ior", "KHR_materials_volume"):
            found.pop(name, None)
        color = np.broadcast_to(f0 / ((ior - 1) / (ior + 1)) ** 2 if ior and ior > 1 else f0 / 0.04, 3)
        specular = {} if weight >= 1 else {"specularFactor": float(weight)}
        if weight > 0 and not np.allclose(color, 1, atol=1e-5):
            specular["specularColorFactor"] = [float(part) for part in color]
        if specular:
            found["KHR_materials_specular"] = specular
        if ior and not np.isclose(ior, 1.5):
            found["KHR_materials_ior"] = {"ior": float(ior)}
        if ior and thickness:
            found["KHR_materials_volume"] = volume = {"thicknessFactor": float(thickness)}
            if absorption is not None and np.any(absorption > 0):
                volume["attenuationDistance"] = float(1 / absorption.max())
                volume["attenuationColor"] = [float(part) for part in np.exp(-absorption / absorption.max())]
        self._keep_extensions()

    def _keep_extensions(self):
        self.material["patchlight_extensions"] = json.dumps(self.extensions)

    def number(self, socket, value):
        nodes.entry(self.principled, socket).default_value = float(value)

    def color(self, socket, value):
        nodes.entry(self.principled, socket).default_value = (*map(float, value), 1.0)

    def image_node(self, texture):
        """A new image node for `texture`, with the mapping that the exporter reads."""
        node = self.tree.nodes.new("ShaderNodeTexImage")
        node.image, node.extension = texture.node.image, texture.node.extension
        node.interpolation = texture.node.interpolation
        _, offset, rotation, scale = textures.mapping_of(texture.node)
        if (offset, rotation, scale) != ((0.0, 0.0), 0.0, (1.0, 1.0)):
            mapping = self.tree.nodes.new("ShaderNodeMapping")
            mapping.inputs["Location"].default_value = (*offset, 0)
            mapping.inputs["Rotation"].default_value = (0, 0, rotation)
            mapping.inputs["Scale"].default_value = (*scale, 1)
            self.tree.links.new(mapping.outputs[0], node.inputs["Vector"])
        return node

    def new_image_node(self, values, name):
        """An image node for linear colours, rows from below; the image is kept as eight-bit sRGB."""
        height, width = values.shape[:2]
        image = bpy.data.images.new(name, width, height, alpha=True)
        image.alpha_mode = "CHANNEL_PACKED"
        data = values.astype(np.float32).copy()
        color = np.clip(data[..., :3], 0, 1)
        data[..., :3] = np.where(color <= 0.0031308, color * 12.92, 1.055 * color ** (1 / 2.4) - 0.055)
        image.pixels.foreach_set(np.clip(data, 0, 1).ravel())
        image.update()
        image.pack()
        node = self.tree.nodes.new("ShaderNodeTexImage")
        node.image = image
        return node

    def link_color(self, socket, node, factor):
        """Links an image times a factor to a colour input."""
        out = node.outputs["Color"]
        if not np.allclose(factor, 1):
            multiply = self.tree.nodes.new("ShaderNodeMix")
            multiply.data_type, multiply.blend_type = "RGBA", "MULTIPLY"
            multiply.inputs[0].default_value = 1.0
            self.tree.links.new(out, multiply.inputs[6])
            multiply.inputs[7].default_value = (*map(float, factor), 1.0)
            out = multiply.outputs[2]
        self.tree.links.new(out, nodes.entry(self.principled, socket))

    def link_number(self, socket, node, channel, factor):
        """Links a channel of an image, times a factor, to a number input."""
        if channel == "A":
            out = node.outputs["Alpha"]
        else:
            separate = self.tree.nodes.new("ShaderNodeSeparateColor")
            self.tree.links.new(node.outputs["Color"], separate.inputs[0])
            out = separate.outputs["RGB".index(channel or "R")]
        if not np.isclose(factor, 1):
            multiply = self.tree.nodes.new("ShaderNodeMath")
            multiply.operation = "MULTIPLY"
            self.tree.links.new(out, multiply.inputs[0])
            multiply.inputs[1].default_value = float(factor)
            out = multiply.outputs[0]
        self.tree.links.new(out, nodes.entry(self.principled, socket))

    def link_normal(self, source, strength):
        node = self.image_node(source)
        normal = self.tree.nodes.new("ShaderNodeNormalMap")
        normal.inputs["Strength"].default_value = strength
        self.tree.links.new(node.outputs["Color"], normal.inputs["Color"])
        self.tree.links.new(normal.outputs[0], self.principled.inputs["Normal"])
