"""What goes on in this session of Blender: the work, what the last one said, and its frames."""
import bpy


class Problem(Exception):
    """An error that the user can mend: one sentence that says what is wrong and what to do."""


class Session:
    """`problem` and `warnings` are shown in the panel, `frames` are paths, `groups` their light groups."""

    def __init__(self):
        self.reset()

    def reset(self):
        self.work, self.problem, self.warnings, self.groups, self.frames = None, "", [], [], []

    def begin(self):
        self.problem, self.warnings = "", []

    def finish(self, work):
        """Keeps what a work found."""
        self.problem, self.warnings = work.error, list(work.warnings)
        if work.is_cancelled:
            self.warnings.append("cancelled: what is finished is kept")
        elif not work.error:
            self.groups, self.frames = work.groups, work.frames


session = Session()


@bpy.app.handlers.persistent
def _forget(*_):
    """Another file was opened."""
    session.reset()


def register():
    bpy.app.handlers.load_post.append(_forget)


def unregister():
    bpy.app.handlers.load_post.remove(_forget)


def redraw():
    """Draws the panel anew."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "PROPERTIES":
                area.tag_redraw()
