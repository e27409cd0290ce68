#include "input/petsc_names.hpp"

#include <algorithm>

namespace mpm {

const std::vector<std::string>& petsc_names() {
  static const std::vector<std::string> names = {"blas_num_threads",
                                                 "blas_view",
                                                 "check_pointer_intensity",
                                                 "checkfunctionlist",
                                                 "checkstack",
                                                 "citations",
                                                 "debug_terminal",
                                                 "debugger_ranks",
                                                 "error_output_none",
                                                 "error_output_stdout",
                                                 "fp_trap",
                                                 "get_total_flops",
                                                 "h",
                                                 "help",
                                                 "history",
                                                 "info",
                                                 "log",
                                                 "log_all",
                                                 "log_mpe",
                                                 "log_nvtx",
                                                 "log_perfstubs",
                                                 "log_roctx",
                                                 "log_sync",
                                                 "log_threshold",
                                                 "log_trace",
                                                 "log_view",
                                                 "log_view_memory",
                                                 "log_view_gpu_time",
                                                 "log_exclude",
                                                 "log_include",
                                                 "malloc",
                                                 "malloc_coalesce",
                                                 "malloc_debug",
                                                 "malloc_dump",
                                                 "malloc_hbw",
                                                 "malloc_requested_size",
                                                 "malloc_test",
                                                 "malloc_view",
                                                 "malloc_view_threshold",
                                                 "memory_view",
                                                 "mpidump",
                                                 "mpi_return_on_error",
                                                 "no_signal_handler",
                                                 "nox",
                                                 "nox_warning",
                                                 "objects_dump",
                                                 "omp_num_threads",
                                                 "omp_view",
                                                 "on_error_abort",
                                                 "on_error_attach_debugger",
                                                 "on_error_emacs",
                                                 "on_error_mpiabort",
                                                 "options_left",
                                                 "options_monitor",
                                                 "options_monitor_cancel",
                                                 "options_suppress_deprecated_warnings",
                                                 "options_view",
                                                 "petsc_ci",
                                                 "petsc_ci_portable_error_output",
                                                 "petsc_sleep",
                                                 "process_view",
                                                 "skip_petscrc",
                                                 "stack_view",
                                                 "start_in_debugger",
                                                 "stop_for_debugger",
                                                 "use_gpu_aware_mpi",
                                                 "version",
                                                 "viewfromoptions"};
  return names;
}

bool is_petsc_name(const std::string& name) {
  // families whose members belong to PETSc objects that a run makes
  static const std::vector<std::string> families = {"sf_", "dm_", "device_", "cuda_", "vecscatter_"};
  const auto begins_name = [&name](const std::string& beginning) { return name.rfind(beginning, 0) == 0; };
  return std::find(petsc_names().begin(), petsc_names().end(), name) != petsc_names().end() ||
         std::any_of(families.begin(), families.end(), begins_name);
}

}  // namespace mpm
