"""Renders a world alone with Cycles: as an equirectangular image, or a small part of it."""
import math
import pathlib
import tempfile

import bpy
import mathutils
import numpy as np


class Panorama:
    """A scene with nothing but a camera, for the worlds that `render` is given."""

    def __init__(self, threads=0):
        self.scene = bpy.data.scenes.new("patchlight sky")
        render, cycles = self.scene.render, self.scene.cycles
        render.engine, render.resolution_percentage, render.film_transparent = "CYCLES", 100, False
        render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
        cycles.use_denoising, cycles.use_adaptive_sampling = False, False
        cycles.pixel_filter_type, cycles.filter_width = "BOX", 1.0
        cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
        if threads:
            render.threads_mode, render.threads = "FIXED", threads
        self.camera = bpy.data.objects.new("patchlight sky", bpy.data.cameras.new("patchlight sky"))
        self.scene.collection.objects.link(self.camera)
        self.scene.camera = self.camera

    def whole(self, world, width, samples):
        """Radiance from all directions, rows from below: an array of width / 2, width, 3, with +X in its middle."""
        data = self.camera.data
        data.type = "PANO"
        (data.cycles if hasattr(data.cycles, "panorama_type") else data).panorama_type = "EQUIRECTANGULAR"
        self.camera.matrix_world = mathutils.Euler((math.pi / 2, 0, -math.pi / 2)).to_matrix().to_4x4()
        return self._render(world, width, width // 2, samples)

    def part(self, world, direction, angle, size, samples):
        """Radiance around `direction`, in a square of `angle` (rad), with its pixels' directions and solid angles."""
        data = self.camera.data
        data.type, data.angle, data.clip_start = "PERSP", angle, 0.01
        self.camera.matrix_world = direction.to_track_quat("-Z", "Y").to_matrix().to_4x4()
        edge = math.tan(angle / 2)
        side = ((np.arange(size) + 0.5) / size * 2 - 1) * edge
        solid = (2 * edge / size) ** 2 / (1 + side[:, None] ** 2 + side[None, :] ** 2) ** 1.5
        x, y = np.meshgrid(side, side)
        axes = np.array(self.camera.matrix_world.to_3x3())
        vectors = np.stack([x, y, -np.ones_like(x)], axis=-1) @ axes.T
        vectors /= np.linalg.norm(vectors, axis=-1, keepdims=True)
        return self._render(world, size, size, samples), vectors, solid

    def _render(self, world, width, height, samples):
        self.scene.world = world
        self.scene.render.resolution_x, self.scene.render.resolution_y = width, height
        self.scene.cycles.samples = samples
        with tempfile.TemporaryDirectory() as folder:
            path = str(pathlib.Path(folder) / "sky.exr")
            self.scene.render.filepath = path
            bpy.ops.render.render(write_still=True, scene=self.scene.name)
            image = bpy.data.images.load(path)
            values = np.empty(width * height * image.channels, np.float32)
            image.pixels.foreach_get(values)
            values = values.reshape(height, width, image.channels)[..., :3].copy()
            bpy.data.images.remove(image)
        return values


def directions(width):
    """Unit vectors of the pixels of `Panorama.whole`, rows from below, and the solid angles of the rows' pixels."""
    height = width // 2
    azimuth = math.pi - (np.arange(width) + 0.5) / width * 2 * math.pi
    elevation = (np.arange(height) + 0.5) / height * math.pi - math.pi / 2
    level = np.cos(elevation)[:, None]
    vectors = np.stack(np.broadcast_arrays(level * np.cos(azimuth), level * np.sin(azimuth),
                                           np.sin(elevation)[:, None]), axis=-1)
    return vectors, np.cos(elevation) * (2 * math.pi / width) * (math.pi / height)


def save(values, path):
    """Writes linear colours, rows from below, as an OpenEXR file of floats."""
    height, width = values.shape[:2]
    image = bpy.data.images.new("patchlight sky", width, height, float_buffer=True, is_data=True)
    data = np.ones((height, width, 4), np.float32)
    data[..., :3] = values
    image.pixels.foreach_set(data.ravel())
    image.filepath_raw, image.file_format = str(path), "OPEN_EXR"
    image.save()
    bpy.data.images.remove(image)
