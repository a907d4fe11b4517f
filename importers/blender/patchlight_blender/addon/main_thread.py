"""Calls in Blender's main thread: a render of the user interface runs in a thread of its own, where data must not be
written."""
import concurrent.futures
import queue
import threading

import bpy

INTERVAL = 0.1
_waiting = queue.SimpleQueue()


def call(function, is_cancelled):
    """The result of `function`, called in the main thread; None if `is_cancelled()` before it is called."""
    if threading.current_thread() is threading.main_thread():
        return function()
    future = concurrent.futures.Future()
    _waiting.put((function, future))
    while True:
        try:
            return future.result(INTERVAL)
        except concurrent.futures.TimeoutError:
            if is_cancelled() and future.cancel():
                return None


def _answer():
    while not _waiting.empty():
        function, future = _waiting.get()
        if future.set_running_or_notify_cancel():
            try:
                future.set_result(function())
            except Exception as error:  # raised again in the thread that waits
                future.set_exception(error)
    return INTERVAL


def register():
    bpy.app.timers.register(_answer, persistent=True)


def unregister():
    if bpy.app.timers.is_registered(_answer):
        bpy.app.timers.unregister(_answer)
