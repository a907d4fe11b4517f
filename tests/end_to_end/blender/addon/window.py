"""What `window_test` does in a window of Blender. It prints a line `fact: NAME VALUE` for each thing that it finds.

With $PATCHLIGHT_PICTURE it also writes a picture of the window there.
"""
import os
import sys
import time
import traceback

import bpy
from patchlight_blender.addon import exr
from patchlight_blender.addon.session import session

PICTURE = os.environ.get("PATCHLIGHT_PICTURE")


def steps():
    window, scene = bpy.context.window_manager.windows[0], bpy.context.scene
    areas = {area.type: area for area in window.screen.areas}
    editor, properties = areas["VIEW_3D"], areas["PROPERTIES"]
    properties.spaces.active.context = "RENDER"
    editor.type = "IMAGE_EDITOR"
    for engine in ("CYCLES", "PATCHLIGHT"):
        scene.render.engine = engine
        yield draw(window)
    fact("groups", " ".join(scene.patchlight.groups.keys()))

    with bpy.context.temp_override(window=window, area=properties):
        bpy.ops.patchlight.render("INVOKE_DEFAULT")
    yield 0.3
    yield draw(window)
    for value in ("PRESS", "RELEASE"):
        window.event_simulate(type="ESC", value=value)
    yield from until(lambda: session.work is None)
    fact("escaped", session.warnings)

    with bpy.context.temp_override(window=window, area=properties):
        bpy.ops.patchlight.render("INVOKE_DEFAULT")
    yield from until(lambda: session.work is None)
    yield draw(window)
    fact("rendered", f"{session.problem} {editor.spaces.active.image.name} {editor.spaces.active.image.type}")
    before = brightness()
    if PICTURE:
        with bpy.context.temp_override(window=window):
            bpy.ops.screen.screenshot(filepath=PICTURE)

    bpy.data.objects["lamp"].data.energy *= 2
    with bpy.context.temp_override(window=window):
        bpy.ops.ed.undo_push(message="edit")
    fact("dirty", bpy.data.is_dirty)
    with bpy.context.temp_override(window=window):
        bpy.ops.render.render("INVOKE_DEFAULT")
    yield 0.5
    yield from until(lambda: not bpy.app.is_job_running("RENDER"))
    fact("f12", brightness() / before)


def brightness():
    return exr.read(session.frames[0]).pixels(["Combined_lamp.R"]).mean()


def fact(name, value):
    print(f"fact: {name} {value}", flush=True)


def draw(window):
    """Draws the window now. A pause after it lets timers run."""
    for area in window.screen.areas:
        area.tag_redraw()
    with bpy.context.temp_override(window=window):
        bpy.ops.wm.redraw_timer(type="DRAW_WIN_SWAP", iterations=1)
    return 0.3


def until(is_done):
    end = time.monotonic() + 30
    while not is_done() and time.monotonic() < end:
        yield 0.1


def run(todo):
    try:
        return next(todo)
    except StopIteration:
        fact("end", "reached")
    except Exception:
        traceback.print_exc()
    sys.stdout.flush()
    os._exit(0)


TODO = steps()
bpy.app.timers.register(lambda: run(TODO), first_interval=0.5)
