# PETSc by pkg-config, as the target PETSc::PETSc. PETSC_HINT names a prefix to look in after all others.
#
# pkg-config searches PKG_CONFIG_PATH and the lib/pkgconfig of CMAKE_PREFIX_PATH.

find_package(PkgConfig QUIET)
if(PKG_CONFIG_FOUND)
  set(_mpm_pkg_config_path "$ENV{PKG_CONFIG_PATH}")
  if(PETSC_HINT)
    set(ENV{PKG_CONFIG_PATH} "${_mpm_pkg_config_path}:${PETSC_HINT}/lib/pkgconfig")
  endif()
  set(_mpm_petsc_version ${PETSc_FIND_VERSION})
  if(NOT _mpm_petsc_version)
    set(_mpm_petsc_version 0)
  endif()
  pkg_search_module(PETSC QUIET IMPORTED_TARGET PETSc>=${_mpm_petsc_version} petsc>=${_mpm_petsc_version})
  set(ENV{PKG_CONFIG_PATH} "${_mpm_pkg_config_path}")
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(PETSc REQUIRED_VARS PETSC_LINK_LIBRARIES VERSION_VAR PETSC_VERSION)

if(PETSc_FOUND AND NOT TARGET PETSc::PETSc)
  add_library(PETSc::PETSc INTERFACE IMPORTED)
  target_link_libraries(PETSc::PETSc INTERFACE PkgConfig::PETSC)
  if(PETSC_LINK_LIBRARIES MATCHES "libpetsc[^;]*\\.a")  # what a static library needs is not in its file
    target_link_libraries(PETSc::PETSc INTERFACE ${PETSC_STATIC_LDFLAGS})
  endif()
endif()
