// Every strategy makes the first steps on a copy of the problem, and the fastest makes the run.
// A clear result is kept for problems of the same size on the same device, so that the same options give the
// same strategy again, and with it the same bits.

#include "run/choose_strategy.hpp"

#include <stdlib.h>
#include <unistd.h>

#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "check/memory_need.hpp"
#include "common/text.hpp"
#include "output/measurement_cache.hpp"
#include "run/autotune.hpp"
#include "run/strategy_choice.hpp"

namespace mpm {
namespace {

/// Version of the autotune: results of another version do not count. Raise it when the autotune measures
/// something else.
constexpr int k_autotune = 3;

/// Strategies worth trying; a tie goes to the first. `sequential` uses one thread; on one thread `atomic` is
/// a slower `sequential`.
std::vector<P2G> candidates(Backend backend) {
  std::vector<P2G> all = {P2G::tile, P2G::gather, P2G::mosaic};
  all.push_back(backend == Backend::serial ? P2G::sequential : P2G::atomic);
  return all;
}

/// Processes that wanted to run, of the last minute, per core of the machine; 0 where the machine does not
/// report it.
double machine_load() {
  double load = 0;
  const long cores = ::sysconf(_SC_NPROCESSORS_ONLN);
  return ::getloadavg(&load, 1) == 1 && cores > 0 ? load / cores : 0;
}

/// A strategy in the autotune, with a copy of the problem.
class Contestant {
 public:
  Contestant(const Config& config, MPI_Comm comm, P2G strategy) : config_(config), comm_(comm) {
    config_.p2g.strategy = strategy;
    times.strategy = strategy;
  }

  /// Makes the contestant's copy of the problem. The strategy leaves the autotune where that fails, for
  /// example because its lists do not fit into memory.
  void set_up(Model model) {
    stepper_ = make_stepper(config_, comm_);
    Failure failure;
    out_ = stepper_->set_up(std::move(model), &failure) != PETSC_SUCCESS || !failure.what.empty();
    name = stepper_->strategy();
    if (out_) stepper_.reset();
  }

  /// Steps from where the last round ended; what a rebuild takes does not count.
  void try_steps(double dt) {
    if (out_) return;
    const auto seconds = time_of_steps([&](long steps, Batch* batch) -> PetscErrorCode {
      Failure failure;
      out_ = due_ && (stepper_->rebuild(0, &failure) != PETSC_SUCCESS || !failure.what.empty());
      if (out_) return PETSC_ERR_LIB;
      const PetscErrorCode error = stepper_->advance({.count = steps, .dt = dt}, batch);
      due_ = batch->rebuild;
      spent += batch->seconds;
      out_ = error != PETSC_SUCCESS || !batch->failure.what.empty();
      return error;
    });
    if (seconds) times.seconds.push_back(*seconds);
  }

  bool wants_copy() const { return !stepper_ && !out_; }
  std::size_t memory() const { return stepper_ ? stepper_->memory() : 0; }
  void let_go() {
    stepper_.reset();
    due_ = false;
  }

  AutotuneTimes times;
  std::string name;  // its word
  double spent = 0;  // s, in all its rounds

