"""Recognizes the values that glTF can hold as they are: a factor, times an image, times vertex colours."""
import dataclasses
import math

import bpy
import numpy as np

from . import nodes
from .values import is_constant

CHANNELS = {"R": 0, "Red": 0, "G": 1, "Green": 1, "B": 2, "Blue": 2}
MISSING = np.array([1.0, 0.0, 1.0])
"""The colour in which Cycles shows a missing image."""


@dataclasses.dataclass
class Texture:
    """`channel` is None for the colour, 'A' for alpha, or 'R', 'G', 'B'. `colors` names a colour attribute."""
    factor: np.ndarray
    node: object = None
    channel: str = None
    colors: str = None

    def place(self):
        """What makes two textures apply alike: image coordinates, wrapping and filtering."""
        if not self.node:
            return None
        mapping = mapping_of(self.node)
        return mapping, self.node.extension, self.node.interpolation


def split(values, value, warn):
    """The value as a `Texture`; None if glTF cannot hold it so."""
    if is_constant(value):
        return Texture(value)
    node, name = value.node, value.name
    if node.type in {"TEX_IMAGE", "TEX_ENVIRONMENT"}:
        if is_missing(node.image):
            warn(f"the image of its node '{node.name}' is missing{_path(node.image)}: "
                 "find it with File > External Data; it is magenta until then")
            return Texture(MISSING if name == "Color" else np.ones(3))
        return Texture(np.ones(3), node, "A" if name == "Alpha" else None)
    if node.type == "VERTEX_COLOR" and name == "Color":
        return Texture(np.ones(3), colors=node.layer_name)
    if node.type == "ATTRIBUTE" and name == "Color" and node.attribute_type == "GEOMETRY":
        return Texture(np.ones(3), colors=node.attribute_name)
    if node.type in {"SEPRGB", "SEPARATE_COLOR"} and getattr(node, "mode", "RGB") == "RGB":
        inner = split(values, values.of(node.inputs[0]), warn)
        index = CHANNELS[name]
        if inner and inner.node and not inner.channel and not inner.colors:
            return dataclasses.replace(inner, channel="RGB"[index], factor=np.full(3, inner.factor[index]))
        return None
    factors = _factors(values, node)
    if not factors:
        return None
    a, b = (split(values, factor, warn) for factor in factors)
    if not a or not b or a.node and b.node or a.colors and b.colors:
        return None
    return Texture(a.factor * b.factor, a.node or b.node, a.channel or b.channel, a.colors or b.colors)


def _factors(values, node):
    """The two values that a node multiplies; None for other nodes."""
    if node.type in {"VECT_MATH", "MATH"} and node.operation == "MULTIPLY":
        return [values.of(socket) for socket in node.inputs[:2]]
    if node.type == "MIX" and node.data_type == "RGBA" and node.blend_type == "MULTIPLY":
        factor, pair = values.of(node.inputs[0]), node.inputs[6:8]
    elif node.type == "MIX_RGB" and node.blend_type == "MULTIPLY":
        factor, pair = values.of(node.inputs[0]), node.inputs[1:3]
    else:
        return None
    if not is_constant(factor) or not np.allclose(factor, 1):
        return None
    return [values.of(socket) for socket in pair]


def _path(image):
    return f" ('{image.filepath_from_user()}')" if image else ""


def is_missing(image):
    """Whether Cycles has no pixels to show."""
    return image is None or image.source != "TILED" and image.size[0] * image.size[1] == 0


def is_color_image(texture):
    """Whether a texture's colours are as glTF reads them: eight bits a channel, sRGB, flat."""
    return (_is_flat(texture.node) and texture.channel is None
            and texture.node.image.colorspace_settings.name == "sRGB")


def is_data_image(texture):
    """Whether a texture's numbers are as glTF reads them: eight bits a channel, not a colour."""
    spaces = {"Non-Color", "Raw", "Linear"}
    return (_is_flat(texture.node)
            and (texture.channel == "A" or texture.node.image.colorspace_settings.name in spaces))


def _is_flat(node):
    image = node.image
    return (node.type == "TEX_IMAGE" and image.source in {"FILE", "GENERATED"} and not image.is_float
            and node.projection == "FLAT" and node.extension in {"REPEAT", "EXTEND"} and mapping_of(node) is not None)


def mapping_of(node):
    """(UV map or '', offset, rotation, scale) of an image node; None if glTF has no such mapping.

    Coordinates are scaled, then turned, then moved.
    """
    name, offset, rotation, scale = "", (0.0, 0.0), 0.0, (1.0, 1.0)
    origin = nodes.source(node.inputs["Vector"])
    if origin and origin.node.type == "MAPPING":
        mapping = origin.node
        if any(nodes.source(mapping.inputs[k]) for k in ("Location", "Rotation", "Scale") if k in mapping.inputs):
            return None
        place, turn, size = (mapping.inputs[k].default_value for k in ("Location", "Rotation", "Scale"))
        if abs(turn[0]) + abs(turn[1]) > 1e-6 or mapping.vector_type == "NORMAL":
            return None
        rotation, scale = turn[2], (size[0], size[1])
        if mapping.vector_type == "POINT":
            offset = (place[0], place[1])
        elif mapping.vector_type == "TEXTURE":
            if min(map(abs, scale)) < 1e-6 or abs(rotation) > 1e-6 and abs(scale[0] - scale[1]) > 1e-6:
                return None
            rotation, scale = -rotation, (1 / scale[0], 1 / scale[1])
            c, s = math.cos(rotation), math.sin(rotation)
            offset = ((s * place[1] - c * place[0]) * scale[0], -(s * place[0] + c * place[1]) * scale[1])
        origin = nodes.source(mapping.inputs["Vector"])
        if origin is None:
            return None
    if origin is None:
        pass
    elif origin.node.type == "TEX_COORD" and origin.name == "UV" and not origin.node.from_instancer:
        pass
    elif origin.node.type == "UVMAP" and not origin.node.from_instancer:
        name = origin.node.uv_map
    elif origin.node.type == "ATTRIBUTE" and origin.name == "Vector" and origin.node.attribute_type == "GEOMETRY":
        name = origin.node.attribute_name
    else:
        return None
    return name, offset, rotation, scale


def pixels(image):
    """The image's linear values, rows from below, as an array of height, width, 4."""
    data = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(data)
    data = data.reshape(image.size[1], image.size[0], -1)
    if data.shape[2] < 4:
        data = np.concatenate([np.repeat(data[..., :1], 3, 2), np.ones_like(data[..., :1])], 2)
    if not image.is_float and image.colorspace_settings.name == "sRGB":
        color = data[..., :3]
        data[..., :3] = np.where(color <= 0.04045, color / 12.92, ((color + 0.055) / 1.055) ** 2.4)
    return data
