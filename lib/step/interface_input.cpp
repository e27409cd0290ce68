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
  in.fields = fields.count, in.rows = static_cast<int>(config.contact_pairs.size());
  in.laws.resize(std::size_t(in.fields) * in.fields);
  for (std::size_t n = 0; n < config.contact_pairs.size(); ++n) {
    const ContactPairConfig& pair = config.contact_pairs[n];
    const int a = fields.of_body[pair.bodies[0]], b = fields.of_body[pair.bodies[1]];
    if (a == b) continue;
    InterfaceLaw& law = in.laws[a * in.fields + b];
    law = law_of(pair, static_cast<int>(n));
    law.first = a < b ? 1 : -1;
    in.laws[b * in.fields + a] = law;
  }
  return in;
}

}  // namespace mpm
