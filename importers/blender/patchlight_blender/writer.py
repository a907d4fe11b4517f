"""Writes a reduced material as a shader, and bakes what glTF cannot hold."""
import dataclasses

import bpy
import numpy as np

from . import nodes, textures
from .bake import UV_NAME
from .shader import Shader
from .values import is_constant


class Made:
    """An exported material, the colour attribute that it uses or None, and whether it is for one mesh only."""

    def __init__(self, material, colors, is_baked):
        self.material, self.colors, self.is_baked = material, colors, is_baked


class Writer:
    """Writes one exported material."""

    def __init__(self, item, user):
        self.item, self.user = item, user
        self.mesh, self.is_baked, self.is_grey = user[0], False, False

    def write(self, surface, two_sided, opaque, transmission, thickness):
        item = self.item
        shader = self.shader = Shader(item.name, two_sided)
        surface = self._translucent(surface)
        base = textures.split(item.values, surface.base, item.warn)
        alpha = textures.split(item.values, surface.alpha, item.warn)
        colors = self._base(surface, base, alpha, opaque)
        for name, value in (("Metallic", surface.metallic), ("Roughness", surface.roughness)):
            self._number(name, value)
        shader.number("Transmission", transmission)
        self._dielectric(surface, transmission, thickness)
        shader.number("Clearcoat", surface.clearcoat[0])
        shader.number("Clearcoat Roughness", surface.clearcoat[1])
        self._emission(surface.emission)
        self._normal(surface.normal)
        material = shader.material
        if item.original:
            for name in item.original.keys():
                if isinstance(item.original[name], (int, float, str)):
                    material[name] = item.original[name]
        material["patchlight_uv"] = shader.uv
        return Made(material, colors, self.is_baked)

    def _mean(self, value):
        return self.item.mean(self.item.values, value, self.user, self.item.copy)

    def _has_uv(self, texture):
        """Whether the mesh has the UV map that a texture reads. Without one Cycles shows a single texel."""
        name = textures.mapping_of(texture.node)[0]
        return name in self.mesh.uv_layers if name else any(l.name != UV_NAME for l in self.mesh.uv_layers)

    def _uv_index(self, name):
        layers = self.mesh.uv_layers
        found = layers.find(name) if name else next((i for i, l in enumerate(layers) if l.active_render), 0)
        return max(found, 0)

    def _bake(self, value, what):
        """Linear values of an output over this mesh; None, with a warning, where Cycles cannot bake."""
        item, (mesh, index, matrix) = self.item, self.user
        try:
            if not item.baker.unwrap(mesh):
                raise RuntimeError("the mesh has eight UV maps already")
            copy = item.copy.copy()
            socket = copy.node_tree.nodes[value.node.name].outputs[list(value.node.outputs).index(value)]
            data = item.baker.colors(mesh, index, matrix, copy, socket)
            bpy.data.materials.remove(copy)
        except RuntimeError as error:
            item.warn(f"its {what} cannot be baked ({error}): the mean is taken")
            return None
        self.is_baked = True
        return data

    def _base(self, surface, base, alpha, opaque):
        """Base colour and alpha. Returns the name of the colour attribute that multiplies them, or None."""
        shader, item = self.shader, self.item
        good = (base and base.factor.max() <= 1
                and (not base.node or textures.is_color_image(base) and self._has_uv(base)))
        fits = opaque or alpha and (not alpha.node or alpha.channel == "A" and textures.is_data_image(alpha)
                                    and self._has_uv(alpha))
        if good and fits and alpha.node and base.node:
            fits = base.node.image == alpha.node.image and base.place() == alpha.place()
        colors = None
        if good and fits:
            node, colors = None, base.colors
            if base.node or not opaque and alpha.node:
                found = base if base.node else alpha
                node = shader.image_node(found)
                shader.uv["baseColorTexture"] = self._uv_index(textures.mapping_of(found.node)[0])
            if base.node:
                shader.link_color("Base Color", node, base.factor)
            else:
                shader.color("Base Color", base.factor)
            if not opaque and alpha.node:
                shader.link_number("Alpha", node, "A", 1)
                self._find_grey(textures.pixels(alpha.node.image)[..., 3])
                if not np.isclose(alpha.factor[0], 1):
                    item.warn(f"the factor {alpha.factor[0]:.3g} on its alpha image is left out")
        else:
            self._baked_base(surface, opaque, fits and not alpha.node)
        shader.material.blend_method = "OPAQUE"
        if not opaque:
            is_grey = self.is_grey or is_constant(surface.alpha)
            shader.material.blend_method, shader.material.alpha_threshold = "BLEND" if is_grey else "CLIP", 0.5
            if is_constant(surface.alpha):
                shader.number("Alpha", surface.alpha[0])
        return colors

    def _baked_base(self, surface, opaque, constant_alpha):
        """Base colour and alpha in one baked image."""
        color = surface.base if is_constant(surface.base) else self._bake(surface.base, "base colour")
        alpha = None if opaque or constant_alpha else self._bake(surface.alpha, "alpha")
        if color is None:
            color = self._mean(surface.base)
        if color.ndim == 1 and alpha is None:
            self.shader.color("Base Color", np.clip(color, 0, 1))
            return
        data = np.ones((alpha if color.ndim == 1 else color).shape, np.float32)
        data[..., :3] = color if color.ndim == 1 else color[..., :3]
        if alpha is not None:
            data[..., 3] = alpha[..., 0]
            self._find_grey(alpha[..., 0])
        if data[..., :3].max() > 1.001:
            self.item.warn("its base colour is above 1 in places and is lowered to 1")
        node = self.shader.new_image_node(data, f"{self.item.name} base")
        self.shader.uv["baseColorTexture"] = self.mesh.uv_layers.find(UV_NAME)
        self.shader.link_color("Base Color", node, np.ones(3))
        if alpha is not None:
            self.shader.link_number("Alpha", node, "A", 1)

    def _find_grey(self, alpha):
        """Notes whether more than a tenth of an alpha image is partly transparent."""
        self.is_grey |= bool(np.mean((alpha > 0.1) & (alpha < 0.9)) > 0.1)

    def _number(self, name, value):
        found = textures.split(self.item.values, value, self.item.warn)
        if found and not found.node and not found.colors:
            self.shader.number(name, np.clip(found.factor[0], 0, 1))
        elif (found and not found.colors and textures.is_data_image(found) and found.factor.max() <= 1
              and self._has_uv(found)):
            self.shader.link_number(name, self.shader.image_node(found), found.channel, found.factor[0])
            self.shader.uv["metallicRoughnessTexture"] = self._uv_index(textures.mapping_of(found.node)[0])
        else:
            mean = float(np.clip(self._mean(value)[0], 0, 1))
            self.item.warn(f"its {name.lower()} varies by other nodes than an image: the mean {mean:.2g} is taken")
            self.shader.number(name, mean)

    def _translucent(self, surface):
        """Writes the translucence of a surface; returns the surface with the base colour of what does not pass."""
        if is_constant(surface.translucence) and not np.any(surface.translucence):
            return surface
        if not is_constant(surface.translucence):
            self.item.warn("the colour of the light that passes it varies: its mean is taken")
        color = np.clip(self._mean(surface.translucence), 0, 1)
        part = float(color.max())
        if part <= 0:
            return surface
        self.shader.translucence(part, color / part)
        rest = self.item.values.multiply(surface.base, np.full(3, 1 / max(1 - part, 1e-6)))
        return dataclasses.replace(surface, base=rest if part < 1 else np.zeros(3))

    def _dielectric(self, surface, transmission, thickness):
        """The reflection of a surface that is no metal, and what is inside if it is glass."""
        if is_constant(surface.metallic) and np.all(surface.metallic >= 1):
            self.shader.dielectric(1, 0.04, None)
            return
        ior = surface.ior
        if transmission > 0 and 0 < ior < 1:
            ior = 1 / ior
            self.item.warn(f"its IOR of {surface.ior:.3g} is that of a void in glass: {ior:.3g} is written instead")
        if surface.absorption is not None and not thickness:
            self.item.warn("its volume is left out where the mesh is not closed")
        self.shader.dielectric(surface.specular, surface.f0, max(ior, 1) if transmission > 0 else None, thickness,
                               surface.absorption)

    def _emission(self, value):
        shader = self.shader
        if is_constant(value):
            strength = float(value.max())
            if value.min() < 0:
                self.item.warn("its emission is negative and becomes 0 there")
            if strength > 0:
                shader.color("Emission", np.clip(value, 0, None) / strength)
                shader.number("Emission Strength", strength)
            return
        found = textures.split(self.item.values, value, self.item.warn)
        if found and not found.colors and (not found.node or textures.is_color_image(found) and self._has_uv(found)):
            strength = max(float(found.factor.max()), 1e-9)
            shader.number("Emission Strength", strength)
            if not found.node:
                shader.color("Emission", found.factor / strength)
                return
            shader.link_color("Emission", shader.image_node(found), found.factor / strength)
            shader.uv["emissiveTexture"] = self._uv_index(textures.mapping_of(found.node)[0])
            return
        data = self._bake(value, "emission")
        if data is None:
            return self._emission(self._mean(value))
        strength = max(float(data[..., :3].max()), 1e-9)
        data[..., :3] = np.clip(data[..., :3] / strength, 0, None)
        data[..., 3] = 1
        shader.number("Emission Strength", strength)
        shader.link_color("Emission", shader.new_image_node(data, f"{self.item.name} emission"), np.ones(3))
        shader.uv["emissiveTexture"] = self.mesh.uv_layers.find(UV_NAME)

    def _normal(self, origin):
        if origin is None:
            return
        node = origin.node
        if node.type == "NORMAL_MAP" and node.space == "TANGENT" and not nodes.source(node.inputs["Strength"]):
            found = textures.split(self.item.values, self.item.values.of(node.inputs["Color"]), self.item.warn)
            if (found and found.node and np.allclose(found.factor, 1) and textures.is_data_image(found)
                    and self._has_uv(found)):
                self.shader.link_normal(found, node.inputs["Strength"].default_value)
                self.shader.uv["normalTexture"] = self._uv_index(textures.mapping_of(found.node)[0])
                return
        self.item.warn(f"the normals of its node '{node.name}' ({node.bl_label}) are left out")
