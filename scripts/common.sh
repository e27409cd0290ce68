# Shared by run and test: set up, choose a preset, build it.

set -euo pipefail
source_dir=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

environment=$("$source_dir/scripts/setup" --print-env) || exit 1
eval "$environment"

# Open MPI refuses root (containers) and more ranks than cores (tests) unless allowed.
if [ "$(id -u)" = 0 ]; then export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1; fi
export OMPI_MCA_rmaps_base_oversubscribe=${OMPI_MCA_rmaps_base_oversubscribe:-1}
# Where threads of several ranks share the cores, binding would put them all on the first ones.
export OMP_PROC_BIND=${OMP_PROC_BIND:-false}

cmake_options=()  # what a script sets beside the preset

has_cuda() { [ -n "$MPM_KOKKOS_CUDA" ]; }
has_gpu() { has_cuda && nvidia-smi -L >/dev/null 2>&1; }

# build PRESET [cmake's options]: its output goes to a log, of which the end is shown if it fails
build() {
  local preset=$1 dir=$source_dir/build/$1 log=$source_dir/build/$1.log fresh=
  shift
  mkdir -p "$dir"
  # CMake remembers where it found things: with other dependencies it has to start afresh.
  if ! echo "$environment" | cmp -s - "$dir/dependencies"; then fresh=--fresh; fi
  echo "Building $preset (output in $log)"
  if ! { cmake $fresh -S "$source_dir" --preset "$preset" "${cmake_options[@]}" && echo "$environment" >"$dir/dependencies" &&
         cmake --build "$dir" "$@"; } >"$log" 2>&1; then
    tail -n 40 "$log" >&2
    echo "The build failed; all of its output is in $log" >&2
    exit 1
  fi
}
