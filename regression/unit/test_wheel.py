#!/usr/bin/env python3
"""A wheel of scripts/wheel stands on its own: pip installs it, without a network, into an environment of its own; with the build, the
dependencies and Open MPI hidden (where this user may mount) it lists its decks, runs them and draws their pictures.

usage: test_wheel.py BUILD_FOLDER

Exit status 77 where there is no patchelf.
"""

import email
import json
import os
import pathlib
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import unittest
import zipfile

import test_bundle

MOST_MEGABYTES, MOST_SECONDS = 100, 120


class Wheel(unittest.TestCase):
    maxDiff = None

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        work = pathlib.Path(cls.folder.name)
        subprocess.run([test_bundle.SOURCE / "scripts" / "wheel", "--build", test_bundle.BUILD, work / "made"], check=True,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        (cls.wheel,) = (work / "made").iterdir()
        cls.root = work / "else where"
        subprocess.run([sys.executable, "-m", "venv", "--system-site-packages", cls.root], check=True)
        subprocess.run([cls.root / "bin" / "pip", "install", "--quiet", "--no-index", "--no-deps", cls.wheel], check=True)
        (cls.package,) = cls.root.glob("lib/python3*/site-packages/soil_mpm")
        (work / "empty").mkdir()
        cls.hide = test_bundle.Bundle.hiding(work / "empty")

    def command(self, *words, **more):
        """Output of soil-mpm in an empty environment."""
        environment = {"PATH": "/usr/bin:/bin", "HOME": str(self.root), "OMP_NUM_THREADS": "1", "MPLCONFIGDIR": str(self.root), **more}
        done = subprocess.run([*self.hide, self.root / "bin" / "soil-mpm", *map(str, words)], cwd=self.root, env=environment,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.assertEqual(done.returncode, 0, done.stdout[-3000:])
        return done.stdout

    def test_archive(self):
        self.assertLess(self.wheel.stat().st_size, MOST_MEGABYTES * 1e6)
        with zipfile.ZipFile(self.wheel) as archive:
            names = archive.namelist()
        self.assertEqual([name for name in names if test_bundle.GLIBC.search(name) and "resolv" not in name], [])
        self.assertTrue(any("libmpi.so" in name for name in names) and any("libmetis.so" in name for name in names))
        self.assertFalse(any("/bench/" in name or "__pycache__" in name for name in names))
        glibc = [int(number) for number in re.search(r"manylinux_(\d+)_(\d+)_", self.wheel.name).groups()]
        self.assertLessEqual(glibc, [int(number) for number in os.confstr("CS_GNU_LIBC_VERSION").split()[1].split(".")])

    def test_licences(self):
        """Every library and program has its text, with the common texts that Debian's ones refer to; a text that is missing is found."""
        program = self.package / "program"
        folder = program / "share" / "licences"
        self.assertEqual(test_bundle.without_licence(program), [])
        asked = {name for path in folder.rglob("*") if path.is_file() for name in
                 re.findall(r"/usr/share/common-licenses/([\w.+-]*[\w+])", path.read_text(errors="replace"))}
        there = {path.name for path in pathlib.Path("/usr/share/common-licenses").iterdir()}
        self.assertEqual(sorted((asked & there) - {path.name for path in (folder / "common").iterdir()}), [])
        (folder / "petsc").rename(folder / "hidden")
        self.addCleanup(lambda: (folder / "hidden").rename(folder / "petsc"))
        self.assertTrue(any(name.endswith("/mpm") for name in test_bundle.without_licence(program)))

    def test_metadata(self):
        with zipfile.ZipFile(self.wheel) as archive:
            (name,) = (name for name in archive.namelist() if name.endswith(".dist-info/METADATA"))
            text = email.message_from_bytes(archive.read(name))
            licence = archive.read(name.replace("METADATA", f"licenses/{text['License-File']}"))
        self.assertEqual((text["Name"], text["Requires-Python"], text["License-Expression"]), ("soil-mpm", ">=3.10", "Apache-2.0"))
        self.assertIn(f"-{text['Version']}-", self.wheel.name)
        self.assertIn("material point method", text["Summary"])
        self.assertEqual(licence, (test_bundle.SOURCE / "LICENSE").read_bytes())
        self.assertEqual(text.get_payload(decode=True).decode(), (test_bundle.SOURCE / "README.md").read_text(encoding="utf-8"))
        self.assertIn("numpy", text.get_all("Requires-Dist"))

    def test_first_deck(self):
        begin = resource.getrusage(resource.RUSAGE_CHILDREN)
        text = self.command("run", "footing_coarse")
        end = resource.getrusage(resource.RUSAGE_CHILDREN)  # of one thread: the wall time of a machine without other work
        self.assertLess(end.ru_utime + end.ru_stime - begin.ru_utime - begin.ru_stime, MOST_SECONDS)
        out = self.root / "out" / "footing_coarse"
        for picture in ("curve.png", "field.png"):
            self.assertIn(f"out/footing_coarse/{picture}", text)
            self.assertTrue((out / picture).read_bytes().startswith(b"\x89PNG"))
        self.assertEqual(json.loads((out / "performance.json").read_text())["outcome"], "finished")

    def test_program(self):
        done = subprocess.run([*self.hide, self.root / "bin" / "mpm", "--version"], capture_output=True, text=True, env={"PATH": "/usr/bin:/bin"})
        self.assertEqual((done.returncode, done.stdout[:4]), (0, "mpm "), done.stderr)

    def test_ranks(self):
        self.command("run", "footing_coarse", "--ranks", 2, "--no-pictures", "--out", "out/ranks", "-time_end", 0.01, "-output_frames", "off")
        self.assertEqual(json.loads((self.root / "out" / "ranks" / "performance.json").read_text())["ranks"], 2)

    def test_other_mpi(self):
        """MPM_MPI: ranks by the Open MPI of the machine; a folder without one is refused, and so are ranks that an MPICH starts."""
        self.hide, hidden = [], self.hide
        self.addCleanup(setattr, self, "hide", hidden)
        self.command("run", "footing_coarse", "--ranks", 2, "--no-pictures", "--out", "out/other", "-time_end", 0.01, "-output_frames", "off",
                     MPM_MPI="machine")
        self.assertEqual(json.loads((self.root / "out" / "other" / "performance.json").read_text())["ranks"], 2)
        for variables, words in (({"MPM_MPI": str(self.root)}, "takes own, machine or the folder"), ({"PMI_SIZE": "2"}, "started 2 ranks")):
            done = subprocess.run([self.package / "program" / "bin" / "mpm", "-version"], capture_output=True, text=True,
                                  env={"PATH": "/usr/bin:/bin", **variables})
            self.assertEqual(done.returncode, 2)
            self.assertIn(words, done.stderr)

    def test_processor(self):
        """A build for a level of processor that is not here does not start, and says so."""
        (file,) = self.package.glob("program/libexec/*/processor")
        before = file.read_text()
        self.addCleanup(file.write_text, before)
        file.write_text("x86-64-v9\n")
        done = subprocess.run([self.package / "program" / "bin" / "mpm", "-version"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 1)
        self.assertIn("takes a processor of level x86-64-v9", done.stderr)

    def test_report(self):
        self.command("run", "footing_coarse", "--no-pictures", "--out", "out/short", "-time_end", 0.02)
        text = self.command("report", "out/short")
        self.assertIn("Checks of trust", (self.root / text.splitlines()[-1]).read_text())

    def test_decks(self):
        names = [line.split()[0] for line in self.command("decks").splitlines()]
        self.assertEqual(names, sorted(path.stem for path in (test_bundle.SOURCE / "inputs").glob("*.opts")))
        self.assertEqual(self.command("decks", "boulders").split(), ["inputs/boulders.opts"])
        self.assertTrue((self.root / "inputs" / "boulders.csv").exists())
        shutil.rmtree(self.root / "inputs")
        self.command("check", "boulders")  # its table lies in the package

    def test_libraries(self):
        trace = self.root / "trace"
        self.command("check", "footing_coarse", LD_DEBUG="libs", LD_DEBUG_OUTPUT=str(trace))
        texts = [path.read_text() for path in self.root.glob("trace.*")]
        texts = [text for text in texts if re.search(r"transferring control: .*/libexec/.*/mpm", text)]
        loaded = {path for text in texts for path in re.findall(r"calling init: (.*)", text)}
        self.assertTrue(any("libmpi.so" in path for path in loaded), loaded)
        strange = [path for path in loaded if not path.startswith(str(self.package)) and not test_bundle.GLIBC.search(path)]
        self.assertEqual(strange, [])


if __name__ == "__main__":
    if shutil.which("patchelf") is None:
        print("test_wheel.py: there is no patchelf", file=sys.stderr)
        sys.exit(77)
    unittest.main()
