#include "transfer/upload_pairs.hpp"

#include "base/copy.hpp"
#include "data/contact_core.hpp"
#include "rebuild/list_pairs.hpp"
#include "transfer/fill_view.hpp"
#include "transfer/host_tables.hpp"

namespace mpm {

template <class Space, class T, int Dim>
void upload_pairs(ContactCore<Space, T, Dim>& s, const PairInput& in, double spacing) {
  RigidPairs<Space, Dim>& pairs = s.pairs;
  pairs.may_meet = !in.bodies.empty();
  pairs.friction = in.friction;
  if (!pairs.may_meet) return;
  HostTables<Dim> tables;
  std::vector<SurfacePoint<Dim>> points;
  std::vector<PairBody<Dim>> bodies;
  for (const PairBodyInput& of : in.bodies) {
    PairBody<Dim> body{};
    const int sampled = tables.sampled;
    body.surface = tables.add(of.surface, spacing);
    body.sampled = tables.sampled > sampled;
    body.first = static_cast<int>(points.size()), body.count = static_cast<int>(of.points.points.size());
    for (std::size_t n = 0; n < of.points.points.size(); ++n) {
      SurfacePoint<Dim>& point = points.emplace_back();
      for (int d = 0; d < Dim; ++d)
        point.x[d] = of.points.points[n][d], point.inward[d] = of.points.inward[n][d];
      point.radius = of.points.radius[n];
    }
    body.ball = of.ball;
    for (int d = 0; d < Dim; ++d) body.centre[d] = of.centre[d];
    body.reach = of.reach;
    body.friction = of.friction, body.restitution = of.restitution;
    body.dynamic = of.dynamic, body.sides = of.sides;
    bodies.push_back(body);
  }
  tables.upload(pairs.vertices);
  fill_view(pairs.points, "mpm::pair_points", static_cast<int>(points.size()),
            [&](int n) { return points[n]; });
  fill_view(pairs.bodies, "mpm::pair_bodies", static_cast<int>(bodies.size()),
            [&](int n) { return bodies[n]; });
  pairs.actions = decltype(pairs.actions)("mpm::pair_actions", bodies.size());
}

template <class Space, class T, int Dim>
SavedPairs save_pairs(const ContactCore<Space, T, Dim>& s) {
  SavedPairs saved;
  if (!s.pairs.may_meet) return saved;
  const int rigids = static_cast<int>(s.rigid_points.size());
  const auto number = [&](int n) { return static_cast<double>(n < rigids ? n : rigids - 1 - n); };
  for (const PairImpulse& row : pair_impulses(s))
    saved.contacts.insert(saved.contacts.end(), {number(row.a), number(row.b), static_cast<double>(row.point),
                                                 row.impulse[0], row.impulse[1], row.impulse[2]});
  const auto actions = mirror_of(s.pairs.actions);
  saved.impulses.resize(std::size_t(rigids) * SavedPairs::totals);
  for (int r = 0; r < rigids; ++r)
    for (int k = 0; k < Wrench<Dim>::size; ++k)
      saved.impulses[std::size_t(r) * SavedPairs::totals + k] = actions(r).impulse[k];
  return saved;
}

template <class Space, class T, int Dim>
void restore_pairs(ContactCore<Space, T, Dim>& s, const SavedPairs& saved) {
  if (!s.pairs.may_meet) return;
  const int rigids = static_cast<int>(s.rigid_points.size());
  const auto number = [&](double n) { return static_cast<int>(n < 0 ? rigids - 1 - n : n); };
  s.pairs.saved.clear(), s.pairs.count = 0;
  for (std::size_t at = 0; at < saved.contacts.size(); at += SavedPairs::width) {
    const double* const row = &saved.contacts[at];
    s.pairs.saved.push_back(
        {number(row[0]), number(row[1]), static_cast<int>(row[2]), {row[3], row[4], row[5]}});
  }
  const auto actions = mirror_of(s.pairs.actions);
  for (std::size_t r = 0; r < saved.impulses.size() / SavedPairs::totals; ++r)
    for (int k = 0; k < Wrench<Dim>::size; ++k)
      actions(r).impulse[k] = saved.impulses[r * SavedPairs::totals + k];
  copy(s.pairs.actions, actions);
}

#define MPM_INSTANTIATE(Space, T, Dim)                                               \
  template void upload_pairs(ContactCore<Space, T, Dim>&, const PairInput&, double); \
  template SavedPairs save_pairs(const ContactCore<Space, T, Dim>&);                 \
  template void restore_pairs(ContactCore<Space, T, Dim>&, const SavedPairs&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
