"""Bakes outputs of node trees to images with Cycles."""
import bmesh
import bpy
import numpy as np

from . import nodes
from .meshes import array

UV_NAME = "patchlight"


class Baker:
    """A scene of its own in which one object at a time is baked."""

    def __init__(self, frame, resolution, threads=0):
        self.resolution, self.count = resolution, 0
        self.scene = bpy.data.scenes.new("patchlight bake")
        self.scene.render.engine, self.scene.frame_current = "CYCLES", frame
        cycles = self.scene.cycles
        cycles.samples, cycles.use_adaptive_sampling, cycles.use_denoising = 4, False, False
        if threads:
            self.scene.render.threads_mode, self.scene.render.threads = "FIXED", threads
        self.plane = bpy.data.meshes.new("patchlight plane")
        self.plane.from_pydata([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [], [(0, 1, 2, 3)])
        self.plane.uv_layers.new(name=UV_NAME).data.foreach_set("uv", [0, 0, 1, 0, 1, 1, 0, 1])

    def probe(self, socket):
        """The colour of an output that depends on constants only."""
        material = self._material_of(socket)
        image = self._bake(self.plane, None, material, UV_NAME, 4, True)
        value = self._read(image)[1:3, 1:3, :3].mean(axis=(0, 1))
        bpy.data.images.remove(image)
        bpy.data.materials.remove(material)
        return value.astype(np.float64)

    def colors(self, mesh, index, matrix, material, socket, size=None):
        """An output over the faces of a mesh that have the material slot `index`, in the UV map `UV_NAME`.

        Returns linear values, rows from below; the fourth is 1 where a face is, and in a margin around it.
        `material` owns `socket` and loses its own output.
        """
        tree = material.node_tree
        emission = tree.nodes.new("ShaderNodeEmission")
        tree.links.new(socket, emission.inputs["Color"])
        for output in [node for node in tree.nodes if node.type == "OUTPUT_MATERIAL"]:
            tree.nodes.remove(output)
        tree.links.new(emission.outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
        if all(layer.name == UV_NAME for layer in mesh.uv_layers):
            _read_no_uv(tree)
        part = mesh.copy()
        work = bmesh.new()
        work.from_mesh(part)
        last = max(len(mesh.materials) - 1, 0)
        bmesh.ops.delete(work, geom=[f for f in work.faces if min(f.material_index, last) != index], context="FACES")
        for face in work.faces:
            face.material_index = 0
        work.to_mesh(part)
        work.free()
        image = self._bake(part, matrix, material, UV_NAME, size or self.resolution, True)
        values = self._read(image)
        bpy.data.images.remove(image)
        bpy.data.meshes.remove(part)
        return values

    def _material_of(self, socket):
        """A material that emits a copy of an output, of any kind of node tree."""
        material = bpy.data.materials.new("patchlight probe")
        material.use_nodes = True
        tree = material.node_tree
        tree.nodes.clear()
        found = nodes.upstream(socket)
        copies = {node.name: nodes.copy_node(tree, node) for node in found}
        for node in found:
            for index, target in enumerate(node.inputs):
                origin = nodes.source(target)
                if origin:
                    outputs = copies[origin.node.name].outputs
                    tree.links.new(outputs[list(origin.node.outputs).index(origin)], copies[node.name].inputs[index])
        emission = tree.nodes.new("ShaderNodeEmission")
        tree.links.new(copies[socket.node.name].outputs[list(socket.node.outputs).index(socket)], emission.inputs[0])
        tree.links.new(emission.outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
        return material

    def _bake(self, mesh, matrix, material, uv_name, size, is_float):
        self.count += 1
        tree = material.node_tree
        image = bpy.data.images.new("patchlight bake", size, size, alpha=True, float_buffer=is_float)
        target = tree.nodes.new("ShaderNodeTexImage")
        target.image = image
        for node in tree.nodes:
            node.select = node == target
        tree.nodes.active = target
        kept = list(mesh.materials)
        mesh.materials.clear()
        mesh.materials.append(material)
        obj = bpy.data.objects.new("patchlight bake", mesh)
        if matrix:
            obj.matrix_world = matrix
        self._activate(obj)
        try:
            bpy.ops.object.bake(type="EMIT", margin=max(size // 64, 1), use_clear=True, uv_layer=uv_name)
        finally:
            bpy.data.objects.remove(obj)
            tree.nodes.remove(target)
            mesh.materials.clear()
            for item in kept:
                mesh.materials.append(item)
        return image

    def _activate(self, obj):
        bpy.context.window.scene = self.scene
        self.scene.collection.objects.link(obj)
        for other in self.scene.objects:
            other.select_set(other == obj)
        bpy.context.view_layer.objects.active = obj

    @staticmethod
    def _read(image):
        values = np.empty(len(image.pixels), np.float32)
        image.pixels.foreach_get(values)
        return values.reshape(image.size[1], image.size[0], 4)

    def unwrap(self, mesh):
        """Gives a mesh the UV map `UV_NAME`: a copy of its render UV map, or a projection if faces overlap in that.

        Whether there was room for it.
        """
        if UV_NAME in mesh.uv_layers:
            return True
        if len(mesh.uv_layers) >= 8:
            return False
        used = next((layer for layer in mesh.uv_layers if layer.active_render), None)
        if used and _is_unique(mesh, array(used.data, "uv", 2)):
            values = array(used.data, "uv", 2)
            mesh.uv_layers.new(name=UV_NAME, do_init=False).data.foreach_set("uv", values.ravel())
            return True
        layer = mesh.uv_layers.new(name=UV_NAME, do_init=False)
        kept = next((i for i, l in enumerate(mesh.uv_layers) if l.active_render), 0)
        mesh.uv_layers.active = layer
        obj = bpy.data.objects.new("patchlight unwrap", mesh)
        self._activate(obj)
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.reveal()
        bpy.ops.mesh.select_all(action="SELECT")
        bpy.ops.uv.smart_project(angle_limit=1.15, island_margin=0.01)
        bpy.ops.object.mode_set(mode="OBJECT")
        bpy.data.objects.remove(obj)
        mesh.uv_layers[kept].active_render = True
        return True

def _read_no_uv(tree):
    """Lets nodes that read the render UV map read zero, as Cycles does where a mesh has none."""
    zero = tree.nodes.new("ShaderNodeCombineXYZ").outputs[0]
    for node in list(tree.nodes):
        if node.type == "TEX_IMAGE" and not node.inputs["Vector"].is_linked:
            tree.links.new(zero, node.inputs["Vector"])
        elif node.type == "TEX_COORD":
            for link in list(node.outputs["UV"].links):
                tree.links.new(zero, link.to_socket)


def _is_unique(mesh, uv, cells=256):
    """Whether the triangles lie in the unit square and hardly overlap there, by their area and the cells they cover."""
    mesh.calc_loop_triangles()
    triangles = uv[array(mesh.loop_triangles, "loops", 3, np.int32)].astype(np.float64)
    if triangles.min() < -1e-4 or triangles.max() > 1 + 1e-4:
        return False
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    area = np.abs(np.cross(b - a, c - a)) / 2
    total = area.sum()
    if total < 1e-4 or total > 1.0001 or area.min() < 1e-12:
        return False
    pick = np.random.default_rng(1)
    chosen = pick.choice(len(area), 8 * cells * cells, p=area / total)
    s, t = pick.random(len(chosen)), pick.random(len(chosen))
    s, t = np.where(s + t > 1, 1 - s, s), np.where(s + t > 1, 1 - t, t)
    points = a[chosen] + s[:, None] * (b - a)[chosen] + t[:, None] * (c - a)[chosen]
    index = np.clip((points * cells).astype(int), 0, cells - 1)
    covered = len(np.unique(index[:, 0] * cells + index[:, 1])) / cells ** 2
    return total < 1.05 * covered
