#include "step/state_map.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <tuple>

#include "common/material_table.hpp"
#include "common/text.hpp"
#include "input/files/checkpoint_particles.hpp"
#include "physics/materials/any.hpp"

namespace mpm {
namespace {

const SavedField* find(const SavedPoints& points, const std::string& name) {
  for (const SavedField& field : points.fields)
    if (field.name == name) return &field;
  return nullptr;
}

/// The law of a body, and the fields of its variables before.
class BodyLaw {
 public:
  BodyLaw(const Config& config, const BodyConfig& body, const std::string& names, const SavedState& state)
      : law_(make_material<double>(model_index(config.materials[body.material].model),
                                   config.materials[body.material].parameters,
                                   config.materials[body.material].object.get())),
        variables_(state_variables(law_)),
        has_pressure_(config.materials[body.material].has_pore_pressure()) {
    const std::vector<std::string> before = names.empty() ? std::vector<std::string>{} : split(names);
    std::size_t of_own = 0;  // number among OwnValues
    for (const StateVariable& variable : variables_) {
      const auto found = std::find(before.begin(), before.end(), variable.name);
      const bool may_own = variable.parameter != nullptr,
                 by_ratio = may_own && variable.parameter == std::string("su") && body.keeps_strength &&
                            parameter_of(model_index(config.materials[body.material].model),
                                         config.materials[body.material].parameters, "su_ratio") > 0,
                 own = may_own && (body.largest_own[of_own] || by_ratio);
      const bool keeps = found != before.end() && (variable.changes || own);
      const std::size_t column = static_cast<std::size_t>(found - before.begin());
      kept_.push_back(keeps && column < state.columns.size() ? find(state.soil, state.columns[column])
                                                             : nullptr);
      if (own) own_[of_own] = kept_.back();
      if (may_own) ++of_own;
    }
  }

  bool has_pore_pressure() const { return has_pressure_; }
  std::size_t count() const { return variables_.size(); }

  /// The variables of particle p, which starts from `start`. fault: the reason where it cannot start.
  std::vector<double> values(std::size_t p, ParticleStart start, std::string& fault) const {
    for (std::size_t k = 0; k < own_.size(); ++k)
      if (own_[k] != nullptr) start.own[k] = own_[k]->values[p];
    if (const ParameterFault found = start_fault(law_, start); !found.key.empty())
      fault = (found.key == "stress" ? "it takes " : "-NAME_" + found.key + " takes ") + found.takes;
    std::vector<double> values = initial_state(law_, start);
    for (std::size_t k = 0; k < values.size(); ++k)
      if (kept_[k] != nullptr) values[k] = kept_[k]->values[p];
    return values;
  }

 private:
  AnyMaterial<double> law_;
  std::vector<StateVariable> variables_;
  bool has_pressure_;
  std::vector<const SavedField*> kept_;  // of each variable, whose values go on; null: it begins anew
  std::array<const SavedField*, k_most_own> own_{};  // those of them that are each particle's own values
};

/// Where the particles of a state are, for laws that begin there.
class Starts {
 public:
  Starts(const Config& config, const SavedState& state)
      : dim_(config.dim),
        stress_(find(state.soil, "stress")),
        height_(find(state.soil, "reference_height")),
        position_(positions_of(state.soil, config.mesh, config.dim)) {}

  /// `excess`: Pa, the pressure of the pore water, which is no part of the effective stress.
  ParticleStart at(std::size_t p, double excess) const {
    ParticleStart start;
    for (int d = 0; d < dim_; ++d) start.position[d] = position_[p * dim_ + d];
    start.up = dim_ - 1;
    start.height = height_ != nullptr ? height_->values[p] : start.position[dim_ - 1];
    for (int k = 0; k < stress_->components; ++k)
      start.stress[k] = stress_->values[p * stress_->components + k] + (k < 3 ? excess : 0);
    return start;
  }
  std::string place(std::size_t p) const { return text_of(std::span(position_).subspan(p * dim_, dim_)); }

