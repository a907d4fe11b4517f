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
{extra}
bpy.ops.wm.save_as_mainfile(filepath=r"{path}")
"""

MISSING_TEXTURE = """
texture = material.node_tree.nodes.new("ShaderNodeTexImage")
texture.image = bpy.data.images.new("brick", 4, 4)
texture.image.source, texture.image.filepath = "FILE", "//brick.png"
material.node_tree.links.new(texture.outputs[0], material.node_tree.nodes["Principled BSDF"].inputs["Base Color"])
"""

TURNTABLE = """
bpy.ops.object.empty_add()
table = bpy.context.object
bpy.data.objects["Plane"].parent = table
for frame, turn in ((1, 0), (25, 6.28)):
    table.rotation_euler.z = turn
    table.keyframe_insert("rotation_euler", frame=frame)
    bpy.data.objects["Area"].location.x = turn
    bpy.data.objects["Area"].keyframe_insert("location", frame=frame)
"""


class BlendCase(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="patchlight."))
        self.addCleanup(shutil.rmtree, self.folder)
        self.scene = self.folder / "room.blend"

    def make(self, red=0.5, camera=True, extra=""):
        script = MAKE.format(red=red, camera=camera, path=self.scene, extra=extra)
        subprocess.run([BLENDER, "-b", "--factory-startup", "--python-exit-code", "1", "--python-expr", script],
                       check=True, capture_output=True)

    def patchlight(self, *arguments, code=0):
        done = subprocess.run([PROGRAMS / "patchlight", *arguments], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, code, done.stderr)
        return done.stderr


class BlendRun(BlendCase):
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

    def test_a_missing_texture_is_named_and_the_frame_is_made(self):
        self.make(extra=MISSING_TEXTURE)
        said = self.patchlight("run", self.scene, *SMALL)
        self.assertIn("material 'floor': the image of its node 'Image Texture' is missing "
                      f"('{self.folder / 'brick.png'}'): find it with File > External Data; it is magenta until then",
                      said)
        self.assertTrue((self.folder / "room.patchlight/frames/Camera.0001.exr").is_file())

    def test_what_a_turntable_with_a_moving_lamp_loses_is_named(self):
        self.make(extra=TURNTABLE)
        said = self.patchlight("run", self.scene, *SMALL)
        self.assertIn("warning: objects do not move in Patchlight: 'Area', 'Plane' stay as in frame 1", said)
        for _ in range(2):
            self.assertEqual(said.count("do not move"), 1)
            said = self.patchlight("run", self.scene, *SMALL)  # it makes nothing, and says it again

    def test_what_is_no_blender_file_is_refused(self):
        self.scene.write_text("BLENDER")
        self.assertIn("is it a whole Blender file", self.patchlight("run", self.scene, code=65))


class WrongBlenders(BlendCase):
    """What a run says, in one sentence, where a script in Blender's place goes wrong."""

    def setUp(self):
        super().setUp()
        self.scene.write_text("BLENDER")

    def run_with(self, script, code, *words):
        program = self.folder / "blender"
        program.write_text(f"#!/bin/sh\n{script}\n")
        program.chmod(0o755)
        done = subprocess.run([PROGRAMS / "patchlight", "run", self.scene], capture_output=True, text=True, check=False,
                              env=dict(os.environ, BLENDER=str(program)))
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        for word in ("patchlight-run: error: ", *words):
            self.assertIn(word, done.stderr)
        self.assertFalse((self.folder / "room.patchlight/blend/export.json").exists())

    def test_a_crash_says_what_to_try(self):
        crash = "Blender crashed; last it said: Writing: room.crash.txt"
        for script, text in (("kill -SEGV $$", crash), ("kill -ABRT $$", crash), ("exit 1", "ended with exit code 1"),
                             ("exit 0", "Blender wrote no export")):
            with self.subTest(script):
                self.run_with(f"echo 'Writing: room.crash.txt'; {script}", 69, text, "open the file in Blender")

    def test_an_old_blender_is_refused(self):
        (self.folder / "bpy.py").write_text("class app:\n    version, version_string = (2, 79, 0), '2.79'\n")
        self.run_with(f"""while [ "$1" != --python ]; do shift; done
PYTHONPATH="{self.folder}" exec "{sys.executable}" "$2" """, 69,
                      "Blender 2.79 is too old: install Blender 3.4 or newer")

    def test_an_interrupted_blender_may_run_again(self):
        self.run_with("kill -TERM $$", 75, "run it again")

    def test_no_blender_is_no_crash(self):
        program = self.folder / "none"
        done = subprocess.run([PROGRAMS / "patchlight", "run", self.scene], capture_output=True, text=True, check=False,
                              env=dict(os.environ, BLENDER=str(program)))
        self.assertEqual(done.returncode, 69)
        self.assertIn("set it to Blender's program, or unset it", done.stderr)

    def test_a_missing_file_is_named(self):
        self.scene.unlink()
        self.assertIn("missing scene", self.patchlight("run", self.scene, code=66))


if __name__ == "__main__":
    if not shutil.which(BLENDER):
        print("skipped: there is no Blender; .ci/setup-blender installs it")
        sys.exit(77)
    unittest.main()
