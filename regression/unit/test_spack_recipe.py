#!/usr/bin/env python3
"""The Spack recipe of scripts/site/spack, read with stand-ins of Spack's modules: its source is this tree, its versions are those that the build
takes, and its options are variables of CMake. Spack itself does not read the recipe here.

usage: test_spack_recipe.py
"""

import pathlib
import re
import runpy
import sys
import types
import unittest
from unittest import mock

ROOT = pathlib.Path(__file__).resolve().parents[2]
RECIPE = ROOT / "scripts/site/spack/spack_repo/soil_mpm/packages/soil_mpm/package.py"


class Stand(types.ModuleType):
    """A module of Spack whose directives note their arguments."""

    def __init__(self, name, said, **things):
        super().__init__(name)
        self.__dict__.update(things)
        for directive in ("license", "version", "variant", "depends_on", "conflicts", "requires", "generator"):
            setattr(self, directive, lambda *words, directive=directive, **more: said.append((directive, words, more)))
        self.when = lambda condition: mock.MagicMock()
        self.join_path = lambda *parts: "/".join(parts)


def read():
    """The class of the recipe, and its directives [(name, arguments, named arguments)]."""
    said = []
    package = type("CMakePackage", (), {"define": lambda self, name, value: f"-D{name}={value}",
                                        "define_from_variant": lambda self, name, variant: f"-D{name}:{variant}"})
    cuda = type("CudaPackage", (), {"cuda_arch_values": ("80", "90")})
    names = {"spack": {}, "spack.package": {}, "spack_repo": {}, "spack_repo.builtin": {}, "spack_repo.builtin.build_systems": {},
             "spack_repo.builtin.build_systems.cmake": {"CMakePackage": package}, "spack_repo.builtin.build_systems.cuda": {"CudaPackage": cuda}}
    with mock.patch.dict(sys.modules, {name: Stand(name, said, **things) for name, things in names.items()}):
        return runpy.run_path(str(RECIPE))["SoilMpm"], said


class Recipe(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.recipe, cls.said = read()
        cls.needs = [(words[0], more.get("when", "")) for name, words, more in cls.said if name == "depends_on"]

    def test_the_source_is_this_tree(self):
        self.assertEqual(self.recipe.git, ROOT.as_uri())
        self.assertEqual((RECIPE.parents[2] / "repo.yaml").read_text().split()[:3], ["repo:", "namespace:", "soil_mpm"])

    def test_versions_are_those_that_the_build_takes(self):
        page = (ROOT / "docs/install.md").read_text()
        for library, word in (("petsc", "PETSc"), ("kokkos", "Kokkos")):
            oldest = re.search(rf"^\| {word} \| ([\d.]+) or newer", page, re.MULTILINE)[1]
            self.assertTrue(any(need.startswith(f"{library}@{oldest}:") for need, _ in self.needs), library)
        cmake = re.search(r"cmake_minimum_required\(VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text())[1]
        self.assertTrue(any(need.startswith(f"cmake@{cmake}") for need, _ in self.needs), cmake)
        for library in ("mpi", "hdf5+mpi", "metis@5:", "zlib-api", "c", "cxx"):
            self.assertIn(library, [need for need, _ in self.needs])
        self.assertIn(("kokkos+cuda", "+cuda"), self.needs)
        self.assertIn(("kokkos cuda_arch=90", "cuda_arch=90"), self.needs)

    def test_options_are_variables_of_cmake(self):
        known = "".join((ROOT / name).read_text() for name in ("CMakeLists.txt", "cmake/CompileOptions.cmake"))
        for word in self.recipe().cmake_args():
            self.assertIn(re.match(r"-D(\w+)", word)[1], known)

    def test_files_that_must_be_there_are_installed(self):
        rules = (ROOT / "cmake/Install.cmake").read_text()
        for name in self.recipe.sanity_check_is_file:
            stem = pathlib.PurePath(name)
            self.assertTrue({"bin": "TARGETS mpm RUNTIME", "include": "lib/include/mpm", "share": "DIRECTORY inputs"}[stem.parts[0]] in rules, name)
            if stem.parts[0] == "share":
                self.assertTrue((ROOT / "inputs" / stem.name).is_file())


if __name__ == "__main__":
    unittest.main()
