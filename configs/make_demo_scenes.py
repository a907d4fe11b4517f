"""Creates the demo scenes cornell_box.glb and mirror_room.glb in the folder of this file.

Run as: blender -b --factory-startup --python configs/make_demo_scenes.py

Lengths are in metres and Z points up, as in Blender; the exporter converts to glTF's Y up. Walls are single-sided and
face into the room, and every object touches its support, so that no light leaks below it.
"""

import math
import sys
import traceback
from pathlib import Path

import bmesh
import bpy
from mathutils import Vector

FOLDER = Path(__file__).resolve().parent

# The measured Cornell box (www.graphics.cornell.edu/online/box/data.html), with walls at exact right angles. The box is
# centred on X; Y runs from the opening to the back wall.
CORNELL_SIZE = (0.5528, 0.5592, 0.5488)
CORNELL_LIGHT = ((0.213, 0.343), (0.227, 0.332))
SHORT_BLOCK = ((0.130, 0.065), (0.082, 0.225), (0.240, 0.272), (0.290, 0.114))
TALL_BLOCK = ((0.423, 0.247), (0.265, 0.296), (0.314, 0.456), (0.472, 0.406))


# --- Blender data -----------------------------------------------------------------------------------------------------


def start_scene(resolution):
    """Starts an empty scene; `resolution` sets the aspect ratio of cameras."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.render.resolution_x, bpy.context.scene.render.resolution_y = resolution


def export_scene(name):
    bpy.ops.export_scene.gltf(
        filepath=str(FOLDER / name),
        export_format="GLB",
        export_cameras=True,
        export_extras=True,
        export_texcoords=False,
        export_animations=False,
    )


def make_material(name, color, metallic=0.0, roughness=1.0, emission=(0.0, 0.0, 0.0), strength=0.0):
    """Principled BSDF without dielectric specular. Emits the radiance `emission` x `strength`, W/m2/sr."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    material.use_backface_culling = True  # Exported as single-sided.
    inputs = material.node_tree.nodes["Principled BSDF"].inputs
    inputs["Base Color"].default_value = (*color, 1.0)
    inputs["Metallic"].default_value = metallic
    inputs["Roughness"].default_value = roughness
    inputs["Specular"].default_value = 0.0
    inputs["IOR"].default_value = 1.5
    inputs["Emission"].default_value = (*emission, 1.0)
    inputs["Emission Strength"].default_value = strength
    return material


def add_object(name, data):
    new_object = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(new_object)
    return new_object


def add_mesh(name, shape, material):
    """`shape` is (vertices, faces); faces are counter-clockwise seen from the front."""
    mesh = bpy.data.meshes.new(name)
    vertices, faces = shape
    mesh.from_pydata(vertices, [], faces)
    mesh.materials.append(material)
    return add_object(name, mesh)


def add_light(name, shape, material, group):
    light = add_mesh(name, shape, material)
    light["light_group"] = group
    return light


def add_sphere(name, shape, center, material):
    sphere = add_mesh(name, shape, material)
    sphere.data.polygons.foreach_set("use_smooth", [True] * len(sphere.data.polygons))
    sphere.location = center


def add_camera(name, position, target, lens, sensor):
    """`lens` and `sensor` in mm; the sensor width applies to the longer side of the image."""
    data = bpy.data.cameras.new(name)
    data.lens, data.sensor_width = lens, sensor
    data.clip_start, data.clip_end = 0.01, 100.0
    camera = add_object(name, data)
    camera.location = position
    camera.rotation_euler = (Vector(target) - Vector(position)).to_track_quat("-Z", "Y").to_euler()


# --- Shapes: (vertices, faces) ----------------------------------------------------------------------------------------


def rectangle(origin, u, v):
    """The rectangle spanned by `u` and `v` from `origin`, facing along u x v."""
    origin, u, v = Vector(origin), Vector(u), Vector(v)
    return [origin, origin + u, origin + u + v, origin + v], [(0, 1, 2, 3)]


def wall_and_panes(origin, u, v, panes_u, panes_v):
    """`rectangle` split along all edges of its panes, as two shapes: the wall around the panes, and the panes.

    `panes_u` and `panes_v`: the panes' edges along u and v in metres, as begin, end, begin, end and so on.
    """
    origin, u, v = Vector(origin), Vector(u), Vector(v)
    steps_u = (0.0, *panes_u, u.length)
    steps_v = (0.0, *panes_v, v.length)
    vertices = [origin + s * u.normalized() + t * v.normalized() for t in steps_v for s in steps_u]
    wall, panes = [], []
    for j in range(len(steps_v) - 1):
        for i in range(len(steps_u) - 1):
            corner, row = j * len(steps_u) + i, len(steps_u)
            is_pane = i % 2 == 1 and j % 2 == 1
            (panes if is_pane else wall).append((corner, corner + 1, corner + row + 1, corner + row))
    return (vertices, wall), (vertices, panes)


