"""Reduces the shader nodes of a material to one surface of the kind that glTF knows."""
import dataclasses

import numpy as np

from . import nodes
from .values import is_constant

DIFFUSE = {"BSDF_DIFFUSE", "BSDF_VELVET", "BSDF_TOON", "SUBSURFACE_SCATTERING", "BSDF_HAIR",
           "BSDF_HAIR_PRINCIPLED"}
GLOSSY = {"BSDF_GLOSSY", "BSDF_ANISOTROPIC"}
GLASS = {"BSDF_GLASS", "BSDF_REFRACTION"}
UNLIKE = {"BSDF_VELVET": "Velvet", "BSDF_TOON": "Toon", "SUBSURFACE_SCATTERING": "Subsurface Scattering",
          "BSDF_HAIR": "Hair", "BSDF_HAIR_PRINCIPLED": "Principled Hair"}
"""Diffuse-like shaders that are only approximated."""
TINT_LUMINANCE = np.array([0.3, 0.6, 0.1])
"""Weights of a colour by which Specular Tint divides it."""


def scalar(x):
    return np.full(3, float(x))


def dielectric(ior):
    """Reflectance of a dielectric at normal incidence."""
    return scalar(((ior - 1) / (ior + 1)) ** 2)


@dataclasses.dataclass
class Surface:
    """Values as `Values` has them. `kind` is 'surface', 'transparent' (nothing to see) or 'holdout'.

    `specular` is the weight of the dielectric reflection, 0 for a surface that has none, and `f0` its reflectance at
    normal incidence. `translucence` is the colour of the light that leaves the other side diffusely, as `base` is that
    of what is reflected. `absorption` is that of the volume inside, 1/m.
    """
    kind: str = "surface"
    base: object = dataclasses.field(default_factory=lambda: np.zeros(3))
    metallic: object = dataclasses.field(default_factory=lambda: np.zeros(3))
    roughness: object = dataclasses.field(default_factory=lambda: np.ones(3))
    specular: float = 0.0
    f0: np.ndarray = dataclasses.field(default_factory=lambda: np.zeros(3))
    transmission: object = dataclasses.field(default_factory=lambda: np.zeros(3))
    translucence: object = dataclasses.field(default_factory=lambda: np.zeros(3))
    emission: object = dataclasses.field(default_factory=lambda: np.zeros(3))
    alpha: object = dataclasses.field(default_factory=lambda: np.ones(3))
    ior: float = 1.5
    clearcoat: tuple = (0.0, 0.03)
    normal: object = None
    absorption: np.ndarray = None


