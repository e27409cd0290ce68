#include "run/effort.hpp"

#include "output/performance_json.hpp"

namespace mpm {

const char* word_of(Outcome outcome) {
  return outcome == Outcome::finished ? "finished" : outcome == Outcome::stopped ? "stopped" : "failed";
}

Performance performance_of(const Job& job, const Clock& clock, const Effort& effort, const Stepper& stepper) {
  const Config& config = job.config;
  const auto& [since, rebuilds, longest, shortest] = effort.rebuilds;
  Performance p{.stepping = effort.stepping - effort.part.stepping,
                .steps = clock.step - effort.part.step,
                .particles = stepper.particles(),
                .looks = effort.looks,
                .rebuilds = rebuilds,
                .shortest = shortest,
                .longest = longest,
                .interval = rebuilds > 0 ? double(clock.step - since) / rebuilds : 0,
                .strategy = stepper.strategy(),
                .device = device_name(config.backend),
                .bandwidth = effort.bandwidth,
                .version = k_version,
                .outcome = word_of(job.outcome),
                .backend = word_of(config.backend),
                .precision = word_of(config.precision),
                .processor = processor_name(),
                .dim = config.dim,
                .ranks = job.ranks(),
                .threads = thread_count(config.backend),
                .cores = usable_cores(),
                .first_step = effort.part.step,
                .time = clock.time()};
  if (p.steps == 0) return p;
  p.functions = stepper.times();
  p.wall = effort.wall() - effort.part.wall;
  p.memory = double(stepper.memory());
  p.between_ranks = stepper.rank_figures();
  return p;
}

PetscErrorCode report_performance(Job& job, const Performance& p, const Stepper& stepper) {
  PetscFunctionBeginUser;
  if (p.steps > 0) {
    PetscCall(job.log.line(format_performance(p)));
    if (p.between_ranks) PetscCall(job.log.line(format_ranks(*p.between_ranks)));
    if (const std::string batches = stepper.batches_report(); !batches.empty())
      PetscCall(job.log.line(batches));
  }
  const std::string& folder = job.config.output.directory;
  PetscCall(agree(job.comm, job.is_first() ? write_performance_json(folder, p) : PETSC_SUCCESS));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
