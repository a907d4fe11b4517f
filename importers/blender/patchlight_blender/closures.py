"""Reduces the shader nodes of a material to one surface of the kind that glTF knows."""
import dataclasses

import numpy as np

from . import nodes
from .values import is_constant

DIFFUSE = {"BSDF_DIFFUSE", "BSDF_VELVET", "BSDF_TOON", "SUBSURFACE_SCATTERING", "BSDF_TRANSLUCENT", "BSDF_HAIR",
           "BSDF_HAIR_PRINCIPLED"}
GLOSSY = {"BSDF_GLOSSY", "BSDF_ANISOTROPIC"}
GLASS = {"BSDF_GLASS", "BSDF_REFRACTION"}
UNLIKE = {"BSDF_VELVET": "Velvet", "BSDF_TOON": "Toon", "SUBSURFACE_SCATTERING": "Subsurface Scattering",
          "BSDF_HAIR": "Hair", "BSDF_HAIR_PRINCIPLED": "Principled Hair"}
"""Diffuse-like shaders that are only approximated."""


def scalar(x):
    return np.full(3, float(x))


@dataclasses.dataclass
class Surface:
    """Values as `Values` has them. `kind` is 'surface', 'transparent' (nothing to see) or 'holdout'."""
    kind: str = "surface"
    base: object = dataclasses.field(default_factory=lambda: np.zeros(3))
    metallic: object = dataclasses.field(default_factory=lambda: np.zeros(3))
    roughness: object = dataclasses.field(default_factory=lambda: np.ones(3))
    specular: object = dataclasses.field(default_factory=lambda: np.zeros(3))
    specular_tint: float = 0.0
    transmission: object = dataclasses.field(default_factory=lambda: np.zeros(3))
    emission: object = dataclasses.field(default_factory=lambda: np.zeros(3))
    alpha: object = dataclasses.field(default_factory=lambda: np.ones(3))
    ior: float = 1.5
    clearcoat: tuple = (0.0, 0.03)
    normal: object = None


