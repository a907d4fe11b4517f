"""Meshes of the export: equal ones are shared, sheared ones are baked, closed ones need one side only."""
import hashlib

import bmesh
import mathutils
import numpy as np
from mathutils.bvhtree import BVHTree

PLACES = 200
"""How many places of one mesh are searched for what stands inside it."""

SHEAR = 1e-5
"""Deviation, over the matrix's largest entry, above which a matrix counts as sheared."""


def prepare(instances):
    """Replaces meshes of equal content by one, and gives instances with a sheared matrix a mesh of their own."""
    first = {}
    for item in instances:
        if _is_sheared(item.matrix):
            item.mesh = item.mesh.copy()
            item.mesh.transform(item.matrix)
            if item.matrix.is_negative:
                item.mesh.flip_normals()
            item.matrix = mathutils.Matrix.Identity(4)
    digests = {}
    for item in instances:
        if item.mesh not in digests:
            _join_slots(item.mesh)
            digests[item.mesh] = _digest(item.mesh)
        item.mesh = first.setdefault(digests[item.mesh], item.mesh)


def _join_slots(mesh):
    """Moves faces to the first slot of their material. Exact Booleans differ from run to run in the slots of equal
    materials."""
    slots = list(mesh.materials) or [None]
    joined = np.array([slots.index(material) for material in slots], np.int32)
    used = array(mesh.polygons, "material_index", 1, np.int32)
    first = joined[np.minimum(used, len(slots) - 1)] if len(used) else used
    if np.any(first != used):
        mesh.polygons.foreach_set("material_index", first)


def _is_sheared(matrix):
    rebuilt = mathutils.Matrix.LocRotScale(*matrix.decompose())
    largest = max(abs(value) for row in matrix.to_3x3() for value in row)
    return max(abs(a - b) for r, q in zip(matrix, rebuilt) for a, b in zip(r, q)) > SHEAR * max(largest, 1e-20)


def array(items, name, width, kind=np.float32):
    """An attribute of every item of a Blender collection, as an array of rows."""
    values = np.empty(len(items) * width, kind)
    items.foreach_get(name, values)
    return values.reshape(-1, width) if width > 1 else values


def _digest(mesh):
    """A hash of all that the export writes of a mesh."""
    parts = [array(mesh.vertices, "co", 3), array(mesh.loops, "vertex_index", 1, np.int32),
             array(mesh.polygons, "loop_total", 1, np.int32), array(mesh.polygons, "material_index", 1, np.int32),
             array(mesh.polygons, "use_smooth", 1, bool),
             np.array([getattr(mesh, name, 0) for name in ("use_auto_smooth", "auto_smooth_angle")])]
    parts += [array(layer.data, "uv", 2) for layer in mesh.uv_layers]
    parts += [array(layer.data, "color", 4) for layer in mesh.color_attributes]
    if mesh.has_custom_normals:
        if hasattr(mesh, "calc_normals_split"):
            mesh.calc_normals_split()
        parts.append(array(mesh.loops, "normal", 3))
    digest = hashlib.sha1(repr([(m.name_full if m else "") for m in mesh.materials]).encode())
    digest.update(repr([layer.name for layer in mesh.uv_layers] + [a.name for a in mesh.color_attributes]).encode())
    for part in parts:
        digest.update(np.ascontiguousarray(part).tobytes())
    return digest.digest()


def is_closed(mesh):
    """Whether each edge has two faces that are wound alike, and the faces of every connected part look outwards."""
    mesh.calc_loop_triangles()
    corners = array(mesh.loop_triangles, "vertices", 3, np.int32).astype(np.int64)
    if not len(corners):
        return False
    count = len(mesh.vertices)
    starts, ends = corners.ravel(), np.roll(corners, -1, axis=1).ravel()
    forward, backward = np.sort(starts * count + ends), np.sort(ends * count + starts)
    if np.any(forward[1:] == forward[:-1]) or not np.array_equal(forward, backward):
        return False
    part = _parts(starts, ends, count)[corners[:, 0]]
    points = array(mesh.vertices, "co", 3).astype(np.float64)
    points -= points.mean(axis=0)
    a, b, c = (points[corners[:, k]] for k in range(3))
    volumes = np.bincount(part, weights=np.einsum("ij,ij->i", a, np.cross(b, c)), minlength=count)
    return bool(np.all(volumes[np.unique(part)] > 0))


def _parts(starts, ends, count):
    """For each vertex the smallest index of a vertex that edges connect it with."""
    label = np.arange(count)
    while True:
        least = np.minimum(label[starts], label[ends])
        new = label.copy()
        np.minimum.at(new, starts, least)
        np.minimum.at(new, ends, least)
        new = new[new]
        if np.array_equal(new, label):
            return label
        label = new


def seen_from_inside(instances, closed, points):
    """The meshes of `closed` that have a camera, a lamp (`points`) or another mesh inside them in some place."""
    corner = {mesh: [mathutils.Vector(c) for c in _box(mesh)] for mesh in {item.mesh for item in instances}}
    placed = []
    for item in instances:
        world = np.array([item.matrix @ c for c in corner[item.mesh]])
        placed.append((world.min(axis=0), world.max(axis=0)))
    low, high = (np.array([box[k] for box in placed]) for k in range(2))
    candidates = np.array([list(p) for p in points]).reshape(-1, 3)
    trees, result, tried = {}, set(), {}
    for item, (least, most) in zip(instances, placed):
        tried[item.mesh] = tried.get(item.mesh, 0) + 1
        if item.mesh not in closed or item.mesh in result or tried[item.mesh] > PLACES:
            continue
        inside = [mathutils.Vector(p) for p in candidates[np.all((candidates > least) & (candidates < most), axis=1)]]
        for k in np.nonzero(np.all((low > least) & (high < most), axis=1))[0]:
            inside.append(instances[k].matrix @ instances[k].mesh.vertices[0].co)
        if inside:
            if item.mesh not in trees:
                trees[item.mesh] = BVHTree.FromPolygons([v.co for v in item.mesh.vertices],
                                                        [tuple(p.vertices) for p in item.mesh.polygons])
            back = item.matrix.inverted_safe()
            if any(_is_inside(trees[item.mesh], back @ p) for p in inside):
                result.add(item.mesh)
    return result


def thickness(mesh):
    """The least side of a mesh's bounding box."""
    corners = np.array(_box(mesh))
    return float((corners.max(axis=0) - corners.min(axis=0)).min())


def _box(mesh):
    points = array(mesh.vertices, "co", 3)
    low, high = points.min(axis=0), points.max(axis=0)
    return [[(low, high)[i >> k & 1][k] for k in range(3)] for i in range(8)]


def _is_inside(tree, point, direction=mathutils.Vector((0.5773, 0.5779, 0.5769))):
    """Whether a ray from `point` leaves a closed mesh through an odd number of faces."""
    crossings, place = 0, point.copy()
    while crossings < 1000:
        hit, _, _, distance = tree.ray_cast(place, direction)
        if hit is None:
            break
        crossings += 1
        place = hit + direction * max(1e-6, distance * 1e-6)
    return crossings % 2 == 1


def remove_faces(mesh, indices):
    """Removes the faces whose material slot is one of `indices`."""
    last = max(len(mesh.materials) - 1, 0)
    work = bmesh.new()
    work.from_mesh(mesh)
    bmesh.ops.delete(work, geom=[f for f in work.faces if min(f.material_index, last) in indices], context="FACES")
    work.to_mesh(mesh)
    work.free()
