#include "output/performance.hpp"

#include <algorithm>

#include "common/text.hpp"
#include "output/log.hpp"

namespace mpm {
namespace {

/// A row of the table; calls are left out where they are negative, bytes and bandwidth where they are 0.
std::string row_of(const FunctionTime& f, double wall, double bandwidth) {
  std::string row = formatted("  %-30s %9s %11.3f %6.1f %%", f.name.c_str(),
                              f.calls < 0 ? "" : std::to_string(f.calls).c_str(), f.seconds,
                              wall > 0 ? 100 * f.seconds / wall : 0.0);
  if (f.bytes > 0 && f.seconds > 0) {
    row += formatted(" %11.2f %9.1f", f.bytes / 1e9, f.bytes / f.seconds / 1e9);
    if (bandwidth > 0) row += formatted(" %6.1f %%", 100 * f.bytes / f.seconds / bandwidth);
  }
  return row + "\n";
}

std::string table_of(const Performance& p) {
  std::string text = formatted("  %-30s %9s %11s %8s %11s %9s %8s\n", "function", "calls", "seconds", "share",
                               "GB moved", "GB/s", "of copy");
  double rest = p.wall;
  for (const FunctionTime& f : functions_within_steps(p)) {
    text += row_of(f, p.wall, p.bandwidth);
    rest -= f.seconds;
  }
  if (rest > 0) text += row_of({"everything else", -1, rest, 0}, p.wall, 0);
  return text + row_of({"wall time", -1, p.wall, 0}, p.wall, 0);
}

}  // namespace

std::vector<FunctionTime> functions_within_steps(const Performance& p) {
  std::vector<FunctionTime> functions = p.functions;
  double sum = 0;
  for (const FunctionTime& f : functions) sum += f.seconds;
  for (FunctionTime& f : functions)
    if (sum > p.stepping) f.seconds *= p.stepping / sum;
  return functions;
}

double moved_per_second(const Performance& p) {
  double bytes = 0;
  for (const FunctionTime& f : p.functions) bytes += f.bytes;
  return bytes / p.stepping;
}

double real_time_factor(const Performance& p) { return p.wall > 0 ? p.simulated / p.wall : 0; }

double updates_per_second(const Performance& p) { return double(p.steps) * p.particles / p.stepping; }

std::string format_performance(const Performance& p) {
  std::string text = "time of the functions, and the least that they must move\n" + table_of(p);
  if (p.looks > 0) text += formatted("%ld steps, checked by the host %ld times\n", p.steps, p.looks);
  if (p.rebuilds > 0)
    text += formatted("bins and lists were rebuilt %ld times, after %ld to %ld steps, %.1f on average\n",
                      p.rebuilds, p.shortest, p.longest, p.interval);
  text += formatted("strategy %s; %.1f MB on the device, %.1f bytes a particle\n", p.strategy.c_str(),
                    p.memory / 1e6, p.memory / std::max(p.particles, 1L));
  if (p.bandwidth > 0)
    text += formatted("%s: a copy reads and writes %.1f GB/s; the steps move %.1f GB/s, %.1f %% of it\n",
                      p.device.c_str(), p.bandwidth / 1e9, moved_per_second(p) / 1e9,
                      100 * moved_per_second(p) / p.bandwidth);
  text += formatted("%.4g us a step without output; %s particle updates", 1e6 * p.stepping / p.steps,
                    format_rate(updates_per_second(p)).c_str());
  if (real_time_factor(p) > 0)
    text += formatted("\n%.3g s of motion in a second of wall time", real_time_factor(p));
  if (p.energy)
    text += formatted("\n%.3g kWh taken by the processors, with all that ran on them", *p.energy / 3.6e6);
  if (p.gpu_energy)
    text += formatted("\n%.3g kWh taken by the GPUs, with all that ran on them", *p.gpu_energy / 3.6e6);
  return text;
}

std::string format_ranks(const RankFigures& r) {
  std::string text = formatted("%d ranks: %.0f to %.0f particles a rank, largest over mean %.3f\n", r.ranks,
                               r.particles.least, r.particles.most, r.particles.balance());
  text += formatted("  halo of at most %.0f nodes with %.0f neighbours, %.1f kB sent a step, %s\n",
                    r.halo_nodes.most, r.neighbours.most, r.sent.most / 1e3, r.halo_path.c_str());
  if (r.compute.most > 0)
    text += formatted(
        "  compute %.3f to %.3f s a rank, largest over mean %.3f; halo (pack and sum) %.3f to %.3f s, wait "
        "%.3f to %.3f s\n",
        r.compute.least, r.compute.most, r.compute.balance(), r.halo.least, r.halo.most, r.wait.least,
        r.wait.most);
  if (r.compute.most > 0 && r.held)
    text +=
        formatted("  devices held up by the halo for %.3f to %.3f s of it\n", r.held->least, r.held->most);
  return text;
}

}  // namespace mpm
