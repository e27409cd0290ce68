#!/usr/bin/env python3
"""Checks which folder includes which, against the table below (docs/CONTRIBUTING.md, "The tree").

    include_rules.py              the tree; one line for each include that breaks a rule
    include_rules.py --self-test  trees made up for the test: faults are found, and a tree without one has none
"""
import pathlib
import re
import sys
import tempfile

# Folder: the folders that it may include, beside itself. Names are those of include lines; `lib` is the folder itself,
# `mpm` its public headers. A row names rows above it only, so that no two folders include each other.
KERNELS = "base device physics/materials data physics loops functions rebuild transfer"
TABLE = {
    "base": "",
    "device": "base",
    "physics/materials": "base device",
    "data": "base device physics/materials",
    "physics": "base physics/materials data",
    "loops": "base device physics/materials data physics",
    "loops/gpu": "base device physics/materials data physics loops",
    "loops/cpu": "base device physics/materials data physics loops",
    "functions": "base device physics/materials data physics loops loops/gpu loops/cpu",
    "rebuild": "base device physics/materials data physics loops loops/gpu loops/cpu functions",
    "transfer": "base device physics/materials data physics loops loops/gpu loops/cpu functions rebuild",
    "mpm": "",
    "mesh": "base mpm",
    "common": "mpm",
    "element": "physics/materials mpm common",
    "output": "physics/materials data mpm common",
    "input/deck": "mpm common output",
    "input/geometry": "data mpm common",
    "parallel": KERNELS + " mpm mesh common input/geometry",
    "checkpoint": "base data mpm mesh common output input/deck input/geometry parallel",
    "input/files": "physics/materials data mpm mesh common input/geometry checkpoint",
    "input/options": "base physics/materials data mpm common element output input/deck input/geometry input/files",
    "step": KERNELS + " mpm mesh common output input/geometry parallel checkpoint input/files",
    "check": "base data mpm mesh common output input/deck input/geometry input/files input/options step",
    "run": "base data mpm mesh common element output input/deck input/geometry parallel checkpoint input/files "
           "input/options step check",
    "lib": "base mpm common input/deck input/options step check run",
    "app": "mpm",
}
# File, folder that it includes against the table: the reason.
EXCEPTIONS = {
    ("loops/reduce_by_tile.hpp", "loops/gpu"): "chooses between the loops of a GPU and of a processor",
    ("loops/reduce_by_tile.hpp", "loops/cpu"): "chooses between the loops of a GPU and of a processor",
    ("functions/follow_soil.cpp", "rebuild"): "collect_soil of rebuild/batches.hpp: the sums need batches of soil at home",
    ("mpm/config.hpp", "base"): "choices.hpp and side_kinds.hpp are installed next to it",
    ("app/main.cpp", "base"): "base/subnormals.hpp: a flag of the processor",
    ("common/model.hpp", "mesh"): "mesh/patch_grid.hpp: the table of patches, plain numbers",
    ("common/snapshot.hpp", "data"): "data/particle_columns.hpp: plain structs",
    ("common/material_table.hpp", "physics/materials"): "physics/materials/tables.hpp: plain structs",
}
# Folders, files: system headers that they never include, not through other headers either.
NEVER = [("kokkos_kernels/", "", r"petsc|mpi\.h|hdf5"), ("lib/include/", "", r"Kokkos_|hdf5"),
         ("lib/input/", "lib/input/options/material_options.cpp", r"Kokkos_"), ("lib/output/", "", r"Kokkos_")]
ROOTS = ["kokkos_kernels/", "lib/include/", "lib/", "kokkos_kernels/base/"]


def name_of(path):
    """The name of a file in include lines, and of its folder in the table."""
    root = next((r for r in ROOTS[:3] if path.startswith(r)), "")
    return path[len(root):], str(pathlib.PurePath(path[len(root):]).parent).replace(".", "lib")


