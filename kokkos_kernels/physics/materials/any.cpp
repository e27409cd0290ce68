#include "physics/materials/any.hpp"

#include <cmath>
#include <limits>
#include <new>

namespace mpm {
namespace {

template <class T, template <class> class... Models>
AnyMaterial<T> make(ModelList<Models...>, int which, const std::vector<double>& values,
                    [[maybe_unused]] const void* object) {
  AnyMaterial<T> any;
  any.which = which;
  int k = 0;
  auto fill = [&](auto* model) {
    using Model = std::remove_pointer_t<decltype(model)>;
    new (any.bytes) Model{};
    std::size_t n = 0;
    for (const auto& parameter : Model::parameters()) {
      const bool left_out = n >= values.size() && !std::isnan(parameter.standard);
      reinterpret_cast<Model*>(any.bytes)->*parameter.member =
          static_cast<T>(left_out ? parameter.standard : values.at(n));
      ++n;
    }
    if constexpr (requires { typename Model::Object; })
      reinterpret_cast<Model*>(any.bytes)->object = static_cast<const typename Model::Object*>(object);
    reinterpret_cast<Model*>(any.bytes)->prepare();
  };
  (void)((which == k++ ? (fill(static_cast<Models<T>*>(nullptr)), true) : false) || ...);
  return any;
}

template <template <class> class... Models>
std::vector<const char*> names(ModelList<Models...>) {
  return {Models<double>::k_name...};
}

template <template <class> class... Models>
std::vector<std::vector<StateVariable>> tables(ModelList<Models...>) {
  const auto list = [](const auto& table) { return std::vector<StateVariable>(table.begin(), table.end()); };
  return {list(Models<double>::state())...};
}

template <template <class> class... Models>
std::vector<bool> changing(ModelList<Models...>) {
  return {stiffness_changes<Models<double>>()...};
}

template <template <class> class... Models>
std::vector<bool> of_host(ModelList<Models...>) {
  return {on_host_in_double<Models<double>>()...};
}

template <class Law>
constexpr const char* failure_of_law() {
  if constexpr (can_fail<Law>()) return Law::k_failure;
  return "";
}

template <template <class> class... Models>
std::vector<const char*> failures(ModelList<Models...>) {
  return {failure_of_law<Models<double>>()...};
}

/// The state of a particle that is created at a height [m] with a stress [Pa].
template <class Law>
auto start_of(const Law& law, double height, const std::array<double, 6>& stress = {},
              const OwnValues& own = {}, int up = 1) {
  LawState<double, state_size<Law>> state{};
  const auto start = law.initial_state({.height = height, .stress = stress, .own = own, .up = up});
  for (int k = 0; k < static_cast<int>(start.size()); ++k) state[k] = start[k];
  return state;
}

}  // namespace

template <class T>
AnyMaterial<T> make_material(int which, const std::vector<double>& parameters, const void* object) {
  return make<T>(Materials{}, which, parameters, object);
}
template AnyMaterial<float> make_material<float>(int, const std::vector<double>&, const void*);
template AnyMaterial<double> make_material<double>(int, const std::vector<double>&, const void*);

std::shared_ptr<const void> make_object(int which, const LawSetup& setup, ParameterFault& fault) {
  std::shared_ptr<const void> object;
  AnyMaterial<double> any;  // the law's type alone is asked for
  any.visit_as(Materials{}, which, [&](const auto& law) {
    using Law = std::decay_t<decltype(law)>;
    if constexpr (requires { typename Law::Object; }) object = Law::make_object(setup, fault);
  });
  return object;
}

template <class T>
StoredMaterial<T> store_material(int which, const std::vector<double>& parameters, const void* object,
                                 double pore_stiffness, bool saturated) {
  StoredMaterial<T> stored{};
  auto* const material = new (stored.bytes) AnyMaterial<T>(make_material<T>(which, parameters, object));
  material->pore_stiffness = static_cast<T>(pore_stiffness);
  material->saturated = saturated;
  return stored;
}
template StoredMaterial<float> store_material<float>(int, const std::vector<double>&, const void*, double,
                                                     bool);
template StoredMaterial<double> store_material<double>(int, const std::vector<double>&, const void*, double,
                                                       bool);

std::vector<const char*> material_models() { return names(Materials{}); }

std::vector<StateVariable> state_variables(int which) { return tables(Materials{})[which]; }

bool stiffness_changes(int which) { return changing(Materials{})[which]; }

bool on_host_in_double(int which) { return of_host(Materials{})[which]; }

ParameterFault parameter_fault(const AnyMaterial<double>& material) {
  ParameterFault fault;
  material.visit([&](const auto& law) { fault = law.check(); });
  return fault;
}

ParameterFault start_fault(const AnyMaterial<double>& material, const ParticleStart& at) {
  ParameterFault fault;
  material.visit([&](const auto& law) {
    if constexpr (requires { law.start_fault(at); }) fault = law.start_fault(at);
  });
  return fault;
}

std::vector<double> parameters_for(int which, const std::vector<double>& parameters, const RunFigures& run) {
  std::vector<double> values = parameters;
  make_material<double>(which, parameters).visit([&](auto law) {
    if constexpr (requires { law.prepare_for(run); }) {
      law.prepare_for(run);
      values.clear();
      for (const auto& parameter : law.parameters()) values.push_back(law.*parameter.member);
    }
  });
  return values;
}

const char* failure_of(int which) { return failures(Materials{})[which]; }

std::vector<StateVariable> state_variables(const AnyMaterial<double>& material) {
  std::vector<StateVariable> carried;
  material.visit([&](const auto& law) {
    const auto table = law.state();
    for (int k = 0; k < static_cast<int>(table.size()); ++k)
      if (carries(law, k)) carried.push_back(table[k]);
  });
  return carried;
}

std::vector<StateVariable> state_variables(int which, const std::vector<double>& parameters) {
  return state_variables(make_material<double>(which, parameters));
}

double parameter_of(int which, const std::vector<double>& parameters, const std::string& key) {
  double value = std::numeric_limits<double>::quiet_NaN();
  make_material<double>(which, parameters).visit([&](const auto& law) {
    for (const auto& parameter : law.parameters())
      if (key == parameter.key) value = law.*parameter.member;
  });
  return value;
}

double largest_time_step(const AnyMaterial<double>& material, double spacing, double density, int dim) {
  double step = std::numeric_limits<double>::infinity();
  material.visit([&](const auto& law) {
    if constexpr (requires { law.largest_time_step(spacing, density, dim); })
      step = law.largest_time_step(spacing, density, dim);
  });
  return step;
}

std::string warning_of(const AnyMaterial<double>& material) {
  std::string lines;
  material.visit([&](const auto& law) {
    if constexpr (requires { law.warning(); }) lines = law.warning();
  });
  return lines;
}

std::vector<double> initial_state(const AnyMaterial<double>& material, const ParticleStart& at) {
  std::vector<double> values;
  material.visit([&](const auto& law) {
    const auto state = law.initial_state(at);
    for (int k = 0; k < static_cast<int>(state.size()); ++k)
      if (carries(law, k)) values.push_back(state[k]);
  });
  return values;
}

double wave_modulus(const AnyMaterial<double>& material, double height, const std::array<double, 6>& stress,
                    const OwnValues& own) {
  double modulus = 0;
  SymTensor<double, 3> start;
  for (int k = 0; k < sym_size<3>; ++k) start[k] = stress[k];
  material.visit(
      [&](const auto& law) { modulus = law.wave_modulus(start, start_of(law, height, stress, own)); });
  return modulus;
}

double strength_at(const AnyMaterial<double>& material, double height) {
  double strength = 0;
  material.visit([&](const auto& law) { strength = law.shear_strength(start_of(law, height)); });
  return strength;
}

}  // namespace mpm
