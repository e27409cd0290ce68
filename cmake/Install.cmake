# Places of the files that `cmake --install` installs: the program, the library with its public headers, and the package that
# find_package(mpm) reads.

include(CMakePackageConfigHelpers)
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/mpm)

# The program finds libraries of its dependencies that are outside the system's folders.
set_target_properties(mpm PROPERTIES INSTALL_RPATH_USE_LINK_PATH ON)
install(TARGETS mpm RUNTIME)
install(TARGETS mpm_lib mpm_kernels EXPORT mpmTargets ARCHIVE)
install(DIRECTORY lib/include/mpm TYPE INCLUDE FILES_MATCHING PATTERN "*.hpp")
# config.hpp includes these two.
install(FILES kokkos_kernels/base/choices.hpp kokkos_kernels/base/side_kinds.hpp DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/mpm)
install(DIRECTORY inputs DESTINATION ${CMAKE_INSTALL_DATADIR}/mpm FILES_MATCHING PATTERN "*.opts" PATTERN "*.csv" PATTERN "*.stl"
  PATTERN "umat/*.f" PATTERN "umat/*.c" PATTERN "umat/ABA_PARAM.INC")
install(FILES kokkos_kernels/physics/materials/umat_symbols.txt DESTINATION ${CMAKE_INSTALL_DATADIR}/mpm)
# The Python package without the measurements of releases, and its command.
install(DIRECTORY python/soil_mpm DESTINATION ${CMAKE_INSTALL_DATADIR}/mpm/python FILES_MATCHING PATTERN "*.py" PATTERN "py.typed"
  PATTERN "page.css" PATTERN "page.js"
  PATTERN "bench" EXCLUDE PATTERN "__pycache__" EXCLUDE)
install(PROGRAMS scripts/soil-mpm TYPE BIN)
install(FILES scripts/site/modulefile DESTINATION ${CMAKE_INSTALL_DATADIR}/modulefiles/mpm RENAME ${PROJECT_VERSION})
install(FILES README.md LICENSE CHANGELOG.md CITATION.cff TYPE DOC)

# Prefixes of the dependencies, for find_package(mpm). HDF5 that pkg-config found needs none.
cmake_path(GET METIS_INCLUDE_DIR PARENT_PATH METIS_PREFIX)
list(GET ZLIB_INCLUDE_DIRS 0 ZLIB_PREFIX)
cmake_path(GET ZLIB_PREFIX PARENT_PATH ZLIB_PREFIX)
set(HDF5_PREFIX "${HDF5_ROOT}")
if(NOT HDF5_PREFIX)
  set(HDF5_PREFIX "$ENV{HDF5_ROOT}")
endif()
if(NOT HDF5_PREFIX AND HDF5_C_COMPILER_EXECUTABLE)  # h5pcc, in bin
  cmake_path(GET HDF5_C_COMPILER_EXECUTABLE PARENT_PATH HDF5_PREFIX)
  cmake_path(GET HDF5_PREFIX PARENT_PATH HDF5_PREFIX)
endif()
configure_package_config_file(cmake/mpmConfig.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/mpmConfig.cmake
  INSTALL_DESTINATION ${package} PATH_VARS CMAKE_INSTALL_DATADIR)
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/mpmConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(EXPORT mpmTargets NAMESPACE mpm:: DESTINATION ${package})
install(FILES
  ${CMAKE_CURRENT_BINARY_DIR}/mpmConfig.cmake
  ${CMAKE_CURRENT_BINARY_DIR}/mpmConfigVersion.cmake
  cmake/FindPETSc.cmake
  cmake/FindParallelHDF5.cmake
  cmake/FindMETIS.cmake
  DESTINATION ${package})

if(MPM_ARCH STREQUAL "native")
  install(CODE [[message(WARNING
    "This build is for the processor of the machine that compiled it (MPM_ARCH=native). "
    "The preset `install` builds for any processor of its architecture.")]])
endif()