 private:
  Config config_;
  MPI_Comm comm_;
  std::unique_ptr<Stepper> stepper_;
  bool due_ = false, out_ = false;
};

/// Do the copies of all contestants fit beside one another? If not, each is made anew in each round.
bool room_for_all(const Contestant& one, std::size_t count, Backend backend, MPI_Comm comm) {
  double enough = 2.0 * one.memory() * count * size_of(comm) < free_memory(backend);
  return share_numbers(comm, 1, &enough) == PETSC_SUCCESS && enough != 0;
}

/// Rounds in which every strategy has its turn, so that what else the machine does meets all of them. They
/// end once the times decide clearly, or after so many that they will not.
std::vector<Contestant> try_all(const Config& config, MPI_Comm comm, const Model& model, double dt) {
  constexpr int k_fewest = 3, k_most = 7;
  constexpr double k_enough = 5;  // s
  std::vector<Contestant> all;
  for (const P2G strategy : candidates(config.backend)) all.emplace_back(config, comm, strategy);
  bool keep = true, decided = false;
  std::vector<AutotuneTimes> times;
  for (int round = 0; round < k_most && !(decided && round >= k_fewest); ++round) {
    const std::vector<AutotuneTimes> before = std::exchange(times, {});
    double spent = 0;
    for (Contestant& each : all) {
      if (!is_beaten(each.times, before)) {
        if (each.wants_copy()) each.set_up(model);
        if (round == 0 && &each == &all.front()) keep = room_for_all(each, all.size(), config.backend, comm);
        each.try_steps(dt);
        if (!keep) each.let_go();
      }
      times.push_back(each.times);
      spent += each.spent;
    }
    decided = !keep || spent > k_enough || choose_by_times(times, 0).clear;
  }
  return all;
}

/// "tile 12.1 us, gather 14 us": the fastest round of each.
std::string figures_of(const std::vector<Contestant>& all) {
  std::string text;
  for (const Contestant& each : all)
    if (!each.times.seconds.empty())
      text += formatted("%s%s %.4g us", text.empty() ? "" : ", ", each.name.c_str(),
                        1e6 * least_of(each.times.seconds));
  return text;
}

/// Text of the log on a choice.
std::string report_choice(const StrategyChoice& choice, const std::vector<Contestant>& all, double load) {
  std::string text = "strategies on the first steps: " + figures_of(all) + " a step; ";
  for (const Contestant& each : all)
    if (each.times.strategy == choice.strategy) text += each.name;
  if (choice.clear) return text + " is taken, and kept for problems of this size";
  return text + " is taken for this run only: " +
         (load > k_busy ? formatted("the machine is busy (%.3g processes a core)", load)
                        : std::string("the times differ too much from round to round"));
}

}  // namespace

PetscErrorCode choose_strategy(Job& job, const Model& model, double dt, const std::string& device) {
  PetscFunctionBeginUser;
  const Config& config = job.config;
  const MPI_Comm comm = job.comm;
  std::size_t coordinates = 1;
  for (const BodyParticles& body : model.bodies) coordinates += body.position.size();
  const int size = static_cast<int>(std::lround(std::log2(double(coordinates) / config.dim)));
  const int ranks = job.ranks();
  const std::string key =
      formatted("mpm %s, trial %d, %s, %s, %dD, 2^%d particles", k_version, k_autotune, device.c_str(),
                config.precision == Precision::single ? "single" : "double", config.dim, size) +
      (ranks > 1 ? formatted(", %d ranks", ranks) : "");
  const bool first = job.is_first();
  double load = machine_load();
  double kept = first ? cached_measurement("fastest_strategy", key, [] { return 0.0; }) : 0;
  PetscCall(share_numbers(comm, 1, &kept));  // what rank 0 remembers; if it does not, all try
  PetscCall(share_numbers(comm, 1, &load));
  if (kept == 0) {
    PetscPushErrorHandler(PetscReturnErrorHandler, nullptr);  // what the autotune cannot do, the run may
    const std::vector<Contestant> all = try_all(config, comm, model, dt);
    PetscPopErrorHandler();
    std::vector<AutotuneTimes> times;
    for (const Contestant& each : all) times.push_back(each.times);
    const StrategyChoice choice = choose_by_times(times, load);
    if (choice.strategy != P2G::automatic) {
      kept = 1.0 + static_cast<int>(choice.strategy);
      PetscCall(job.log.line(report_choice(choice, all, load)));
    }
    PetscCall(share_numbers(comm, 1, &kept));
    if (first && choice.clear) cached_measurement("fastest_strategy", key, [&] { return kept; });
  }
  if (kept >= 1 && kept <= static_cast<int>(P2G::automatic))
    job.config.p2g.strategy = static_cast<P2G>(int(kept) - 1);
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
