// Whether a state that was read can be that of a run: what a kernel would use as an index is in range, and
// every number is finite.

#include <algorithm>
#include <cmath>
#include <utility>

#include "checkpoint/checkpoint.hpp"
#include "checkpoint/earlier.hpp"
#include "common/velocity_fields.hpp"
#include "data/column_terms.hpp"
#include "data/side_terms.hpp"
#include "data/site_terms.hpp"
#include "mesh/background.hpp"
#include "output/probes.hpp"
#include "parallel/global_bound.hpp"

namespace mpm {
namespace {

constexpr std::size_t k_most_columns = 100;

/// Whether an address (patch number in the grid with its ring, times cells of a patch, plus place) is that of
/// a cell at most `ring` cells outside the mesh.
bool in_mesh(long address, const Config& config, int fields, int ring) {
  const MeshConfig& mesh = config.mesh;
  const int dim = config.dim;
  const int edge = patch_edge(dim);
  long cells_of_patch = 1;
  for (int d = 0; d < dim; ++d) cells_of_patch *= edge;
  if (address < 0) return false;
  long patch = address / cells_of_patch, place = address % cells_of_patch;
  for (int d = 0; d < dim; ++d) {
    const long patches = (mesh.cells[d] + edge - 1) / edge + 2;  // with the ring outside
    const long cell = (patch % patches - 1) * edge + place % edge;
    if (cell < -ring || cell >= mesh.cells[d] + ring) return false;
    patch /= patches, place /= edge;
  }
  return patch < fields;
}

/// The fields that the soil of every checkpoint has, with their components; restoring asks for those that
/// only some runs have, as the state variables of the laws. The first that is not there.
std::string missing_field(const SavedPoints& points, const Config& config) {
  const int dim = config.dim;
  const std::pair<const char*, int> fields[] = {
      {"coordinate", dim}, {"velocity", dim}, {"stress", dim == 2 ? 4 : 6}, {"volume", 1}, {"body", 1}};
  for (const auto& [name, components] : fields)
    if (std::none_of(
            points.fields.begin(), points.fields.end(),
            [&, n = name, c = components](const auto& f) { return f.name == n && f.components == c; }))
      return name;
  return "";
}

std::string points_fault(const SavedPoints& points, const Config& config, const std::string& name) {
  if (const std::string missing = missing_field(points, config); !missing.empty())
    return "a checkpoint with a sound " + name + "/" + missing;
  const int fields = velocity_fields(config).count;
  const auto inside = [&](long address) { return in_mesh(address, config, fields, 0); };
  if (!std::all_of(points.address.begin(), points.address.end(), inside))
    return "a checkpoint whose " + name + " is inside the mesh";
  for (const SavedField& field : points.fields) {
    const double furthest = field.name == "coordinate" ? 2 : HUGE_VAL;  // cells: more than any margin
    const double bodies = field.name == "body" ? static_cast<double>(config.bodies.size()) : HUGE_VAL;
    const bool positive = field.name == "volume" || field.name == "mass";
    const auto sound = [&](double x) {
      return std::isfinite(x) && (!positive || x > 0) && std::fabs(x) <= furthest && x < bodies &&
             (bodies == HUGE_VAL || x >= 0);
    };
    if (!std::all_of(field.values.begin(), field.values.end(), sound))
      return "a checkpoint with a sound " + name + "/" + field.name;
  }
  return "";
}

/// Whether the tables of sides have a row for each node of those that act, and of those with columns.
bool sound_sides(const SavedSides& sides, const Config& config) {
  if (sides.kinds.empty()) return sides.values.empty() && sides.columns.empty();  // no run has written it
  if (sides.kinds.size() != 2 * static_cast<std::size_t>(config.dim)) return false;
  for (const long kind : sides.kinds)
    if (kind < 0 || kind > static_cast<long>(k_last_wall)) return false;
  const SavedSideRows rows = rows_of_sides(sides, config);
  const std::size_t terms = config.dim == 2 ? SideTerms<2>::size : SideTerms<3>::size;
  const std::size_t column_terms = config.dim == 2 ? ColumnTerms<2>::size : ColumnTerms<3>::size;
  const auto finite = [](double x) { return std::isfinite(x); };
  return sides.values.size() == rows.acting * terms && sides.columns.size() == rows.columns * column_terms &&
         std::all_of(sides.values.begin(), sides.values.end(), finite) &&
         std::all_of(sides.columns.begin(), sides.columns.end(), finite);
}

/// Whether contacts between rigid bodies are those of bodies of the run.
bool sound_pairs(const SavedPairs& pairs, const Config& config) {
  const auto rigids = static_cast<double>(config.rigids.size());
  const auto finite = [](double x) { return std::isfinite(x); };
  const std::size_t of_rigids = SavedPairs::totals * config.rigids.size();
  if (pairs.contacts.size() % SavedPairs::width != 0 ||
      !(pairs.impulses.empty() || pairs.impulses.size() == of_rigids) ||
      !std::all_of(pairs.contacts.begin(), pairs.contacts.end(), finite) ||
      !std::all_of(pairs.impulses.begin(), pairs.impulses.end(), finite))
    return false;
  for (std::size_t at = 0; at < pairs.contacts.size(); at += SavedPairs::width)
    for (int k = 0; k < 2; ++k)
      if (pairs.contacts[at + k] < -2 * config.dim || pairs.contacts[at + k] >= rigids) return false;
  return true;
}

/// Fault of the account of bodies that are placed at a stage, and of their state variables.
std::string bodies_fault(const SavedState& state, const Config& config) {
  const std::size_t bodies = config.bodies.size();
  const auto negative = [](long count) { return count < 0; };
  if (state.unused.size() != bodies || std::any_of(state.unused.begin(), state.unused.end(), negative))
    return "a checkpoint with a sound account of unused";
  if (state.variables.size() != bodies || state.columns.size() > k_most_columns)
    return "a checkpoint with sound variables and columns";
  for (const SavedField& field : state.soil.fields)
    for (std::size_t p = 0; field.name == "body" && p < field.values.size(); ++p) {
      const double b = field.values[p];
      if (b >= 0 && b < static_cast<double>(bodies) && config.bodies[static_cast<std::size_t>(b)].absent)
        return "a checkpoint before which no particle of " + config.bodies[static_cast<std::size_t>(b)].name +
               " was placed";
    }
  return "";
}

}  // namespace

std::string state_fault(const SavedState& state, const Config& config) {
  if (state.rigids.size() != config.rigids.size()) return "a checkpoint of as many rigids";
  if (!std::isfinite(state.bound) || !std::isfinite(state.increment) || state.bound < 0 || state.bound > 0.5)
    return "a checkpoint with a sound bound";
  if (!std::isfinite(state.margin) || state.due_in < 0 || state.due_in > GlobalBound::k_late)
    return "a checkpoint with a sound margin and due_in";
  if (state.lost.size() != config.bodies.size() * k_lost || state.particles < 0)
    return "a checkpoint with a sound account of what has left";
  if (const std::string fault = bodies_fault(state, config); !fault.empty()) return fault;
  const std::size_t energies = (config.output.energy ? k_saved_energy : 0) + (config.loads.empty() ? 0 : 1);
  if (state.energy.size() != energies)
    return "a checkpoint with an energy balance where the run has one, and the work of loads";
  const int fields = velocity_fields(config).count;
  for (const long address : state.alone)
    if (!in_mesh(address, config, fields, 0)) return "a checkpoint with a sound alone";
  const std::size_t rigids = config.rigids.size();
  const std::size_t rows = state.impulse.address.size() * rigids, values = state.impulse.values.size();
  const std::size_t at_sites =
      config.dim == 2 ? k_sites<2> * SiteTerms<2>::size : k_sites<3> * SiteTerms<3>::size;
  if (values != ImpulseTerms::size * rows && values != at_sites * rows)
    return "a checkpoint with a sound impulse";
  const int ring = patch_edge(config.dim);
  for (const long address : state.impulse.address)
    if (!in_mesh(address, config, fields, 2 * ring)) return "a checkpoint with a sound impulse_address";
  const auto finite = [](double x) { return std::isfinite(x); };
  if (state.sections.size() != 2 * planes_of(config).size() ||
      !std::all_of(state.sections.begin(), state.sections.end(), finite))
    return "a checkpoint with a sound section_lost";
  if (!std::all_of(state.impulse.values.begin(), state.impulse.values.end(), finite))
    return "a checkpoint with a sound impulse";
  if (state.part_impulses.size() % PartTerms::size != 0 ||
      !std::all_of(state.part_impulses.begin(), state.part_impulses.end(), finite))
    return "a checkpoint with sound part_impulses";
  if (!std::all_of(state.interfaces.begin(), state.interfaces.end(), finite))
    return "a checkpoint with sound interfaces";
  if (!sound_pairs(state.pairs, config)) return "a checkpoint with sound pair_contacts and pair_impulses";
  if (!sound_sides(state.sides, config))
    return "a checkpoint with sound side_kinds, side_nodes and side_columns";
  for (const SavedRigid& rigid : state.rigids)
    if (!std::all_of(rigid.begin(), rigid.end(), finite)) return "a checkpoint with sound rigids";
  if (state.joints.size() != JointTerms::size * config.joints.size() ||
      !std::all_of(state.joints.begin(), state.joints.end(), finite))
    return "a checkpoint with sound joints";
  if ((!state.supports.empty() && state.supports.size() != SupportTerms::size * rigids) ||
      !std::all_of(state.supports.begin(), state.supports.end(), finite))
    return "a checkpoint with sound rigid_supports";
  if (!std::all_of(state.lost.begin(), state.lost.end(), finite)) return "a checkpoint with a sound lost";
  if (!std::all_of(state.energy.begin(), state.energy.end(), finite))
    return "a checkpoint with a sound energy";
  if (!std::all_of(state.bounds.begin(), state.bounds.end(), finite)) return "a checkpoint with sound bounds";
  return points_fault(state.soil, config, "soil");
}

}  // namespace mpm
