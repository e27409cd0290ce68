// The options of a material, from the tables of the models. The only file of input/ that sees Kokkos.

#include <cmath>

#include "input/groups.hpp"
#include "input/text.hpp"
#include "materials/list.hpp"

namespace mpm {
namespace {

/// A model's table without the types of its members.
struct Model {
  std::string name;
  std::vector<Option> options;   // names without the material's
  std::vector<double> standard;  // NaN: required
};

template <class M>
Model table_of() {
  Model model{M::k_name, {}, {}};
  for (const auto& p : M::parameters()) {
    model.options.push_back({.name = p.key,
                             .meaning = p.meaning,
                             .unit = p.unit,
                             .range = {.lowest = p.lowest, .highest = p.highest},
                             .required = std::isnan(p.standard)});
    model.standard.push_back(p.standard);
  }
  return model;
}

template <template <class> class... Models>
std::vector<Model> tables_of(ModelList<Models...>) {
  return {table_of<Models<double>>()...};
}

void read_parameters(OptionReader& in, const std::string& name, const Model& model,
                     std::vector<double>& parameters) {
  for (std::size_t k = 0; k < model.options.size(); ++k) {
    Option option = model.options[k];
    option.name = name + "_" + option.name;
    double value = model.standard[k];
    in.number(option, value);
    parameters.push_back(value);
  }
}

/// Rejects the parameters that only other models have.
void reject_others(OptionReader& in, const std::string& name, const Model& model,
                   const std::vector<Model>& models) {
  const auto has = [](const Model& m, const std::string& key) {
    for (const auto& option : m.options)
      if (option.name == key) return true;
    return false;
  };
  for (const Model& other : models)
    for (const auto& option : other.options)
      if (!has(model, option.name))
        in.not_taken(name + "_" + option.name, "the model " + model.name + " has no such parameter");
}

}  // namespace

void read_material(OptionReader& in, const std::string& name, MaterialConfig& material) {
  const auto models = tables_of(Materials{});
  std::vector<std::string> words;
  for (const Model& model : models) words.push_back(model.name);

  material.name = name;
  in.section("Each material NAME");
  int chosen = 0;
  const bool known = in.word({.name = name + "_model", .meaning = "its constitutive model", .required = true},
                             words, chosen);
  in.number({.name = name + "_density",
             .meaning = "initial density",
             .unit = "kg/m3",
             .range = k_positive,
             .required = true},
            material.density);
  if (in.listing()) {
    for (const Model& model : models) {
      in.section("Material NAME of model " + model.name);
      read_parameters(in, name, model, material.parameters);
    }
  } else if (known) {
    material.model = words[chosen];
    read_parameters(in, name, models[chosen], material.parameters);
    reject_others(in, name, models[chosen], models);
  } else {
    in.ignore(name + "_");
  }
}

}  // namespace mpm
