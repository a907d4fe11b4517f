"""Cameras: what glTF says of them, and the rest as extras of their nodes."""
import math

import bpy
import mathutils

from .report import names


class Frame:
    """The size of the render's frame. `aspect` is width over height, with the pixels' own aspect."""

    def __init__(self, render, resolution=None):
        percent = render.resolution_percentage / 100
        self.width, self.height = resolution or (max(int(render.resolution_x * percent), 1),
                                                 max(int(render.resolution_y * percent), 1))
        self.aspect = self.width * render.pixel_aspect_x / (self.height * render.pixel_aspect_y)


def is_wide(camera, frame):
    """Whether the sensor's width, not its height, spans the frame."""
    return camera.sensor_fit == "HORIZONTAL" or camera.sensor_fit == "AUTO" and frame.aspect >= 1


def vertical_angle(camera, frame):
    """Angle of view from the frame's lower to its upper edge, rad, without shift."""
    if is_wide(camera, frame):
        return 2 * math.atan(camera.sensor_width / 2 / camera.lens / frame.aspect)
    sensor = camera.sensor_height if camera.sensor_fit == "VERTICAL" else camera.sensor_width
    return 2 * math.atan(sensor / 2 / camera.lens)


def shift(camera, frame):
    """Offset of the frame's centre from the view axis, to the right and up, in widths and heights of the frame."""
    if is_wide(camera, frame):
        return camera.shift_x, camera.shift_y * frame.aspect
    return camera.shift_x / frame.aspect, camera.shift_y


def extras(obj, frame):
    """What glTF cannot say of a camera: see README.md."""
    camera, result = obj.data, {"aspect": frame.aspect}
    offset = shift(camera, frame)
    if any(offset):
        result["shift"] = list(offset)
    if camera.dof.use_dof and camera.type == "PERSP":
        focus = camera.dof.focus_distance
        if camera.dof.focus_object:
            place = camera.dof.focus_object.matrix_world.translation
            axis = -obj.matrix_world.to_3x3().col[2].normalized()
            focus = abs((place - obj.matrix_world.translation).dot(axis))
        result["aperture"] = camera.lens / 1000 / camera.dof.aperture_fstop
        result["focus"] = focus
    return result


def warn_of(obj, scene, report):
    """Names what is lost of a camera. Whether it can be exported at all."""
    camera, name = obj.data, f"camera '{obj.name}'"
    if camera.type == "PANO":
        report.warn(f"{name} is panoramic and is left out: Patchlight has perspective and parallel cameras")
        return False
    if camera.dof.use_dof and (camera.dof.aperture_blades or camera.dof.aperture_ratio != 1):
        report.warn(f"{name}: the shape of its aperture becomes a circle")
    if camera.dof.use_dof and camera.type == "ORTHO":
        report.warn(f"{name}: the depth of field of a parallel camera is left out")
    if scene.render.use_multiview:
        report.warn(f"{name}: stereo is left out")
    if camera.animation_data and (camera.animation_data.action or camera.animation_data.drivers):
        report.warn(f"{name}: only its place and direction are animated, its lens, shift and focus stay as in frame "
                    f"{scene.frame_current}")
    return True


def place(matrix):
    """A camera's matrix without its scale, which Cycles ignores."""
    return mathutils.Matrix.LocRotScale(matrix.to_translation(), matrix.to_3x3().normalized().to_quaternion(), None)


def may_move(obj):
    """Whether an object, its parents or the targets of its constraints are animated in any way."""
    waiting, seen = [obj], set()
    while waiting:
        item = waiting.pop()
        if item is None or item in seen:
            continue
        seen.add(item)
        data = item.animation_data
        if data and (data.action or data.drivers or data.nla_tracks):
            return True
        bones = item.pose.bones if item.pose else []
        for constraint in list(item.constraints) + [c for bone in bones for c in bone.constraints]:
            if constraint.type in {"FOLLOW_PATH", "CAMERA_SOLVER", "FOLLOW_TRACK"}:
                return True
            waiting.append(getattr(constraint, "target", None))
            curve = getattr(getattr(constraint, "target", None), "data", None)
            if getattr(curve, "animation_data", None):
                return True
        waiting.append(item.parent)
    return False


def motion(scene, objects):
    """For each camera that moves in the scene's frames, its matrices by frame."""
    suspects = [obj for obj in objects if may_move(obj)]
    if not suspects:
        return {}
    now, paths = scene.frame_current, {obj: {} for obj in suspects}
    for frame in range(scene.frame_start, scene.frame_end + 1, scene.frame_step):
        scene.frame_set(frame)
        graph = bpy.context.evaluated_depsgraph_get()
        for obj in suspects:
            paths[obj][frame] = place(obj.evaluated_get(graph).matrix_world)
    scene.frame_set(now)
    return {obj: path for obj, path in paths.items() if _varies(list(path.values()))}


def _varies(matrices):
    first = matrices[0]
    return any(abs(a - b) > 1e-6 for m in matrices[1:] for r, q in zip(m, first) for a, b in zip(r, q))


def active(scene, report):
    """The cameras that a render of the scene uses: those of its markers, else the active one."""
    bound = [marker.camera for marker in scene.timeline_markers if marker.camera]
    if bound:
        report.warn(f"the scene's markers change the camera: the job renders all frames of {names(c.name for c in bound)}")
        return list(dict.fromkeys(bound))
    if not scene.camera:
        report.warn("the scene has no active camera: set one with View > Cameras > Set Active Object as Camera")
        return []
    return [scene.camera]
