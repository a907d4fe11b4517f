"""Frames of a scene by the programs: a render, or other lights on the frames that are there."""
import dataclasses
import json
import pathlib
import re

from . import groups, scene_file
from .process import Process
from .session import Problem

LEVELS = 4
"""Folders above an output, and itself, in which the program looks for an export."""


@dataclasses.dataclass
class Request:
    """What the programs are asked for: `changes` has the settings of light groups by name."""
    program: str
    output: pathlib.Path
    arguments: list
    changes: dict


def request(program, scene, arguments):
    """A request with the scene's light groups and output."""
    changes = {item.name: item.change() for item in scene.patchlight.groups if item.change()}
    return Request(program, scene_file.output_folder(scene), arguments, changes)


class Work:
    """Programs that run one after another. `frames` are the pictures that they made, `groups` these have."""

    def __init__(self, asked, steps, text):
        self.asked, self.text, self.fraction = asked, text, 0.0
        self.warnings, self.error = [], ""
        self.frames, self.groups, self.is_cancelled = [], [], False
        self._steps, self.process = steps(self), None
        self._next(None)

    def poll(self):
        """Whether the work still goes on."""
        if self.process is None:
            return False
        code = self.process.poll()
        self.text, self.fraction = self.process.text, max(self.fraction, self.process.fraction)
        if code is None:
            return True
        self.warnings += [line for line in self.process.warnings if line not in self.warnings]
        if self.is_cancelled or self.process.error:
            self.error = "" if self.is_cancelled else self.process.error
            self.close()
        else:
            self._next(self.process)
        return self.process is not None

    def cancel(self):
        self.is_cancelled = True
        if self.process:
            self.process.stop()

    def close(self):
        """Ends the program if it still runs."""
        if self.process:
            self.process.close()
        self.process = None

    def _next(self, finished):
        try:
            command, text = self._steps.send(finished)
        except StopIteration:
            return self.close()
        except Problem as problem:
            self.error = str(problem)
            return self.close()
        self.close()
        self.process = Process(self.asked.program, [*command, "--output", self.asked.output, *self.asked.arguments],
                               text)


def render(scene):
    """Steps that render the file `scene` and apply the changes of light groups."""
    def steps(work):
        yield ["run", scene], "Exporting"
        yield from _list_frames(work, scene)
        yield from _apply_lights(work, scene)
    return steps


def relight(job):
    """Steps that apply the changes of light groups to the frames of `job` that are there."""
    def steps(work):
        yield from _list_frames(work, job)
        yield from _apply_lights(work, job)
    return steps


def exported_job(output):
    """The job of the last export for an output."""
    output = output.absolute()
    for folder in [output, *output.parents][:LEVELS]:
        job = folder / "blend" / f"{scene_file.stem()}.yaml"
        if job.is_file():
            return job
    raise Problem("there are no frames to relight yet: press Render first")


def _list_frames(work, job):
    """Finds the frames of a job, and their light groups."""
    status = yield ["status", job], work.text
    names = re.findall(r"^trace +(?:fresh|stale) +frames/(\S+)", status.output(), re.MULTILINE)
    work.frames = [work.asked.output / "frames" / name for name in names]
    if not names:
        raise Problem("there are no frames of these settings: render them first")
    work.groups = groups.of_frame(work.frames[0])


def _apply_lights(work, job):
    changes = {name: change for name, change in work.asked.changes.items() if name in work.groups}
    for name in work.asked.changes.keys() - changes.keys():
        work.warnings.append(f"light group '{name}' gives no light here: its strength and colour have no effect")
    if changes:
        lights = json.dumps(changes, ensure_ascii=False)
        yield ["relight", job, "--set", f"lights={lights}"], "Relighting"
        work.frames = [work.asked.output / "relit" / path.name for path in work.frames]