class Reducer:
    """`mean(value)` gives a number for a value that varies; `warn(text)` prints a warning about the material."""

    def __init__(self, values, mean, warn):
        self.values, self.mean, self.warn = values, mean, warn

    def surface(self, output):
        """The surface of a Material Output node, or of None."""
        if output is None:
            return Surface()
        if nodes.source(output.inputs["Volume"]):
            self.warn("its volume is left out")
            if not nodes.source(output.inputs["Surface"]):
                return Surface(kind="transparent")
        if nodes.source(output.inputs["Displacement"]):
            self.warn("its displacement is left out: apply a Displace modifier instead")
        return self.reduce(nodes.source(output.inputs["Surface"]))

    def reduce(self, origin):
        if origin is None:
            return Surface()
        node = origin.node
        kind, get = node.type, lambda name: self.values.of(nodes.entry(node, name))
        if kind == "BSDF_PRINCIPLED":
            return self._principled(node, get)
        if kind in DIFFUSE:
            if kind in UNLIKE:
                self.warn(f"its {UNLIKE[kind]} shader '{node.name}' becomes diffuse")
            if kind == "BSDF_TRANSLUCENT":
                self.warn(f"the light that passes its Translucent shader '{node.name}' is reflected instead")
            return Surface(base=get("Color"), normal=_normal(node))
        if kind in GLOSSY:
            roughness = scalar(0) if node.distribution == "SHARP" else get("Roughness")
            return Surface(base=get("Color"), metallic=scalar(1), roughness=roughness, normal=_normal(node))
        if kind in GLASS:
            roughness = scalar(0) if node.distribution == "SHARP" else get("Roughness")
            return Surface(base=get("Color"), roughness=roughness, transmission=scalar(1), specular=scalar(0.5),
                           ior=self._number(get("IOR")), normal=_normal(node))
        if kind == "BSDF_TRANSPARENT":
            color = get("Color")
            if not is_constant(color) or color.min() < 0.99:
                self.warn(f"the colour of its Transparent shader '{node.name}' is left out")
            return Surface(kind="transparent", alpha=np.zeros(3))
        if kind == "EMISSION":
            return Surface(emission=self.values.multiply(get("Color"), get("Strength")))
        if kind == "BACKGROUND":
            return Surface(emission=self.values.multiply(get("Color"), get("Strength")))
        if kind == "HOLDOUT":
            return Surface(kind="holdout")
        if kind == "MIX_SHADER":
            return self._mix(node)
        if kind == "ADD_SHADER":
            a, b = (self.reduce(nodes.source(socket)) for socket in node.inputs[:2])
            for one, other in ((a, b), (b, a)):
                if one.kind == "transparent":
                    self.warn(f"its Add Shader '{node.name}' adds Transparent: the surface becomes opaque")
                    return other
            return self._sum(a, b, np.ones(3), np.ones(3))
        self.warn(f"its node '{node.name}' ({node.bl_label}) has no counterpart: it becomes black")
        return Surface()

    def _principled(self, node, get):
        base = get("Base Color")
        subsurface = get("Subsurface")
        if not is_constant(subsurface) or np.any(subsurface):
            self.warn(f"the subsurface scattering of its node '{node.name}' becomes diffuse")
            if nodes.entry(node, "Subsurface Color"):
                base = self.values.mix(base, get("Subsurface Color"), subsurface)
        for name in ("Sheen", "Anisotropic"):
            if not is_constant(get(name)) or np.any(get(name)):
                self.warn(f"{name} of its node '{node.name}' is left out")
        return Surface(
            base=base, metallic=get("Metallic"), roughness=get("Roughness"), specular=get("Specular"),
            specular_tint=self._number(get("Specular Tint")) if node.inputs["Specular Tint"].type == "VALUE" else 0.0,
            transmission=get("Transmission"), ior=self._number(get("IOR")), alpha=get("Alpha"), normal=_normal(node),
            emission=self.values.multiply(get("Emission"), get("Emission Strength")),
            clearcoat=(self._number(get("Clearcoat")), self._number(get("Clearcoat Roughness"))))

    def _number(self, value):
        return float(self.mean(value)[0])

    def _mix(self, node):
        values = self.values
        origin = nodes.source(node.inputs[0])
        factor = values.of(node.inputs[0])
        if is_constant(factor):
            factor = np.clip(factor, 0, 1)
            if not np.any(factor) or np.all(factor == 1):
                return self.reduce(nodes.source(node.inputs[2 if np.any(factor) else 1]))
        a, b = (self.reduce(nodes.source(socket)) for socket in node.inputs[1:3])
        if "holdout" in (a.kind, b.kind):
            self.warn(f"its Mix Shader '{node.name}' mixes a holdout, which is left out")
            return b if a.kind == "holdout" else a
        if a.kind == b.kind == "transparent":
            return a
        if a.kind == "transparent":
            return dataclasses.replace(b, alpha=values.multiply(b.alpha, factor))
        if b.kind == "transparent":
            return dataclasses.replace(a, alpha=values.multiply(a.alpha, values.complement(factor)))
        eta = origin.node.get("eta") if origin else None
        if eta and is_constant(b.metallic) and np.all(b.metallic == 1):
            level = ((eta - 1) / (eta + 1)) ** 2 / 0.08
            return dataclasses.replace(a, specular=self.mean(b.base) * level, roughness=b.roughness)
        return self._sum(a, b, values.complement(factor), factor)

    def _sum(self, a, b, weight_a, weight_b):
        """The surface with both kinds of reflection; numbers that weigh them are means."""
        values = self.values
        base = values.add(values.multiply(a.base, weight_a), values.multiply(b.base, weight_b))
        parts = []
        for surface, weight in ((a, weight_a), (b, weight_b)):
            amount = float(np.mean(self.mean(surface.base) * self.mean(weight)))
            parts.append((amount, self.mean(surface.metallic)[0], surface))
        total = sum(p[0] for p in parts) or 1.0

        def weighted(name, amounts):
            whole = sum(amounts)
            if whole <= 0:
                return getattr(a, name)
            if amounts[1] <= 0 or amounts[0] <= 0:
                return getattr(a if amounts[1] <= 0 else b, name)
            return sum(x * self.mean(getattr(s, name)) for x, s in zip(amounts, (a, b))) / whole

        amounts = [p[0] for p in parts]
        shine = [p[0] * p[1] for p in parts]
        share = [float(np.mean(self.mean(w))) for w in (weight_a, weight_b)]
        metallic = weighted("metallic", amounts) if total > 0 else scalar(0)
        return Surface(
            base=base, metallic=metallic, roughness=weighted("roughness", shine if sum(shine) else amounts),
            specular=weighted("specular", amounts), transmission=weighted("transmission", amounts),
            emission=values.add(values.multiply(a.emission, weight_a), values.multiply(b.emission, weight_b)),
            alpha=values.mix(a.alpha, b.alpha, scalar(min(share[1], 1.0))), ior=max(parts, key=lambda p: p[0])[2].ior,
            clearcoat=a.clearcoat if amounts[0] >= amounts[1] else b.clearcoat, normal=a.normal or b.normal)


def _normal(node):
    return nodes.source(node.inputs["Normal"]) if "Normal" in node.inputs else None
