"""Runs tests in Blender: `blender -b --factory-startup --python tests/importers/blender/run.py -- FOLDER [NAME...]`.

A name is that of a file in the folder without `_test.py`. The exit code is 1 after a failure.
"""
import os
import pathlib
import sys
import unittest

PACKAGE = pathlib.Path(__file__).resolve().parents[3] / "importers" / "blender"

if __name__ == "__main__":
    folder, *wanted = sys.argv[sys.argv.index("--") + 1:]
    sys.path[:0] = [folder, str(PACKAGE)]
    sys.dont_write_bytecode = True
    suite = unittest.TestSuite()
    for path in sorted(pathlib.Path(folder).glob("*_test.py")):
        if not wanted or path.stem.removesuffix("_test") in wanted:
            suite.addTests(unittest.defaultTestLoader.loadTestsFromName(path.stem))
    result = unittest.TextTestRunner(verbosity=2, stream=sys.stderr).run(suite)
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(0 if result.wasSuccessful() and result.testsRun else 1)
