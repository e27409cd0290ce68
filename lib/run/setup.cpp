#include "run/setup.hpp"

#include <unistd.h>

#include <filesystem>

#include "check/warnings_soil.hpp"
#include "common/text.hpp"
#include "input/deck/run_options.hpp"
#include "output/files.hpp"
#include "output/performance_json.hpp"
#include "step/stepper.hpp"

namespace mpm {

PetscErrorCode lock_folder(Job& job) {
  PetscFunctionBeginUser;
  std::string other;
  const std::string& folder = job.config.output.directory;
  std::error_code error;
  const bool due = job.is_first() && std::filesystem::is_directory(folder, error) &&
                   ::access(folder.c_str(), W_OK | X_OK) == 0;
  PetscCall(agree(job.comm, due ? job.lock.take(folder, &other) : PETSC_SUCCESS));
  PetscCall(share_text(job.comm, &other));
  if (!other.empty())
    job.report.errors = {"mpm: -output_dir: given \"" + folder +
                         "\", takes a folder that no other run has; this one has " + other};
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode take_folder(Job& job) {
  PetscFunctionBeginUser;
  PetscCall(agree(job.comm, job.is_first() ? make_folder(job.config.output.directory) : PETSC_SUCCESS));
  PetscCall(lock_folder(job));
  if (!job.report.errors.empty()) {
    PetscCall(print_errors(job.comm, job.report));
    job.outcome = Outcome::bad_input;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode begin_log(Job& job) {
  PetscFunctionBeginUser;
  const Backend backend = job.config.backend;
  PetscCall(job.log.start(job.comm, job.config.output.progress));
  PetscCall(
      job.log.line(format_header(k_version, kokkos_version(),
                                 std::string(word_of(backend)) + ", " + device_name(backend), job.ranks())));
  for (const std::string& warning : job.report.warnings) PetscCall(job.log.line(warning));
  if (const std::string note = note_of_touching(job.config); !note.empty()) PetscCall(job.log.line(note));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode open_folder(Job& job, bool goes_on) {
  PetscFunctionBeginUser;
  Log& log = job.log;
  const InputReport& report = job.report;
  const std::string& folder = job.config.output.directory;
  const bool first = job.is_first();
  int removed = 0;
  PetscCall(agree(job.comm, !first    ? PETSC_SUCCESS
                            : goes_on ? forget_performance_json(folder)
                                      : prepare_output_folder(folder, &removed)));
  PetscCall(place_log_view(report, folder));
  PetscCall(agree(job.comm, log.open(folder, goes_on)));
  if (!job.lock.left_by().empty())
    PetscCall(log.line("the lock of the folder was left by " + job.lock.left_by() + ", which is gone"));
  if (removed > 0)
    PetscCall(log.print("%d files of an earlier run were removed from %s", removed, folder.c_str()));
  std::vector<EffectiveOption> options = report.options;
  options.insert(options.end(), report.stage_options.begin(), report.stage_options.end());
  PetscCall(log.line("options in force\n" + format_options(options)));
  PetscCall(agree(job.comm, first ? write_options_json(folder, k_version, options) : PETSC_SUCCESS));
  PetscFunctionReturn(PETSC_SUCCESS);
}

std::string device_key(Backend backend) {
  const std::string processor = backend == Backend::cuda ? "" : processor_name();
  return formatted("%s, %s %s", word_of(backend), device_name(backend).c_str(), processor.c_str());
}

}  // namespace mpm
