"""Cameras: angles, shift and the rest, against where Cycles shows a point."""
import math

import bpy
import mathutils
import numpy as np
from bpy_extras.object_utils import world_to_camera_view
from support import ExportTest, Shaders, diffuse


class Cameras(ExportTest):
    def seen(self, exported, name, point):
        """Where the exported camera shows a point of Blender's space: 0 to 1 from the frame's left and lower edge."""
        node, camera = exported.node(name), exported.camera(name)["perspective"]
        x, y, z, w = node.get("rotation", (0, 0, 0, 1))
        local = mathutils.Quaternion((w, x, y, z)).inverted() @ (
            mathutils.Vector((point[0], point[2], -point[1])) - mathutils.Vector(node.get("translation", (0, 0, 0))))
        edge, extras = math.tan(camera["yfov"] / 2), node["extras"]
        shift = extras.get("shift", (0, 0))
        return (0.5 + local.x / -local.z / (2 * edge * extras["aspect"]) - shift[0],
                0.5 + local.y / -local.z / (2 * edge) - shift[1])

    def test_points_are_seen_where_blender_shows_them(self):
        point = mathutils.Vector((0.3, 0.2, 0.1))
        for fit in ("AUTO", "HORIZONTAL", "VERTICAL"):
            for width, height, aspect in ((480, 270, 1), (270, 480, 1), (400, 300, 2), (300, 400, 3)):
                with self.subTest(f"{fit} {width} x {height}, pixels {aspect} : 1"):
                    self.setUp()
                    camera = self.add_camera(location=(0, -0.4, 3))
                    data = camera.data
                    data.sensor_fit, data.sensor_height, data.lens = fit, 20, 28
                    data.shift_x, data.shift_y = 0.1, -0.2
                    camera.rotation_euler = (0.2, 0.1, 0.3)
                    camera.scale = (2, 2, 2)
                    render = self.scene.render
                    render.resolution_x, render.resolution_y, render.pixel_aspect_x = width, height, aspect
                    bpy.context.view_layer.update()
                    exported = self.export()
                    got = self.seen(exported, "camera", point)
                    camera.scale = (1, 1, 1)
                    bpy.context.view_layer.update()
                    want = world_to_camera_view(self.scene, camera, point)
                    np.testing.assert_allclose(got, want[:2], atol=2e-5)

    def test_cycles_shows_them_there_too(self):
        lamp = Shaders("lamp")
        self.add_cube("lamp", lamp.show(lamp.add("Emission")), (0.3, 0.2, 0), 0.01)
        camera = self.add_camera(location=(0, 0, 3))
        camera.data.shift_x, camera.data.shift_y = 0.1, -0.15
        self.scene.render.resolution_x, self.scene.render.resolution_y = 120, 200
        exported = self.export()
        image = self.cycles(120, 200, 16).sum(axis=2)
        rows, columns = np.mgrid[:200, :120]
        got = [((columns + 0.5) * image).sum() / image.sum() / 120, ((rows + 0.5) * image).sum() / image.sum() / 200]
        np.testing.assert_allclose(got, self.seen(exported, "camera", (0.3, 0.2, 0.0)), atol=5e-4)

    def test_clip_aperture_and_focus(self):
        target = self.add(None, "target", (1, 1, -2))
        camera = self.add_camera(location=(0, 0, 5))
        data = camera.data
        data.clip_start, data.clip_end, data.lens = 0.2, 40, 50
        data.dof.use_dof, data.dof.focus_object, data.dof.aperture_fstop = True, target, 2
        bpy.context.view_layer.update()
        exported = self.export()
        perspective, extras = exported.camera("camera")["perspective"], exported.node("camera")["extras"]
        self.assertAlmostEqual(perspective["znear"], 0.2, 5)
        self.assertAlmostEqual(perspective["zfar"], 40, 4)
        self.assertAlmostEqual(extras["aperture"], 0.025, 6)
        self.assertAlmostEqual(extras["focus"], 7, 5)
        data.dof.use_dof = False
        self.assertNotIn("focus", self.export().node("camera")["extras"])

    def test_parallel_and_panoramic_cameras(self):
        flat = self.add_camera("flat")
        flat.data.type, flat.data.ortho_scale = "ORTHO", 8
        self.add_camera("round").data.type = "PANO"
        self.scene.render.resolution_x, self.scene.render.resolution_y = 400, 200
        exported = self.export()
        self.assertAlmostEqual(exported.camera("flat")["orthographic"]["ymag"], 2, 5)
        flat.data.sensor_fit = "VERTICAL"
        self.assertAlmostEqual(self.export().camera("flat")["orthographic"]["ymag"], 4, 5)
        self.assert_warned(exported, "'round'", "panoramic")
        self.assertNotIn("round", exported.names())

    def test_motion_by_parents_and_constraints_is_kept(self):
        arm = self.add(None, "arm")
        for frame, angle in ((1, 0), (11, math.pi / 2)):
            arm.rotation_euler.z = angle
            arm.keyframe_insert("rotation_euler", frame=frame)
        camera = self.add_camera(location=(3, 0, 0))
        camera.parent = arm
        track = camera.constraints.new("TRACK_TO")
        track.target, track.track_axis, track.up_axis = self.add(None, "aim"), "TRACK_NEGATIVE_Z", "UP_Y"
        self.add_camera("still")
        self.scene.camera = camera
        self.scene.frame_start, self.scene.frame_end = 1, 11
        exported = self.export()
        self.assertIn("frames: 1-11", exported.job)
        self.assertEqual(len(exported.gltf["animations"]), 1)
        animation = exported.gltf["animations"][0]
        names = {exported.gltf["nodes"][c["target"]["node"]]["name"] for c in animation["channels"]}
        self.assertEqual(names, {"camera"})
        channel = next(c for c in animation["channels"] if c["target"]["path"] == "translation")
        sampler = animation["samplers"][channel["sampler"]]
        times, places = exported.accessor(sampler["input"]).ravel(), exported.accessor(sampler["output"])
        np.testing.assert_allclose(times[[0, -1]] * self.scene.render.fps, (1, 11), atol=1e-4)
        np.testing.assert_allclose(places[[0, -1]], ((3, 0, 0), (0, 0, -3)), atol=1e-5)
        middle = places[len(places) // 2]
        self.assertAlmostEqual(float(np.linalg.norm(middle)), 3, 4)

    def test_what_moves_besides_cameras_is_named(self):
        cube = self.add_cube("cube", diffuse("paint"))
        cube.keyframe_insert("location", frame=1)
        shape = self.add_cube("shape", location=(5, 0, 0))
        shape.shape_key_add(name="Basis")
        shape.shape_key_add(name="other").keyframe_insert("value", frame=1)
        cube.data.materials[0].node_tree.nodes["Diffuse BSDF"].inputs[0].keyframe_insert("default_value", frame=1)
        exported = self.export()
        for words in (("'cube'", "do not move"), ("'shape'", "shapes"), ("'paint'", "stay")):
            self.assert_warned(exported, *words)

    def test_a_turntable_with_a_moving_lamp_is_named(self):
        table = self.add(None, "table")
        product = self.add_cube("product")
        product.parent = table
        rail = bpy.data.curves.new("rail", "CURVE")
        rail.splines.new("POLY").points.add(1)
        follow = self.add_lamp("key light", "AREA", 10).constraints.new("FOLLOW_PATH")
        follow.target = self.add(rail, "rail")
        follow.use_fixed_location = True
        turned, spun = self.add_lamp("spot", "SPOT", 10), self.add_cube("spun", location=(5, 0, 0))
        for frame, turn in ((1, 0), (25, math.pi)):
            table.rotation_euler.z = turned.rotation_euler.x = spun.rotation_euler.z = turn
            follow.offset_factor = turn / math.pi
            for obj in (table, turned, spun):
                obj.keyframe_insert("rotation_euler", frame=frame)
            follow.keyframe_insert("offset_factor", frame=frame)
        for name in ("still", "still lamp"):
            self.add_cube(name, location=(9, 0, 0)) if name == "still" else self.add_lamp(name, "POINT", 10)
        self.scene.frame_set(1)
        exported = self.export()
        self.assert_warned(exported, "objects do not move in Patchlight: 'key light', 'product', 'spot', 'spun' stay "
                           "as in frame 1")

    def test_scenes_without_an_active_camera(self):
        self.add_cube("cube")
        exported = self.export()
        self.assert_warned(exported, "no active camera")
        self.assertNotIn("cameras:", exported.job)
