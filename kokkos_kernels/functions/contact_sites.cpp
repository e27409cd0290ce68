#include "functions/step_kernels.hpp"
#include "loops/site_contact.hpp"

namespace mpm {
namespace {

/// Sweeps over all sites at once (Jacobi). The impulses of the step before are a good beginning, so few do.
constexpr int k_sweeps = 2;

template <class Space, class T, int Dim>
struct SitePasses {
  using Contact = SiteContact<Space, T, Dim>;
  const State<Space, T, Dim>& s;
  Contact contact;
  ControlView<Space> control;
  int sites = contact.sites_of_body() * static_cast<int>(s.rigid_points.size());
  int nodes = contact.count * Contact::cells;

  /// A kernel of so many indices, while the steps are not paused.
  template <class Work>
  void pass(const char* name, int n, const Work& work) const {
    const auto control = this->control;
    Kokkos::parallel_for(
        name, light(Kokkos::RangePolicy<Space>(s.space, 0, n)), KOKKOS_LAMBDA(int k) {
          if (!control().paused) work(k);
        });
  }
  void find() const {
    const Contact of = contact;
    pass(
        "mpm::clear_sites", nodes, KOKKOS_LAMBDA(int k) {
          for (int term = 0; term < SiteSums<Dim>::size; ++term) of.sums(k, term) = 0;
        });
    pass(
        "mpm::find_sites", sites, KOKKOS_LAMBDA(int n) { of.find(n); });
    pass(
        "mpm::meet_sites", nodes, KOKKOS_LAMBDA(int k) {
          const int slot = of.contact_slots(k / Contact::cells),
                    cell = slot * Contact::cells + k % Contact::cells;
          for (int p = of.begin(cell); p < of.begin(cell + 1); ++p) of.meet(slot, p);
        });
    pass(
        "mpm::couple_sites", sites, KOKKOS_LAMBDA(int n) { of.couple(n); });
  }
  void begin() const {
    const Contact of = contact;
    pass(
        "mpm::begin_sites", sites, KOKKOS_LAMBDA(int n) { of.begin_impulse(n); });
  }
  void take() const {
    const Contact of = contact;
    pass(
        "mpm::give_sites", nodes, KOKKOS_LAMBDA(int k) { of.take(k); });
  }
  void sweep(int times) const {
    const Contact of = contact;
    for (int n = 0; n < times; ++n) {
      pass(
          "mpm::sweep_sites", sites, KOKKOS_LAMBDA(int k) { of.sweep(k); });
      take();
    }
  }
  void brake() const {
    const Contact of = contact;
    pass(
        "mpm::brake_at_sites", nodes, KOKKOS_LAMBDA(int k) { of.brake(k); });
  }
  void end() const {
    const Contact of = contact;
    pass(
        "mpm::end_nodes_at_sites", nodes, KOKKOS_LAMBDA(int k) { of.end_node(k); });
    using Team = Kokkos::TeamPolicy<Space>;
    constexpr int threads = node_threads<Space, Dim>;
    const int room = Wrench<Dim>::size * Contact::cells, rigids = static_cast<int>(s.rigid_points.size());
    const std::size_t bytes = scratch_bytes<double>(room) + k_scratch_slack;
    const auto control = this->control;
    Kokkos::parallel_for(
        "mpm::end_sites",
        light(Team(s.space, contact.count * rigids, threads).set_scratch_size(0, Kokkos::PerTeam(bytes))),
        KOKKOS_LAMBDA(const typename Team::member_type& team) {
          if (!control().paused)
            of.end_body(team, team.league_rank() / of.count, team.league_rank() % of.count,
                        scratch<double>(team, room));
        });
  }
};

}  // namespace

template <class Space, class T, int Dim>
void sum_site_forces(const State<Space, T, Dim>& s, double dt) {
  if (s.contact.count == 0) return;
  const SitePasses<Space, T, Dim> passes{s, {s, dt}, s.never_paused};
  passes.find();
  passes.begin();
}

template <class Space, class T, int Dim>
void contact_at_sites(State<Space, T, Dim>& s, double dt) {
  if (s.contact.count == 0) return;
  const SitePasses<Space, T, Dim> passes{s, {s, dt}, s.control};
  passes.find();
  passes.begin();
  passes.take();
  passes.sweep(k_sweeps);
  if (s.scheme.damping > 0) {
    passes.brake();
    passes.sweep(1);
  }
  passes.end();
}

#define MPM_INSTANTIATE(Space, T, Dim)                           \
  template void contact_at_sites(State<Space, T, Dim>&, double); \
  template void sum_site_forces(const State<Space, T, Dim>&, double);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
