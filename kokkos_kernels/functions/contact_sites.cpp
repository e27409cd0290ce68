#include "functions/contact_sites.hpp"

#include "functions/shared_words.hpp"
#include "loops/end_sites.hpp"
#include "loops/find_sites.hpp"
#include "loops/shared_sites.hpp"
#include "loops/solve_sites.hpp"

namespace mpm {
namespace {

/// Runs work(k) for so many indices, while the steps are not paused.
template <class Space, class T, int Dim, class Work>
void pass(const SitePasses<Space, T, Dim>& of, const char* name, int n, const Work& work) {
  const auto control = of.control;
  Kokkos::parallel_for(
      name, light(Kokkos::RangePolicy<Space>(of.s.space, 0, n)), KOKKOS_LAMBDA(int k) {
        if (!control().paused) work(k);
      });
}

template <class Space, class T, int Dim>
int node_count(const State<Space, T, Dim>& s) {
  return s.contact.count * Patch<Dim>::cells;
}
template <class Space, class T, int Dim>
int site_count(const State<Space, T, Dim>& s) {
  return s.at_sites.list.nodes * k_sites<Dim>;
}

/// Calls f(what ranks share).
template <class Space, class T, int Dim, class F>
void with_shared(const SitePasses<Space, T, Dim>& of, SiteField field, F&& f) {
  const Sites<Space, T, Dim> sites(of.s, of.dt);
  using Sums = SiteSums<Dim>;
  switch (field) {
    case SiteField::gaps: return f(SharedGaps<Space, T, Dim>{sites});
    case SiteField::counts: return f(SharedSums<Space, T, Dim>{sites, Sums::sites, 1});
    case SiteField::momentum: return f(SharedSums<Space, T, Dim>{sites, Sums::momentum, Dim});
    case SiteField::kept: return f(SharedKept<Space, T, Dim>{sites});
  }
}

}  // namespace

template <class Space, class T, int Dim>
void SitePasses<Space, T, Dim>::find() const {
  const FindSites<Space, T, Dim> of(s, dt);
  const int nodes = node_count(s), groups = s.at_sites.list.groups;
  pass(
      *this, "mpm::clear_sites", nodes, KOKKOS_LAMBDA(int k) {
        for (int term = 0; term < SiteSums<Dim>::size; ++term) of.sums(k, term) = 0;
        for (int n = k; n < groups; n += nodes) of.list.open(of.list.group(n)) = 0;
      });
  if constexpr (is_device<Space>)
    pass(
        *this, "mpm::find_sites", site_count(s), KOKKOS_LAMBDA(int n) { of.find(n); });
  else
    pass(
        *this, "mpm::find_sites", s.at_sites.list.nodes, KOKKOS_LAMBDA(int n) { of.find_of_node(n); });
  meet();
}

template <class Space, class T, int Dim>
void SitePasses<Space, T, Dim>::meet() const {
  using Find = FindSites<Space, T, Dim>;
  using Team = Kokkos::TeamPolicy<Space>;
  const int parts = (s.at_sites.list.pairs + Find::k_pairs - 1) / Find::k_pairs;
  if (parts == 0) return;
  const Find of(s, dt);
  const std::size_t bytes = scratch_bytes<typename Find::Near>(Find::k_pairs) + k_scratch_slack;
  const auto control = this->control;
  Kokkos::parallel_for(
      "mpm::meet_sites",
      light(Team(s.space, parts, is_device<Space> ? Find::k_pairs : 1)
                .set_scratch_size(0, Kokkos::PerTeam(bytes))),
      KOKKOS_LAMBDA(const typename Team::member_type& team) {
        if (!control().paused)
          of.meet(team, team.league_rank(), scratch<typename Find::Near>(team, Find::k_pairs));
      });
}

template <class Space, class T, int Dim>
void SitePasses<Space, T, Dim>::couple() const {
  const FindSites<Space, T, Dim> of(s, dt);
  pass(
      *this, "mpm::couple_sites", site_count(s), KOKKOS_LAMBDA(int n) { of.couple(n); });
}

template <class Space, class T, int Dim>
void SitePasses<Space, T, Dim>::begin() const {
  const SolveSites<Space, T, Dim> of(s, dt);
  pass(
      *this, "mpm::begin_sites", site_count(s), KOKKOS_LAMBDA(int n) { of.begin_impulse(n); });
}

template <class Space, class T, int Dim>
void SitePasses<Space, T, Dim>::sweep() const {
  const SolveSites<Space, T, Dim> of(s, dt);
  pass(
      *this, "mpm::sweep_sites", site_count(s), KOKKOS_LAMBDA(int n) { of.sweep(n); });
}

template <class Space, class T, int Dim>
void SitePasses<Space, T, Dim>::take() const {
  const SolveSites<Space, T, Dim> of(s, dt);
  pass(
      *this, "mpm::give_sites", node_count(s), KOKKOS_LAMBDA(int k) { of.take(k); });
}

template <class Space, class T, int Dim>
void SitePasses<Space, T, Dim>::brake() const {
  const SolveSites<Space, T, Dim> of(s, dt);
  pass(
      *this, "mpm::brake_at_sites", node_count(s), KOKKOS_LAMBDA(int k) { of.brake(k); });
}

template <class Space, class T, int Dim>
void SitePasses<Space, T, Dim>::end() const {
  const EndSites<Space, T, Dim> of(s, dt);
  pass(
      *this, "mpm::end_nodes_at_sites", node_count(s), KOKKOS_LAMBDA(int k) { of.end_node(k); });
  const int groups = s.at_sites.list.groups;
  if (groups == 0) return;
  using Team = Kokkos::TeamPolicy<Space>;
  constexpr int threads = node_threads<Space, Dim>;
  const int room = (1 + s.part_forces.count) * Wrench<Dim>::size * Patch<Dim>::cells;
  const std::size_t bytes = scratch_bytes<double>(room) + k_scratch_slack;
  const auto control = this->control;
  Kokkos::parallel_for(
      "mpm::end_sites", light(Team(s.space, groups, threads).set_scratch_size(0, Kokkos::PerTeam(bytes))),
      KOKKOS_LAMBDA(const typename Team::member_type& team) {
        if (!control().paused)
          of.end_group(team, of.list.group(team.league_rank()), scratch<double>(team, room));
      });
}

template <class Space, class T, int Dim>
int SitePasses<Space, T, Dim>::width(SiteField field) const {
  int width = 0;
  with_shared(*this, field, [&]<class Shared>(const Shared& shared) {
    width = shared.size * InWords<T, typename Shared::Value>::count;
  });
  return width;
}

template <class Space, class T, int Dim>
void SitePasses<Space, T, Dim>::pack(SiteField field, const HaloLists<Space>& lists, T* out) const {
  with_shared(*this, field, [&](const auto& shared) { pack_words(s.space, lists, shared, out); });
}

template <class Space, class T, int Dim>
void SitePasses<Space, T, Dim>::combine(SiteField field, const HaloLists<Space>& lists, const T* in) const {
  with_shared(*this, field, [&](const auto& shared) { combine_words(s.space, lists, shared, in); });
}

#define MPM_INSTANTIATE(Space, T, Dim) template struct SitePasses<Space, T, Dim>;
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
