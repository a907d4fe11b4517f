"""What changes with the frame: cameras keep their motion and lamps their strength, everything else is named."""
import bpy

from .report import names


def is_animated(data):
    """Whether a data-block has keys or drivers of its own."""
    animation = getattr(data, "animation_data", None)
    return bool(animation and (animation.action or animation.drivers or animation.nla_tracks))


def may_move(obj):
    """Whether an object, its parents or the targets of its constraints are animated in any way."""
    waiting, seen = [obj], set()
    while waiting:
        item = waiting.pop()
        if item is None or item in seen:
            continue
        seen.add(item)
        if is_animated(item):
            return True
        bones = item.pose.bones if item.pose else []
        for constraint in list(item.constraints) + [c for bone in bones for c in bone.constraints]:
            target = getattr(constraint, "target", None)
            if constraint.type in {"CAMERA_SOLVER", "FOLLOW_TRACK", "OBJECT_SOLVER"}:
                return True
            if is_animated(getattr(target, "data", None)):
                return True
            waiting.append(target)
        waiting.append(item.parent)
    return False


def may_deform(obj):
    """Whether the shape of an object is animated: by shape keys, an armature or what its modifiers refer to."""
    if is_animated(getattr(obj.data, "shape_keys", None)) or is_animated(obj.data):
        return True
    for modifier in obj.modifiers:
        if modifier.type in {"CLOTH", "SOFT_BODY", "FLUID", "MESH_SEQUENCE_CACHE", "DYNAMIC_PAINT", "OCEAN"}:
            return True
        target = getattr(modifier, "object", None)
        if isinstance(target, bpy.types.Object) and target != obj and may_move(target):
            return True
    return False


def frames(scene):
    """The numbers of the scene's frames."""
    return range(scene.frame_start, scene.frame_end + 1, scene.frame_step)


def paths(scene, objects, place):
    """For each object that moves in the scene's frames, `place` of its matrices by frame."""
    suspects = [obj for obj in objects if may_move(obj)]
    if not suspects:
        return {}
    now, found = scene.frame_current, {obj: {} for obj in suspects}
    for frame in frames(scene):
        scene.frame_set(frame)
        graph = bpy.context.evaluated_depsgraph_get()
        for obj in suspects:
            found[obj][frame] = place(obj.evaluated_get(graph).matrix_world)
    scene.frame_set(now)
    return {obj: path for obj, path in found.items() if _varies(list(path.values()))}


def _varies(matrices):
    first = matrices[0]
    return any(abs(a - b) > 1e-6 for m in matrices[1:] for r, q in zip(m, first) for a, b in zip(r, q))


def warn(found, scene, report):
    """Names what changes with the frame and stays as it is: places, shapes, materials and the world."""
    frame = f"as in frame {scene.frame_current}"
    moving = {item.source.name for item in found.meshes + found.lamps
              if may_move(item.source) or item.instancer and may_move(item.instancer)}
    if moving:
        report.warn(f"objects do not move in Patchlight: {names(moving)} stay {frame}")
    shapes = {item.source.name for item in found.meshes if may_deform(item.source)}
    if shapes:
        report.warn(f"the shapes of {names(shapes)} stay {frame}")
    used = {m for item in found.meshes for m in item.mesh.materials if m}
    changing = {m.name for m in used if is_animated(m) or is_animated(m.node_tree)}
    if changing:
        report.warn(f"the materials {names(changing)} stay {frame}")
    if scene.world and (is_animated(scene.world) or is_animated(scene.world.node_tree)):
        report.warn(f"the world '{scene.world.name}' stays {frame}")
