"""Frames as images of Blender."""
import re

import bpy

from ..record import FRAME_OF

RANGE = "patchlight_range"
"""Custom property of images: their first and last frame."""


def show(frames, context):
    """Loads frames, one image for each camera, and shows the first in an image editor that is free for it."""
    numbers = {}
    for path in frames:
        camera, number = re.fullmatch(r"(.+)\.(\d+)\.exr", path.name).groups()
        numbers.setdefault(camera, []).append((int(number), path))
    images = [_load(camera, sorted(found)) for camera, found in numbers.items()]
    editor = next(filter(_is_free, _editors(context)), None)
    if editor and images:
        _show_in(editor, images[0])
    return images


def open_window(context, image):
    """Shows an image in an image editor, in a new window if there is none."""
    editor = next(_editors(context), None)
    if editor is None:
        bpy.ops.wm.window_new()
        area = context.window_manager.windows[-1].screen.areas[0]
        area.type = "IMAGE_EDITOR"
        editor = area.spaces.active
    _show_in(editor, image)


def _load(camera, frames):
    first, path = frames[0]
    image = next((item for item in bpy.data.images if item.get(FRAME_OF) == camera), None)
    if image is None:
        image = bpy.data.images.load(str(path))
        image.name, image[FRAME_OF], image.use_view_as_render = f"Patchlight {camera}", camera, True
    image.source = "SEQUENCE" if len(frames) > 1 else "FILE"
    image.filepath = str(path)
    image[RANGE] = first, frames[-1][0]
    image.reload()
    return image


def _editors(context):
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "IMAGE_EDITOR":
                yield area.spaces.active


def _is_free(editor):
    image = editor.image
    return image is None or image.type == "RENDER_RESULT" or FRAME_OF in image


def _show_in(editor, image):
    editor.image = image
    user, (first, last) = editor.image_user, image[RANGE]
    user.frame_start, user.frame_offset, user.frame_duration = first, first - 1, last - first + 1
    user.use_auto_refresh = True
