#!/usr/bin/env python3
"""A bundle of scripts/bundle stands on its own: unpacked elsewhere, without a variable of this shell, with the build, the
dependencies and Open MPI hidden (where this user may mount), it runs a case, and loads no library but its own and glibc's.

usage: test_bundle.py BUILD_FOLDER
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(sys.argv.pop(1)).resolve() if len(sys.argv) > 1 else SOURCE / "build" / "openmp"
GLIBC = re.compile(r"/(lib(c|m|mvec|dl|pthread|rt|resolv|util|nsl|anl)\.so|ld-linux|libnss_)")
SHELL = {"PATH": os.environ["PATH"], "HOME": os.environ.get("HOME", "/"), "OMP_NUM_THREADS": "2", "OMP_WAIT_POLICY": "passive"}


def hidden_places():
    """Folders that a bundle must do without."""
    words = subprocess.run(["ompi_info", "--parsable", "--path", "all"], capture_output=True, text=True).stdout
    paths = re.findall(r"^path:(?:pkglibdir|pkgdatadir|sysconfdir):(/.*openmpi.*)$", words, re.M)
    paths += [str(BUILD), os.environ.get("MPM_DEPS", os.path.expanduser("~/.cache/mpm"))]
    return [path for path in dict.fromkeys(paths) if os.path.isdir(path)]


def without_licence(root):
    """Files from elsewhere in a package, and programs, for which share/licences of it has no text; rows of licences that name no file."""
    folder = root / "share" / "licences"
    rows = [line.split("\t") for line in (folder / "INDEX.tsv").read_text().splitlines()]
    told = {place for place, *_ in rows}
    bare = {place for place, _, name in rows if not any(path.stat().st_size for path in (folder / name).glob("*"))}
    files = {path.relative_to(root).as_posix() for name in ("lib", "libexec") for path in (root / name).rglob("*") if path.is_file()}
    own = {name for name in files if re.search(r"/(libmpm_\w*\.so|processor)$", name)}
    linked = {word for word in ("petsc", "kokkos") if any(word in name for _, _, name in rows)}
    return sorted((files - own - told) | bare | {place for place in told if not (root / place).exists()} | ({"petsc", "kokkos"} - linked))


class Bundle(unittest.TestCase):
    maxDiff = None

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        work = pathlib.Path(cls.folder.name)
        subprocess.run([SOURCE / "scripts" / "bundle", "--build", BUILD, work / "made.tar"], check=True, stdout=subprocess.DEVNULL)
        (work / "else where").mkdir()
        subprocess.run(["tar", "xf", work / "made.tar", "-C", work / "else where"], check=True)
        (cls.root,) = (work / "else where").iterdir()
        (work / "empty").mkdir()
        cls.hide = cls.hiding(work / "empty")

    @classmethod
    def hiding(cls, empty):
        """Words before a command that run it with an empty folder over each hidden place; none where that is not allowed."""
        mounts = "".join(f"mount --bind '{empty}' '{place}' && " for place in hidden_places())
        words = ["unshare", "--mount", "--map-root-user", "sh", "-c", mounts + 'exec "$@"', "sh"]
        try:
            return words if subprocess.run(words + ["true"], capture_output=True).returncode == 0 else []
        except FileNotFoundError:
            return []

    def run_bundled(self, *command, **more):
        done = subprocess.run([*self.hide, *map(str, command)], cwd=self.root, env={**SHELL, **more}, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True)
        self.assertEqual(done.returncode, 0, done.stdout[-3000:])
        return done.stdout

    def test_case(self):
        text = self.run_bundled(sys.executable, "regression/run", "--backends", "serial", "--precisions", "double", "free_stream")
        self.assertRegex(text, r"\n[1-9]\d* pass, 0 short, 0 FAIL")

    def test_mpirun(self):
        words = "bin/mpirun -n 1 --bind-to none bin/mpm -options_file regression/cases/free_stream/case.opts -time_end 0.1"
        text = self.run_bundled(*words.split(), "-output_dir", self.root / "out" / "mpirun")
        self.assertIn("finished after", text)

    def test_ranks(self):
        """mpirun starts as many processes as asked for."""
        text = self.run_bundled("bin/mpirun", "-n", 3, "sh", "-c", "echo rank $OMPI_COMM_WORLD_RANK of $OMPI_COMM_WORLD_SIZE")
        self.assertEqual(sorted(text.split("\n"))[1:], [f"rank {rank} of 3" for rank in range(3)])

    @unittest.skipUnless(shutil.which("tclsh"), "there is no tclsh")
    def test_module(self):
        """The modulefile names this place, by the words of Environment Modules and Lmod."""
        (file,) = self.root.glob("share/modulefiles/mpm/*")
        words = "proc module-whatis args {}; proc conflict args {}; proc prepend-path {name place} {puts $name=$place}"
        text = subprocess.run(["tclsh"], input=f"{words}\nset ModulesCurrentModulefile {{{file}}}\nsource $ModulesCurrentModulefile\n",
                              capture_output=True, text=True, check=True).stdout
        self.assertEqual(text.split("\n")[:2], [f"PATH={self.root}/bin", f"PYTHONPATH={self.root}/python"])

    def test_licences(self):
        self.assertEqual(without_licence(self.root), [])

    def test_libraries(self):
        for number, command in enumerate(("bin/mpm -help", "bin/mpirun -n 1 bin/mpm -help")):
            trace = pathlib.Path(self.folder.name) / f"trace{number}"
            self.run_bundled(*command.split(), LD_DEBUG="libs", LD_DEBUG_OUTPUT=str(trace))
            texts = [path.read_text() for path in trace.parent.glob(f"{trace.name}.*")]
            texts = [text for text in texts if f"transferring control: {self.root}/libexec/" in text]
            loaded = {path for text in texts for path in re.findall(r"calling init: (.*)", text)}
            self.assertTrue(any("libmpi.so" in path for path in loaded), loaded)
            strange = [path for path in loaded if not path.startswith(str(self.root)) and not GLIBC.search(path)]
            self.assertEqual(strange, [], command)


if __name__ == "__main__":
    unittest.main()
