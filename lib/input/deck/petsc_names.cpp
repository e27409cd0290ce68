#include "input/deck/petsc_names.hpp"

#include <algorithm>

#include "common/text.hpp"

namespace mpm {
namespace {

enum class Takes { flag, number, files, words };

/// An option of PETSc that a run passes on. None of them names a file, except for -log_view.
struct Passed {
  const char* name;
  Takes takes;
  const char* words = "";  // with commas
};
constexpr Passed k_passed[] = {
    {"blas_num_threads", Takes::number},
    {"blas_view", Takes::flag},
    {"check_pointer_intensity", Takes::number},
    {"device_enable", Takes::words, "none,lazy,eager"},
    {"device_select", Takes::number},
    {"dm_view", Takes::flag},
    {"error_output_none", Takes::flag},
    {"error_output_stdout", Takes::flag},
    {"fp_trap", Takes::flag},
    {"get_total_flops", Takes::flag},
    {"log_sync", Takes::flag},
    {"log_threshold", Takes::number},
    {"log_view", Takes::files},
    {"log_view_gpu_time", Takes::flag},
    {"log_view_memory", Takes::flag},
    {"malloc_coalesce", Takes::flag},
    {"malloc_debug", Takes::flag},
    {"malloc_dump", Takes::flag},
    {"malloc_hbw", Takes::flag},
    {"malloc_requested_size", Takes::flag},
    {"malloc_test", Takes::flag},
    {"malloc_view", Takes::flag},
    {"malloc_view_threshold", Takes::number},
    {"memory_view", Takes::flag},
    {"mpi_return_on_error", Takes::flag},
    {"no_signal_handler", Takes::flag},
    {"nox", Takes::flag},
    {"nox_warning", Takes::flag},
    {"omp_num_threads", Takes::number},
    {"omp_view", Takes::flag},
    {"on_error_abort", Takes::flag},
    {"on_error_mpiabort", Takes::flag},
    {"options_left", Takes::flag},
    {"options_view", Takes::flag},
    {"sf_monitor", Takes::flag},
    {"sf_use_default_stream", Takes::flag},
    {"sf_use_gpu_aware_mpi", Takes::flag},
    {"skip_petscrc", Takes::flag},
    {"use_gpu_aware_mpi", Takes::flag},
};

const Passed* passed_of(const std::string& name) {
  const auto* found =
      std::find_if(std::begin(k_passed), std::end(k_passed), [&](const Passed& p) { return p.name == name; });
  return found == std::end(k_passed) ? nullptr : found;
}

bool is_one_of(const std::string& value, const std::string& words) {
  const auto all = split(words);
  return std::find(all.begin(), all.end(), lower_case(value)) != all.end();
}

}  // namespace

const std::vector<std::string>& petsc_names() {
  static const std::vector<std::string> names = {"blas_num_threads",
                                                 "blas_view",
                                                 "check_pointer_intensity",
                                                 "checkfunctionlist",
                                                 "checkstack",
                                                 "citations",
                                                 "debug_terminal",
                                                 "debugger_nodes",
                                                 "debugger_ranks",
                                                 "dll_append",
                                                 "dll_prepend",
                                                 "dll_view",
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
                                                 "popen_machine",
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
  // families whose members belong to what a run makes of PETSc, and to its web server
  static const std::vector<std::string> families = {"sf_", "dm_", "saws_", "vecscatter_"};
  const auto begins_name = [&name](const std::string& beginning) { return name.rfind(beginning, 0) == 0; };
  return is_passed_on(name) ||
         std::find(petsc_names().begin(), petsc_names().end(), name) != petsc_names().end() ||
         std::any_of(families.begin(), families.end(), begins_name);
}

bool is_passed_on(const std::string& name) { return passed_of(name) != nullptr; }

std::string petsc_fault(const std::string& name, const std::string& value) {
  const Passed* passed = passed_of(name);
  if (passed == nullptr) return "nothing: this option of PETSc is not passed on";
  switch (passed->takes) {
    case Takes::flag:
      return value.empty() || is_one_of(value, "true,false,yes,no,on,off,1,0") ? "" : "true or false";
    case Takes::number: return parse_number(value) ? "" : "a number";
    case Takes::words:
      return is_one_of(value, passed->words) ? "" : "one of " + join(split(passed->words), ", ");
    default: return "";
  }
}

std::vector<std::string> passed_on_names() {
  std::vector<std::string> names;
  for (const Passed& passed : k_passed) names.emplace_back(passed.name);
  return names;
}

}  // namespace mpm
