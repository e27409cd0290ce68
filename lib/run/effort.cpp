#include "run/effort.hpp"

#include <optional>
#include <string>

#include "output/performance_json.hpp"

namespace mpm {

const char* word_of(Outcome outcome) {
  return outcome == Outcome::finished ? "finished" : outcome == Outcome::stopped ? "stopped" : "failed";
}

namespace {

/// Energy [J] of the processors of all machines since the part began: one rank of each machine counts it.
/// None where one of them has no counters. Collective.
std::optional<double> energy_of(MPI_Comm comm, Effort& effort) {
  MPI_Comm machine;
  MPI_Comm_split_type(comm, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine);
  int rank = 0;
  MPI_Comm_rank(machine, &rank);
  MPI_Comm_free(&machine);
  effort.energy.read();
  double sums[2] = {rank == 0 ? effort.energy.joules() - effort.part.joules : 0,
                    rank == 0 && !effort.energy.found() ? 1.0 : 0.0};
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, comm);
  return sums[1] > 0 ? std::nullopt : std::optional(sums[0]);
}

/// Whether no rank of this machine before this one uses the same GPU. Collective on the machine.
bool is_first_of_gpu(MPI_Comm machine, const std::string& bus) {
  constexpr int k_length = 32;  // of a place on PCI
  int rank = 0, size = 1;
  MPI_Comm_rank(machine, &rank);
  MPI_Comm_size(machine, &size);
  std::string own = bus, all(std::size_t(size) * k_length, '\0');
  own.resize(k_length);
  MPI_Allgather(own.data(), k_length, MPI_CHAR, all.data(), k_length, MPI_CHAR, machine);
  for (int other = 0; other < rank; ++other)
    if (all.compare(std::size_t(other) * k_length, k_length, own) == 0) return false;
  return true;
}

/// Energy [J] of the GPUs of all machines since the part began: one rank of each GPU counts it. None on a
/// processor, and where one of the GPUs has no counter. Collective.
std::optional<double> gpu_energy_of(MPI_Comm comm, Backend backend, Effort& effort) {
  if (backend != Backend::cuda) return std::nullopt;
  MPI_Comm machine;
  MPI_Comm_split_type(comm, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine);
  const bool counts = is_first_of_gpu(machine, effort.gpu_bus);
  MPI_Comm_free(&machine);
  double sums[2] = {counts ? effort.gpu.joules() - effort.part.gpu : 0, effort.gpu.found() ? 0.0 : 1.0};
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, comm);
  return sums[1] > 0 ? std::nullopt : std::optional(sums[0]);
}

}  // namespace

Performance performance_of(const Job& job, const Clock& clock, Effort& effort, const Stepper& stepper) {
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
                .time = clock.time(),
                .simulated = clock.time() - effort.part.time,
                .energy = energy_of(job.comm, effort),
                .gpu_energy = gpu_energy_of(job.comm, config.backend, effort)};
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
