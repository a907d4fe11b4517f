"""Operators of the panel: render, cancel, relight, show the frames."""
import time

import bpy

from . import pictures, pipeline, scene_file, settings
from .preferences import program
from .session import Problem, redraw, session

INTERVAL = 0.1


class _Worker:
    """An operator that runs programs: without blocking Blender when invoked, until their end when executed."""
    bl_options = {"REGISTER"}

    @classmethod
    def poll(cls, context):
        return session.work is None

    def execute(self, context):
        if not self._begin(context):
            return {"CANCELLED"}
        try:
            while session.work.poll():
                time.sleep(INTERVAL)
        finally:
            work = self._end()
        return self._report(context, work)

    def invoke(self, context, event):
        if not self._begin(context):
            return {"CANCELLED"}
        manager = context.window_manager
        self.timer = manager.event_timer_add(INTERVAL, window=context.window)
        manager.progress_begin(0, 100)
        manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "ESC" and event.value == "PRESS":
            session.work.cancel()
            return {"RUNNING_MODAL"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        if session.work.poll():
            context.window_manager.progress_update(100 * session.work.fraction)
            redraw()
            return {"PASS_THROUGH"}
        return self._report(context, self._end_modal(context))

    def cancel(self, context):
        """Blender loads another file, or ends."""
        self._end_modal(context)

    def _begin(self, context):
        try:
            session.begin()
            session.work = self._work(context)
        except Problem as problem:
            session.problem = str(problem)
            self.report({"ERROR"}, str(problem))
        redraw()
        return session.work is not None

    def _end_modal(self, context):
        context.window_manager.event_timer_remove(self.timer)
        context.window_manager.progress_end()
        return self._end()

    def _end(self):
        work, session.work = session.work, None
        work.close()
        session.finish(work)
        redraw()
        return work

    def _report(self, context, work):
        if work.is_cancelled:
            self.report({"INFO"}, "Patchlight was cancelled: what is finished is kept")
            return {"CANCELLED"}
        if work.error:
            self.report({"ERROR"}, work.error)
            return {"CANCELLED"}
        for line in work.warnings:
            self.report({"WARNING"}, line)
        pictures.show(work.frames, context)
        return {"FINISHED"}


class PATCHLIGHT_OT_render(_Worker, bpy.types.Operator):
    bl_idname = "patchlight.render"
    bl_label = "Render with Patchlight"
    bl_description = "Renders the cameras and frames below. What is up to date is not made again. Esc stops it"

    def _work(self, context):
        scene = context.scene
        asked = pipeline.request(program(), scene, settings.panel_arguments(scene))
        if bpy.ops.ed.flush_edits.poll():
            bpy.ops.ed.flush_edits()
        return pipeline.Work(asked, pipeline.render(scene_file.file_to_render(scene)), "Exporting")


class PATCHLIGHT_OT_relight(_Worker, bpy.types.Operator):
    bl_idname = "patchlight.relight"
    bl_label = "Relight"
    bl_description = "Gives the rendered frames the strengths and colours of the light groups. No ray is cast"

    def _work(self, context):
        scene = context.scene
        asked = pipeline.request(program(), scene, settings.panel_arguments(scene))
        return pipeline.Work(asked, pipeline.relight(pipeline.exported_job(asked.output)), "Relighting")


class PATCHLIGHT_OT_cancel(bpy.types.Operator):
    bl_idname = "patchlight.cancel"
    bl_label = "Cancel"
    bl_description = "Stops Patchlight. What is finished is kept"

    @classmethod
    def poll(cls, context):
        return session.work is not None

    def execute(self, context):
        session.work.cancel()
        return {"FINISHED"}


class PATCHLIGHT_OT_show(bpy.types.Operator):
    bl_idname = "patchlight.show"
    bl_label = "Show Frames"
    bl_description = "Opens the last frames in an image editor"

    @classmethod
    def poll(cls, context):
        return bool(session.frames)

    def execute(self, context):
        pictures.open_window(context, pictures.show(session.frames, context)[0])
        return {"FINISHED"}


CLASSES = (PATCHLIGHT_OT_render, PATCHLIGHT_OT_relight, PATCHLIGHT_OT_cancel, PATCHLIGHT_OT_show)


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)


def unregister():
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)


def cancel():
    """Stops what runs."""
    if session.work:
        session.work.close()
