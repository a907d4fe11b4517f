"""What the panel sets of a scene, and the program's arguments for it."""
import io
import json

import bpy

from .. import cameras, motion
from ..report import Report
from .session import Problem

QUALITIES = {
    "DRAFT": ("Draft", {"import.accuracy": 0.25, "solve.rays": 64, "trace.samples": 4, "trace.quality": "patches"}),
    "MEDIUM": ("Medium", {"import.accuracy": 1, "solve.rays": 256, "trace.samples": 16, "trace.quality": "direct"}),
    "HIGH": ("High", {"import.accuracy": 1, "solve.rays": 1024, "trace.samples": 32, "trace.quality": "direct"}),
    "FINAL": ("Final", {"import.accuracy": 4, "solve.rays": 1024, "trace.samples": 64, "trace.quality": "direct"}),
}


def _described(values):
    return ", ".join(f"{key} {value}" for key, value in values.items())


class PatchlightGroup(bpy.types.PropertyGroup):
    """A light group, by `name`."""
    strength: bpy.props.FloatProperty(name="Strength", description="Factor on the light of the group", default=1, min=0,
                                      soft_max=4)
    color: bpy.props.FloatVectorProperty(name="Color", description="Colour that the group's light is multiplied by",
                                         subtype="COLOR", default=(1, 1, 1), min=0, soft_max=1)

    def change(self):
        """The job's settings of the group; none if its light stays as the scene has it."""
        changed = {}
        if self.strength != 1:
            changed["scale"] = self.strength
        if tuple(self.color) != (1, 1, 1):
            changed["color"] = list(self.color)
        return changed


class PatchlightSettings(bpy.types.PropertyGroup):
    quality: bpy.props.EnumProperty(
        name="Quality", default="MEDIUM",
        items=[(key, name, _described(values)) for key, (name, values) in QUALITIES.items()])
    patch_area: bpy.props.FloatProperty(
        name="Patch Area", description="Target area of a patch. 0: chosen by the quality and the sizes of surfaces",
        unit="AREA", min=0, soft_max=1, precision=4)
    cameras: bpy.props.EnumProperty(
        name="Cameras", default="ACTIVE",
        items=[("ACTIVE", "Active", "The active camera, or those of the timeline's markers"),
               ("ALL", "All", "All cameras of the scene")])
    frames: bpy.props.EnumProperty(
        name="Frames", default="CURRENT",
        items=[("CURRENT", "Current", "The current frame"),
               ("RANGE", "Range", "The scene's frames. A camera that stands still under lights that stay has one")])
    output: bpy.props.StringProperty(
        name="Output", subtype="DIR_PATH",
        description="Folder of frames and solution. Empty: the folder NAME.patchlight beside the file")
    groups: bpy.props.CollectionProperty(type=PatchlightGroup)


def panel_arguments(scene):
    """Arguments for the cameras and frames that the panel chooses."""
    settings = scene.patchlight
    every = [obj for obj in scene.objects if obj.type == "CAMERA"]
    chosen = every if settings.cameras == "ALL" else cameras.active(scene, Report(io.StringIO()))
    if not every:
        raise Problem("the scene has no camera: add one with Add > Camera")
    if not chosen:
        raise Problem("the scene has no active camera: set one with View > Cameras > Set Active Object as Camera")
    if settings.frames == "CURRENT":
        return arguments(scene, chosen, scene.frame_current)
    step = f"x{scene.frame_step}" if scene.frame_step > 1 else ""
    return arguments(scene, chosen, f"{scene.frame_start}-{scene.frame_end}{step}")


def arguments(scene, chosen, frames):
    """Arguments for cameras of the scene, and frames: a number or a range."""
    for obj in chosen:
        if obj.data.type == "PANO":
            raise Problem(f"camera '{obj.name}' is panoramic: Patchlight has perspective and parallel cameras")
        if isinstance(frames, int) and not scene.frame_start <= frames <= scene.frame_end and motion.may_move(obj):
            raise Problem(f"frame {frames} is outside the scene's frames {scene.frame_start} to {scene.frame_end}, and "
                          f"the motion of camera '{obj.name}' is known in these only: extend the scene's frames")
    values = dict(QUALITIES[scene.patchlight.quality][1])
    if scene.patchlight.patch_area > 0:
        del values["import.accuracy"]
        values["import.patch_area"] = scene.patchlight.patch_area
    values |= {"trace.cameras": json.dumps([obj.name for obj in chosen], ensure_ascii=False), "trace.frames": frames,
               "trace.fps": scene.render.fps, "trace.layers": "[light_groups]"}
    threads = ["--threads", scene.render.threads] if scene.render.threads_mode == "FIXED" else []
    return [part for key, value in values.items() for part in ("--set", f"{key}={value}")] + threads


def register():
    bpy.utils.register_class(PatchlightGroup)
    bpy.utils.register_class(PatchlightSettings)
    bpy.types.Scene.patchlight = bpy.props.PointerProperty(type=PatchlightSettings)


def unregister():
    del bpy.types.Scene.patchlight
    bpy.utils.unregister_class(PatchlightSettings)
    bpy.utils.unregister_class(PatchlightGroup)
