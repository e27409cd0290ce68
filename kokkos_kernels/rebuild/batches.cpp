#include "rebuild/batches.hpp"

#include "base/copy.hpp"
#include "functions/step_kernels.hpp"
#include "loops/interpolation.hpp"

namespace mpm {
namespace {

constexpr long k_sample_every = 50, k_first_sample = 2;  // steps that are sampled

template <class Space, class View>
void copy_part(const Space& space, const View& to, const View& from, int first, int last, double& bytes) {
  using Part = Kokkos::View<typename View::value_type*, typename View::memory_space, Kokkos::MemoryUnmanaged>;
  const std::size_t count = last - first;
  copy(space, Part(to.data() + first, count), Part(from.data() + first, count));
  bytes += count * sizeof(typename View::value_type);
}

/// Copies a batch to the device; returns bytes.
template <class Space, class T, int Dim>
double copy_in(const Space& space, const Core<Space, T, Dim>& s, const SoilBatch<Space, T, Dim>& batch) {
  double bytes = 0;
  for_each_of_step(s.soil.points, batch.set.points, [&](const auto& home, const auto& there, Use) {
    copy_part(space, there, home, batch.first, batch.last, bytes);
  });
  return bytes;
}
/// Copies the fields that a step changes back to the host; returns their bytes.
template <class Space, class T, int Dim>
double copy_out(const Space& space, const Core<Space, T, Dim>& s, const SoilBatch<Space, T, Dim>& batch) {
  double bytes = 0;
  for_each_of_step(s.soil.points, batch.set.points, [&](const auto& home, const auto& there, Use use) {
    if (use == Use::changes) copy_part(space, home, there, batch.first, batch.last, bytes);
  });
  return bytes;
}

/// The batch that s.soil now is, to the nodes.
template <class Space, class T, int Dim>
void sum_batch(const ContactCore<Space, T, Dim>& s) {
  with_domain(s.soil.points, [&](auto domain) {
    using Source = SoilSource<Space, T, Dim, domain()>;
    const Source source{s.soil.points, s.grid.inv_spacing};
    particle_to_node(s.p2g.strategy, interpolation_of(s, s.soil.bins, source, s.nodes.soil, s.space));
  });
}

}  // namespace

template <class Space, class T, int Dim>
void update_by_batches(ContactCore<Space, T, Dim>& s, double dt) {
  auto& b = s.batches;
  if (read_control(s).paused) return;  // this also waits for the nodes
  BatchCost& cost = b.cost;
  const bool sampled = cost.steps++ % k_sample_every == k_first_sample;
  const auto timed = [&](const Space& space, double& seconds, auto&& work) {
    const Kokkos::Timer timer;
    work();
    if (!sampled) return;
    space.fence("mpm::part of a batch");
    seconds += timer.seconds();
  };
  const Kokkos::Timer timer;
  const bool sums = !s.plan.sums_ahead;  // while the batch is there; else update_particles does so itself
  if (sums) {
    reset_nodes(s);
    s.space.fence("mpm::before the sums of batches");
  }
  const auto whole = s.soil;
  const auto scratch = s.scratch;
  const Space space = s.space;
  for (const auto& batch : b.all) {
    const Space& stream = batch.stays ? space : b.streams[batch.place % k_turns];
    timed(stream, cost.in_seconds, [&] {
      if (!batch.stays || !b.loaded) cost.copied_in += copy_in(stream, s, batch);
    });
    timed(stream, cost.kernel_seconds, [&] {
      s.soil = batch.set, s.scratch = batch.scratch, s.space = stream;
      update_particles(s, dt);
      if (sums) sum_batch(s);
      s.soil = whole, s.scratch = scratch, s.space = space;
    });
    timed(stream, cost.out_seconds, [&] {
      if (!batch.stays) cost.copied_out += copy_out(stream, s, batch);
    });
  }
  b.loaded = true;
  s.summed.soil = s.summed.soil || sums;
  for (const Space& stream : b.streams) stream.fence("mpm::update_by_batches");
  space.fence("mpm::update_by_batches");
  cost.sampled += sampled;
  if (!sampled) cost.seconds += timer.seconds();
}

template <class Space, class T, int Dim>
void collect_soil(const Core<Space, T, Dim>& s) {
  if (!s.batches.loaded) return;
  for (const auto& batch : s.batches.all)
    if (batch.stays) copy_out(s.space, s, batch);
  s.space.fence("mpm::collect_soil");
}

#define MPM_INSTANTIATE(Space, T, Dim)                                  \
  template void update_by_batches(ContactCore<Space, T, Dim>&, double); \
  template void collect_soil(const Core<Space, T, Dim>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
