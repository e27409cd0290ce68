// The program's way from options to results.

#include "mpm/simulation.hpp"

#include <utility>

#include "common/hdf5_handle.hpp"
#include "input/options/options.hpp"
#include "run/element_run.hpp"
#include "run/run.hpp"

namespace mpm {

struct Simulation::Body {
  Job job;
  Run run{job};
  bool ready = false;
  std::function<void()> on_first_step;
};

Simulation::Simulation() : body_(std::make_unique<Body>()) {}
Simulation::~Simulation() = default;
bool Simulation::ready() const { return body_->ready; }
Outcome Simulation::outcome() const { return body_->job.outcome; }
void Simulation::on_first_step(std::function<void()> call) { body_->on_first_step = std::move(call); }

PetscErrorCode Simulation::set_from_options(MPI_Comm comm, const char* prefix, const InputReport& arguments) {
  PetscFunctionBeginUser;
  Job& job = body_->job;
  silence_hdf5();
  keep_hdf5_memory();
  job.comm = comm;
  job.report = arguments;
  PetscCall(read_options(prefix, available_backends(), job.config, job.report));
  if (job.report.help) {
    PetscCall(print_help(comm, job.report));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(body_->run.check());
  body_->ready = job.report.errors.empty();
  if (!body_->ready) {
    if (prefix == nullptr) PetscCall(forget_options(job.report));
    PetscCall(print_errors(comm, job.report));
    job.outcome = Outcome::bad_input;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Simulation::run() {
  PetscFunctionBeginUser;
  PetscCall(is_element(body_->job.config) ? run_element(body_->job)
                                          : body_->run.execute(body_->on_first_step));
  PetscFunctionReturn(PETSC_SUCCESS);
}

std::unique_ptr<InputReport, void (*)(InputReport*)> prepare_arguments(MPI_Comm comm, int* argc,
                                                                       char*** argv) {
  auto report =
      std::unique_ptr<InputReport, void (*)(InputReport*)>(new InputReport, [](InputReport* r) { delete r; });
  prepare_arguments(comm, argc, argv, *report);
  return report;
}

}  // namespace mpm