def prism(base, height):
    """A prism on Z = 0 without a bottom face; `base` is a list of (x, y), counter-clockwise from above."""
    n = len(base)
    vertices = [(x, y, z) for z in (0.0, height) for x, y in base]
    sides = [(i, (i + 1) % n, n + (i + 1) % n, n + i) for i in range(n)]
    return vertices, sides + [tuple(range(n, 2 * n))]


def upright_loop(width, bottom, top, y):
    """The corners of an upright rectangle at depth `y`, counter-clockwise seen from the front (-Y)."""
    left, right = -width / 2, width / 2
    return [(left, y, bottom), (right, y, bottom), (right, y, top), (left, y, top)]


def loft(loops):
    """Connects consecutive loops of four vertices by quads, and closes the first loop from behind."""
    vertices = [vertex for loop in loops for vertex in loop]
    edges = [(4 * k + i, 4 * k + (i + 1) % 4) for k in range(len(loops) - 1) for i in range(4)]
    return vertices, [(3, 2, 1, 0)] + [(a, b, b + 4, a + 4) for a, b in edges]


def rotated_square(center, edge, degrees):
    """A base of `prism`."""
    corners = (math.radians(degrees + 45 + 90 * i) for i in range(4))
    radius = edge / math.sqrt(2)
    return [(center[0] + radius * math.cos(a), center[1] + radius * math.sin(a)) for a in corners]


def uv_sphere(radius, segments=32, rings=16):
    """A UV sphere with a fixed face order; that of Blender's operator differs from run to run."""
    polar_angles = [math.pi * ring / rings for ring in range(1, rings)]
    azimuths = [2 * math.pi * segment / segments for segment in range(segments)]
    ring_vertices = [
        Vector((math.sin(polar) * math.cos(azimuth), math.sin(polar) * math.sin(azimuth), math.cos(polar)))
        for polar in polar_angles
        for azimuth in azimuths
    ]
    vertices = [radius * vertex for vertex in (*ring_vertices, Vector((0, 0, 1)), Vector((0, 0, -1)))]
    north, south, last_ring = len(ring_vertices), len(ring_vertices) + 1, len(ring_vertices) - segments
    faces = []
    for i in range(segments):
        j = (i + 1) % segments
        faces.append((north, i, j))
        faces += [(k + i, k + segments + i, k + segments + j, k + j) for k in range(0, last_ring, segments)]
        faces.append((last_ring + i, south, last_ring + j))
    return vertices, faces


def icosphere(radius, subdivisions=3):
    builder = bmesh.new()
    bmesh.ops.create_icosphere(builder, subdivisions=subdivisions, radius=radius)
    vertices = [vertex.co.copy() for vertex in builder.verts]
    faces = [tuple(vertex.index for vertex in face.verts) for face in builder.faces]
    builder.free()
    return vertices, faces


def room_sides(size):
    """(origin, u, v) of the inner sides of a room on Z = 0, centred on X, whose front is at Y = 0."""
    width, depth, height = size
    left, right = -width / 2, width / 2
    across, along, up = Vector((width, 0, 0)), Vector((0, depth, 0)), Vector((0, 0, height))
    return {
        "floor": ((left, 0, 0), across, along),
        "ceiling": ((left, depth, height), across, -along),
        "back_wall": ((left, depth, 0), across, up),
        "left_wall": ((left, 0, 0), along, up),
        "right_wall": ((right, depth, 0), -along, up),
        "front_wall": ((right, 0, 0), -across, up),
    }


# --- Scenes -----------------------------------------------------------------------------------------------------------


def from_cornell(point):
    """Converts published floor coordinates, with X to the left, to scene coordinates."""
    return CORNELL_SIZE[0] / 2 - point[0], point[1]


