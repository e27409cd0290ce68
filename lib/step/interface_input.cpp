#include "step/interface_input.hpp"

#include "common/velocity_fields.hpp"

namespace mpm {
namespace {

InterfaceLaw law_of(const ContactPairConfig& pair, int row) {
  InterfaceLaw law;
  law.row = row;
  law.welded = pair.welded;
  const bool limited = pair.shear_limit || pair.shear_fraction;
  // A limit alone is the shear stress; Coulomb's law counts where friction or adhesion is given, or nothing.
  law.friction = pair.friction || pair.adhesion > 0 || !limited ? pair.friction.value_or(0) : -1;
  law.adhesion = pair.adhesion;
  if (pair.shear_limit) law.shear_limit = *pair.shear_limit;
  law.shear_fraction = pair.shear_fraction.value_or(-1);
  return law;
}

}  // namespace

InterfaceInput interface_input(const Config& config) {
  InterfaceInput in;
  const VelocityFields fields = velocity_fields(config);
  if (fields.count < 2) return in;
  const std::vector<ContactPairConfig> pairs = pairs_of_fields(config);
  in.fields = fields.count, in.rows = static_cast<int>(pairs.size());
  in.laws.resize(std::size_t(in.fields) * in.fields);
  for (int n = 0; n < in.rows; ++n) {
    const int a = fields.of_body[pairs[n].bodies[0]], b = fields.of_body[pairs[n].bodies[1]];
    InterfaceLaw law = law_of(pairs[n], n);
    law.sign = a < b ? 1 : -1;
    for (int side = 0; side < 2; ++side) law.strong[a < b ? side : 1 - side] = pairs[n].strong[side];
    in.laws[a * in.fields + b] = in.laws[b * in.fields + a] = law;
  }
  return in;
}

}  // namespace mpm
