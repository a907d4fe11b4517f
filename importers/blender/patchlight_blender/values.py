"""Colours and numbers of a node tree that are constant, or the output of a node, and sums and products of them."""
import numpy as np

from . import nodes

PURE = {"RGB", "VALUE", "MATH", "VECT_MATH", "MIX", "MIX_RGB", "BLACKBODY", "WAVELENGTH", "VALTORGB", "CURVE_RGB",
        "CURVE_VEC", "CURVE_FLOAT", "GAMMA", "HUE_SAT", "BRIGHTCONTRAST", "INVERT", "MAP_RANGE", "CLAMP", "SEPRGB",
        "COMBRGB", "SEPXYZ", "COMBXYZ", "SEPHSV", "COMBHSV", "SEPARATE_COLOR", "COMBINE_COLOR", "RGBTOBW", "MAPPING",
        "NORMAL", "VECTOR_ROTATE"}
"""Types of nodes whose outputs depend on their inputs alone."""

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


class Values:
    """Arithmetic on one flat node tree. A value is an array of three numbers, or the output socket of a node."""

    def __init__(self, tree, probe):
        """`probe(socket)` gives the value of an output that depends on constants only."""
        self.tree, self.probe, self.known = tree, probe, {}

    def of(self, socket):
        """The value of an input socket. Numbers come as three equal ones."""
        origin, last = nodes.trace(socket)
        if origin is None:
            value = last.default_value
            if not hasattr(value, "__len__"):
                value = [value] * 3
            return np.array([float(v) for v in value[:3]])
        value = self.folded(origin)
        if is_constant(value) and socket.type in {"VALUE", "INT"} and origin.type == "RGBA":
            return np.full(3, value @ LUMINANCE)
        return value

    def folded(self, origin):
        """The constant that an output has, or the output itself."""
        if origin.node.type in {"RGB", "VALUE"}:
            value = origin.default_value if hasattr(origin.default_value, "__len__") else [origin.default_value] * 3
            return np.array([float(v) for v in value[:3]])
        if any(node.type not in PURE for node in nodes.upstream(origin)):
            return origin
        key = (origin.node.name, origin.identifier)
        if key not in self.known:
            self.known[key] = self.probe(origin)
        return self.known[key]

    def combine(self, operation, a, b):
        """`a` and `b` under an operation of the node Vector Math."""
        node = self.tree.nodes.new("ShaderNodeVectorMath")
        node.operation = operation
        for socket, value in zip(node.inputs, (a, b)):
            if is_constant(value):
                socket.default_value = value
            else:
                self.tree.links.new(value, socket)
        return node.outputs["Vector"]

    def multiply(self, a, b):
        if is_constant(a) and is_constant(b):
            return a * b
        for one, other in ((a, b), (b, a)):
            if is_constant(one) and np.allclose(one, 1):
                return other
            if is_constant(one) and not np.any(one):
                return np.zeros(3)
        return self.combine("MULTIPLY", a, b)

    def add(self, a, b):
        if is_constant(a) and is_constant(b):
            return a + b
        for one, other in ((a, b), (b, a)):
            if is_constant(one) and not np.any(one):
                return other
        return self.combine("ADD", a, b)

    def complement(self, a):
        """1 - a."""
        return 1 - a if is_constant(a) else self.combine("SUBTRACT", np.ones(3), a)

    def mix(self, a, b, factor):
        if is_constant(a) and is_constant(b) and np.allclose(a, b):
            return a
        return self.add(self.multiply(a, self.complement(factor)), self.multiply(b, factor))


def is_constant(value):
    return isinstance(value, np.ndarray)


def luminance(value):
    return float(value @ LUMINANCE)
