# How everything is compiled, for the processor MPM_ARCH.

# errno after sqrt() is read by no one, and keeps loops from being vectorised.
# Contraction to fused multiply-adds is off in strict C++ mode by default.
# Vectors wider than the processor's (lanes.hpp) never pass between object files: no word of their ABI.
set(host_options -fno-math-errno -ffp-contract=fast -Wall -Wno-psabi)
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  # Below 1 GB gcc collects no garbage, which takes a tenth of its time, for 0.5 GB more memory.
  list(APPEND host_options --param=ggc-min-heapsize=1000000)
endif()
if(MPM_ARCH)
  list(APPEND host_options -march=${MPM_ARCH})
endif()
# nvcc writes parentheses and pragmas of its own into the code that it hands to the host compiler.
string(REPLACE ";" "," host_options_of_nvcc "${host_options};-Wno-parentheses;-Wno-unknown-pragmas")
add_compile_options(
  "$<$<COMPILE_LANGUAGE:CXX>:${host_options};-Wextra>"
  # No -Wextra for nvcc: it would speak of the code that nvcc generates.
  # Relaxed: constexpr lambdas of the host may be called by functions of host and device.
  "$<$<COMPILE_LANGUAGE:CUDA>:--expt-relaxed-constexpr;-Xcompiler=${host_options_of_nvcc}>")
# To see that kernels compile takes half as long where nvcc (12.9 on) leaves out most of its optimisation.
if(CMAKE_BUILD_TYPE STREQUAL "Check" AND CMAKE_CUDA_COMPILER)
  include(CheckCompilerFlag)
  check_compiler_flag(CUDA --Ofast-compile=max MPM_HAS_FAST_COMPILE)
  if(MPM_HAS_FAST_COMPILE)
    add_compile_options($<$<COMPILE_LANGUAGE:CUDA>:--Ofast-compile=max>)
  endif()
endif()
if(MPM_SANITIZE)
  add_compile_options(-fsanitize=${MPM_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=undefined)
  add_link_options(-fsanitize=${MPM_SANITIZE})
  if(MPM_FUZZ)
    add_compile_options(-fsanitize=fuzzer-no-link)
  endif()
endif()
# No C++ bindings of MPI: they would have to be linked.
add_compile_definitions(OMPI_SKIP_MPICXX MPICH_SKIP_MPICXX)
# Only what is used is loaded at run time.
add_link_options(LINKER:--as-needed)

if(NOT "float" IN_LIST MPM_REALS)
  add_compile_definitions(MPM_ONLY_DOUBLE)
endif()
if(NOT "3" IN_LIST MPM_DIMS)
  add_compile_definitions(MPM_ONLY_2D)
endif()
if(NOT MPM_OPENMP)
  add_compile_definitions(MPM_NO_OPENMP)
endif()

if(NOT MPM_PROCESSOR)
  if(NOT Kokkos_ENABLE_CUDA)
    message(FATAL_ERROR "MPM_PROCESSOR=OFF leaves no back end: Kokkos in ${Kokkos_DIR} has no CUDA")
  endif()
  add_compile_definitions(MPM_ONLY_CUDA)
endif()

# The headers of others that most sources of a target include, parsed once, which spares a source 1 to 2 s. CMake does not do it for
# what nvcc compiles, so that a build for CUDA shows whether sources of kernels include what they need.
# CMAKE_DISABLE_PRECOMPILE_HEADERS leaves it out.
function(mpm_precompile target)
  if(NOT MPM_KOKKOS_LANGUAGE STREQUAL "CXX")
    list(REMOVE_ITEM ARGN <Kokkos_Core.hpp>)
  endif()
  target_precompile_headers(${target} PRIVATE ${ARGN})
endfunction()
