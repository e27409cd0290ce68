#!/usr/bin/env python3
"""Checks of a build with CUDA that need no GPU.

    check.py layout BUILD     nvcc and the host compiler lay out views alike: docs/install.md, "Your own PETSc, Kokkos, HDF5"
    check.py start PROGRAM    the program needs no driver to be loaded; without a GPU it runs on the processor, and makes the
                              dry run of a deck for the GPU
"""
import json
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
DECK = ROOT / "inputs" / "footing_coarse.opts"


def call(words, cwd=None):
    done = subprocess.run([str(word) for word in words], cwd=cwd, capture_output=True, text=True)
    return done.returncode, done.stdout, done.stderr


def places_of_device(ptx):
    """Size of the kernel's argument, and from where in it the values go to out[0], out[1], ..."""
    body = re.search(r"\.entry \S*view_layout\S*\((.*?)\n\}", ptx, re.S).group(1)
    size = re.search(r"\.b8 \S+\[(\d+)\]", body).group(1)
    loaded = dict(re.findall(r"ld\.param\.\w+\s+(%\w+), \[\w+_param_0\+(\d+)\]", body))
    stored = re.findall(r"st\.global\.\w+\s+\[%\w+(?:\+(\d+))?\], (%\w+);", body)
    return f"{size}: " + " ".join(loaded[value] for _, value in sorted(stored, key=lambda s: int(s[0] or 0)))


def layout(build):
    (command,) = [each for each in json.loads((build / "compile_commands.json").read_text())
                  if each["file"].endswith("view_layout.cpp")]
    words = shlex.split(command["command"])
    with tempfile.TemporaryDirectory() as folder:
        ptx = pathlib.Path(folder, "view_layout.ptx")
        # Optimised, so that values go from the argument to the output without copies between.
        dropped = ("--generate-code", "-MD", "-MT", "-MF", "-O", "-g", "-G", "-Xcicc", "-Xptxas")
        kept = [word for word in words[:words.index("-c")] if not word.startswith(dropped) and not word.endswith((".o", ".o.d"))]
        arch = re.search(r"compute_(\d+\w?)", command["command"]).group(1)
        status, _, errors = call([*kept, "-O3", f"-arch=compute_{arch}", "-ptx", command["file"], "-o", ptx], command["directory"])
        assert status == 0, errors
        device = places_of_device(ptx.read_text())
    (program,) = build.glob("regression/mpm_view_layout")
    status, host, errors = call([program])
    assert status == 0, errors
    print(f"device {device}\nhost   {host}", end="")
    assert device == host.strip(), "nvcc and the host compiler lay out views differently; take a newer Kokkos (docs/install.md)"


def start(program):
    _, needed, _ = call(["readelf", "-d", program])
    assert "libcuda" not in needed, needed
    few = ["-options_file", DECK, "-time_max_steps", 5, "-progress", "off"]
    with tempfile.TemporaryDirectory() as folder:
        for backend in ("serial", "openmp"):
            status, _, errors = call([program, *few, "-backend", backend, "-output_dir", f"{folder}/{backend}"])
            assert status == 0 and errors == "", f"-backend {backend}: {status} {errors}"
        status, printed, errors = call([program, *few, "-backend", "cuda", "-dry_run"])
        assert status == 0 and "a dry run: nothing was written" in printed, f"-dry_run: {status} {printed} {errors}"
        if "no GPU here" not in printed + errors:
            print("there is a GPU: what becomes of a run without one was not tried")
            return
        status, printed, errors = call([program, *few, "-backend", "cuda", "-output_dir", f"{folder}/cuda"])
        assert status == 2 and 'mpm: -backend: given "cuda", takes serial or openmp' in errors, f"{status} {errors}"
        assert not pathlib.Path(folder, "cuda").exists()


if len(sys.argv) == 3 and sys.argv[1] in ("layout", "start"):
    {"layout": layout, "start": start}[sys.argv[1]](pathlib.Path(sys.argv[2]).resolve())
else:
    sys.exit(__doc__)
