"""What is exported of objects: as the render sees them, with the fewest meshes and sides."""
import math

import bpy
import mathutils
import numpy as np
from patchlight_blender import command
from support import ExportTest, Shaders, diffuse


class Geometry(ExportTest):
    def test_hidden_objects_and_cutters_are_left_out(self):
        wall = self.add_cube("wall", size=2)
        cutter = self.add_cube("cutter", location=(1, 0, 0), size=1)
        cutter.hide_render = True
        boolean = wall.modifiers.new("cut", "BOOLEAN")
        boolean.object, boolean.solver = cutter, "EXACT"
        for name, hide in (("hidden", "hide_render"), ("excluded", "exclude")):
            collection = bpy.data.collections.new(name)
            self.scene.collection.children.link(collection)
            collection.objects.link(bpy.data.objects.new(f"in {name}", wall.data))
            if hide == "hide_render":
                collection.hide_render = True
            else:
                bpy.context.view_layer.layer_collection.children[name].exclude = True
        unseen = self.add_cube("hidden in the viewport only", location=(5, 0, 0))
        unseen.hide_viewport = True
        exported = self.export()
        self.assertEqual(exported.names(), ["hidden in the viewport only", "wall"])
        self.assertGreater(exported.triangles("wall"), 12)

    def test_modifiers_have_their_render_settings(self):
        square = self.add_square("square")
        subdivision = square.modifiers.new("s", "SUBSURF")
        subdivision.levels, subdivision.render_levels, subdivision.show_viewport = 0, 2, False
        self.assertEqual(self.export().triangles("square"), 32)

    def test_instances_share_their_mesh(self):
        part = self.add_cube("part")
        collection = bpy.data.collections.new("parts")
        collection.objects.link(part)
        self.scene.collection.objects.unlink(part)
        for k in range(3):
            empty = self.add(None, f"place {k}", (3 * k, 0, 0))
            empty.instance_type, empty.instance_collection = "COLLECTION", collection
        copy = self.add_cube("copy", location=(0, 5, 0))
        exported = self.export()
        self.assertEqual(exported.names(), ["copy", "place 0/part", "place 1/part", "place 2/part"])
        self.assertEqual(len(exported.gltf["meshes"]), 1, copy)
        self.assertEqual(exported.node("place 2/part")["translation"], [6, 0, 0])

    def test_geometry_nodes_instances_are_exported(self):
        cube = self.add_cube("cube", size=0.1)
        cube.hide_render = True
        square = self.add_square("square")
        modifier = square.modifiers.new("scatter", "NODES")
        tree = bpy.data.node_groups.new("scatter", "GeometryNodeTree")
        tree.inputs.new("NodeSocketGeometry", "Geometry")
        tree.outputs.new("NodeSocketGeometry", "Geometry")
        start, end = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
        place, info = tree.nodes.new("GeometryNodeInstanceOnPoints"), tree.nodes.new("GeometryNodeObjectInfo")
        info.inputs["Object"].default_value = cube
        info.inputs["As Instance"].default_value = True
        tree.links.new(start.outputs[0], place.inputs["Points"])
        tree.links.new(info.outputs["Geometry"], place.inputs["Instance"])
        tree.links.new(place.outputs[0], end.inputs[0])
        modifier.node_group = tree
        exported = self.export()
        self.assertEqual(len(exported.gltf["nodes"]), 4)
        self.assertEqual(len(exported.gltf["meshes"]), 1)
        places = {tuple(round(v, 3) for v in node["translation"]) for node in exported.gltf["nodes"]}
        self.assertEqual(places, {(-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1)})

    def test_particles_that_are_objects_are_instances(self):
        part = self.add_cube("part", size=0.1)
        part.hide_render = True
        square = self.add_square("square")
        settings = square.modifiers.new("scatter", "PARTICLE_SYSTEM").particle_system.settings
        settings.type, settings.count = "HAIR", 7
        settings.render_type, settings.instance_object, settings.use_advanced_hair = "OBJECT", part, True
        exported = self.export()
        self.assertEqual(exported.names().count("square/part"), 7)
        self.assertEqual(len(exported.gltf["meshes"]), 2)

    def test_curves_texts_and_metaballs_become_meshes_once(self):
        text = bpy.data.curves.new("text", "FONT")
        text.body, text.extrude = "A", 0.1
        self.add(text, "text")
        ball = bpy.data.metaballs.new("ball")
        ball.elements.new()
        self.add(ball, "ball", (5, 0, 0))
        curve = bpy.data.curves.new("curve", "CURVE")
        curve.dimensions, curve.bevel_depth = "3D", 0.1
        curve.splines.new("POLY").points.add(1)
        curve.splines[0].points[1].co = (1, 0, 0, 1)
        self.add(curve, "curve", (0, 5, 0))
        self.assertEqual(self.export().names(), ["ball", "curve", "text"])

    def test_closed_meshes_have_one_side(self):
        self.add_cube("closed")
        self.add_square("sheet", location=(5, 0, 0))
        inward = self.add_cube("inward", location=(10, 0, 0))
        inward.data.flip_normals()
        exported = self.export()
        self.assertFalse(exported.material("closed").get("doubleSided", False))
        self.assertTrue(exported.material("sheet")["doubleSided"])
        self.assertTrue(exported.material("inward")["doubleSided"])
        self.assertEqual(exported.material("closed")["name"], exported.material("sheet")["name"])

    def test_a_room_seen_from_inside_has_two_sides(self):
        self.add_cube("room", size=10)
        self.add_cube("empty box", location=(20, 0, 0))
        self.add_camera(location=(1, 1, 1))
        exported = self.export()
        self.assertTrue(exported.material("room")["doubleSided"])
        self.assertFalse(exported.material("empty box").get("doubleSided", False))

    def test_sheared_and_mirrored_instances_stand_where_they_stood(self):
        parent = self.add(None, "parent")
        parent.scale = (1, 3, 1)
        child = self.add_cube("sheared", size=2)
        child.parent, child.rotation_euler = parent, (0, 0, math.radians(30))
        mirrored = self.add_cube("mirrored", location=(10, 0, 0), size=2)
        mirrored.scale = (-1, 1, 1)
        bpy.context.view_layer.update()
        want = np.array([child.matrix_world @ mathutils.Vector(v.co) for v in child.data.vertices])
        exported = self.export()
        got = exported.positions("sheared")
        for point in np.stack([want[:, 0], want[:, 2], -want[:, 1]], axis=1):
            self.assertLess(np.linalg.norm(got - point, axis=1).min(), 1e-5)
        node = exported.node("mirrored")
        self.assertLess(np.prod(node["scale"]), 0)

    def test_smooth_faces_keep_their_normals(self):
        bpy.ops.mesh.primitive_uv_sphere_add(segments=16, ring_count=8)
        ball = bpy.context.object
        for face in ball.data.polygons:
            face.use_smooth = True
        exported = self.export()
        attributes = exported.mesh(ball.name)["primitives"][0]["attributes"]
        points, normals = (exported.accessor(attributes[key]) for key in ("POSITION", "NORMAL"))
        self.assertGreater((points * normals).sum(axis=1).min(), 0.99)

    def test_what_is_left_out_is_named(self):
        holdout = self.add_square("hole")
        holdout.is_holdout = True
        unseen = self.add_square("no shadow", location=(5, 0, 0))
        unseen.visible_shadow = False
        self.add(bpy.data.volumes.new("smoke"), "smoke")
        hairy = self.add_square("hairy", diffuse("skin"), (9, 0, 0))
        hairy.modifiers.new("fur", "PARTICLE_SYSTEM").particle_system.settings.type = "HAIR"
        collection = bpy.data.collections.new("masks")
        self.scene.collection.children.link(collection)
        collection.objects.link(bpy.data.objects.new("mask", unseen.data))
        bpy.context.view_layer.layer_collection.children["masks"].holdout = True
        exported = self.export()
        self.assertEqual(exported.names(), ["hairy", "no shadow"])
        self.assert_warned(exported, "'mask'", "holdout")
        self.assert_warned(exported, "'hole'", "holdout")
        self.assert_warned(exported, "'no shadow'", "shadow rays")
        self.assert_warned(exported, "'hairy'", "'fur'")

    def test_the_layer_overrides_materials(self):
        self.add_square("square", diffuse("white"))
        bpy.context.view_layer.material_override = diffuse("clay")
        self.assertEqual(self.export().material("square")["name"], "clay")

    def test_the_scene_stays_as_it_was(self):
        m = Shaders("noise")
        self.add_square("square", m.show(m.add("BsdfDiffuse", Color=m.add("TexNoise").outputs["Color"])))
        self.add_lamp("lamp", "AREA", 10)
        self.add_camera()
        before = {kind: len(getattr(bpy.data, kind)) for kind in command.KINDS}
        settings = [self.scene.render.engine, self.scene.render.resolution_percentage, self.scene.frame_current]
        self.export()
        self.assertEqual(before, {kind: len(getattr(bpy.data, kind)) for kind in before})
        self.assertEqual(settings, [self.scene.render.engine, self.scene.render.resolution_percentage,
                                    self.scene.frame_current])
