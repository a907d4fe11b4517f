"""The panel's operators, run to their end as scripts do."""
import os
import signal
import time

import bpy
import numpy as np
from patchlight_blender.addon import exr, groups, pipeline, preferences, scene_file, settings
from patchlight_blender.addon.session import session
from support import AddonTest, read_image


class Operators(AddonTest):
    def render(self):
        self.assertEqual(bpy.ops.patchlight.render(), {"FINISHED"})
        return exr.read(session.frames[0])

    def test_frames_come_back_with_their_layers(self):
        """Blender's compositor reads the image and its layer of the lamp, and adds them."""
        self.save()
        frame = self.render()
        image = bpy.data.images["Patchlight Camera"]
        self.assertEqual((image.source, image.colorspace_settings.name), ("FILE", "Linear"))
        scene = bpy.data.scenes.new("compositor")
        scene.use_nodes = True
        nodes, links = scene.node_tree.nodes, scene.node_tree.links
        nodes.clear()
        shown, both = nodes.new("CompositorNodeImage"), nodes.new("CompositorNodeMixRGB")
        shown.image, both.blend_type = image, "ADD"
        links.new(shown.outputs["Combined"], both.inputs[1])
        links.new(shown.outputs["Combined_lamp"], both.inputs[2])
        links.new(both.outputs[0], nodes.new("CompositorNodeComposite").inputs[0])
        scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 32, 24, 100
        scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
        scene.render.filepath = str(self.folder / "sum.exr")
        bpy.ops.render.render(write_still=True, scene=scene.name)
        expected = frame.pixels(["R", "G", "B"]) + frame.pixels([f"Combined_lamp.{c}" for c in "RGB"])
        np.testing.assert_allclose(read_image(self.folder / "sum.exr")[..., :3], expected, rtol=1e-6)

    def test_relighting_casts_no_ray_and_changes_the_image(self):
        self.move_camera()
        self.save()
        self.scene.patchlight.frames = "RANGE"
        self.render()
        self.said()
        image = bpy.data.images["Patchlight Camera"]
        self.assertEqual((image.source, len(session.frames)), ("SEQUENCE", 3))
        self.floor.use_nodes = False  # edits of the scene do not matter
        self.change("lamp", strength=2, color=(1, 0.5, 1))
        self.change("gone", strength=2)
        self.assertEqual(bpy.ops.patchlight.relight(), {"FINISHED"})
        said = self.said()
        self.assertIn("relight runs: ", said)
        for stage in ("import", "solve", "trace"):
            self.assertNotIn(f"{stage} runs: ", said)
        self.assertIn("'gone' gives no light", " ".join(session.warnings))
        for path in session.frames:
            before = exr.read(self.output / "frames" / path.name)
            lamp = before.pixels([f"Combined_lamp.{c}" for c in "RGB"])
            expected = before.pixels(["R", "G", "B"]) + lamp * (1, 0, 1)
            np.testing.assert_allclose(exr.read(path).pixels(["R", "G", "B"]), expected, rtol=2e-3)
        self.assertEqual(image.filepath, str(self.output / "relit/Camera.0001.exr"))
        self.change("lamp", strength=1, color=(1, 1, 1))
        self.change("gone", strength=1)
        bpy.ops.patchlight.relight()
        self.assertEqual(image.filepath, str(self.output / "frames/Camera.0001.exr"))
        self.scene.patchlight.quality = "FINAL"
        self.assert_refused("no frames of these settings", "relight")
        bpy.ops.wm.open_mainfile(filepath=str(self.blend))
        self.assertEqual((session.problem, session.frames), ("", []))

    def test_a_file_that_was_never_saved_is_rendered_once(self):
        self.scene.patchlight.output = str(self.folder / "out")
        self.floor.node_tree.nodes["Principled BSDF"].inputs["Emission"].default_value = (1, 0, 0, 1)
        self.scene.world = bpy.data.worlds.new("world")
        self.render()
        self.assertEqual(session.groups, ["environment", "floor", "lamp", "panel"])
        self.assertEqual(groups.of_scene(self.scene, bpy.context.view_layer), session.groups)
        self.output = self.folder / "out"
        time_of_export = self.time_of_export()
        self.said()
        self.render()
        self.assertEqual(self.time_of_export(), time_of_export)
        self.assertNotIn(" runs: ", self.said())
        self.scene.patchlight.output = "//out"
        self.assert_refused("relative to a file that was never saved")

    def test_all_cameras_are_rendered(self):
        bpy.ops.object.camera_add(location=(0, 1, 5))
        self.scene.patchlight.cameras, self.scene.patchlight.patch_area = "ALL", 1
        self.save()
        self.render()
        self.assertEqual([path.name for path in session.frames], ["Camera.0001.exr", "Camera.001.0001.exr"])
        self.assertIn("Patchlight Camera.001", bpy.data.images)
        self.assertIn("import.patch_area=1.0", settings.panel_arguments(self.scene))

    def start_work(self):
        self.save()
        asked = pipeline.request(preferences.program(), self.scene, settings.panel_arguments(self.scene))
        work = pipeline.Work(asked, pipeline.render(scene_file.file_to_render(self.scene)), "Exporting")
        self.addCleanup(work.close)
        self.wait_for_export()
        return work

    def wait_for(self, work):
        end = time.monotonic() + 20
        while work.poll():
            self.assertLess(time.monotonic(), end)
            time.sleep(0.05)

    def test_cancelling_stops_blender_too(self):
        work = self.start_work()
        work.cancel()
        self.wait_for(work)
        session.finish(work)
        self.assertEqual((session.problem, session.frames), ("", []))
        self.assertIn("cancelled", session.warnings[0])
        self.assertEqual(self.exporters(), [])
        self.assertIn("interrupted", self.said())

    def test_a_killed_program_is_named(self):
        work = self.start_work()
        os.kill(work.process.pid, signal.SIGKILL)
        self.wait_for(work)
        self.assertIn("SIGKILL", work.error)

    def assert_refused(self, words, operator="render"):
        with self.assertRaisesRegex(RuntimeError, words):
            getattr(bpy.ops.patchlight, operator)()
        self.assertIn(words, session.problem)

    def test_problems_are_told_before_anything_runs(self):
        self.save()
        self.assert_refused("press Render first", "relight")
        self.camera.data.type = "PANO"
        self.assert_refused("is panoramic")
        self.scene.camera = None
        self.assert_refused("no active camera")
        bpy.data.objects.remove(self.camera)
        self.assert_refused("no camera")
        program = bpy.context.preferences.addons["patchlight_blender"].preferences
        program.program = "/nowhere/patchlight"
        self.add_camera_again()
        self.assert_refused("the add-on's preferences name '/nowhere/patchlight'")
        self.assertEqual(self.said(), "")

    def add_camera_again(self):
        bpy.ops.object.camera_add()
        self.scene.camera = bpy.context.object
