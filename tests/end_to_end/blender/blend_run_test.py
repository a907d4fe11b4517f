"""`patchlight run SCENE.blend` with the real Blender. Arguments: folder of the programs, then those of unittest. Without
Blender the exit code is 77."""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

PROGRAMS = pathlib.Path(sys.argv.pop(1)) if len(sys.argv) > 1 else pathlib.Path("build/bin")
BLENDER = os.environ.get("BLENDER", "blender")
SMALL = ["--set", "trace.resolution=[32, 24]", "--set", "solve.rays=16", "--set", "import.accuracy=0.05"]

MAKE = """
import bpy, sys
bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
bpy.ops.mesh.primitive_plane_add(size=4)
material = bpy.data.materials.new("floor")
material.use_nodes = True
material.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = ({red}, 0.5, 0.5, 1)
bpy.context.object.data.materials.append(material)
bpy.ops.object.light_add(type="AREA", location=(0, 0, 3))
bpy.context.object.data.energy = 100
if {camera}:
    bpy.ops.object.camera_add(location=(0, 0, 6))
    scene.camera = bpy.context.object
bpy.ops.wm.save_as_mainfile(filepath=r"{path}")
"""


class BlendRun(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="patchlight."))
        self.addCleanup(shutil.rmtree, self.folder)
        self.scene = self.folder / "room.blend"

    def make(self, red=0.5, camera=True):
        script = MAKE.format(red=red, camera=camera, path=self.scene)
        subprocess.run([BLENDER, "-b", "--factory-startup", "--python-exit-code", "1", "--python-expr", script],
                       check=True, capture_output=True)

    def patchlight(self, *arguments, code=0):
        done = subprocess.run([PROGRAMS / "patchlight", *arguments], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, code, done.stderr)
        return done.stderr

    def test_a_second_run_does_nothing_and_an_edited_material_casts_no_ray(self):
        self.make()
        first = self.patchlight("run", self.scene, *SMALL)
        self.assertIn("million rays", first)
        self.assertTrue((self.folder / "room.patchlight/frames/Camera.0001.exr").is_file())
        second = self.patchlight("run", self.scene, *SMALL)
        for stage in ("import", "solve", "trace"):
            self.assertNotIn(f"{stage} runs", second)
        self.make(red=0.8)
        third = self.patchlight("run", self.scene, *SMALL)
        self.assertIn("solve runs", third)
        self.assertNotIn(" rays", third)

    def test_files_to_keep_stand_beside_the_scene_and_an_edited_job_stays(self):
        self.make()
        self.patchlight("from-blend", self.scene)
        job = self.folder / "room.yaml"
        job.write_text(job.read_text() + "solve: {rays: 16}\n")
        edited = job.read_text()
        self.assertIn("stays as it is", self.patchlight("from-blend", self.scene))
        self.assertEqual(job.read_text(), edited)
        self.assertEqual(sorted(path.name for path in self.folder.iterdir()), ["room.blend", "room.glb", "room.yaml"])
        self.patchlight("run", job, *SMALL)
        self.patchlight("from-blend", "--force", self.scene)
        self.assertNotEqual(job.read_text(), edited)

    def test_a_scene_without_a_camera_is_framed(self):
        self.make(camera=False)
        self.patchlight("run", self.scene, *SMALL)
        self.assertTrue((self.folder / "room.patchlight/frames/default.0001.exr").is_file())

    def test_what_is_no_blender_file_is_refused(self):
        self.scene.write_text("BLENDER")
        self.assertIn("is it a Blender file?", self.patchlight("run", self.scene, code=65))


if __name__ == "__main__":
    if not shutil.which(BLENDER):
        print("skipped: there is no Blender; .ci/setup-blender installs it")
        sys.exit(77)
    unittest.main()
