#include "checkpoint/changes.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>

#include "checksum.hpp"
#include "input/text.hpp"
#include "output/log.hpp"

namespace mpm {
namespace {

/// Options that say where, how long and with what output a run goes on, not what it computes.
bool may_change(const std::string& name) {
  constexpr const char* names[] = {"-backend",
                                   "-precision",
                                   "-device_memory_limit",
                                   "-p2g",
                                   "-p2g_margin",
                                   "-p2g_mosaic_cells",
                                   "-p2g_rebuild_interval",
                                   "-partition",
                                   "-halo_path",
                                   "-halo_overlap",
                                   "-time_end",
                                   "-time_max_steps",
                                   "-history_interval",
                                   "-checkpoint_interval",
                                   "-restart",
                                   "-wall_time_limit",
                                   "-progress",
                                   "-dry_run"};
  return name.starts_with("-output_") ||
         std::find(std::begin(names), std::end(names), name) != std::end(names);
}

/// The same text, or lists of the same numbers: 0.1 is .1.
bool same_value(const std::string& a, const std::string& b) {
  if (a == b) return true;
  const auto one = split(a), other = split(b);
  if (one.size() != other.size()) return false;
  for (std::size_t k = 0; k < one.size(); ++k) {
    const auto x = parse_number(one[k]), y = parse_number(other[k]);
    if (one[k] != other[k] && !(x && y && *x == *y)) return false;
  }
  return true;
}

/// The value of an option; empty if there is none of that name.
std::string value_of(const std::string& name, const std::vector<EffectiveOption>& options) {
  for (const EffectiveOption& option : options)
    if (option.name == name) return option.value;
  return "";
}

}  // namespace

std::vector<EffectiveOption> options_to_keep(const std::vector<EffectiveOption>& options,
                                             const Config& config) {
  std::vector<EffectiveOption> kept = options;
  for (const BodyConfig& body : config.bodies) {
    if (body.shape.kind != ShapeKind::particles) continue;
    std::ifstream file(body.shape.file, std::ios::binary);
    const std::string contents(std::istreambuf_iterator<char>(file), {});
    for (EffectiveOption& option : kept)
      if (option.name == "-" + body.name + "_file")
        option.value =
            formatted("a file of %zu bytes with crc32 %08x", contents.size(), checksum(0, contents));
  }
  return kept;
}

std::vector<std::string> contradictions(const Checkpoint& checkpoint, const std::vector<EffectiveOption>& now,
                                        const std::string& file) {
  std::map<std::string, const EffectiveOption*> then;
  for (const EffectiveOption& option : checkpoint.options) then[option.name] = &option;
  std::vector<std::string> lines;
  const std::string why = ", which holds in the run of " + file;
  for (const EffectiveOption& option : now) {
    const auto found = then.find(option.name);
    const EffectiveOption* former = found == then.end() ? nullptr : found->second;
    then.erase(option.name);
    if (may_change(option.name) || (former == nullptr && option.standard)) continue;
    if (former != nullptr && same_value(former->value, option.value)) continue;
    lines.push_back("mpm: " + option.name + ": " + (option.standard ? "default" : "given") + " \"" +
                    option.value + "\", takes " +
                    (former == nullptr ? "nothing at a restart" : "\"" + former->value + "\"") + why);
  }
  for (const auto& [name, former] : then)
    if (!may_change(name) && !former->standard)
      lines.push_back("mpm: " + name + ": not given, takes \"" + former->value + "\"" + why);
  return lines;
}

std::string changed_machine(const Checkpoint& then, const Checkpoint& now) {
  std::string text;
  const auto compare = [&](const std::string& what, const std::string& before, const std::string& after) {
    if (!same_value(before, after))
      text += (text.empty() ? "" : ", ") + what + " " + after + " after " + before;
  };
  compare("backend", then.backend, now.backend);
  compare("precision", then.precision, now.precision);
  compare("strategy", then.strategy, now.strategy);
  compare("ranks", std::to_string(then.ranks), std::to_string(now.ranks));
  for (const char* name : {"-p2g_margin", "-p2g_mosaic_cells", "-p2g_rebuild_interval", "-partition"})
    compare(name, value_of(name, then.options), value_of(name, now.options));
  return text;
}

}  // namespace mpm
