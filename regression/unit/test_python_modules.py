#!/usr/bin/env python3
"""soil_mpm.python_modules: a script finds a Python that has its modules, or ends with one line."""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPTS = pathlib.Path(__file__).resolve().parents[2] / "scripts"
THIRD_PARTY = ("import numpy", "import h5py", "import matplotlib", "from soil_mpm")


def wrapper(folder, lines):
    """A Python of its own name in a folder."""
    path = folder / "python_with_modules"
    path.write_text("#!/bin/sh\n" + lines + f'exec {sys.executable} "$@"\n')
    path.chmod(0o755)
    return str(path)


class PythonModules(unittest.TestCase):
    def setUp(self):
        kept = tempfile.TemporaryDirectory()
        self.addCleanup(kept.cleanup)
        self.folder = pathlib.Path(kept.name)
        self.script = self.folder / "script"
        (self.folder / "soil_mpm").symlink_to(SCRIPTS / "soil_mpm")
        self.script.write_text("from soil_mpm.python_modules import need\n"
                               "need('made_up_module')\nimport sys\nimport made_up_module\nprint(made_up_module.WORD, *sys.argv[1:])\n")

    def run_script(self, *words, **variables):
        environment = dict(os.environ, MPM_DEPS=str(self.folder), **variables)
        return subprocess.run([sys.executable, *words], env=environment, capture_output=True, text=True)

    def test_goes_on_with_the_python_that_has_the_module(self):
        (self.folder / "made_up_module.py").write_text("WORD = 'found'\n")
        python = wrapper(self.folder, f"export PYTHONPATH={self.folder}\n")
        done = self.run_script(str(self.script), "a b", "c", MPM_PYTHON=python)
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "found a b c\n", ""))

    def test_finds_the_python_that_setup_chose(self):
        (self.folder / "made_up_module.py").write_text("WORD = 'found'\n")
        python = wrapper(self.folder, f"export PYTHONPATH={self.folder}\n")
        (self.folder / "env").mkdir()
        (self.folder / "env" / "one.sh").write_text(f"export MPM_PETSC='/none'\nexport MPM_PYTHON='{python}'\n")
        done = self.run_script(str(self.script), MPM_PYTHON="/none")
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "found\n", ""))

    def test_ends_with_one_line(self):
        done = self.run_script(str(self.script), MPM_PYTHON="/none")
        self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (1, "", 1))
        self.assertIn("lacks made_up_module; takes apt install made_up_module, pip install made_up_module, or MPM_PYTHON",
                      done.stderr)

    def test_every_script_finds_its_python(self):
        python = wrapper(self.folder, "")
        for path in sorted([*SCRIPTS.iterdir(), *SCRIPTS.glob("bench/*")]):
            if not path.is_file() or not path.read_bytes().startswith(b"#!/usr/bin/env python3"):
                continue
            if not any(words in path.read_text() for words in THIRD_PARTY):
                continue
            with self.subTest(script=path.name):
                done = self.run_script("-S", str(path), "--help", MPM_PYTHON=python)  # -S: without packages
                self.assertEqual((done.returncode, done.stderr), (0, ""))


if __name__ == "__main__":
    unittest.main()
