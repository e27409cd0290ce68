# SPDX-License-Identifier: Apache-2.0

from pathlib import Path

from spack_repo.builtin.build_systems.cmake import CMakePackage, generator
from spack_repo.builtin.build_systems.cuda import CudaPackage

from spack.package import *


class SoilMpm(CMakePackage, CudaPackage):
    """Large deformations of soil by the material point method: explicit GIMP in plane strain
    and 3D, on processors and GPUs by Kokkos, on several ranks by MPI. The program is `mpm`, the
    CMake package is `mpm` with the target `mpm::mpm`."""

    # The recipe is part of the source tree: Spack builds the clone that the recipe lies in.
    git = Path(__file__).resolve().parents[7].as_uri()

    license("Apache-2.0")

    version("main", branch="main")

    variant("openmp", default=True, description="Build the back end for threads")
    variant("tests", default=False, description="Build the unit tests, which --test=root runs")
    # variants cuda and cuda_arch: CudaPackage

    depends_on("c", type="build")
    depends_on("cxx", type="build")
    depends_on("cmake@3.25:", type="build")
    depends_on("pkgconfig", type="build")
    generator("ninja")
    depends_on("catch2@3:", type="build", when="+tests")

    depends_on("mpi")
    depends_on("petsc@3.19: +mpi+double~complex~ml")  # ML brings another Kokkos
    depends_on("hdf5+mpi")
    depends_on("metis@5:")
    depends_on("zlib-api")

    # The program has the back ends of its Kokkos.
    depends_on("kokkos@4.7: +serial cxxstd=20")
    for backend in ("openmp", "cuda"):
        depends_on(f"kokkos+{backend}", when=f"+{backend}")
        depends_on(f"kokkos~{backend}", when=f"~{backend}")

    with when("+cuda"):
        # nvcc from 12.9 on and g++ disagreed on the layout of views in C++20 before 4.7.02.
        depends_on("kokkos@4.7.02: +cmake_lang~wrapper~cuda_relocatable_device_code")
        # A shared Kokkos needs libcuda.so.1 when it is loaded, which login nodes do not have.
        depends_on("kokkos~shared")
        depends_on("kokkos~alloc_async")  # ranks open each other's memory by CUDA IPC
        requires("^kokkos+cuda_lambda", when="^kokkos@4")  # later ones have no such variant
        depends_on("cmake@3.25.2:", type="build")
        depends_on("cuda@12:")
        conflicts("cuda_arch=none", msg="name the GPU, as in cuda_arch=90")
        for arch in CudaPackage.cuda_arch_values:
            depends_on(f"kokkos cuda_arch={arch}", when=f"cuda_arch={arch}")

    conflicts("%gcc@:10", msg="C++20 is needed")

    sanity_check_is_file = [
        join_path("bin", "mpm"),
        join_path("include", "mpm", "simulation.hpp"),
        join_path("share", "mpm", "inputs", "footing_coarse.opts"),
    ]

    def cmake_args(self):
        return [
            self.define_from_variant("MPM_TESTS", "tests"),
            # Spack's compiler wrapper names the processor that the spec is for.
            self.define("MPM_ARCH", ""),
        ]

    def check(self):
        """The unit tests alone: others take hours, or Python packages."""
        if self.spec.satisfies("+tests ~cuda"):  # with CUDA they need a GPU
            Executable(join_path(self.build_directory, "regression", "mpm_unit"))()

    def test_dry_run(self):
        """a deck is read and tried, on the processor"""
        deck = join_path(self.prefix.share, "mpm", "inputs", "footing_coarse.opts")
        mpm = Executable(self.prefix.bin.mpm)
        printed = mpm("-options_file", deck, "-backend", "serial", "-dry_run", output=str.split)
        assert "a dry run: nothing was written" in printed
