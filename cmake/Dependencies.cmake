# Libraries that mpm uses, as targets:
#   Kokkos::kokkos  PETSc::PETSc  MPI::MPI_C  HDF5::HDF5  METIS::METIS  ZLIB::ZLIB  Catch2::Catch2
# `scripts/setup` installs what is missing; <Package>_ROOT and CMAKE_PREFIX_PATH steer the search.

find_package(Kokkos 4.7 REQUIRED CONFIG)
# Kokkos' language: sources that see it go through nvcc when it was built as CUDA.
if(Kokkos_ENABLE_COMPILE_AS_CMAKE_LANGUAGE)
  set(MPM_KOKKOS_LANGUAGE ${Kokkos_COMPILE_LANGUAGE})
else()
  set(MPM_KOKKOS_LANGUAGE CXX)
endif()
if(MPM_KOKKOS_LANGUAGE STREQUAL CUDA)
  set(CMAKE_CUDA_ARCHITECTURES ${Kokkos_CUDA_ARCHITECTURES})
  if(CMAKE_BUILD_TYPE STREQUAL Check)  # to compile, not to run: PTX alone
    list(TRANSFORM CMAKE_CUDA_ARCHITECTURES APPEND -virtual)
  endif()
  set(CMAKE_CUDA_RUNTIME_LIBRARY Static)
  enable_language(CUDA)
  # nvcc's -O is for the code of the processor alone, and each source has its own.
  string(REPLACE "-O3" "" CMAKE_CUDA_FLAGS_RELEASE "${CMAKE_CUDA_FLAGS_RELEASE}")
  if(NOT CMAKE_CUDA20_STANDARD_COMPILE_OPTION)  # CMake before 3.25.2 has no option for nvcc's C++20
    set(CMAKE_CUDA20_STANDARD_COMPILE_OPTION -std=c++20)
    list(APPEND CMAKE_CUDA_COMPILE_FEATURES cuda_std_20)
  endif()
endif()

# nvcc from 12.9 on and g++ lay out the members of Kokkos' mdspan differently in C++20 (test cuda.view_layout), and
# kernels then read wrong extents. Kokkos avoids it from 4.7.02 on.
if(Kokkos_ENABLE_CUDA AND Kokkos_VERSION VERSION_LESS 4.7.02 AND IMPL_MDSPAN IN_LIST Kokkos_OPTIONS
    AND NOT CMAKE_CUDA_COMPILER_VERSION VERSION_LESS 12.9)
  message(FATAL_ERROR "Kokkos ${Kokkos_VERSION} in ${Kokkos_DIR} has a fault with this CUDA: take 4.7.02 or newer, "
    "or build it with -DKokkos_ENABLE_IMPL_MDSPAN=OFF")
endif()

# Adds sources that include Kokkos to a target. Those that nvcc compiles get -O3: the processor runs a step's loops in them.
function(mpm_kokkos_sources target)
  target_sources(${target} PRIVATE ${ARGN})
  set_source_files_properties(${ARGN} PROPERTIES LANGUAGE ${MPM_KOKKOS_LANGUAGE})
  if(MPM_KOKKOS_LANGUAGE STREQUAL CUDA)
    set_source_files_properties(${ARGN} PROPERTIES COMPILE_OPTIONS "$<$<CONFIG:Release>:-O3>")
  endif()
endfunction()

# As mpm_kokkos_sources, for a group of sources that take little of a step. nvcc takes 20 s to read Kokkos' headers; it compiles the group as one
# file, <target>_<group>.cpp in the build folder. (UNITY_BUILD of CMake 3.25 does not take CUDA.) Other compilers compile each
# source. No two sources of a group may define the same name in unnamed namespaces.
# The host compiler then gets little else than code that launches kernels; -O3 would take over twice as long as -Og.
function(mpm_kokkos_group target group)
  if(NOT MPM_KOKKOS_LANGUAGE STREQUAL CUDA)
    mpm_kokkos_sources(${target} ${ARGN})
    return()
  endif()
  set(text "")
  foreach(source IN LISTS ARGN)
    string(APPEND text "#undef MPM_INSTANTIATE\n#undef MPM_STRATEGY\n#include \"${CMAKE_CURRENT_SOURCE_DIR}/${source}\"\n")
  endforeach()
  set(together ${CMAKE_CURRENT_BINARY_DIR}/${target}_${group}.cpp)
  file(CONFIGURE OUTPUT ${together} CONTENT "${text}" @ONLY)
  mpm_kokkos_sources(${target} ${together})
  set_source_files_properties(${together} PROPERTIES COMPILE_OPTIONS "$<$<CONFIG:Release>:-Xcompiler=-Og>")
endfunction()

find_package(MPI REQUIRED COMPONENTS C)

# Found by modules beside this file, which are installed for the users of the library.
find_package(PETSc 3.19 REQUIRED)
find_package(ParallelHDF5 REQUIRED)
find_package(ZLIB REQUIRED)  # HDF5 stands on it too
find_package(METIS REQUIRED)

if(MPM_TESTS)
  find_package(Catch2 3 REQUIRED CONFIG)
endif()
