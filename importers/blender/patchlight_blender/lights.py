"""Lamps: strength and colour, light groups, photometric files, and area lamps as emissive meshes."""
import itertools
import math
import re

import bpy
import numpy as np

from . import ies, motion, nodes
from .shader import Shader
from .values import Values, is_constant

DISK_SIDES = 64

RAYS = ("diffuse", "glossy", "transmission")


def is_animated(lamp):
    """Whether the strength or colour of a lamp may change with the frame: it has a light group of its own then."""
    return motion.is_animated(lamp) or motion.is_animated(lamp.node_tree)


class Lamps:
    """Reads lamps. `files` collects photometric files to write: name to bytes."""

    def __init__(self, scene, name, baker, report):
        self.scene, self.name, self.baker, self.report, self.files = scene, name, baker, report, {}
        holders = {group for obj in scene.objects if obj.type == "LIGHT" and not obj.hide_render
                   for group in [self._collection(obj)] if group}
        self.by_collection = len(holders) > 1
        self.powers, self.settings = {}, {}

    def follow(self, items):
        """Finds the strengths of animated lamps in the scene's frames. The factors by frame of those that change are in
        `settings` once they are added: light group to frame to colour."""
        suspects = {item.source.data for item in items if is_animated(item.source.data)}
        now = self.scene.frame_current
        found = {lamp: {} for lamp in suspects}
        for frame in motion.frames(self.scene) if suspects else ():
            self.scene.frame_set(frame)
            for lamp in suspects:
                found[lamp][frame] = np.clip(self.strength(lamp)[0], 0, None)
        if suspects:
            self.scene.frame_set(now)
        self.powers = {lamp: path for lamp, path in found.items() if np.ptp(list(path.values()), axis=0).any()}

    def _collection(self, obj):
        """The collection right below the scene's own that holds an object; '' if none does."""
        return next((c.name for c in self.scene.collection.children if obj.name in c.all_objects), "")

    def group(self, obj, instancer=None):
        """The light group of an object; '' if it has none of its own."""
        for item in (obj, instancer):
            if item is not None:
                own = item.get("light_group")
                if isinstance(own, str) and own:
                    return own
                if item.lightgroup:
                    return item.lightgroup
        return self._collection(instancer or obj) if self.by_collection else ""

    def strength(self, lamp):
        """(Colour times power, IES node or None) of a lamp's data: W, for suns W/m2."""
        base = np.array(lamp.color[:]) * lamp.energy
        if not lamp.use_nodes or not lamp.node_tree:
            return base, None
        copy = nodes.flat_copy(lamp, rays=nodes.LIGHTING)
        values = Values(copy.node_tree, self.baker.probe)
        warn = lambda text: self.report.warn(f"light '{lamp.name}': {text}")
        total, found = np.zeros(3), None
        output = copy.node_tree.get_output_node("CYCLES")
        for node, weight in self._emissions(output and nodes.source(output.inputs[0]), 1.0, values, warn):
            color, strength = values.of(node.inputs["Color"]), values.of(node.inputs["Strength"])
            for part in (color, strength):
                if not is_constant(part) and found is None:
                    found = next((n for n in nodes.upstream(part) if n.type == "TEX_IES"), None)
            color, strength = (self._number(values, part, warn) for part in (color, strength))
            total = total + color * strength * weight
        profile = ies.profile(found, warn) if found else None
        bpy.data.lights.remove(copy)
        return base * total, profile

    def _emissions(self, origin, weight, values, warn):
        """The Emission nodes that an output mixes, with their weights."""
        if origin is None:
            return
        node = origin.node
        if node.type == "EMISSION":
            yield node, weight
        elif node.type in {"MIX_SHADER", "ADD_SHADER"}:
            shares, pair = (1.0, 1.0), node.inputs[:2]
            if node.type == "MIX_SHADER":
                factor = float(np.mean(self._number(values, values.of(node.inputs[0]), warn)))
                shares, pair = (1 - factor, factor), node.inputs[1:3]
            for share, socket in zip(shares, pair):
                if share > 0:
                    yield from self._emissions(nodes.source(socket), weight * share, values, warn)
        else:
            warn(f"its node '{node.name}' ({node.bl_label}) is left out: lamps need Emission")

    def _number(self, values, value, warn):
        """A constant, with photometric files as 1; textures on lamps become 1 with a warning."""
        if is_constant(value):
            return value
        node = value.node
        if node.type == "TEX_IES":
            return np.ones(3)
        if node.type == "LIGHT_FALLOFF":
            if value.name != "Quadratic":
                warn(f"its {value.name.lower()} falloff becomes quadratic")
            return self._number(values, values.of(node.inputs["Strength"]), warn)
        if node.type in {"MATH", "VECT_MATH"} and node.operation in {"MULTIPLY", "DIVIDE"}:
            a, b = (self._number(values, values.of(socket), warn) for socket in node.inputs[:2])
            return a * b if node.operation == "MULTIPLY" else a / np.where(b == 0, 1, b)
        if node.type in {"MIX", "MIX_RGB"} and node.blend_type == "MULTIPLY":
            pair = node.inputs[6:8] if node.type == "MIX" else node.inputs[1:3]
            a, b = (self._number(values, values.of(socket), warn) for socket in pair)
            return a * b
        warn(f"its node '{node.name}' ({node.bl_label}) varies with direction and is left out")
        return np.ones(3)

    def add(self, item):
        """Makes the exported object of a lamp, without its place; None if it gives no light."""
        obj, lamp = item.source, item.source.data
        warn = lambda text: self.report.warn(f"light '{obj.name}': {text}")
        if lamp.type == "AREA" and lamp.cycles.is_portal:
            return None
        power, profile = self.strength(lamp)
        path = self.powers.get(lamp)
        if path:
            power = np.max(list(path.values()), axis=0)
        if not np.any(power > 0):
            return None
        if not (lamp.cycles.cast_shadow if hasattr(lamp.cycles, "cast_shadow") else lamp.use_shadow):
            warn("casts no shadow in Cycles, but does in Patchlight")
        unseen = [ray for ray in RAYS if not getattr(obj, f"visible_{ray}")]
        if unseen:
            warn(f"is invisible to {', '.join(unseen)} rays in Cycles, but lights all surfaces in Patchlight")
        made = self._area(item, power, warn) if lamp.type == "AREA" else self._punctual(obj, power, profile)
        group = self.group(obj, item.instancer)
        if is_animated(lamp):
            if group:
                warn(f"has a light group of its own instead of '{group}', since it is animated")
            group = lamp.name
        if path:
            self.settings[group] = {frame: one / np.where(power > 0, power, 1) for frame, one in path.items()}
        made["light_group"] = group or obj.name
        if not obj.visible_camera:
            made["visible_camera"] = False
        return made

    def _punctual(self, obj, power, profile):
        lamp = obj.data
        data = bpy.data.lights.new("patchlight lamp", lamp.type)
        made = bpy.data.objects.new("patchlight lamp", data)
        peak = float(power.max())
        data.energy, data.color = peak, np.clip(power, 0, None) / peak
        if lamp.type == "SUN":
            made["angle"] = math.degrees(lamp.angle)
        else:
            made["radius"] = lamp.shadow_soft_size
        if lamp.type == "SPOT":
            outer = math.cos(lamp.spot_size / 2)
            inner, factor = fitted_cone(outer, lamp.spot_blend)
            _shape(data, outer, inner)
            data.energy = peak * factor
            made["spot_blend"], made["axis_intensity"] = lamp.spot_blend, peak / (4 * math.pi)
        if profile and lamp.type == "SUN":
            self.report.warn(f"light '{obj.name}': the photometric file of a sun is left out")
        elif profile:
            if lamp.type == "SPOT":
                self.report.warn(f"light '{obj.name}': its photometric file replaces the cone of the spot")
            made["ies"] = self._file(profile, peak)
        return made

    def _file(self, profile, power):
        """The name of the photometric file of a lamp of that power, which lamps alike share."""
        data = profile.text(power).encode("ascii")
        stem = re.sub(r"[^A-Za-z0-9._-]", "_", f"{self.name}_{profile.name}")
        names = (f"{stem}{suffix}.ies" for suffix in itertools.chain([""], (f"_{k}" for k in itertools.count(2))))
        name = next(name for name in names if self.files.get(name, data) == data)
        self.files[name] = data
        return name

    def _area(self, item, power, warn):
        """A black mesh that emits on the side that the lamp shines to: radiance P / (4 A), as Cycles has it."""
        lamp = item.source.data
        if abs(lamp.spread - math.pi) > 1e-3:
            warn(f"its spread of {math.degrees(lamp.spread):.0f} degrees becomes 180")
        width = lamp.size
        height = lamp.size_y if lamp.shape in {"RECTANGLE", "ELLIPSE"} else lamp.size
        if lamp.shape in {"SQUARE", "RECTANGLE"}:
            outline = [(-0.5, -0.5), (-0.5, 0.5), (0.5, 0.5), (0.5, -0.5)]
        else:  # a polygon of the ellipse's area
            turn = 2 * math.pi / DISK_SIDES
            radius = 0.5 * math.sqrt(turn / math.sin(turn))
            outline = [(radius * math.cos(k * turn), -radius * math.sin(k * turn)) for k in range(DISK_SIDES)]
        axes = [item.matrix.to_3x3().col[k] * size for k, size in enumerate((width, height))]
        area = axes[0].cross(axes[1]).length * (1 if len(outline) == 4 else math.pi / 4)
        mesh = bpy.data.meshes.new("patchlight lamp")
        mesh.from_pydata([(x * width, y * height, 0) for x, y in outline], [], [range(len(outline))])
        shader = Shader(item.source.name, False)
        shader.color("Base Color", (0, 0, 0))
        radiance = np.clip(power, 0, None) / (4 * area)
        shader.color("Emission", radiance / radiance.max())
        shader.number("Emission Strength", radiance.max())
        mesh.materials.append(shader.material)
        mesh["patchlight_name"] = item.source.name
        made = bpy.data.objects.new("patchlight lamp", mesh)
        made["intangible"] = True
        return made


def _shape(data, outer, inner):
    """Gives a spot the cosines of its outer and inner angle."""
    data.spot_size = 2 * math.acos(outer)
    data.spot_blend = 1 - math.acos(inner) / math.acos(outer)


def fitted_cone(outer, blend, steps=2000):
    """(Cosine of the inner angle, factor) of the glTF spot that is nearest to Cycles' spot of the same outer cosine.

    Cycles: cos t * smoothstep((cos t - outer) / ((1 - outer) * blend)). glTF: the square of a clamped line in cos t.
    The factor keeps the flux.
    """
    cosine = outer + (1 - outer) * (np.arange(steps) + 0.5) / steps
    step = np.clip((cosine - outer) / max((1 - outer) * blend, 1e-9), 0, 1)
    wanted = cosine * step * step * (3 - 2 * step)
    best = (math.inf, 1.0, 1.0)
    for inner in np.linspace(outer + (1 - outer) * 0.002, 1, 200):
        shape = np.clip((cosine - outer) / (inner - outer), 0, 1) ** 2
        factor = wanted.sum() / shape.sum()
        best = min(best, (float(((wanted - factor * shape) ** 2).sum()), float(inner), float(factor)))
    return best[1], best[2]
