// The options of a material, from the tables of the models. The only file of input/ that sees Kokkos.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <set>

#include "common/material_table.hpp"
#include "common/text.hpp"
#include "input/options/groups.hpp"
#include "physics/materials/any.hpp"
#include "physics/materials/list.hpp"

namespace mpm {
namespace {

/// A model's table without the types of its members.
struct ModelOptions {
  std::string name;
  std::vector<Option> options;                    // names without the material's
  std::vector<double> standard;                   // NaN: required
  std::vector<std::string> instead_of;            // the key of another parameter, or empty
  std::vector<std::vector<ParameterWord>> words;  // beside the numbers of the range, or alone
  std::vector<TextOption> texts;                  // options that are not numbers
};

/// Rule of a law's own option: a stage may change all but how the soil begins.
ChangeRule rule_of(const std::string& key) {
  if (key == "su_ratio") return k_at_stages;
  for (const char* start : {"ocr", "preconsolidation", "specific_volume", "library", "states", "state_start"})
    if (key == start) return {};
  return k_by_choice;
}

template <class M>
ModelOptions table_of() {
  ModelOptions model{M::k_name, {}, {}, {}, {}, {}};
  for (const auto& p : M::parameters()) {
    model.options.push_back({.name = p.key,
                             .meaning = p.meaning,
                             .unit = p.unit,
                             .range = {.lowest = p.lowest, .highest = p.highest},
                             .required = std::isnan(p.standard),
                             .change = rule_of(p.key)});
    model.standard.push_back(p.standard);
    model.instead_of.push_back(p.instead_of != nullptr ? p.instead_of : "");
    auto& words = model.words.emplace_back();
    for (const ParameterWord& word : p.words)
      if (word.word != nullptr) words.push_back(word);
  }
  if constexpr (requires { M::texts(); })
    for (const TextOption& text : M::texts()) model.texts.push_back(text);
  return model;
}

template <template <class> class... Models>
std::vector<ModelOptions> tables_of(ModelList<Models...>) {
  return {table_of<Models<double>>()...};
}

/// The parameter that takes the place of another; empty where there is none.
std::string stand_in_for(const ModelOptions& model, const std::string& key) {
  for (std::size_t k = 0; k < model.options.size(); ++k)
    if (model.instead_of[k] == key) return model.options[k].name;
  return "";
}

/// Reads a parameter that takes words, and numbers too where its range holds any.
void read_with_words(OptionReader& in, Option option, const std::vector<ParameterWord>& words,
                     double& value) {
  std::vector<std::string> names;
  int chosen = 0;
  for (const ParameterWord& word : words) {
    if (word.value == value) chosen = static_cast<int>(names.size()), option.standard = word.word;
    names.push_back(word.word);
  }
  const bool takes_numbers = option.range.lowest <= option.range.highest;
  const std::string given = in.given_text(option.name);
  if (!takes_numbers || std::find(names.begin(), names.end(), given) != names.end()) {
    if (in.word(option, names, chosen)) value = words[chosen].value;
  } else {
    option.aside = ", or " + one_of(names) + option.aside;
    option.words = names;
    in.number(option, value);
  }
}

void read_parameters(OptionReader& in, const std::string& name, const ModelOptions& model,
                     std::vector<double>& parameters) {
  for (std::size_t k = 0; k < model.options.size(); ++k) {
    Option option = model.options[k];
    const std::string stand_in = stand_in_for(model, option.name);
    double value = model.standard[k];
    option.name = name + "_" + option.name;
    if (!stand_in.empty()) option.aside = ", or -" + name + "_" + stand_in + " in its place";
    if (!model.instead_of[k].empty()) option.standard = "none";
    const auto only = stand_in.empty() ? in.always() : in.unless(name + "_" + stand_in);
    if (!stand_in.empty() && in.given(name + "_" + stand_in)) {
      in.not_taken(option.name, "-" + name + "_" + stand_in + " is in its place");
      value = 0;
    } else if (!model.words[k].empty()) {
      read_with_words(in, option, model.words[k], value);
    } else {
      in.number(option, value);
    }
    parameters.push_back(value);
  }
}

/// The run's -strength_factor, where the material has none of its own.
void take_strength_factor(const OptionReader& in, const ModelOptions& model, const Config& config,
                          MaterialConfig& material) {
  for (std::size_t k = 0; k < model.options.size(); ++k)
    if (model.options[k].name == "strength_factor" && !in.given(material.name + "_strength_factor"))
      material.parameters[k] = config.strength_factor;
}

/// A law's text with the material's own prefix in the place of -NAME_.
std::string with_prefix(std::string text, const std::string& name) {
  const std::string prefix = "-NAME_";
  const std::string own = "-" + name + "_";
  for (auto at = text.find(prefix); at != std::string::npos; at = text.find(prefix, at + own.size()))
    text.replace(at, prefix.size(), own);
  return text;
}

/// The options of a model that are texts, in the order of its table.
std::vector<std::string> read_texts(OptionReader& in, const std::string& name, const ModelOptions& model) {
  std::vector<std::string> texts;
  for (const TextOption& text : model.texts) {
    std::string& value = texts.emplace_back();
    const Option option{.name = name + "_" + text.key,
                        .meaning = text.meaning,
                        .required = text.required,
                        .standard = text.required ? "" : "none",
                        .change = rule_of(text.key)};
    if (!text.list_of_numbers) {
      in.text(option, value);
      continue;
    }
    std::vector<std::string> pieces;
    if (!in.list_of(option, with_prefix(text.takes, name), pieces)) continue;
    if (!std::all_of(pieces.begin(), pieces.end(), [](const auto& piece) { return parse_number(piece); }))
      in.reject(option.name, with_prefix(text.takes, name));
    value = join(pieces);
  }
  return texts;
}

/// Rejects the parameters that only other models have, each once. has_grains: the density of the grains is
/// given.
void reject_others(OptionReader& in, const std::string& name, const ModelOptions& model,
                   const std::vector<ModelOptions>& models, bool has_grains) {
  std::set<std::string> known;
  if (has_grains) known.insert("grain_density");  // of read_pores
  for (const auto& option : model.options) known.insert(option.name);
  for (const TextOption& text : model.texts) known.insert(text.key);
  const auto reject = [&](const std::string& key) {
    if (known.insert(key).second)
      in.not_taken(name + "_" + key, "the model " + model.name + " has no such parameter");
  };
  for (const ModelOptions& other : models) {
    for (const auto& option : other.options) reject(option.name);
    for (const TextOption& text : other.texts) reject(text.key);
  }
}

/// Checks the parameters together by the law itself.
void check_together(OptionReader& in, int model, const MaterialConfig& material) {
  const ParameterFault fault =
      parameter_fault(make_material<double>(model, material.parameters, material.object.get()));
  if (!fault.key.empty()) in.reject(material.name + "_" + fault.key, with_prefix(fault.takes, material.name));
}

/// Whether a single point is driven, in lieu of a mesh.
bool is_single_point(const Config& config) { return !config.element.file.empty(); }

/// Whether the model runs where the run's options say. A single point is always computed on the processor.
bool check_run(OptionReader& in, int model, const Config& config, const MaterialConfig& material) {
  if (!on_host_in_double(model)) return true;
  const bool cuda = config.backend == Backend::cuda && !is_single_point(config),
             single = config.precision == Precision::single;
  if (cuda)
    in.reject(material.name + "_model", "another model on a GPU: " + material.model +
                                            " runs on processors, with -backend serial or openmp");
  if (single)
    in.reject(material.name + "_model",
              "another model with -precision single: " + material.model + " takes -precision double");
  return !cuda && !single;
}

/// The fraction of F-bar, which is by default that of the run. Where soil dilates as it yields, F-bar creates
/// energy (docs/soils.md): only a fraction that is given holds there.
void read_f_bar(OptionReader& in, const Config& config, MaterialConfig& material) {
  const bool dilates = std::strtod(in.given_text(material.name + "_dilation_deg").c_str(), nullptr) > 0;
  const bool none = dilates && !in.given("f_bar_fraction");
  double fraction = none ? 0 : config.f_bar_fraction;
  const bool found = in.number(
      {.name = material.name + "_f_bar_fraction",
       .meaning = "f_bar_fraction of its soil",
       .unit = "-",
       .range = {.lowest = 0, .highest = 1},
       .standard =
           in.listing() ? "f_bar_fraction, or 0 where that is not given and dilation_deg is above 0" : "",
       .change = k_by_choice},
      fraction);
  if (found || none) material.f_bar_fraction = fraction;
}

}  // namespace

double parameter_of(const MaterialConfig& material, const std::string& key) {
  for (const ModelOptions& model : tables_of(Materials{}))
    for (std::size_t k = 0; k < model.options.size(); ++k)
      if (model.name == material.model && model.options[k].name == key)
        return k < material.parameters.size() ? material.parameters[k] : model.standard[k];
  return std::numeric_limits<double>::quiet_NaN();
}

void read_material(OptionReader& in, const std::string& name, const MeshConfig* mesh, const Config& config,
                   MaterialConfig& material) {
  const auto models = tables_of(Materials{});
  std::vector<std::string> words;
  for (const ModelOptions& model : models) words.push_back(model.name);

  material.name = name;
  in.section("Each material NAME", {"materials"});
  int chosen = 0;
  const bool known = in.word({.name = name + "_model", .meaning = "its constitutive model", .required = true},
                             words, chosen);
  read_pores(in, config, material);
  if (const auto only = in.where(name + "_water", {"off"});
      in.listing() || material.pores.water == PoreWater::drained) {
    in.number({.name = name + "_density",
               .meaning = "initial density",
               .unit = "kg/m3",
               .range = k_density,
               .required = true},
              material.density);
    in.number(
        {.name = name + "_pore_stiffness",
         .meaning = "undrained loading: stiffness of the pore water, its bulk modulus over the porosity, "
                    "which gives an excess pore pressure; 0: drained",
         .unit = "Pa",
         .range = {.lowest = 0, .highest = 1e12},
         .change = k_by_choice},
        material.pore_stiffness);
  }
  in.number({.name = name + "_k0",
             .meaning = "horizontal over vertical effective stress of bodies with the stress k0",
             .unit = "-",
             .range = {.lowest = 0, .highest = 10},
             .standard = "1 - sin(friction), or nu/(1 - nu) without friction, none for cam_clay and umat"},
            material.k0);
  read_f_bar(in, config, material);
  if (in.listing()) {
    for (std::size_t k = 0; k < models.size(); ++k)
      if (on_host_in_double(static_cast<int>(k)))
        in.restricts(name + "_model", "another model than " + words[k] +
                                          " with -backend cuda or -precision single: it runs on processors "
                                          "in double precision");
    for (const ModelOptions& model : models) {
      in.section("Material NAME of model " + model.name, {"materials"});
      const auto only = in.where(name + "_model", {model.name});
      read_parameters(in, name, model, material.parameters);
      read_texts(in, name, model);
    }
  } else if (known) {
    const auto errors = in.errors();
    material.model = words[chosen];
    read_parameters(in, name, models[chosen], material.parameters);
    take_strength_factor(in, models[chosen], config, material);
    material.texts = read_texts(in, name, models[chosen]);
    const bool sound = check_run(in, chosen, config, material) && in.errors() == errors;
    if (sound && is_single_point(config))
      check_together(in, chosen, material);
    else if (sound)
      make_law_object(in, mesh ? *mesh : MeshConfig{}, config.dim, material);
    reject_others(in, name, models[chosen], models, material.pores.water != PoreWater::drained);
  } else {
    in.ignore(name + "_");
  }
}

void make_law_object(OptionReader& in, const MeshConfig& mesh, int dim, MaterialConfig& material) {
  const int model = model_index(material.model);
  ParameterFault fault;
  material.object = make_object(model, {material.name, material.texts, dim, mesh.lower, mesh.spacing}, fault);
  if (!fault.key.empty())
    in.reject(material.name + "_" + fault.key, with_prefix(fault.takes, material.name));
  else
    check_together(in, model, material);
}

std::vector<std::string> warnings_of_law(const MaterialConfig& material) {
  const int model = model_index(material.model);
  if (model < 0) return {};
  const std::string text =
      warning_of(make_material<double>(model, material.parameters, material.object.get()));
  return text.empty() ? std::vector<std::string>{} : split(with_prefix(text, material.name), '\n');
}

void prepare_material(MaterialConfig& material, double spacing, double largest_pressure) {
  material.parameters =
      parameters_for(model_index(material.model), material.parameters, {spacing, largest_pressure});
}

std::string own_parameter_fault(const MaterialConfig& material, const std::string& key, double least,
                                double largest) {
  const int which = model_index(material.model);
  const ModelOptions model = tables_of(Materials{})[which];
  MaterialConfig weakest = material;
  for (std::size_t k = 0; k < model.options.size(); ++k) {
    const Option& option = model.options[k];
    if (option.name != key) continue;
    const std::string takes =
        "particles whose " + key + " is a number in " + option.unit + option.range.text();
    if (!option.range.holds(least)) return takes + "; the least of this file is " + text_of(least);
    if (!option.range.holds(largest)) return takes + "; the largest of this file is " + text_of(largest);
    if (parameter_of(material, key) != k_young_of_particle) weakest.parameters.at(k) = least;
  }
  const ParameterFault fault =
      parameter_fault(make_material<double>(which, weakest.parameters, weakest.object.get()));
  if (fault.key != key) return "";
  return "particles whose " + key + " is " + with_prefix(fault.takes, material.name) +
         "; the least of this file is " + text_of(least);
}

bool check_start(OptionReader& in, const std::string& body, const MaterialConfig& material, double height,
                 const Sym6& stress, int dim, const OwnValues& own) {
  const auto law =
      make_material<double>(model_index(material.model), material.parameters, material.object.get());
  const ParameterFault fault =
      start_fault(law, {.position = {}, .height = height, .stress = stress, .own = own, .up = dim - 1});
  if (fault.key.empty()) return true;
  const bool of_body = fault.key == "stress";
  in.reject((of_body ? body : material.name) + "_" + fault.key, with_prefix(fault.takes, material.name));
  return false;
}

bool may_start(const MaterialConfig& material, double height, const Sym6& stress, int dim,
               const OwnValues& own) {
  const auto law =
      make_material<double>(model_index(material.model), material.parameters, material.object.get());
  return start_fault(law, {.position = {}, .height = height, .stress = stress, .own = own, .up = dim - 1})
      .key.empty();
}

bool needs_own_young(const MaterialConfig& material) {
  return parameter_of(material, "young") == k_young_of_particle;
}

bool check_element_start(OptionReader& in, const MaterialConfig& material, double height,
                         const Sym6& stress) {
  const auto law =
      make_material<double>(model_index(material.model), material.parameters, material.object.get());
  const ParameterFault fault = start_fault(law, {.position = {}, .height = height, .stress = stress});
  if (fault.key.empty()) return true;
  const std::string takes = with_prefix(fault.takes, material.name);
  if (fault.key == "stress")
    in.reject("element_path", "a start (row 0) with " + takes);
  else
    in.reject(material.name + "_" + fault.key, takes);
  return false;
}

bool has_strength(const MaterialConfig& material) {
  constexpr double k_far = 1e9;  // m
  const int model = model_index(material.model);
  if (model < 0) return false;  // reported
  if (parameter_of(material, "su_ratio") > 0) return true;
  const AnyMaterial<double> law = make_material<double>(model, material.parameters, material.object.get());
  return strength_at(law, -k_far) > 0 || strength_at(law, k_far) > 0;
}

bool has_strength(const Config& config, const BodyConfig& body) {
  return body.material < static_cast<int>(config.materials.size()) &&
         has_strength(config.materials[body.material]);
}

}  // namespace mpm
