#include "materials/any.hpp"

#include <new>

namespace mpm {
namespace {

template <class T, template <class> class... Models>
AnyMaterial<T> make(ModelList<Models...>, int which, const std::vector<double>& values) {
  AnyMaterial<T> any;
  any.which = which;
  int k = 0;
  auto fill = [&](auto* model) {
    using Model = std::remove_pointer_t<decltype(model)>;
    new (any.bytes) Model{};
    int n = 0;
    for (const auto& parameter : Model::parameters())
      reinterpret_cast<Model*>(any.bytes)->*parameter.member = static_cast<T>(values.at(n++));
    reinterpret_cast<Model*>(any.bytes)->prepare();
  };
  (void)((which == k++ ? (fill(static_cast<Models<T>*>(nullptr)), true) : false) || ...);
  return any;
}

template <template <class> class... Models>
std::vector<const char*> names(ModelList<Models...>) {
  return {Models<double>::k_name...};
}

}  // namespace

template <class T>
AnyMaterial<T> make_material(int which, const std::vector<double>& parameters) {
  return make<T>(Materials{}, which, parameters);
}
template AnyMaterial<float> make_material<float>(int, const std::vector<double>&);
template AnyMaterial<double> make_material<double>(int, const std::vector<double>&);

std::vector<const char*> material_models() { return names(Materials{}); }

double wave_modulus(const AnyMaterial<double>& material) {
  double modulus = 0;
  material.visit([&](const auto& model) { modulus = model.wave_modulus(); });
  return modulus;
}

double strength_at(const AnyMaterial<double>& material, double height) {
  double strength = 0;
  material.visit([&](const auto& model) { strength = model.strength_at(height); });
  return strength;
}

}  // namespace mpm