def faults_of(tree, table, exceptions):
    """One line for each include under `tree` that breaks a rule."""
    files = {str(f.relative_to(tree)): f.read_text() for top in ("kokkos_kernels", "lib", "app")
             for f in sorted((tree / top).rglob("*.[hc]pp"))}
    includes, system = {}, {}
    for path, text in files.items():
        found = re.findall(r'^\s*#\s*include\s*([<"])([^>"]+)', text, re.M)
        system[path] = [name for mark, name in found if mark == "<"]
        places = [str(pathlib.PurePath(path).parent) + "/"] + ROOTS
        includes[path] = [place + name for mark, name in found if mark == '"'
                          for place in [next((p for p in places if p + name in files), None)] if place]
    faults, arrows, used = [], {}, set()
    for path, targets in includes.items():
        name, folder = name_of(path)
        if folder not in table:
            faults.append(f"{path}: the table has no row for its folder")
            continue
        for target in targets:
            to = name_of(target)[1]
            excepted = (name, to) in exceptions
            used |= {(name, to)} if excepted else set()
            if to != folder:
                if not excepted or path.startswith("lib/"):  # no two rooms of lib include each other at all
                    arrows.setdefault((folder, to), path)
                if not excepted and to not in table[folder].split():
                    faults.append(f'{path}: includes {target}; {folder} may include: {table[folder] or "nothing"}')
    faults += [f"{a} and {b} include each other: {arrows[a, b]} and {arrows[b, a]}"
               for a, b in sorted(arrows) if a < b and (b, a) in arrows]
    faults += [f"{name}: the exception for {to} is not in use" for name, to in sorted(set(exceptions) - used)]
    for folder, except_for, pattern in NEVER:
        for path in (p for p in files if p.startswith(folder) and p != except_for):
            reached, ahead = set(), [path]
            while ahead:
                at = ahead.pop()
                if at not in reached:
                    reached.add(at)
                    ahead += includes[at]
            faults += [f"{path}: includes <{header}>" + (f" through {at}" if at != path else "")
                       for at in sorted(reached) for header in system[at] if re.match(pattern, header)]
    return faults


def self_test():
    table = {"base": "", "data": "base", "a": "base b", "b": "base a", "input": "base common", "common": ""}
    right = {"kokkos_kernels/base/x.hpp": "", "kokkos_kernels/data/x.hpp": '#include "base/x.hpp"\n#include "data/y.hpp"',
             "kokkos_kernels/data/y.hpp": "", "lib/input/x.cpp": '#include <petscsys.h>\n#include "common/x.hpp"',
             "lib/common/x.hpp": ""}
    wrong = {  # the file that is added: the fault
        ("kokkos_kernels/base/y.hpp", '#include "data/x.hpp"'): "base may include: nothing",
        ("lib/common/x.hpp", '#include "input/x.cpp"'): "common may include: nothing",
        ("kokkos_kernels/new/x.hpp", ""): "no row for its folder",
        ("kokkos_kernels/base/x.hpp", "#include <petscvec.h>"): "includes <petscvec.h>",
        ("lib/common/x.hpp", "#include <Kokkos_Core.hpp>"): "lib/input/x.cpp: includes <Kokkos_Core.hpp> through lib/common",
    }
    both = {"kokkos_kernels/a/x.hpp": '#include "b/x.hpp"', "kokkos_kernels/b/x.hpp": '#include "a/x.hpp"'}
    rooms = {"lib/common/y.hpp": '#include "input/y.hpp"', "lib/input/y.hpp": ""}
    cases = [(right, {}, ""), (right | both, {}, "a and b include each other"),
             (right | both, {("a/x.hpp", "b"): ""}, ""),
             (right | rooms, {("common/y.hpp", "input"): ""}, "common and input include each other"),
             (right, {("base/x.hpp", "data"): ""}, "not in use"),
             (right | {"kokkos_kernels/base/y.hpp": '#include "data/x.hpp"'}, {("base/y.hpp", "data"): ""}, "")]
    cases += [(right | dict([added]), {}, fault) for added, fault in wrong.items()]
    for tree, exceptions, fault in cases:
        with tempfile.TemporaryDirectory() as folder:
            for path, text in tree.items():
                file = pathlib.Path(folder, path)
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_text(text)
            found = faults_of(pathlib.Path(folder), table, exceptions)
        assert fault in "\n".join(found) and bool(fault) == bool(found), (fault, found)


if __name__ == "__main__":
    if sys.argv[1:] == ["--self-test"]:
        sys.exit(self_test())
    names = list(TABLE)
    faults = [f"the table: {row} names {to}, which is not above it" for row in names for to in TABLE[row].split()
              if to not in names[:names.index(row)]]
    faults += faults_of(pathlib.Path(__file__).parents[1], TABLE, EXCEPTIONS)
    print("\n".join(faults) or "every include is allowed")
    sys.exit(bool(faults))
