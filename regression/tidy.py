#!/usr/bin/env python3
"""Runs the checks of .clang-tidy on sources of a build. Exit status 77 where there is no clang-tidy 14.

    tidy.py BUILD [--jobs N]          the folders FOLDERS, whose sources include no header of Kokkos
    tidy.py BUILD --all [--jobs N]    every source of app, lib and kokkos_kernels
    tidy.py BUILD SOURCE ...          these sources

The sources of one of the FOLDERS are checked as one text, since the headers of the system take most of the time: no two of them
may define the same name in unnamed namespaces. What passed is not checked again until a source, a header of the tree that it
includes, its flags or .clang-tidy changes: BUILD/tidy has a digest of each text.
"""
import argparse
import concurrent.futures
import hashlib
import json
import pathlib
import re
import shlex
import subprocess
import sys
import time

from mpm_regression.clang_tools import MAJOR, find_tool

FOLDERS = ("lib/common/", "lib/checkpoint/", "lib/element/", "lib/mesh/", "lib/output/")
ROOTS = ("kokkos_kernels/", "lib/include/", "lib/", "kokkos_kernels/base/")
ROOT = pathlib.Path(__file__).resolve().parents[1]


def flags_of(command, build):
    """The flags that clang needs, without those that only the compiler of the build has."""
    words, flags = iter(shlex.split(command)), []
    for word in words:
        if word == "-isystem":
            flags += [word, next(words)]
        elif word.startswith(("-D", "-I", "-std=")):
            flags.append(word)
        elif word == "-fopenmp":  # clang's own omp.h is a package of its own
            flags += [word, "-isystem", str(build / "tidy/include")]
    return flags


def files_of(source):
    """The files of the tree that a source includes, itself too."""
    found, ahead = set(), [source]
    while ahead:
        file = ahead.pop()
        if file not in found:
            found.add(file)
            for name in re.findall(r'^\s*#\s*include\s*"([^"]+)"', (ROOT / file).read_text(), re.M):
                ahead += [root + name for root in ROOTS if (ROOT / (root + name)).exists()][:1]
    return sorted(found)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("sources", nargs="*")
    parser.add_argument("--all", action="store_true")
    parser.add_argument("--jobs", type=int, default=2)
    args = parser.parse_args()
    tool, build = find_tool("clang-tidy"), args.build.resolve()
    if tool is None:
        print(f"no clang-tidy {MAJOR}")
        return 77
    (build / "tidy/include").mkdir(parents=True, exist_ok=True)
    header = subprocess.run(["g++", "-print-file-name=include/omp.h"], capture_output=True, text=True).stdout.strip()
    if pathlib.Path(header).is_file():  # clang does not take attributes with the function that frees the memory
        text = pathlib.Path(header).read_text().replace("__malloc__ (omp_free)", "__malloc__")
        (build / "tidy/include/omp.h").write_text(text)
    commands = {}
    for entry in json.loads((build / "compile_commands.json").read_text()):
        path = pathlib.Path(entry["file"])
        if path.is_relative_to(ROOT) and not path.is_relative_to(build):
            commands[str(path.relative_to(ROOT))] = entry["command"]
    if args.all or args.sources:
        groups = [[f] for f in args.sources or commands if args.sources or f.startswith(("app/", "lib/", "kokkos_kernels/"))]
    else:
        groups = [group for folder in FOLDERS if (group := [f for f in commands if f.startswith(folder)])]

    def check(sources):
        flags = flags_of(commands[sources[0]], build)
        files = {file for source in sources for file in files_of(source)}
        state = [str(flags), (ROOT / ".clang-tidy").read_text()] + [(ROOT / f).read_text() for f in sorted(files)]
        digest = hashlib.sha256("\0".join(state).encode()).hexdigest()
        name = sources[0] if len(sources) == 1 else str(pathlib.PurePath(sources[0]).parent)
        stamp = build / "tidy" / (name.replace("/", "+") + ".passed")
        if stamp.exists() and stamp.read_text() == digest:
            return ""
        text = ROOT / name
        if len(sources) > 1:
            text = stamp.with_suffix(".cpp")
            text.write_text("".join(f'#include "{ROOT / f}"  // NOLINT(bugprone-suspicious-include)\n' for f in sources))
        run = subprocess.run([tool, "--quiet", "--checks=-clang-analyzer-*", "--warnings-as-errors=*", str(text), "--", *flags],
                             cwd=ROOT, capture_output=True, text=True)
        if run.returncode == 0:
            stamp.write_text(digest)
            return ""
        return run.stdout or run.stderr

    start = time.time()
    with concurrent.futures.ThreadPoolExecutor(args.jobs) as pool:
        reports = [report for report in pool.map(check, groups) if report]
    count = sum(map(len, groups))
    print("".join(reports) + f"{len(groups) - len(reports)} of {len(groups)} texts of {count} sources pass ({time.time() - start:.0f} s)")
    return bool(reports or not groups)


if __name__ == "__main__":
    sys.exit(main())
