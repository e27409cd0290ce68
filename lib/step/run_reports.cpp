#include "step/run_reports.hpp"

#include <algorithm>
#include <cstdio>

#include "base/copy.hpp"
#include "common/material_table.hpp"
#include "common/text.hpp"
#include "data/state_memory.hpp"
#include "physics/materials/any.hpp"
#include "step/bytes_moved.hpp"

namespace mpm {
namespace {

const char* words_of(FaultKind kind, const char* of_law) {
  switch (kind) {
    case FaultKind::outside: return "is outside the mesh";
    case FaultKind::not_finite: return "has a position, velocity, stress or volume that is not finite";
    case FaultKind::volume: return "has left 0.2 to 2 times its volume at the start (-stray_particles stop)";
    case FaultKind::porosity:
      return "has a porosity beyond 0.02 to 0.98, where soil is no porous medium: it has strained too much";
    case FaultKind::law: return of_law;
    case FaultKind::state: return "has a state variable of its law that is not finite";
    case FaultKind::alone: return "is alone, with no other soil in reach (-stray_particles stop)";
    default: return "moved more than a cell in one step";
  }
}

}  // namespace

template <class Space, class T, int Dim>
Failure RunReports<Space, T, Dim>::failure_of(const Fault& fault) const {
  if (fault.kind == FaultKind::none) return {};
  const Config& config = run_.config;
  std::string who;
  const char* of_law = "";
  if (fault.particle < 0) {
    who = "rigid " + config.rigids[-1 - fault.particle].name;
    of_law = "cannot move so that its joints hold; a shorter step (-time_step) may help";
  } else {
    const bool of_start = fault.particle < ids_.at_start();
    const std::size_t b = of_start ? ids_.body_of(fault.particle) : body_of(fault.particle);
    const long number = of_start ? fault.particle - ids_.first(b) : fault.particle;
    who = "particle " + std::to_string(number) + " of body " + config.bodies[b].name;
    of_law = mpm::failure_of(model_index(config.materials[config.bodies[b].material].model));
  }
  char where[120];
  const double* x = fault.position;
  const Vec3& low = config.mesh.lower;
  if (Dim == 2)
    std::snprintf(where, sizeof where, " at (%.9g, %.9g) m ", x[0] + low[0], x[1] + low[1]);
  else
    std::snprintf(where, sizeof where, " at (%.9g, %.9g, %.9g) m ", x[0] + low[0], x[1] + low[1],
                  x[2] + low[2]);
  return {who + where + words_of(fault.kind, of_law)};
}

template <class Space, class T, int Dim>
std::size_t RunReports<Space, T, Dim>::body_of(int id) const {
  const auto& soil = run_.state.soil.points;
  const auto held = Kokkos::make_pair(0, soil.count);
  const auto ids = mirror_of(Kokkos::subview(soil.id, held));
  const auto body = mirror_of(Kokkos::subview(soil.body, held));
  for (int p = 0; p < soil.count; ++p)
    if (ids(p) == id) return body(p);
  return 0;
}

template <class Space, class T, int Dim>
Failure RunReports<Space, T, Dim>::failure_of_limit() const {
  const auto& b = run_.state.batches;
  if (b.limit >= b.least) return {};
  constexpr double k_above = 1.0005;  // so that the limit in the message is enough
  return {formatted("-device_memory_limit: given %.4g GiB, takes at least %.4g GiB for these particles",
                    b.limit / k_gib, k_above * b.least / k_gib)};
}

template <class Space, class T, int Dim>
std::vector<FunctionTime> RunReports<Space, T, Dim>::times(const Timers& timers) const {
  std::vector<FunctionTime> times;
  for (int n = 0; n < k_functions; ++n) {
    const StepPhase f = static_cast<StepPhase>(n);
    const bool seldom = f == StepPhase::persistent || f == StepPhase::energy;
    if (seldom && timers.calls(f) == 0) continue;
    double figures[2] = {timers.seconds(f), timers.calls(f) * bytes_of(f, run_.state)};
    static_cast<void>(run_.largest(figures, 2));
    times.push_back({name_of(f), timers.calls(f), figures[0], figures[1]});
  }
  return times;
}

template <class Space, class T, int Dim>
std::size_t RunReports<Space, T, Dim>::memory() const {
  return static_cast<std::size_t>(
      run_.sum_of(static_cast<double>(memory_of(run_.state) + (run_.ranks ? run_.ranks->memory() : 0))));
}

template <class Space, class T, int Dim>
PetscErrorCode RunReports<Space, T, Dim>::ownership(std::vector<OwnedPatch>* patches) const {
  PetscFunctionBeginUser;
  const auto& s = run_.state;
  const auto origin = mirror_of(Kokkos::subview(s.patches.origin, Kokkos::make_pair(0, s.patches.slots)));
  const auto begin = mirror_of(s.soil.bins.begin);
  std::vector<char> own, all;
  for (int slot = 0; slot < s.patches.slots; ++slot) {
    OwnedPatch patch{
        {}, begin((slot + 1) * Patch<Dim>::cells) - begin(slot * Patch<Dim>::cells), rank_of(run_.comm)};
    if (patch.particles == 0) continue;
    for (int d = 0; d < Dim; ++d) patch.place[d] = origin(slot)[d] / Patch<Dim>::edge;
    const char* const bytes = reinterpret_cast<const char*>(&patch);
    own.insert(own.end(), bytes, bytes + sizeof patch);
  }
  std::vector<std::vector<char>> out(size_of(run_.comm));
  out[0] = std::move(own);
  PetscCall(exchange_records(run_.comm, sizeof(OwnedPatch), out, &all));
  patches->resize(all.size() / sizeof(OwnedPatch));
  std::copy(all.begin(), all.end(), reinterpret_cast<char*>(patches->data()));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
std::optional<RankFigures> RunReports<Space, T, Dim>::of_ranks() const {
  if (!run_.ranks) return std::nullopt;
  const RankReport r = run_.ranks->report(run_.state);
  std::array<double, 8> low{r.work,       r.wait,         r.halo, r.particles,
                            r.neighbours, r.shared_nodes, r.sent, r.held},
      high = low, sum = low;
  static_cast<void>(run_.least(low.data(), 8));
  static_cast<void>(run_.largest(high.data(), 8));
  static_cast<void>(run_.sum(sum.data(), 8));
  const int ranks = size_of(run_.comm);
  const auto spread = [&](int k) { return Spread{low[k], high[k], sum[k] / ranks}; };
  RankFigures figures;
  figures.ranks = ranks;
  figures.compute = spread(0), figures.wait = spread(1), figures.halo = spread(2);
  figures.particles = spread(3), figures.neighbours = spread(4), figures.halo_nodes = spread(5);
  figures.sent = spread(6);
  if (is_device<Space> && run_.ranks->overlaps(run_.state)) figures.held = spread(7);
  figures.halo_path = run_.ranks->halo_words(run_.state);
  return figures;
}

template <class Space, class T, int Dim>
std::string RunReports<Space, T, Dim>::of_batches(double stepping) const {
  const auto& b = run_.state.batches;
  if (!b.in_use() || b.all.empty()) return {};
  int most = 0, stay = 0;
  for (const auto& batch : b.all) {
    most = std::max(most, batch.last - batch.first);
    stay += batch.stays;
  }
  const int batches = static_cast<int>(b.all.size()), turns = batches - stay;
  std::string text = formatted(
      "%d batches of at most %d particles: %d stay on the device, %d take turns in %d places; "
      "%.4g of %.4g GiB of the device, %.4g GiB of the host",
      batches, most, stay, turns, b.places - stay, memory_of(run_.state) / k_gib, b.limit / k_gib,
      b.store.extent(0) / k_gib);
  const BatchCost& c = b.cost;
  if (turns == 0 || c.sampled == 0 || c.steps == c.sampled || stepping <= 0) return text;
  // Means of a step; what copies and kernels take alone is from the steps that were sampled.
  const double in = c.copied_in / c.steps, out = c.copied_out / c.steps;
  const double in_alone = c.in_seconds / c.sampled, out_alone = c.out_seconds / c.sampled;
  const double kernels = c.kernel_seconds / c.sampled, update = c.seconds / (c.steps - c.sampled);
  const double beside = std::max(0.0, stepping - c.seconds - c.sampled * (in_alone + kernels + out_alone));
  const double step = update + beside / c.steps;
  text += formatted("\n  a step copies %.4g MB to the device and %.4g MB back, alone at %.1f and %.1f GB/s",
                    in / 1e6, out / 1e6, in / in_alone / 1e9, out / out_alone / 1e9);
  text += formatted(
      "\n  with them the update of the particles takes %.4g us, %.1f %% of a step; its kernels alone "
      "%.4g us",
      1e6 * update, 100 * update / step, 1e6 * kernels);
  return text + formatted("\n  a step of %.4g us takes %.3g times as long as without copies", 1e6 * step,
                          step / (step - update + kernels));
}

#define MPM_INSTANTIATE(Space, T, Dim) template class RunReports<Space, T, Dim>;
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
