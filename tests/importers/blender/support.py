"""Scenes for the tests, exported files read back, and small renders by Cycles."""
import io
import json
import pathlib
import struct
import tempfile
import unittest

import bpy
import numpy as np

from patchlight_blender import command
from patchlight_blender.report import Report

COMPONENTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
TYPES = {5121: np.uint8, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}


class Exported:
    """The files of an export: `gltf` is the JSON, `job` the text of the YAML, `warnings` the lines of the report."""

    def __init__(self, folder, name, warnings):
        data = (folder / f"{name}.glb").read_bytes()
        size, = struct.unpack_from("<I", data, 12)
        self.gltf, self.binary = json.loads(data[20:20 + size]), data[20 + size + 8:]
        self.job = (folder / f"{name}.yaml").read_text()
        self.folder, self.warnings = folder, warnings

    def node(self, name):
        return next(node for node in self.gltf["nodes"] if node["name"] == name)

    def names(self):
        return sorted(node["name"] for node in self.gltf["nodes"])

    def mesh(self, name):
        return self.gltf["meshes"][self.node(name)["mesh"]]

    def material(self, name, primitive=0):
        """The material of a node's mesh."""
        return self.gltf["materials"][self.mesh(name)["primitives"][primitive]["material"]]

    def accessor(self, index):
        item = self.gltf["accessors"][index]
        view = self.gltf["bufferViews"][item["bufferView"]]
        start = view.get("byteOffset", 0) + item.get("byteOffset", 0)
        kind, width = TYPES[item["componentType"]], COMPONENTS[item["type"]]
        values = np.frombuffer(self.binary, kind, item["count"] * width, start)
        return values.reshape(-1, width)

    def positions(self, name, primitive=0):
        return self.accessor(self.mesh(name)["primitives"][primitive]["attributes"]["POSITION"])

    def triangles(self, name):
        return sum(self.gltf["accessors"][p["indices"]]["count"] // 3 for p in self.mesh(name)["primitives"])

    def light(self, name):
        index = self.node(name)["extensions"]["KHR_lights_punctual"]["light"]
        return self.gltf["extensions"]["KHR_lights_punctual"]["lights"][index]

    def camera(self, name):
        return self.gltf["cameras"][self.node(name)["camera"]]

    def image(self, material, texture="baseColorTexture"):
        """Pixels of a texture of a material, rows from below, sRGB."""
        holder = material if texture in material else material["pbrMetallicRoughness"]
        source = self.gltf["images"][self.gltf["textures"][holder[texture]["index"]]["source"]]
        view = self.gltf["bufferViews"][source["bufferView"]]
        path = self.folder / "image.png"
        path.write_bytes(self.binary[view["byteOffset"]:view["byteOffset"] + view["byteLength"]])
        return read_image(path)


def image(name, pixels, color_space="sRGB"):
    """An image of a few pixels, rows from below, as the file has them."""
    pixels = np.asarray(pixels, np.float32)
    made = bpy.data.images.new(name, pixels.shape[1], pixels.shape[0], alpha=True)
    made.colorspace_settings.name = color_space
    made.pixels.foreach_set(pixels.ravel())
    made.update()
    made.pack()
    return made


def read_image(path):
    image = bpy.data.images.load(str(path), check_existing=False)
    values = np.array(image.pixels[:], np.float32).reshape(image.size[1], image.size[0], image.channels)
    bpy.data.images.remove(image)
    return values


class ExportTest(unittest.TestCase):
    """Starts each test with an empty scene and a folder that is removed."""

    def setUp(self):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        self.scene = bpy.context.scene
        self.scene.render.engine = "CYCLES"
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = pathlib.Path(holder.name)

    def export(self, *options):
        report = Report(io.StringIO())
        arguments = ["--output", str(self.folder / "out"), "--name", "scene", "--threads", "1",
                     "--bake-resolution", "64", "--sky-resolution", "128", *options]
        command.export(self.scene, command.parse(arguments), report)
        return Exported(self.folder / "out", "scene", report.warnings)

    def assert_warned(self, exported, *words):
        self.assertTrue(any(all(word in line for word in words) for line in exported.warnings),
                        f"no warning has {words}: {exported.warnings}")

    def add(self, data, name="object", location=(0, 0, 0)):
        obj = bpy.data.objects.new(name, data)
        obj.location = location
        self.scene.collection.objects.link(obj)
        return obj

    def add_mesh(self, name, vertices, faces, material=None, location=(0, 0, 0)):
        mesh = bpy.data.meshes.new(name)
        mesh.from_pydata(vertices, [], faces)
        if material:
            mesh.materials.append(material)
        return self.add(mesh, name, location)

    def add_square(self, name, material=None, location=(0, 0, 0), size=2.0):
        h = size / 2
        obj = self.add_mesh(name, [(-h, -h, 0), (h, -h, 0), (h, h, 0), (-h, h, 0)], [(0, 1, 2, 3)], material, location)
        obj.data.uv_layers.new(name="UVMap").data.foreach_set("uv", [0, 0, 1, 0, 1, 1, 0, 1])
        return obj

    def add_cube(self, name, material=None, location=(0, 0, 0), size=1.0):
        h = size / 2
        corners = [(x, y, z) for x in (-h, h) for y in (-h, h) for z in (-h, h)]
        faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
        return self.add_mesh(name, corners, faces, material, location)

    def add_camera(self, name="camera", location=(0, 0, 5)):
        camera = self.add(bpy.data.cameras.new(name), name, location)
        self.scene.camera = camera
        return camera

    def add_lamp(self, name, kind, energy, **settings):
        lamp = bpy.data.lights.new(name, kind)
        lamp.energy = energy
        for key, value in settings.items():
            setattr(lamp, key, value)
        return self.add(lamp, name)

    def cycles(self, width, height, samples=16):
        """What Cycles renders: linear colours, rows from below."""
        render, cycles = self.scene.render, self.scene.cycles
        render.resolution_x, render.resolution_y, render.resolution_percentage = width, height, 100
        render.threads_mode, render.threads = "FIXED", 1
        cycles.samples, cycles.use_denoising, cycles.use_adaptive_sampling = samples, False, False
        cycles.pixel_filter_type, cycles.filter_width, cycles.light_sampling_threshold = "BOX", 1.0, 0
        render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
        render.filepath = str(self.folder / "cycles.exr")
        bpy.ops.render.render(write_still=True)
        return read_image(self.folder / "cycles.exr")[..., :3]


class MaterialTest(ExportTest):
    """Tests of one material on a square."""

    def of(self, material):
        """The export of a square with a material, and the material in it."""
        self.add_square("square", material)
        exported = self.export()
        return exported, exported.material("square")

    def assert_base(self, material, color, metallic=0.0):
        rough = material["pbrMetallicRoughness"]
        np.testing.assert_allclose(rough.get("baseColorFactor", [1, 1, 1, 1])[:3], color, atol=1e-3)
        self.assertAlmostEqual(rough.get("metallicFactor", 1.0), metallic, 3)


class Shaders:
    """A material whose nodes are made one by one: `tree.add("BsdfDiffuse", Color=(1, 0, 0, 1))`."""

    def __init__(self, name, data=None):
        self.data = data or bpy.data.materials.new(name)
        self.data.use_nodes = True
        self.nodes, self.links = self.data.node_tree.nodes, self.data.node_tree.links
        self.nodes.clear()

    def add(self, kind, **inputs):
        """A new node. An input takes a value, or the output of another node."""
        node = self.nodes.new("ShaderNode" + kind)
        for name, value in inputs.items():
            index = int(name[1:]) if name[0] == "_" else name.replace("_", " ")
            self.set(node.inputs[index], value)
        return node

    def set(self, socket, value):
        if isinstance(value, bpy.types.NodeSocket):
            self.links.new(value, socket)
        else:
            socket.default_value = value

    def show(self, node, output="OutputMaterial"):
        """Makes a shader the surface, and returns the material."""
        self.links.new(node.outputs[0], self.nodes.new("ShaderNode" + output).inputs["Surface"])
        return self.data


def diffuse(name, color=(0.8, 0.8, 0.8, 1)):
    shaders = Shaders(name)
    return shaders.show(shaders.add("BsdfDiffuse", Color=color))
