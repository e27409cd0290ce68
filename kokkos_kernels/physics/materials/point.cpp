#include "physics/materials/point.hpp"

#include "physics/materials/any.hpp"

namespace mpm {
namespace {

template <class T, int Dim>
SymTensor<T, Dim> tensor_of(const std::array<double, 6>& values) {
  SymTensor<T, Dim> tensor{};
  for (int k = 0; k < sym_size<Dim>; ++k) tensor[k] = static_cast<T>(values[k]);
  return tensor;
}

template <class T, class Law>
LawState<T, state_size<Law>> state_of(const PointState& point) {
  LawState<T, state_size<Law>> state{};
  for (std::size_t k = 0; k < point.state.size(); ++k)
    state[static_cast<int>(k)] = static_cast<T>(point.state[k]);
  return state;
}

/// The increment as a step hands it to the law of a particle that does not turn.
template <class T, int Dim>
Increment<T, T, Dim> increment_of(const PointIncrement& by, const int* no_steps) {
  Increment<T, T, Dim> increment{};
  increment.strain = tensor_of<T, Dim>(by.strain);
  increment.dt = static_cast<T>(by.dt);
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j)
      increment.gradient[i][j] = static_cast<T>(by.strain[sym_index<3>(i, j)] / by.dt);
  increment.clock = {.start = by.time, .dt = by.dt, .steps = no_steps};
  return increment;
}

/// The position of a point at a height, which is along the last axis.
std::array<double, 3> position_at(double height, int dim) {
  std::array<double, 3> position{};
  position[dim - 1] = height;
  return position;
}

template <class T, int Dim>
PointState updated(const AnyMaterial<T>& material, double height, const PointState& point,
                   const PointIncrement& by) {
  int no_steps = 0;  // not constant: to load it atomically may write it
  PointState next = point;
  const auto increment = increment_of<T, Dim>(by, &no_steps);
  material.visit([&](const auto& law) {
    using Law = std::remove_cvref_t<decltype(law)>;
    auto stress = tensor_of<T, Dim>(point.stress);
    auto state = state_of<T, Law>(point);
    if constexpr (takes_place<Law>())
      law.update(stress, state, increment, ParticlePlace{.position = position_at(height, Dim)});
    else
      law.update(stress, state, increment);
    for (int k = 0; k < sym_size<Dim>; ++k) next.stress[k] = stress[k];
    for (std::size_t k = 0; k < next.state.size(); ++k) next.state[k] = state[static_cast<int>(k)];
  });
  return next;
}

template <class T, int Dim>
bool has_failed(const AnyMaterial<T>& material, const PointState& point) {
  bool failed = false;
  material.visit([&](const auto& law) {
    using Law = std::remove_cvref_t<decltype(law)>;
    if constexpr (can_fail<Law>()) failed = law.failed(state_of<T, Law>(point));
  });
  return failed;
}

template <class T, int Dim>
double modulus_at(const AnyMaterial<T>& material, const PointState& point) {
  double modulus = 0;
  material.visit([&](const auto& law) {
    using Law = std::remove_cvref_t<decltype(law)>;
    modulus = law.wave_modulus(tensor_of<T, Dim>(point.stress), state_of<T, Law>(point));
  });
  return modulus;
}

/// The law keeps its object as long as it lives.
template <class T, int Dim>
PointLaw law_in(const PointMaterial& of) {
  const auto material = make_material<T>(of.which, of.parameters, of.object.get());
  return {
      [material, object = of.object, height = of.height](const PointState& point, const PointIncrement& by) {
        return updated<T, Dim>(material, height, point, by);
      },
      [material](const PointState& point) { return has_failed<T, Dim>(material, point); },
      [material](const PointState& point) { return modulus_at<T, Dim>(material, point); }};
}

}  // namespace

PointLaw point_law(const PointMaterial& material, bool single, int dim) {
  if (single) return dim == 2 ? law_in<float, 2>(material) : law_in<float, 3>(material);
  return dim == 2 ? law_in<double, 2>(material) : law_in<double, 3>(material);
}

PointState point_start(const PointMaterial& of, int dim, const std::array<double, 6>& stress) {
  const auto material = make_material<double>(of.which, of.parameters, of.object.get());
  const ParticleStart start{.position = position_at(of.height, dim),
                            .height = of.height,
                            .stress = stress,
                            .own = {},
                            .up = dim - 1};
  PointState point{.stress = stress, .state = initial_state(material, start)};
  point.state.resize(state_variables(of.which).size());  // those that its particles do not carry are 0
  return point;
}

}  // namespace mpm
