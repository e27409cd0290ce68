// `-p2g auto`: every strategy makes the first steps on a copy of the problem, and the fastest makes the run.
// What was found is kept for problems of the same size on the same device, so that the same options give the
// same strategy again, and with it the same bits.

#include <cmath>
#include <optional>

#include "output/remembered.hpp"
#include "parallel/together.hpp"
#include "simulation_body.hpp"
#include "trial.hpp"

namespace mpm {
namespace {

/// What trials of another number found does not count: raise it when a trial measures something else.
constexpr int k_trial = 2;

/// Those worth trying: `sequential` is one thread, `atomic` on one thread a slower `sequential`.
std::vector<P2G> candidates(Backend backend) {
  std::vector<P2G> all = {P2G::tile, P2G::gather, P2G::mosaic};
  all.push_back(backend == Backend::serial ? P2G::sequential : P2G::atomic);
  return all;
}

/// Tries one strategy; adds what it took to `told`. A strategy whose lists do not fit into memory is left
/// out.
std::optional<double> try_strategy(const Config& config, MPI_Comm comm, Model model, double dt,
                                   std::string* told) {
  const auto stepper = make_stepper(config, comm);
  Failure failure;
  if (stepper->set_up(std::move(model), &failure) != PETSC_SUCCESS || !failure.what.empty())
    return std::nullopt;
  const auto seconds =
      time_of_steps([&](long steps, Batch* batch) { return stepper->advance(steps, dt, batch); });
  if (seconds)
    *told +=
        formatted("%s%s %.4g us", told->empty() ? "" : ", ", stepper->strategy().c_str(), 1e6 * *seconds);
  return seconds;
}

}  // namespace

PetscErrorCode Simulation::Body::choose_strategy(const Model& model, const std::string& device) {
  PetscFunctionBeginUser;
  std::size_t coordinates = 1;
  for (const BodyParticles& body : model.bodies) coordinates += body.position.size();
  const int size = static_cast<int>(std::lround(std::log2(double(coordinates) / config.dim)));
  const int ranks = size_of(comm);
  const std::string key =
      formatted("mpm %s, trial %d, %s, %s, %dD, 2^%d particles", k_version, k_trial, device.c_str(),
                config.precision == Precision::single ? "single" : "double", config.dim, size) +
      (ranks > 1 ? formatted(", %d ranks", ranks) : "");
  std::string told;
  const auto fastest = [&] {
    Config trial = config;
    std::pair<double, P2G> best{0, P2G::automatic};
    PetscPushErrorHandler(PetscReturnErrorHandler, nullptr);  // what a trial cannot do, the run may
    for (const P2G strategy : candidates(config.backend)) {
      trial.p2g.strategy = strategy;
      const auto seconds = try_strategy(trial, comm, model, dt, &told);
      if (seconds && (best.second == P2G::automatic || *seconds < best.first)) best = {*seconds, strategy};
    }
    PetscPopErrorHandler();
    return best.second == P2G::automatic ? 0.0 : 1.0 + static_cast<int>(best.second);
  };
  double kept = 0;  // what rank 0 remembers; if it does not, all try
  if (rank_of(comm) == 0) kept = remembered("fastest_strategy", key, [] { return 0.0; });
  PetscCall(share_numbers(comm, 1, &kept));
  if (kept == 0) {
    kept = fastest();
    PetscCall(share_numbers(comm, 1, &kept));
    if (rank_of(comm) == 0) remembered("fastest_strategy", key, [&] { return kept; });
  }
  if (kept >= 1 && kept <= static_cast<int>(P2G::automatic))
    config.p2g.strategy = static_cast<P2G>(int(kept) - 1);
  if (!told.empty())
    PetscCall(log.line("strategies on the first steps: " + told + " a step; the fastest is kept"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