class Reducer:
    """`mean(value)` gives a number for a value that varies; `warn(text)` prints a warning about the material."""

    def __init__(self, values, mean, warn):
        self.values, self.mean, self.warn = values, mean, warn

    def surface(self, output):
        """The surface of a Material Output node, or of None."""
        if output is None:
            return Surface()
        if nodes.source(output.inputs["Displacement"]):
            self.warn("its displacement is left out: apply a Displace modifier instead")
        inside, outside = (nodes.source(output.inputs[name]) for name in ("Volume", "Surface"))
        surface = Surface(kind="transparent") if inside and not outside else self.reduce(outside)
        if inside:
            clear = not is_constant(surface.transmission) or np.any(surface.transmission)
            surface.absorption = self._absorption(inside.node) if clear else None
            if surface.absorption is None:
                self.warn("its volume is left out")
        return surface

    def _absorption(self, node):
        """The absorption of a volume that does nothing else and is the same everywhere, else None."""
        if node.type != "VOLUME_ABSORPTION":
            return None
        color, density = (self.values.of(node.inputs[name]) for name in ("Color", "Density"))
        return np.clip(1 - color, 0, None) * density if is_constant(color) and is_constant(density) else None

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
            return Surface(base=get("Color"), normal=_normal(node))
        if kind == "BSDF_TRANSLUCENT":
            return Surface(translucence=get("Color"), normal=_normal(node))
        if kind in GLOSSY:
            roughness = scalar(0) if node.distribution == "SHARP" else get("Roughness")
            return Surface(base=get("Color"), metallic=scalar(1), roughness=roughness, normal=_normal(node))
        if kind in GLASS:
            roughness = scalar(0) if node.distribution == "SHARP" else get("Roughness")
            ior = self._number(get("IOR"), "IOR")
            return Surface(base=get("Color"), roughness=roughness, transmission=scalar(1), ior=ior, f0=dielectric(ior),
                           specular=0.0 if kind == "BSDF_REFRACTION" else 1.0, normal=_normal(node))
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
        for name in ("Sheen", "Anisotropic", "Transmission Roughness", "Clearcoat Normal"):
            if nodes.entry(node, name) and (not is_constant(get(name)) or np.any(get(name))):
                self.warn(f"{name} of its node '{node.name}' is left out")
        ior, transmission = self._number(get("IOR"), "IOR"), get("Transmission")
        specular, f0 = self._specular(node, get, base, ior, float(self.mean(transmission)[0]))
        coat = self._number(get("Clearcoat"), "clearcoat") * nodes.coat_factor(node)
        return Surface(
            base=base, metallic=get("Metallic"), roughness=get("Roughness"), specular=specular, f0=f0,
            transmission=transmission, ior=ior, alpha=get("Alpha"), normal=_normal(node),
            emission=self.values.multiply(get("Emission"), get("Emission Strength")),
            clearcoat=(coat, self._number(get("Clearcoat Roughness"), "clearcoat roughness") if coat else 0.03))

    def _specular(self, node, get, base, ior, clear):
        """(Weight, reflectance at normal incidence) of the dielectric reflection of a Principled BSDF, of which the
        part `clear` is glass."""
        level = self._number(get("Specular"), "specular")
        opaque = (1 - clear) * (level > 0)
        if not opaque + clear:
            return 0.0, np.zeros(3)
        if node.inputs["Specular Tint"].type == "VALUE":
            tint = self._number(get("Specular Tint"), "specular tint")
            if tint and not is_constant(base):
                self.warn("the tint of its specular reflection is that of its mean base colour")
            color = self.mean(base) if tint else np.ones(3)
            f0 = 0.08 * level * (1 - tint + tint * color / max(color @ TINT_LUMINANCE, 1e-6))
        else:  # since Blender 4.0
            f0 = 2 * level * dielectric(ior) * self.mean(get("Specular Tint"))
        return opaque + clear, np.clip((opaque * f0 + clear * dielectric(ior)) / (opaque + clear), 0, 1)

    def _number(self, value, name):
        """A value as one number. Names those that vary."""
        number = float(self.mean(value)[0])
        if not is_constant(value):
            self.warn(f"its {name} varies: the mean {number:.2g} is taken")
        return number

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
            color = self.mean(b.base)
            weight = min(float(color.max()), 1.0)
            return dataclasses.replace(a, specular=weight, f0=dielectric(eta) * color / max(weight, 1e-6),
                                       roughness=b.roughness)
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
        coats = [part * (1 - p[1]) * p[2].specular for part, p in zip(share, parts)]
        coat = sum(coats) / max(1 - self.mean(metallic)[0], 1e-6)
        return Surface(
            base=base, metallic=metallic, roughness=weighted("roughness", shine if sum(shine) else amounts),
            specular=min(float(coat), 1.0), f0=sum(c * p[2].f0 for c, p in zip(coats, parts)) / (sum(coats) or 1.0),
            transmission=weighted("transmission", amounts),
            translucence=values.add(values.multiply(a.translucence, weight_a),
                                    values.multiply(b.translucence, weight_b)),
            emission=values.add(values.multiply(a.emission, weight_a), values.multiply(b.emission, weight_b)),
            alpha=values.mix(a.alpha, b.alpha, scalar(min(share[1], 1.0))), ior=max(parts, key=lambda p: p[0])[2].ior,
            clearcoat=a.clearcoat if amounts[0] >= amounts[1] else b.clearcoat, normal=a.normal or b.normal)


def _normal(node):
    return nodes.source(node.inputs["Normal"]) if "Normal" in node.inputs else None