def make_cornell_box():
    start_scene((512, 512))
    white = make_material("white", (0.725, 0.71, 0.68))
    red = make_material("red", (0.63, 0.065, 0.05))
    green = make_material("green", (0.14, 0.45, 0.091))
    light = make_material("light", (0.78, 0.78, 0.78), emission=(1.0, 0.82, 0.55), strength=36.0)

    width, depth, height = CORNELL_SIZE
    sides = room_sides(CORNELL_SIZE)
    light_u = [width - x for x in reversed(CORNELL_LIGHT[0])]
    light_v = [depth - y for y in reversed(CORNELL_LIGHT[1])]
    ceiling, panel = wall_and_panes(*sides["ceiling"], light_u, light_v)
    add_mesh("floor", rectangle(*sides["floor"]), white)
    add_mesh("ceiling", ceiling, white)
    add_light("light", panel, light, "lights.ceiling")
    add_mesh("back_wall", rectangle(*sides["back_wall"]), white)
    add_mesh("left_wall", rectangle(*sides["left_wall"]), red)
    add_mesh("right_wall", rectangle(*sides["right_wall"]), green)
    add_mesh("short_block", prism([from_cornell(p) for p in SHORT_BLOCK], 0.165), white)
    add_mesh("tall_block", prism([from_cornell(p) for p in TALL_BLOCK], 0.330), white)

    # The published lens (35 mm on 25 mm film), moved closer so that the box fills the image.
    middle = height / 2
    add_camera("camera", (0, -0.765, middle), (0, 0, middle), lens=35.0, sensor=25.0)
    export_scene("cornell_box.glb")


def add_leaning_mirror(center_x, wall_y, size, lean, frame, glass):
    """A framed mirror on the floor that leans against the wall behind it by `lean` radians."""
    outline = (size[0], 0.0, size[1])
    opening = (size[0] - 0.14, 0.07, size[1] - 0.07)
    thickness, recess = 0.045, 0.02
    loops = [
        upright_loop(*outline, 0.0),
        upright_loop(*outline, -thickness),
        upright_loop(*opening, -thickness),
        upright_loop(*opening, recess - thickness),
    ]
    parts = [
        add_mesh("mirror_frame", loft(loops), frame),
        add_mesh("mirror", (loops[-1], [(0, 1, 2, 3)]), glass),
    ]
    for part in parts:
        part.location = (center_x, wall_y - size[1] * math.sin(lean), 0)
        part.rotation_euler = (-lean, 0, 0)


def make_mirror_room():
    start_scene((640, 480))
    plaster = make_material("plaster", (0.72, 0.70, 0.66))
    boards = make_material("boards", (0.42, 0.32, 0.22))
    teal = make_material("teal", (0.10, 0.30, 0.33))
    ochre = make_material("ochre", (0.62, 0.36, 0.12))
    oak = make_material("oak", (0.30, 0.16, 0.07))
    chalk = make_material("chalk", (0.80, 0.79, 0.77))
    coral = make_material("coral", (0.70, 0.20, 0.13))
    silver = make_material("silver", (0.95, 0.95, 0.95), metallic=1.0, roughness=0.0)
    warm = make_material("ceiling_light", (0.8, 0.8, 0.8), emission=(1.0, 0.78, 0.50), strength=32.0)
    cool = make_material("window_light", (0.8, 0.8, 0.8), emission=(0.60, 0.80, 1.0), strength=11.0)

    size = (4.0, 4.0, 2.6)
    sides = room_sides(size)
    ceiling, panel = wall_and_panes(*sides["ceiling"], (1.7, 2.5), (1.5, 2.0))
    front_wall, window = wall_and_panes(*sides["front_wall"], (2.3, 2.85, 2.9, 3.45), (0.9, 1.5, 1.55, 2.15))
    add_mesh("floor", rectangle(*sides["floor"]), boards)
    add_mesh("ceiling", ceiling, plaster)
    add_light("ceiling_panel", panel, warm, "lights.ceiling")
    add_mesh("back_wall", rectangle(*sides["back_wall"]), teal)
    add_mesh("left_wall", rectangle(*sides["left_wall"]), ochre)
    add_mesh("right_wall", rectangle(*sides["right_wall"]), plaster)
    add_mesh("front_wall", front_wall, plaster)
    add_light("window", window, cool, "lights.window")

    add_leaning_mirror(0.5, size[1], (1.75, 1.7), math.radians(3), oak, silver)
    add_mesh("plinth", prism(rotated_square((0.9, 2.8), 0.4, 20), 0.5), plaster)
    add_sphere("plinth_sphere", icosphere(0.2), (0.9, 2.8, 0.5 + 0.2), coral)
    add_sphere("floor_sphere", uv_sphere(0.35), (-0.45, 2.7, 0.35), chalk)

    # The window is visible only in the mirror.
    add_camera("camera", (1.75, 0.3, 1.35), (0.05, 3.2, 0.7), lens=35.0, sensor=36.0)
    export_scene("mirror_room.glb")


def main():
    make_cornell_box()
    make_mirror_room()


if __name__ == "__main__":
    try:
        main()
    except Exception:  # Blender itself would exit with 0.
        traceback.print_exc()
        sys.exit(1)
