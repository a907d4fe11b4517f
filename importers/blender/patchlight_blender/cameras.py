"""Cameras: what glTF says of them, and the rest as extras of their nodes."""
import math

import mathutils

from .motion import is_animated
from .report import names


class Frame:
    """The size of the render's frame. `aspect` is width over height, with the pixels' own aspect."""

    def __init__(self, render, resolution=None):
        percent = render.resolution_percentage
        self.width, self.height = resolution or (max(render.resolution_x * percent // 100, 1),
                                                 max(render.resolution_y * percent // 100, 1))
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


def magnification(camera, frame):
    """Half the width and half the height of what a parallel camera sees, m."""
    half = camera.ortho_scale / 2
    return (half, half / frame.aspect) if is_wide(camera, frame) else (half * frame.aspect, half)


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
    if is_animated(camera):
        report.warn(f"{name}: only its place and direction are animated, its lens, shift and focus stay as in frame "
                    f"{scene.frame_current}")
    return True


def place(matrix):
    """A camera's matrix without its scale, which Cycles ignores."""
    return mathutils.Matrix.LocRotScale(matrix.to_translation(), matrix.to_3x3().normalized().to_quaternion(), None)


def active(scene, report):
    """The cameras that a render of the scene uses: those of its markers, else the active one."""
    bound = [marker.camera for marker in scene.timeline_markers if marker.camera]
    if bound:
        report.warn(f"markers change the camera: the job renders all frames of {names(c.name for c in bound)}"
                    ": edit trace.cameras")
        return list(dict.fromkeys(bound))
    if not scene.camera:
        report.warn("the scene has no active camera: set one with View > Cameras > Set Active Object as Camera")
        return []
    return [scene.camera]
