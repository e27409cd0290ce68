#include "input/options/analysis_options.hpp"

#include <utility>
#include <vector>

#include "common/text.hpp"

namespace mpm {
namespace {

enum class Analysis { penetration, flow };

/// Options of an analysis with the values in force.
std::vector<std::pair<std::string, std::string>> values_of(const Config& config) {
  constexpr const char* k_updates[] = {"flip", "pic", "xpic", "apic"};
  constexpr const char* k_domains[] = {"fixed", "stretch", "split"};
  return {{"velocity_update", k_updates[static_cast<int>(config.velocity_update)]},
          {"particle_domain", k_domains[static_cast<int>(config.particle_domain)]},
          {"position_correction", config.position_correction ? "delta" : "none"}};
}

}  // namespace

void read_analysis(OptionReader& in, Config& config) {
  Analysis analysis = Analysis::penetration;
  in.word(
      {.name = "analysis",
       .meaning = "kind of the job, which sets defaults: penetration, also for waves and excavations: "
                  "velocity_update flip, particle_domain fixed, position_correction none; flow, for slides "
                  "and collapses and for soil that is stretched far: apic, split and delta (apic alone with "
                  "-geometry axisymmetric)"},
      Words<Analysis>{{"penetration", Analysis::penetration}, {"flow", Analysis::flow}}, analysis);
  if (analysis != Analysis::flow) return;
  config.velocity_update = VelocityUpdate::apic;
  if (config.geometry == Geometry::axisymmetric) return;  // whose domains and positions stay
  config.particle_domain = ParticleDomain::split;
  config.position_correction = true;
}

void note_analysis(OptionReader& in, const Config& config) {
  if (in.listing() || !in.given("analysis")) return;
  std::vector<std::string> set, given;
  for (const auto& [name, value] : values_of(config))
    (in.given(name) ? given : set).push_back("-" + name + " " + value);
  std::string line = in.given_text("analysis");
  line += set.empty() ? " sets nothing" : " sets " + join(set, ", ");
  if (!given.empty()) line += "; the deck gives " + join(given, ", ");
  in.note("analysis", line);
}

bool set_by_flow(const OptionReader& in, const Config& config, const std::string& name) {
  if (in.given_text("analysis") != "flow" || in.given(name)) return false;
  return name == "velocity_update" || config.geometry != Geometry::axisymmetric;
}

}  // namespace mpm
