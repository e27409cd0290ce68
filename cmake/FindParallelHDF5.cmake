# HDF5 with MPI, as the target HDF5::HDF5. HDF5_ROOT names its prefix.
#
# Debian's parallel HDF5 is known to pkg-config and lies where find_package(HDF5) finds the serial one first.

if(NOT TARGET HDF5::HDF5 AND NOT HDF5_ROOT AND NOT DEFINED ENV{HDF5_ROOT})
  find_package(PkgConfig QUIET)
  if(PKG_CONFIG_FOUND)
    pkg_search_module(MPM_HDF5 QUIET IMPORTED_TARGET hdf5-openmpi hdf5-mpich)
  endif()
  if(TARGET PkgConfig::MPM_HDF5)
    add_library(HDF5::HDF5 INTERFACE IMPORTED)
    target_link_libraries(HDF5::HDF5 INTERFACE PkgConfig::MPM_HDF5)
    set(ParallelHDF5_LIBRARIES ${MPM_HDF5_LINK_LIBRARIES})
  endif()
endif()
if(NOT TARGET PkgConfig::MPM_HDF5)
  set(HDF5_PREFER_PARALLEL ON)
  find_package(HDF5 QUIET COMPONENTS C)
  if(HDF5_FOUND AND HDF5_IS_PARALLEL)
    set(ParallelHDF5_LIBRARIES ${HDF5_LIBRARIES})
  elseif(HDF5_FOUND)
    set(ParallelHDF5_NOT_FOUND_MESSAGE
      "HDF5 in ${HDF5_INCLUDE_DIRS} is not parallel; name another by HDF5_ROOT")
  endif()
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(ParallelHDF5 REQUIRED_VARS ParallelHDF5_LIBRARIES
  REASON_FAILURE_MESSAGE "${ParallelHDF5_NOT_FOUND_MESSAGE}")
