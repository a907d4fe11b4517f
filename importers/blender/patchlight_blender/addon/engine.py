"""The render engine: F12, `blender -b FILE -f 1` and `-a`."""
import time

import bpy
import numpy as np

from ..job import ENGINE
from . import exr, main_thread, pipeline, scene_file, settings
from .preferences import program
from .session import Problem, session

INTERVAL = 0.05


class PatchlightEngine(bpy.types.RenderEngine):
    bl_idname = ENGINE
    bl_label = "Patchlight"
    bl_use_eevee_viewport = True
    bl_use_shading_nodes_custom = False
    file = None
    """The file of the frames of one animation, so that each of them is of the same export."""

    def render(self, depsgraph):
        scene = depsgraph.scene.original
        first = next(layer for layer in scene.view_layers if layer.use)
        if depsgraph.view_layer.name != first.name:  # the exporter warns of it
            return
        try:
            work = self._work(scene)
            shown = None
            while work and work.poll():
                if self.test_break():
                    work.cancel()
                self.update_progress(work.fraction)
                if work.text != shown:
                    shown = work.text
                    self.update_stats("", shown)
                time.sleep(INTERVAL)
        except Problem as problem:
            session.problem = str(problem)
            self.report({"ERROR"}, str(problem))
            return
        if work is None or work.is_cancelled:
            return
        session.finish(work)
        for line in work.warnings:
            self.report({"WARNING"}, line)
        if work.error:
            self.report({"ERROR"}, work.error)
        else:
            self._take(work.frames[0], scene.render, first.name)

    def _work(self, scene):
        cls = PatchlightEngine
        if cls.file is None:
            cls.file = main_thread.call(lambda: scene_file.file_to_render(scene), self.test_break)
        if cls.file is None:
            return None
        asked = pipeline.request(program(), scene, settings.arguments(scene, [scene.camera], scene.frame_current))
        return pipeline.Work(asked, pipeline.render(cls.file), "Exporting")

    def _take(self, path, render, layer):
        """Hands a frame to Blender, or the region of it that is rendered."""
        width, height, x, y = self.resolution_x, self.resolution_y, 0, 0
        if render.use_border:
            x, y = int(render.border_min_x * width), int(render.border_min_y * height)
            width, height = int(render.border_max_x * width) - x, int(render.border_max_y * height) - y
        pixels = np.ones((height, width, 4), np.float32)
        pixels[..., :3] = exr.read(path).pixels(["R", "G", "B"])[y:y + height, x:x + width]
        result = self.begin_result(0, 0, width, height, layer=layer)
        result.layers[0].passes["Combined"].rect.foreach_set(pixels.reshape(-1, 4))
        self.end_result(result)


@bpy.app.handlers.persistent
def _begin(*_):
    PatchlightEngine.file = None


def register():
    bpy.utils.register_class(PatchlightEngine)
    bpy.app.handlers.render_init.append(_begin)


def unregister():
    bpy.app.handlers.render_init.remove(_begin)
    bpy.utils.unregister_class(PatchlightEngine)
