"""A small scene, and what the tests ask of its files."""
import os
import pathlib
import stat
import subprocess
import tempfile
import time
import unittest

import bpy
import numpy as np
from patchlight_blender.addon.session import session

ADDON = "patchlight_blender"
PROGRAM = os.environ["PATCHLIGHT"]


def read_image(path):
    """Pixels of an image file without layers, rows from below."""
    image = bpy.data.images.load(str(path), check_existing=False)
    values = np.array(image.pixels[:], np.float32).reshape(image.size[1], image.size[0], image.channels)
    bpy.data.images.remove(image)
    return values


class AddonTest(unittest.TestCase):
    """Starts each test with a floor, a lamp and a panel of light, and a camera, in a file that was never saved.

    The program that the add-on finds writes what it says to a file: see `said`.
    """

    def setUp(self):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        bpy.ops.preferences.addon_enable(module=ADDON)
        session.reset()
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.use(pathlib.Path(holder.name).resolve())
        self.make()

    def use(self, folder):
        """Works in a folder."""
        self.folder, self.blend, self.output = folder, folder / "room.blend", folder / "room.patchlight"
        self.log, program = folder / "said", folder / "patchlight"
        program.write_text(f'#!/bin/sh\nexec "{PROGRAM}" "$@" 2>> "{self.log}"\n')
        program.chmod(program.stat().st_mode | stat.S_IXUSR)
        os.environ["PATCHLIGHT"] = str(program)

    def make(self):
        self.scene = scene = bpy.context.scene
        scene.render.engine = "PATCHLIGHT"
        scene.render.resolution_x, scene.render.resolution_y, scene.frame_end = 32, 24, 3
        scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
        scene.render.filepath = "//picture_"
        scene.patchlight.quality = "DRAFT"
        bpy.ops.mesh.primitive_plane_add(size=4)
        self.floor = bpy.data.materials.new("floor")
        self.floor.use_nodes = True
        bpy.context.object.data.materials.append(self.floor)
        self.panel = self.add_lamp("panel", "AREA", 100, (0, 0, 3))
        self.lamp = self.add_lamp("lamp", "POINT", 50, (1, 0, 2))
        bpy.ops.object.camera_add(location=(0, 0, 6))
        self.camera = scene.camera = bpy.context.object

    def add_lamp(self, name, kind, energy, location):
        bpy.ops.object.light_add(type=kind, location=location)
        lamp = bpy.context.object
        lamp.name, lamp.data.energy = name, energy
        return lamp

    def move_camera(self):
        for frame in (1, 3):
            self.camera.location.x = frame / 4
            self.camera.keyframe_insert("location", frame=frame)

    def change(self, group, **values):
        item = self.scene.patchlight.groups.get(group) or self.scene.patchlight.groups.add()
        item.name = group
        for key, value in values.items():
            setattr(item, key, value)

    def save(self):
        bpy.ops.wm.save_as_mainfile(filepath=str(self.blend))

    def said(self):
        """What the program said since the last call."""
        text = self.log.read_text() if self.log.exists() else ""
        self.log.unlink(missing_ok=True)
        return text

    def command(self):
        """Blender with the add-on and the saved file."""
        return [bpy.app.binary_path, "-b", "--factory-startup", "--addons", ADDON, str(self.blend)]

    def start(self, *arguments, code=0, **environment):
        """Runs Blender on the saved file as a user does on the command line, and returns what it printed."""
        done = subprocess.run([*self.command(), *arguments], capture_output=True, text=True, check=False, timeout=60,
                              env=dict(os.environ, **environment))
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done.stdout + done.stderr

    def exporters(self):
        """Processes of Blender that export the test's file."""
        pattern = f"background.*{self.folder}"
        return subprocess.run(["pgrep", "-f", pattern], capture_output=True, text=True, check=False).stdout.split()

    def wait_for_export(self):
        end = time.monotonic() + 20
        while not self.exporters():
            self.assertLess(time.monotonic(), end)
            time.sleep(0.05)

    def picture(self, frame=1):
        return read_image(self.folder / f"picture_{frame:04}.exr")[..., :3]

    def time_of_export(self):
        return (self.output / "blend/export.json").stat().st_mtime_ns
