"""The world: a colour or an image as it is, any other node tree baked to an equirectangular image."""
import math
import pathlib

import bpy
import mathutils
import numpy as np

from . import nodes, panorama, textures
from .values import Values, is_constant

SAMPLES = 4
SUN_NAME = "Sky sun"
SEARCH_WIDTH, SEARCH_SIZE = 256, math.radians(3)
"""Size of the image in which the sun's disc is looked for, and its least size there."""


class World:
    """`environment` has the keys of the job; the image is written to `folder`."""

    def __init__(self, scene, folder, name, options, baker, report):
        self.folder, self.name, self.options, self.report = folder, name, options, report
        self.environment, self.sun, self.group = {}, None, ""
        if scene.world:
            self._read(scene.world, baker)
            self.group = scene.world.lightgroup
            if self.environment and self.group:
                self.environment["light_group"] = self.group

    def _read(self, world, baker):
        if not world.use_nodes or not world.node_tree:
            self._color(np.array(world.color[:]))
            return
        self._warn_of(world)
        output = world.node_tree.get_output_node("CYCLES")
        if output is None or not nodes.source(output.inputs["Surface"]):
            return
        copy = nodes.flat_copy(world, rays=nodes.LIGHTING)
        if not self._plain(copy, baker):
            self._bake(copy)

    def warn(self, text):
        self.report.warn(f"world: {text}")

    def _warn_of(self, world):
        kinds = {node.type for node in nodes.all_nodes(world.node_tree)}
        output = world.node_tree.get_output_node("CYCLES")
        if output and nodes.source(output.inputs["Volume"]):
            self.warn("its volume is left out")
        if "LIGHT_PATH" in kinds:
            self.warn("Light Path is read as light sees it, so the background of frames may differ")
        seen = getattr(world, "cycles_visibility", None)
        unseen = [ray for ray in ("camera", "diffuse", "glossy") if seen and not getattr(seen, ray)]
        if unseen:
            self.warn(f"it is invisible to {', '.join(unseen)} rays in Cycles, but is exported visible to all")

    def _color(self, color):
        if color.min() < 0:
            self.warn("its negative colour becomes 0")
        if color.max() > 0:
            self.environment = {"color": np.clip(color, 0, None)}

    def _plain(self, copy, baker):
        """Takes a colour, or an image with a turn about the vertical axis. Whether the world is one of these."""
        origin = nodes.source(copy.node_tree.get_output_node("CYCLES").inputs["Surface"])
        if origin.node.type != "BACKGROUND":
            return False
        values = Values(copy.node_tree, baker.probe)
        color, strength = (values.of(origin.node.inputs[key]) for key in ("Color", "Strength"))
        if not is_constant(strength):
            return False
        if is_constant(color):
            self._color(color * strength)
            return True
        found = textures.split(values, color, self.warn)
        if not found or found.colors or not found.node or found.node.type != "TEX_ENVIRONMENT":
            return False
        turn = _rotation(found.node)
        if turn is None or found.node.projection != "EQUIRECTANGULAR" or found.factor.min() < 0 or strength[0] < 0:
            return False
        file = self._file(found.node.image)
        if file is None:
            return False
        self.environment = {"image": file, "strength": float(strength[0])}
        if not np.allclose(found.factor, 1):
            self.environment["color"] = found.factor
        if abs(turn) > 1e-6:
            self.environment["rotation"] = math.degrees(turn)
        return True

    def _file(self, image):
        """Writes the environment's own file and returns its name; None if it has to be baked."""
        if image.source != "FILE" or not image.is_float or image.colorspace_settings.name not in {"Linear", "Raw",
                                                                                                   "Non-Color"}:
            return None
        if image.packed_file:
            data = image.packed_file.data
        else:
            path = pathlib.Path(image.filepath_from_user())
            data = path.read_bytes() if path.is_file() else b""
        kind = ".exr" if data[:4] == b"\x76\x2f\x31\x01" else ".hdr" if data[:2] == b"#?" else None
        values = textures.pixels(image)[..., :3]
        if values.min() < 0 or not np.isfinite(values).all():
            self.warn(f"negative texels of image '{image.name}' become 0")
            panorama.save(_clean(values), self.folder / f"{self.name}_sky.exr")
            return f"{self.name}_sky.exr"
        if kind is None:
            return None
        (self.folder / f"{self.name}_sky{kind}").write_bytes(data)
        return f"{self.name}_sky{kind}"

    def _bake(self, copy):
        studio = panorama.Panorama(self.options.threads)
        discs = [node for node in copy.node_tree.nodes
                 if node.type == "TEX_SKY" and node.sky_type == "NISHITA" and node.sun_disc and not node.mute]
        self.sun = self._measure_sun(studio, copy, discs) if discs else None
        sky = studio.whole(copy, self.options.sky_resolution, SAMPLES)
        if sky.min() < -1e-6 or not np.isfinite(sky).all():
            self.warn("negative texels of the baked sky become 0")
        if np.any(sky > 0):
            panorama.save(_clean(sky), self.folder / f"{self.name}_sky.exr")
            self.environment = {"image": f"{self.name}_sky.exr"}

    def _measure_sun(self, studio, copy, discs):
        """(Direction, irradiance, angle) of the sun's disc in the sky; None if it is below the horizon.

        The disc is left out of `copy`.
        """
        sizes, parts = [node.sun_size for node in discs], []
        for shown in (True, False):
            for node, size in zip(discs, sizes):
                node.sun_disc, node.sun_size = shown, max(size, SEARCH_SIZE)
            parts.append(studio.whole(copy, SEARCH_WIDTH, SAMPLES))
        vectors, solid = panorama.directions(SEARCH_WIDTH)
        weight = np.clip(parts[0] - parts[1], 0, None).sum(axis=2) * solid[:, None]
        weight[weight < weight.max() * 1e-3] = 0
        if not weight.any():
            return None
        direction = mathutils.Vector((vectors * weight[..., None]).sum(axis=(0, 1))).normalized()
        parts = []
        for shown in (True, False):
            for node, size in zip(discs, sizes):
                node.sun_disc, node.sun_size = shown, size
            parts.append(studio.part(copy, direction, max(sizes) + SEARCH_SIZE / 2, 256, SAMPLES))
        disc = np.clip(parts[0][0] - parts[1][0], 0, None) * parts[0][2][..., None]
        if not disc.any():
            return None
        center = mathutils.Vector((parts[0][1] * disc.sum(axis=2)[..., None]).sum(axis=(0, 1))).normalized()
        return center, disc.sum(axis=(0, 1)).astype(float), max(sizes)

    def suns(self):
        """The disc of a Nishita sky as a sun."""
        if not self.sun:
            return []
        direction, irradiance, size = self.sun
        data = bpy.data.lights.new(SUN_NAME, "SUN")
        data.energy, data.color = float(irradiance.max()), irradiance / irradiance.max()
        obj = bpy.data.objects.new(SUN_NAME, data)
        obj.matrix_world = direction.to_track_quat("Z", "Y").to_matrix().to_4x4()
        obj["angle"], obj["light_group"] = math.degrees(size), self.group or SUN_NAME
        return [obj]


def _clean(values):
    return np.clip(np.nan_to_num(values, nan=0.0, posinf=0.0, neginf=0.0), 0, None)


def _rotation(node):
    """The turn of an environment image about +Z, counter-clockwise from above; None for any other mapping."""
    origin = nodes.source(node.inputs["Vector"])
    if origin is None:
        return 0.0
    turn = 0.0
    if origin.node.type == "MAPPING":
        mapping = origin.node
        if any(nodes.source(mapping.inputs[k]) for k in ("Location", "Rotation", "Scale") if k in mapping.inputs):
            return None
        place, angles, scale = (mapping.inputs[k].default_value for k in ("Location", "Rotation", "Scale"))
        if any(abs(v) > 1e-6 for v in (*place, angles[0], angles[1])) or any(abs(v - 1) > 1e-6 for v in scale):
            return None
        turn = angles[2] if mapping.vector_type == "TEXTURE" else -angles[2]
        origin = nodes.source(mapping.inputs["Vector"])
    if origin and origin.node.type == "TEX_COORD" and origin.name in {"Generated", "Object"} and not origin.node.object:
        return turn
    return None
