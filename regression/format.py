#!/usr/bin/env python3
"""Checks that clang-format 14 leaves all sources as they are. Exit status 77 where there is no clang-format 14.

    format.py        names the sources that differ
    format.py --fix  reformats them
"""
import pathlib
import re
import subprocess
import sys

from mpm_regression.clang_tools import MAJOR, find_tool

FOLDERS = ("app", "lib", "kokkos_kernels", "regression")

tool = find_tool("clang-format")
if tool is None:
    print(f"no clang-format {MAJOR}")
    sys.exit(77)
root = pathlib.Path(__file__).parents[1]
sources = [str(f) for folder in FOLDERS for f in sorted((root / folder).rglob("*"))
           if f.suffix in (".hpp", ".cpp", ".h", ".c")]
if "--fix" in sys.argv:
    sys.exit(subprocess.run([tool, "-i", *sources]).returncode)
# Its warnings name each line that differs.
text = subprocess.run([tool, "--dry-run", *sources], capture_output=True, text=True).stderr
differ = sorted(set(re.findall(r"^(\S+?):\d+:\d+: warning", text, re.M)))
print("\n".join(f"{pathlib.Path(f).relative_to(root)}: differs; regression/format.py --fix" for f in differ)
      or f"{len(sources)} sources are formatted")
sys.exit(bool(differ or "error" in text))
