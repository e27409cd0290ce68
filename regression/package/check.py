#!/usr/bin/env python3
"""The package that `cmake --install` makes is all that another program needs: the example of this folder, built on an install
tree that was moved since, computes the same as the installed program, and nothing installed names the source or the build.

    check.py BUILD FOLDER

BUILD is a build of mpm, FOLDER a folder for the install tree and what is built on it.
"""
import argparse
import csv
import os
import pathlib
import re
import shutil
import subprocess

HERE = pathlib.Path(__file__).resolve().parent
STEPS = 10
# Places of the dependencies are those that the package keeps; what the shell says of them does not count.
PLACES = re.compile(r"^(PETSC|KOKKOS|Kokkos|METIS|HDF5|MPM|CMAKE)_?\w*$|^PKG_CONFIG_PATH$")


def call(*words, **options):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, **options)
    assert done.returncode == 0, f"{words}: {done.returncode}\n{done.stdout}{done.stderr}"
    return done.stdout + done.stderr


def variable(build, name):
    found = re.search(rf"^{name}:\w+=(.*)$", (build / "CMakeCache.txt").read_text(), re.M)
    return found.group(1) if found else ""


def install(build, folder):
    """The install tree, at another place than where it was made."""
    made, prefix = folder / "made", folder / "pre fix"
    printed = call("cmake", "--install", build, "--prefix", made)
    native = variable(build, "MPM_ARCH") == "native"
    assert ("MPM_ARCH=native" in printed) == native, printed
    made.rename(prefix)
    return prefix


def check_content(prefix, source, build):
    installed = {str(path.relative_to(prefix)) for path in prefix.rglob("*") if path.is_file()}
    for name in ("bin/mpm", "include/mpm/simulation.hpp", "include/mpm/devices.hpp", "include/mpm/config.hpp",
                 "include/mpm/choices.hpp", "include/mpm/side_kinds.hpp", "share/mpm/inputs/footing.opts", "share/doc/mpm/LICENSE",
                 "share/mpm/python/soil_mpm/deck.py", "bin/soil-mpm",
                 f"share/modulefiles/mpm/{variable(build, 'CMAKE_PROJECT_VERSION')}"):
        assert name in installed, f"{name} was not installed"
    for name in installed:
        if not name.endswith((".a", "bin/mpm")):
            text = (prefix / name).read_text(errors="replace")  # binary STL files too
            for place in (source, build, prefix.parent):
                assert str(place) not in text, f"{name} names {place}"
            assert "-march" not in text or not name.endswith(".cmake"), f"{name} hands on -march"
        if name.endswith(".hpp"):
            included = re.findall(r'#include ["<](.*)[">]', (prefix / name).read_text())
            assert not [each for each in included if "okkos" in each], f"{name} includes Kokkos"


def history(folder):
    with (folder / "history.csv").open() as file:
        return [{name: value for name, value in row.items() if name != "wall_time"} for row in csv.DictReader(file)]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("folder", type=pathlib.Path)
    given = parser.parse_args()
    build, folder = given.build.resolve(), given.folder.resolve()
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    prefix = install(build, folder)
    check_content(prefix, pathlib.Path(variable(build, "CMAKE_HOME_DIRECTORY")), build)

    # Each public header alone, beside the program.
    example = folder / "example"
    shutil.copytree(HERE, example)
    with (example / "CMakeLists.txt").open("a") as file:
        file.write("add_library(headers OBJECT)\ntarget_link_libraries(headers PRIVATE mpm::mpm)\n")
        for header in sorted((prefix / "include/mpm").glob("*.hpp")):
            (example / f"{header.stem}.cpp").write_text(f"#include <mpm/{header.name}>\n")
            file.write(f"target_sources(headers PRIVATE {header.stem}.cpp)\n")
    environment = {name: value for name, value in os.environ.items() if not PLACES.match(name)}
    flags = variable(build, "MPM_SANITIZE")
    flags = [f"-DCMAKE_CXX_FLAGS=-fsanitize={flags}", f"-DCMAKE_C_FLAGS=-fsanitize={flags}"] if flags else []
    call("cmake", "-G", "Ninja", "-S", example, "-B", example / "build", f"-DCMAKE_PREFIX_PATH={prefix}",
         f"-DCMAKE_CXX_COMPILER={variable(build, 'CMAKE_CXX_COMPILER')}", *flags, env=environment)
    call("cmake", "--build", example / "build", env=environment)

    # Both run the same deck.
    deck = prefix / "share/mpm/inputs/footing_coarse.opts"
    options = ["-options_file", deck, "-backend", "serial", "-p2g", "sequential", "-time_max_steps", STEPS, "-output_frames", "off"]
    for name, program in (("program", prefix / "bin/mpm"), ("library", example / "build/example")):
        printed = call(program, *options, "-output_dir", folder / name, env=environment)
        assert name == "program" or "example: the steps begin" in printed and "ended with 0" in printed, printed
    rows = history(folder / "library")
    assert rows == history(folder / "program"), "the example and the program differ"
    assert int(rows[-1]["step"]) == STEPS, rows[-1]
    print(f"package: {len(rows)} rows of the example's history are those of the program")


main()
