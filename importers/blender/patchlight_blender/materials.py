"""Exported materials: what each material of the scene becomes on a mesh."""
import bpy
import numpy as np

from . import closures, nodes, textures
from .bake import UV_NAME, Baker
from .closures import Surface
from .meshes import thickness
from .values import Values, is_constant
from .writer import Writer

GREY = 0.8
"""Reflectance that Cycles gives to objects without a material."""


VARYING = {"OBJECT_INFO": "the object", "PARTICLE_INFO": "the particle", "HAIR_INFO": "the hair",
           "CAMERA": "the view", "TANGENT": "the tangent"}
"""What the values of some types of nodes depend on beyond the place on the surface."""


class Reduced:
    """A material of the scene as a `Surface`, with the flat copy of its nodes that the values belong to."""

    def __init__(self, original, user, baker, report):
        self.original, self.baker, self.report = original, baker, report
        self.name = original.name if original else "default"
        self.one_sided = self.see_through = False
        self.copy, self.values = None, None
        if original is None or not original.use_nodes or not original.node_tree:
            color = np.array(original.diffuse_color[:3]) if original else np.full(3, GREY)
            self.surface = Surface(base=color)
            return
        uses = {node.type for node in nodes.all_nodes(original.node_tree)}
        self.copy, self.values, self.surface = self._reduce(user, True)
        varying = uses & set(VARYING)
        if varying:
            self.warn(f"it varies with {' and '.join(sorted(VARYING[kind] for kind in varying))}: "
                      "one value is taken for all")
        if "LIGHT_PATH" in uses:
            lit = self._reduce(user, False, rays=nodes.LIGHTING)[2]
            shines = not is_constant(self.surface.emission) or np.any(self.surface.emission)
            self.see_through = lit.kind == "transparent" and not shines
            self.warn("Light Path is read as the camera sees it" +
                      (", but light passes the material" if lit.kind == "transparent" else ""))
        if "NEW_GEOMETRY" in uses:
            back = self._reduce(user, False, backfacing=1.0)[2]
            dark = is_constant(back.emission) and not np.any(back.emission)
            lit = not is_constant(self.surface.emission) or np.any(self.surface.emission)
            self.one_sided = back.kind == "transparent" and self.surface.kind != "transparent" or dark and bool(lit)

    def warn(self, text):
        self.report.warn(f"material '{self.name}': {text}")

    def _reduce(self, user, aloud, **settings):
        copy = nodes.flat_copy(self.original, **settings)
        values = Values(copy.node_tree, self.baker.probe)
        reducer = closures.Reducer(values, lambda value: self.mean(values, value, user, copy),
                                   self.warn if aloud else lambda text: None)
        return copy, values, reducer.surface(copy.node_tree.get_output_node("CYCLES"))

    def mean(self, values, value, user, copy):
        """The mean of a value: exact for constants, of the image's pixels, or of a small baked image."""
        if is_constant(value):
            return value
        found = textures.split(values, value, self.warn)
        if found and not found.colors:
            if not found.node:
                return found.factor
            data = textures.pixels(found.node.image)
            return found.factor * (np.full(3, data[..., 3].mean()) if found.channel == "A" else
                                   np.full(3, data[..., "RGB".index(found.channel)].mean()) if found.channel else
                                   data[..., :3].mean(axis=(0, 1)))
        mesh, index, matrix = user
        if not self.baker.unwrap(mesh):
            return np.full(3, 0.5)
        extra = copy.copy()
        socket = extra.node_tree.nodes[value.node.name].outputs[list(value.node.outputs).index(value)]
        data = self.baker.colors(mesh, index, matrix, extra, socket, 64)
        bpy.data.materials.remove(extra)
        return _covered_mean(data)


def _covered_mean(data):
    inside = data[..., 3] > 0.5
    return data[inside][:, :3].mean(axis=0).astype(np.float64) if inside.any() else np.full(3, 0.5)


class Materials:
    """Makes the exported materials. `excluded` collects the names of those that the job leaves out, and `shines` says
    whether one emits light."""

    def __init__(self, scene, report, resolution, threads):
        self.report, self.baker = report, Baker(scene.frame_current, resolution, threads)
        self.reduced, self.made, self.excluded, self.shines = {}, {}, {}, False

    def reduce(self, original, mesh, index, matrix):
        if original not in self.reduced:
            self.reduced[original] = Reduced(original, (mesh, index, matrix), self.baker, self.report)
        return self.reduced[original]

    def get(self, original, mesh, index, matrix, closed, one_sided):
        """The material to export for slot `index` of `mesh`; None if its surface is left out."""
        item = self.reduce(original, mesh, index, matrix)
        surface = item.surface
        if surface.kind == "holdout":
            item.warn("it is a holdout and is left out")
            return None
        if surface.kind == "transparent" or is_constant(surface.alpha) and not np.any(surface.alpha):
            return None
        opaque = is_constant(surface.alpha) and np.all(surface.alpha >= 1)
        two_sided = not (one_sided and opaque or item.one_sided)
        transmission = float(np.mean(item.mean(item.values, surface.transmission, (mesh, index, matrix), item.copy)))
        if item.see_through and transmission <= 0.5:
            self.excluded[item.name] = True
            item.warn("it lets shadow rays pass, but cameras see it: the job leaves it out, see 'materials' there")
        maps = tuple(layer.name for layer in mesh.uv_layers if layer.name != UV_NAME)
        solid = closed and transmission > 0
        shared, own = (original, two_sided, solid, maps), (original, two_sided, mesh, index)
        for key in (shared, own):
            if key in self.made:
                return self.made[key]
        self.shines |= not is_constant(surface.emission) or bool(np.any(surface.emission > 0))
        made = Writer(item, (mesh, index, matrix)).write(surface, two_sided, opaque, transmission,
                                                          thickness(mesh) if solid else 0)
        self.made[own if made.is_baked else shared] = made
        return made