 private:
  int dim_;
  const SavedField *stress_, *height_;
  std::vector<double> position_;
};

/// A law's text with the material's own prefix in the place of -NAME_.
std::string with_name(std::string text, const std::string& name) {
  const std::string prefix = "-NAME_", own = "-" + name + "_";
  for (auto at = text.find(prefix); at != std::string::npos; at = text.find(prefix, at + own.size()))
    text.replace(at, prefix.size(), own);
  return text;
}

/// The columns of `fresh` in the place of those of the former columns.
void replace_columns(const SavedState& fresh, std::vector<std::vector<double>>&& columns, SavedState& state) {
  std::erase_if(state.soil.fields, [&](const SavedField& field) {
    return std::find(state.columns.begin(), state.columns.end(), field.name) != state.columns.end();
  });
  const auto after = std::find_if(state.soil.fields.begin(), state.soil.fields.end(),
                                  [](const SavedField& field) { return field.name == "body"; });
  std::vector<SavedField> made;
  for (std::size_t k = 0; k < columns.size(); ++k)
    made.push_back({fresh.columns[k], 1, find(fresh.soil, fresh.columns[k])->bytes, std::move(columns[k])});
  state.soil.fields.insert(after, std::make_move_iterator(made.begin()), std::make_move_iterator(made.end()));
  state.columns = fresh.columns, state.variables = fresh.variables;
}

bool same_pores(const PoreConfig& a, const PoreConfig& b) {
  const auto values = [](const PoreConfig& of) {
    return std::tie(of.water, of.porosity, of.grain_density, of.permeability, of.kozeny);
  };
  return values(a) == values(b);
}

}  // namespace

std::vector<char> changed_laws(const Config& before, const Config& now) {
  std::vector<char> changed(now.bodies.size());
  for (std::size_t b = 0; b < std::min(now.bodies.size(), before.bodies.size()); ++b) {
    const MaterialConfig &then = before.materials[before.bodies[b].material],
                         &is = now.materials[now.bodies[b].material];
    changed[b] = then.name != is.name || then.model != is.model || then.parameters != is.parameters ||
                 then.texts != is.texts || then.pore_stiffness != is.pore_stiffness ||
                 !same_pores(then.pores, is.pores);
  }
  return changed;
}

std::string map_state(const Config& now, const std::vector<char>& changed, const SavedState& fresh,
                      SavedState& state) {
  const SavedField* const body = find(state.soil, "body");
  const SavedField* const pore = find(state.soil, k_excess_pore_pressure);
  const Starts starts(now, state);
  std::vector<BodyLaw> laws;
  for (std::size_t b = 0; b < now.bodies.size(); ++b)
    laws.emplace_back(now, now.bodies[b], state.variables.at(b), state);
  std::vector<const SavedField*> former;
  for (const std::string& column : state.columns) former.push_back(find(state.soil, column));
  const std::size_t count = state.soil.id.size();
  std::vector<std::vector<double>> columns(fresh.columns.size(), std::vector<double>(count));
  const bool has_pore = !columns.empty() && fresh.columns.back() == k_excess_pore_pressure;
  std::vector<std::pair<std::size_t, double>> drained;  // particles whose excess pore pressure is gone, Pa
  std::string fault;
  for (std::size_t p = 0; p < count; ++p) {
    const auto b = static_cast<std::size_t>(body->values[p]);
    const double excess = pore != nullptr ? pore->values[p] : 0;
    if (has_pore && laws[b].has_pore_pressure()) columns.back()[p] = excess;
    if (changed[b] == 0) {
      for (std::size_t k = 0; k < laws[b].count(); ++k) columns[k][p] = former[k]->values[p];
      continue;
    }
    if (excess != 0 && !laws[b].has_pore_pressure()) drained.emplace_back(p, excess);
    std::string why;
    const std::vector<double> values = laws[b].values(p, starts.at(p, excess), why);
    for (std::size_t k = 0; k < values.size(); ++k) columns[k][p] = values[k];
    if (!why.empty() && fault.empty())
      fault = "the particle of body " + now.bodies[b].name + " at " + starts.place(p) +
              " m cannot go on with the material " + now.materials[now.bodies[b].material].name + ": " +
              with_name(why, now.materials[now.bodies[b].material].name);
  }
  for (SavedField& field : state.soil.fields)
    for (const auto& [p, excess] : drained)
      for (int k = 0; k < 3 && field.name == "stress"; ++k) field.values[p * field.components + k] += excess;
  replace_columns(fresh, std::move(columns), state);
  return fault;
}

void add_bodies(const std::vector<int>& bodies, const SavedState& fresh, SavedState& state) {
  const SavedField* const body = find(fresh.soil, "body");
  for (std::size_t p = 0; p < fresh.soil.id.size(); ++p) {
    if (std::find(bodies.begin(), bodies.end(), static_cast<int>(body->values[p])) == bodies.end()) continue;
    state.soil.id.push_back(fresh.soil.id[p]), state.soil.address.push_back(fresh.soil.address[p]);
    for (SavedField& field : state.soil.fields) {
      const SavedField* const from = find(fresh.soil, field.name);
      const auto row = from->values.begin() + static_cast<long>(p) * field.components;
      field.values.insert(field.values.end(), row, row + field.components);
    }
  }
  for (const int b : bodies) state.unused.at(b) = fresh.unused.at(b);
  state.alone_known = 0, state.alone.clear();
}

}  // namespace mpm
