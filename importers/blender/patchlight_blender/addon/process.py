"""A run of the program `patchlight`, followed by its log."""
import json
import os
import pathlib
import signal
import subprocess
import tempfile

import bpy

from .session import Problem

STAGES = {"import": ("Importing", 0.0, 0.1), "solve": ("Solving", 0.1, 0.5), "trace": ("Rendering", 0.5, 1.0),
          "relight": ("Relighting", 0.0, 1.0)}
"""What a stage is called, and its part of the progress."""

NOT_FRESH = 1
"""Exit code of `patchlight status` that is no error."""


class Process:
    """A started program. `poll` reads what it has said since: `text`, `fraction`, `warnings`, `error`."""

    def __init__(self, program, arguments, text):
        self.text, self.fraction, self.warnings, self.error = text, 0.0, [], ""
        self._folder = tempfile.TemporaryDirectory(prefix="patchlight.")
        log = pathlib.Path(self._folder.name) / "log.jsonl"
        log.touch()
        self._log, self._rest = log.open("rb"), b""
        self._out, self._err = tempfile.TemporaryFile(), tempfile.TemporaryFile()
        try:
            self._child = subprocess.Popen(
                [program, *map(str, arguments), "--log-json", str(log)], stdin=subprocess.DEVNULL, stdout=self._out,
                stderr=self._err, env=dict(os.environ, BLENDER=bpy.app.binary_path))
        except OSError as error:
            raise Problem(f"cannot start '{program}' ({error.strerror}): install Patchlight again") from error
        self.pid = self._child.pid

    def poll(self):
        """The exit code; None while the program runs."""
        code = self._child.poll()
        lines = (self._rest + self._log.read()).split(b"\n")
        self._rest = lines.pop()
        for line in lines:
            self._take(json.loads(line))
        if code not in {None, 0, NOT_FRESH} and not self.error:
            self.error = self._reason(code)
        return code

    def output(self):
        """What the program printed, after its end."""
        self._out.seek(0)
        return self._out.read().decode(errors="replace")

    def stop(self):
        """Asks the program to stop. What it has finished stays."""
        if self._child.poll() is None:
            self._child.terminate()

    def close(self):
        """Ends the program if it still runs, and removes the log."""
        self.stop()
        self._child.wait()
        for file in (self._log, self._out, self._err):
            file.close()
        self._folder.cleanup()

    def _take(self, line):
        level, message = line["level"], line["message"]
        name, start, end = STAGES.get(line["stage"], ("", 0.0, 0.0))
        if level == "warning" and message not in self.warnings:
            self.warnings.append(message)
        elif level == "error":
            self.error = message
        if name and level == "progress":
            self.fraction = start + (end - start) * line["fraction"]
            self.text = f"{name}: {line['fraction']:.0%}"
        elif name:
            self.fraction, self.text = max(self.fraction, start), name

    def _reason(self, code):
        """Why the program ended with a code and without a line in its log."""
        if code < 0:
            return f"patchlight was ended by {signal.Signals(-code).name}: render again, what was finished is kept"
        self._err.seek(0)
        said = [line.partition(": error: ")[2] for line in self._err.read().decode(errors="replace").splitlines()]
        return next(filter(None, reversed(said)), f"patchlight ended with exit code {code}: run it in a terminal")
