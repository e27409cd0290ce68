#!/usr/bin/env python3
"""Fails where objects use functions and kernels for CUDA that none of them defines, as the link of the program would.

    missing_instances.py LIBRARY OBJECT ...     what nvcc compiled
"""
import re
import subprocess
import sys


def main():
    if len(sys.argv) < 3:
        raise SystemExit(__doc__)
    used, defined = set(), set()
    for line in subprocess.run(["nm", "--demangle", *sys.argv[1:]], capture_output=True, text=True, check=True).stdout.splitlines():
        symbol = re.match(r"[0-9a-f ]{16} (\w) (.*Kokkos::Cuda\b.*)", line)
        if symbol:
            (used if symbol[1] == "U" else defined).add(symbol[2])
    missing = sorted(name for name in used - defined if not name.startswith("Kokkos::") and " Kokkos::" not in name.split("<")[0])
    for name in missing:
        print(f"no object defines {name}")
    print(f"{len(defined)} functions and kernels for CUDA, {len(missing)} missing")
    return bool(missing or not defined)


if __name__ == "__main__":
    sys.exit(main())
