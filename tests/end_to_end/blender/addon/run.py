"""Tests of the add-on, started by `run`. The exit code is 1 after a failure."""
import os
import pathlib
import sys
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
sys.dont_write_bytecode = True

if __name__ == "__main__":
    wanted = sys.argv[sys.argv.index("--") + 1:]
    suite = unittest.TestSuite()
    for path in sorted(HERE.glob("*_test.py")):
        if not wanted or path.stem.removesuffix("_test") in wanted:
            suite.addTests(unittest.defaultTestLoader.loadTestsFromName(path.stem))
    result = unittest.TextTestRunner(verbosity=2, stream=sys.stderr).run(suite)
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(0 if result.wasSuccessful() and result.testsRun else 1)
