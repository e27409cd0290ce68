#include "step/interface_snapshot.hpp"

#include <algorithm>
#include <tuple>

#include "common/collectives.hpp"
#include "common/velocity_fields.hpp"
#include "functions/interfaces.hpp"
#include "step/to_nodes.hpp"

namespace mpm {
namespace {

/// The group of a pair. lower [m]: the lower corner of the mesh.
ParticleSnapshot group_of(const std::string& name, int row, const std::vector<InterfaceNode>& nodes,
                          const Vec3& lower) {
  ParticleSnapshot group;
  group.name = name;
  std::vector<double> force, normal, area, pressure, shear;
  for (const InterfaceNode& node : nodes) {
    if (node.row != row) continue;
    double across = 0;  // N, against the normal
    for (int d = 0; d < 3; ++d) across -= node.force[d] * node.normal[d];
    const double per_area = node.area > 0 ? 1 / node.area : 0;
    area.push_back(node.area), pressure.push_back(across * per_area);
    for (int d = 0; d < 3; ++d) {
      group.position.push_back(node.position[d] + lower[d]);
      force.push_back(node.force[d]), normal.push_back(node.normal[d]);
      shear.push_back((node.force[d] + across * node.normal[d]) * per_area);
    }
  }
  group.state = {{"contact_force", std::move(force)},
                 {"contact_normal", std::move(normal)},
                 {"contact_area", std::move(area)},
                 {"contact_pressure", std::move(pressure)},
                 {"contact_shear", std::move(shear)}};
  return group;
}

}  // namespace

template <class Space, class T, int Dim>
PetscErrorCode add_interfaces(StepContext<Space, T, Dim>& run, double dt, Snapshot* out) {
  PetscFunctionBeginUser;
  out->contacts.clear();
  if (!run.state.interfaces.in_use()) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(sum_present_forces(run.state, run.ranks.get()));
  const KeptSums kept(run.state);
  std::vector<InterfaceNode> nodes;
  PetscCallCXX(nodes = interface_nodes(run.state, dt));
  if (run.ranks) PetscCall(share_records(run.comm, &nodes));
  std::sort(nodes.begin(), nodes.end(), [](const InterfaceNode& a, const InterfaceNode& b) {
    return std::tie(a.row, a.position) < std::tie(b.row, b.position);
  });
  const std::vector<ContactPairConfig> pairs = pairs_of_fields(run.config);
  for (std::size_t n = 0; n < pairs.size(); ++n)
    out->contacts.push_back(group_of(pairs[n].name, static_cast<int>(n), nodes, run.config.mesh.lower));
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define MPM_INSTANTIATE(Space, T, Dim) \
  template PetscErrorCode add_interfaces(StepContext<Space, T, Dim>&, double, Snapshot*);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
