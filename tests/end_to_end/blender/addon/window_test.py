"""The panel and F12 in a window, on a display without a screen."""
import os
import pathlib
import re
import shutil
import subprocess
import unittest

import bpy
from support import ADDON, AddonTest

SCRIPT = pathlib.Path(__file__).with_name("window.py")


@unittest.skipUnless(shutil.which("xvfb-run"), "there is no xvfb-run; .ci/setup-blender installs it")
class Window(AddonTest):
    def test_the_panel_renders_and_f12_takes_unsaved_changes(self):
        self.save()
        done = subprocess.run(
            ["xvfb-run", "-a", "-s", "-screen 0 1280x800x24 +extension GLX", bpy.app.binary_path, "--factory-startup",
             "-noaudio", "--enable-event-simulate", "--window-geometry", "0", "0", "1280", "800", "--addons", ADDON,
             str(self.blend), "--python", str(SCRIPT)],
            capture_output=True, text=True, check=False, timeout=120, env=dict(os.environ, LIBGL_ALWAYS_SOFTWARE="1"))
        said = done.stdout + done.stderr
        self.assertNotIn("Traceback", said)
        facts = dict(re.findall(r"^fact: (\w+) (.*)$", said, re.MULTILINE))
        self.assertIn("end", facts, said)
        self.assertEqual(facts["groups"], "lamp panel")
        self.assertIn("cancelled", facts["escaped"])
        self.assertEqual(facts["rendered"], " Patchlight Camera MULTILAYER")
        self.assertEqual(facts["dirty"], "True")
        self.assertAlmostEqual(float(facts["f12"]), 2, delta=0.01)
