"""The job that renders an exported scene as Cycles would."""
import json
import math
import os

import bpy
import numpy as np

ENGINE = "PATCHLIGHT"
"""Identifier of the add-on's render engine."""

VIEWS = {"Standard": "sRGB", "Raw": "Raw"}
"""Blender's view transforms that Patchlight has without a configuration of OpenColorIO."""


def color_config():
    """Path of the OpenColorIO configuration that Blender uses."""
    return os.environ.get("OCIO") or bpy.utils.system_resource("DATAFILES", path="colormanagement") + "/config.ocio"


def view_settings(scene, report):
    """Lines below `trace` for the colours of the PNG. What they cannot say is warned of."""
    view, lines = scene.view_settings, []
    name, has_look = VIEWS.get(view.view_transform), view.look not in {"None", ""}
    if name and not has_look:
        lines.append(f"  view: {name}")
    else:
        lines += [f"  ocio: {quoted(color_config())}", f"  view: {quoted(view.view_transform)}"]
    if has_look:
        lines.append(f"  look: {quoted(view.look)}")
    if abs(view.gamma - 1) > 1e-4:
        lines.append(f"  gamma: {view.gamma:.6g}")
    if view.use_curve_mapping:
        report.warn("the curves of the view settings are left out")
    exposure = view.exposure
    if scene.cycles.film_exposure != 1:
        exposure += math.log2(max(scene.cycles.film_exposure, 1e-6))
        report.warn(f"film exposure {scene.cycles.film_exposure:.3g} applies to the PNG, not to the EXR as in Cycles")
    if abs(exposure) > 1e-6:
        lines.append(f"  exposure: {exposure:.6g}")
    return lines


def warn_of_render(scene, report):
    """Names the settings of the render that have no counterpart."""
    render, cycles = scene.render, scene.cycles
    if render.engine not in {"CYCLES", ENGINE}:
        report.warn(f"the scene's render engine is {render.engine}: it is exported as Cycles would render it")
    if render.pixel_aspect_x != render.pixel_aspect_y:
        report.warn("pixels that are not square are left out: the frame has square ones")
    if scene.display_settings.display_device not in {"sRGB", "None"}:
        report.warn(f"display device '{scene.display_settings.display_device}' is left out: the PNG is for the "
                    "configuration's default display")
    if render.film_transparent:
        report.warn("a transparent film is left out: the frame shows the sky")
    if render.use_border:
        report.warn("the render region is left out: the whole frame is rendered")
    if render.use_motion_blur:
        report.warn("motion blur is left out")
    if scene.use_nodes and render.use_compositing and scene.node_tree and len(scene.node_tree.nodes) > 2:
        report.warn("the compositor's nodes are left out")
    if cycles.feature_set == "EXPERIMENTAL" and any(
            obj.type == "MESH" and obj.cycles.use_adaptive_subdivision for obj in scene.objects):
        report.warn("adaptive subdivision is left out: the modifier's render level is taken")


def quoted(text):
    """A YAML string. JSON's are a part of them."""
    return json.dumps(str(text), ensure_ascii=False)


def shown(value):
    """A text, a number or a list of numbers as YAML."""
    if isinstance(value, str):
        return quoted(value)
    return "[" + ", ".join(map(shown, value)) + "]" if hasattr(value, "__len__") else f"{value:.7g}"


def text(name, frame, cameras, animated, excluded, environment, lights, view, scene):
    """The job as YAML. `environment` has its keys and values, `excluded` names of materials, `lights` the factors of
    light groups by frame."""
    lines = [f"# Exported from {name}.blend. Keys: pipeline/README.md", f"scene: {quoted(name + '.glb')}",
             f"output: {quoted(name + '.patchlight')}",
             "import: {punctual_units: blender}    # the unit of the lamps in the file"]
    if excluded:
        lines.append("materials:")
        lines += [f"  {quoted(escaped(item))}: {{exclude: true}}    # lets light through" for item in sorted(excluded)]
    if environment:
        lines.append("environment:")
        for key, value in environment.items():
            lines.append(f"  {key}: {shown(value)}")
    if lights:
        lines.append("lights:")
        lines += [f"  {quoted(group)}: {settings(factors)}" for group, factors in sorted(lights.items())]
    lines.append("trace:")
    if cameras:
        lines.append("  cameras: [" + ", ".join(quoted(camera.name) for camera in cameras) + "]")
    lines.append(f"  resolution: [{frame.width}, {frame.height}]")
    if animated:
        step = f"x{scene.frame_step}" if scene.frame_step > 1 else ""
        lines.append(f"  frames: {scene.frame_start}-{scene.frame_end}{step}")
        lines.append(f"  fps: {scene.render.fps}")
    return "\n".join(lines + view) + "\n"


def settings(factors):
    """Scale and colour of a light group by frame, as YAML. `factors`: frame to colour."""
    scales = {frame: max(factor) for frame, factor in factors.items()}
    colors = {frame: factor / scales[frame] for frame, factor in factors.items() if scales[frame] > 0}
    parts = [f"scale: {_by_frame(scales)}"]
    if any(abs(part - 1) > 1e-6 for color in colors.values() for part in color):
        parts.append(f"color: {_by_frame(colors)}")
    return "{" + ", ".join(parts) + "}"


def _by_frame(values):
    """A map of the frames between which values are linear."""
    frames = sorted(values)
    kept = frames[:1]
    for frame, after in zip(frames[1:], frames[2:]):
        start = kept[-1]
        passed = [f for f in frames if start < f <= frame]
        line = [np.interp(f, (start, after), (0, 1)) for f in passed]
        rise = np.subtract(values[after], values[start])
        if any(np.abs(values[start] + t * rise - values[f]).max() > 1e-5 for f, t in zip(passed, line)):
            kept.append(frame)
    if frames[-1] != kept[-1]:
        kept.append(frames[-1])
    return "{" + ", ".join(f"{frame}: {shown(values[frame])}" for frame in kept) + "}"


def escaped(name):
    """A glob that matches a name alone."""
    return "".join(f"[{c}]" if c in "*?[" else c for c in name)
