#include "step/linked_rigids.hpp"

#include <algorithm>
#include <cmath>

#include "functions/link_rigids.hpp"

namespace mpm {
namespace {

/// A direction of length 1.
template <int Dim>
Vector<double, Dim> unit(Vector<double, Dim> v) {
  const double length = std::sqrt(dot(v, v));
  for (int d = 0; d < Dim; ++d) v[d] /= length;
  return v;
}

/// An axis, and right-handed directions across it.
void set_axes(const Vec3& along, Joint<2>& joint) {
  joint.axes[0] = unit(Vector<double, 2>{along[0], along[1]});
  joint.axes[1] = {-joint.axes[0][1], joint.axes[0][0]};
}
void set_axes(const Vec3& along, Joint<3>& joint) {
  joint.axes[0] = unit(Vector<double, 3>{along[0], along[1], along[2]});
  int least = 0;  // component of the axis
  for (int d = 1; d < 3; ++d)
    if (std::fabs(joint.axes[0][d]) < std::fabs(joint.axes[0][least])) least = d;
  Vector<double, 3> other{};
  other[least] = 1;
  joint.axes[1] = unit(cross(joint.axes[0], other));
  joint.axes[2] = cross(joint.axes[0], joint.axes[1]);
}

template <int Dim>
Joint<Dim> joint_of(const Config& config, const JointConfig& in) {
  Joint<Dim> joint;
  const bool ends = in.kind == JointKind::rod || in.kind == JointKind::cable;
  for (int side = 0; side < 2; ++side) joint.body[side] = in.bodies[side];
  for (int d = 0; d < Dim; ++d) {
    joint.end[0][d] = in.point[d] - config.mesh.lower[d];
    joint.end[1][d] = (ends ? in.other_point[d] : in.point[d]) - config.mesh.lower[d];
    joint.velocity[d] = in.velocity_table || in.displacement_table ? 0 : in.velocity[d];
  }
  const bool slides = in.kind == JointKind::slider;
  joint.holds_point = !slides && !ends;
  joint.slides = slides;
  joint.holds_length = ends, joint.pulls_only = in.kind == JointKind::cable;
  joint.length = in.length;
  if (slides || in.kind == JointKind::weld) joint.held_turn = HeldTurn::all;
  if (in.kind == JointKind::hinge && Dim == 3) joint.held_turn = HeldTurn::about_others;
  if (in.axis != Vec3{}) set_axes(in.axis, joint);
  joint.stops = in.stop.has_value();
  for (int side = 0; side < 2 && in.stop; ++side) joint.stop[side] = (*in.stop)[side];
  return joint;
}

template <int Dim>
RigidSupport<Dim> support_of(const Config& config, const RigidConfig& in) {
  RigidSupport<Dim> support;
  support.on = in.is_sprung();
  for (int k = 0; k < Wrench<Dim>::size; ++k) {
    const int degree = Dim == 2 && k == Wrench<Dim>::moment ? 5 : k;
    support.stiffness[k] = in.stiffness[degree], support.viscosity[k] = in.viscosity[degree];
  }
  support.has_point = in.moment_point.has_value();
  for (int d = 0; d < Dim && in.moment_point; ++d)
    support.point[d] = (*in.moment_point)[d] - config.mesh.lower[d];
  return support;
}

/// Vectors of a wrench as three numbers each.
template <int Dim>
void split(const Wrench<Dim>& wrench, double scale, double* force, double* moment) {
  for (int d = 0; d < Dim; ++d) force[d] = scale * wrench[Wrench<Dim>::force + d];
  for (int k = 0; k < k_turning_axes<Dim>; ++k) moment[k] = scale * wrench[Wrench<Dim>::moment + k];
}
template <int Dim>
Wrench<Dim> join(const double* force, const double* moment) {
  Wrench<Dim> wrench{};
  for (int d = 0; d < Dim; ++d) wrench[Wrench<Dim>::force + d] = force[d];
  for (int k = 0; k < k_turning_axes<Dim>; ++k) wrench[Wrench<Dim>::moment + k] = moment[k];
  return wrench;
}

}  // namespace

template <class Space, class T, int Dim>
void LinkedRigids<Space, T, Dim>::set_up() {
  const Config& config = run_.config;
  std::vector<Joint<Dim>> joints;
  std::vector<RigidSupport<Dim>> supports;
  for (const JointConfig& joint : config.joints) joints.push_back(joint_of<Dim>(config, joint));
  for (const RigidConfig& rigid : config.rigids) supports.push_back(support_of<Dim>(config, rigid));
  const bool linked = !joints.empty() || std::any_of(supports.begin(), supports.end(),
                                                     [](const auto& of) { return of.on || of.has_point; });
  if (!linked) supports.clear();
  double size = 0;  // m
  for (int d = 0; d < Dim; ++d) size = std::max(size, config.mesh.upper[d] - config.mesh.lower[d]);
  upload_links(run_.state, joints, supports, size);
}

template <class Space, class T, int Dim>
void LinkedRigids<Space, T, Dim>::measure(double interval, HistoryRow* row) {
  if (!run_.state.links.in_use()) return;
  const double scale = interval > 0 ? 1 / interval : 0;
  std::vector<Joint<Dim>> joints = joints_of(run_.state);
  std::vector<RigidSupport<Dim>> supports = supports_of(run_.state);
  row->joints.clear();
  for (Joint<Dim>& joint : joints) {
    JointReaction& of = row->joints.emplace_back();
    split(joint.impulse, scale, of.force.data(), of.moment.data());
    of.peak = joint.peak, of.work = joint.work;
    joint.impulse = {}, joint.peak = 0;
  }
  for (std::size_t r = 0; r < supports.size(); ++r) {
    RigidRow& of = row->rigids[run_.rigids.place_of(r)];
    split(supports[r].impulse, scale, of.spring_force.data(), of.spring_moment.data());
    supports[r].impulse = {};
  }
  put_links(run_.state, joints, supports);
}

template <class Space, class T, int Dim>
void LinkedRigids<Space, T, Dim>::save(SavedState* saved) const {
  saved->joints.clear(), saved->supports.clear();
  if (!run_.state.links.in_use()) return;
  for (const Joint<Dim>& joint : joints_of(run_.state)) {
    std::array<double, JointTerms::size> row{};
    for (int d = 0; d < Dim; ++d) row[JointTerms::way + d] = joint.way[d];
    split(joint.impulse, 1, &row[JointTerms::impulse], &row[JointTerms::moment]);
    row[JointTerms::peak] = joint.peak, row[JointTerms::work] = joint.work;
    saved->joints.insert(saved->joints.end(), row.begin(), row.end());
  }
  for (const RigidSupport<Dim>& support : supports_of(run_.state)) {
    std::array<double, SupportTerms::size> row{};
    split(support.impulse, 1, &row[SupportTerms::impulse], &row[SupportTerms::moment]);
    saved->supports.insert(saved->supports.end(), row.begin(), row.end());
  }
}

template <class Space, class T, int Dim>
void LinkedRigids<Space, T, Dim>::restore(const SavedState& saved) {
  if (!run_.state.links.in_use()) return;
  std::vector<Joint<Dim>> joints = joints_of(run_.state);
  std::vector<RigidSupport<Dim>> supports = supports_of(run_.state);
  for (std::size_t j = 0; j < joints.size() && saved.joints.size() == JointTerms::size * joints.size(); ++j) {
    const double* const row = &saved.joints[j * JointTerms::size];
    for (int d = 0; d < Dim; ++d) joints[j].way[d] = row[JointTerms::way + d];
    joints[j].impulse = join<Dim>(row + JointTerms::impulse, row + JointTerms::moment);
    joints[j].peak = row[JointTerms::peak], joints[j].work = row[JointTerms::work];
  }
  for (std::size_t r = 0;
       saved.supports.size() == SupportTerms::size * supports.size() && r < supports.size(); ++r) {
    const double* const row = &saved.supports[r * SupportTerms::size];
    supports[r].impulse = join<Dim>(row + SupportTerms::impulse, row + SupportTerms::moment);
  }
  put_links(run_.state, joints, supports);
}

#define MPM_INSTANTIATE(Space, T, Dim) template class LinkedRigids<Space, T, Dim>;
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
