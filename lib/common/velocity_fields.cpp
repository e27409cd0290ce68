#include "common/velocity_fields.hpp"

#include <algorithm>

namespace mpm {
namespace {

/// Pairs that have a body.
int pairs_of(const Config& config, int body) {
  return static_cast<int>(std::count_if(
      config.contact_pairs.begin(), config.contact_pairs.end(),
      [&](const ContactPairConfig& pair) { return pair.bodies[0] == body || pair.bodies[1] == body; }));
}

/// The body with which one shares its field, as they are welded and no other pair has either of them; else
/// the body itself.
int partner(const Config& config, int body) {
  for (const ContactPairConfig& pair : config.contact_pairs)
    if (pair.welded && (pair.bodies[0] == body || pair.bodies[1] == body) &&
        pairs_of(config, pair.bodies[0]) == 1 && pairs_of(config, pair.bodies[1]) == 1)
      return std::min(pair.bodies[0], pair.bodies[1]);
  return body;
}

}  // namespace

VelocityFields velocity_fields(const Config& config) {
  const int bodies = static_cast<int>(config.bodies.size());
  VelocityFields fields{std::vector<int>(bodies, 0), 0};
  for (int b = 0; b < bodies; ++b)
    if (pairs_of(config, b) == 0) fields.count = 1;
  for (int b = 0; b < bodies; ++b) {
    if (pairs_of(config, b) == 0) continue;
    const int other = partner(config, b);
    fields.of_body[b] = other < b ? fields.of_body[other] : fields.count++;
  }
  fields.count = std::max(fields.count, 1);
  return fields;
}

std::vector<ContactPairConfig> pairs_of_fields(const Config& config) {
  const VelocityFields fields = velocity_fields(config);
  std::vector<ContactPairConfig> pairs = config.contact_pairs;
  std::erase_if(pairs, [&](const ContactPairConfig& pair) {
    return fields.of_body[pair.bodies[0]] == fields.of_body[pair.bodies[1]];
  });
  return pairs;
}

}  // namespace mpm
