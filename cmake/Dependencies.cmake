# What mpm stands on, as targets:
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
  set(CMAKE_CUDA_RUNTIME_LIBRARY Static)
  enable_language(CUDA)
  if(NOT CMAKE_CUDA20_STANDARD_COMPILE_OPTION)  # CMake before 3.25.2 does not know nvcc's C++20
    set(CMAKE_CUDA20_STANDARD_COMPILE_OPTION -std=c++20)
    list(APPEND CMAKE_CUDA_COMPILE_FEATURES cuda_std_20)
  endif()
endif()

# Adds sources that include Kokkos to a target.
function(mpm_kokkos_sources target)
  target_sources(${target} PRIVATE ${ARGN})
  set_source_files_properties(${ARGN} PROPERTIES LANGUAGE ${MPM_KOKKOS_LANGUAGE})
endfunction()

find_package(MPI REQUIRED COMPONENTS C)

find_package(PkgConfig REQUIRED)
pkg_search_module(PETSC REQUIRED IMPORTED_TARGET GLOBAL PETSc>=3.19 petsc>=3.19)
add_library(PETSc::PETSc ALIAS PkgConfig::PETSC)
if(PETSC_LINK_LIBRARIES MATCHES "libpetsc[^;]*\\.a")
  target_link_libraries(PkgConfig::PETSC INTERFACE ${PETSC_STATIC_LDFLAGS})
endif()

# Debian's parallel HDF5 is known to pkg-config; others by find_package.
if(NOT HDF5_ROOT AND NOT DEFINED ENV{HDF5_ROOT})
  pkg_search_module(HDF5 QUIET IMPORTED_TARGET GLOBAL hdf5-openmpi hdf5-mpich)
endif()
if(TARGET PkgConfig::HDF5)
  add_library(HDF5::HDF5 ALIAS PkgConfig::HDF5)
else()
  set(HDF5_PREFER_PARALLEL ON)
  find_package(HDF5 REQUIRED COMPONENTS C)
  if(NOT HDF5_IS_PARALLEL)
    message(FATAL_ERROR "HDF5 in ${HDF5_INCLUDE_DIRS} is not parallel; name another by HDF5_ROOT")
  endif()
endif()

find_package(ZLIB REQUIRED)  # HDF5 stands on it too

find_path(METIS_INCLUDE_DIR metis.h HINTS ${METIS_ROOT} ENV METIS_ROOT PATH_SUFFIXES include REQUIRED)
find_library(METIS_LIBRARY metis HINTS ${METIS_ROOT} ENV METIS_ROOT PATH_SUFFIXES lib REQUIRED)
add_library(METIS::METIS UNKNOWN IMPORTED)
set_target_properties(METIS::METIS PROPERTIES
  IMPORTED_LOCATION ${METIS_LIBRARY} INTERFACE_INCLUDE_DIRECTORIES ${METIS_INCLUDE_DIR})

if(MPM_TESTS)
  find_package(Catch2 3 REQUIRED CONFIG)
endif()
