// Reports on the state: rows of the history, frames, the cost of batches.

#include <algorithm>

#include "base/copy.hpp"
#include "common/text.hpp"
#include "data/memory_of.hpp"
#include "parallel/gather.hpp"
#include "step/load_input.hpp"
#include "step/typed_stepper.hpp"
#include "step/water.hpp"

namespace mpm {
namespace {

/// Vectors with three components, positions from the origin.
template <int Dim>
ParticleSnapshot node_snapshot(NodeFields&& nodes, const Vec3& lower) {
  ParticleSnapshot out;
  out.name = k_nodes;
  out.position.assign(3 * nodes.mass.size(), 0);
  out.velocity = out.position;
  for (std::size_t n = 0; n < nodes.mass.size(); ++n)
    for (int d = 0; d < Dim; ++d) {
      out.position[3 * n + d] = nodes.position[n * Dim + d] + lower[d];
      out.velocity[3 * n + d] = nodes.velocity[n * Dim + d];
    }
  out.mass = std::move(nodes.mass), out.number = std::move(nodes.number);
  return out;
}

}  // namespace

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::measure(double interval, HistoryRow* row) {
  PetscFunctionBeginUser;
  row->bodies.clear(), row->rigids.clear();
  set_gravity(row->time);
  set_loads(row->time);
  collect_soil(state_);
  PetscCall(sum_soil());
  for (int b = 0; b < static_cast<int>(config_.bodies.size()); ++b) {
    BodyRow body;
    PetscCall(measure_body(b, &body));
    row->bodies.push_back(body);
  }
  PetscCall(measure_loads(row));
  if (state_.energy.on) PetscCall(measure_energy(row));
  PetscCall(count_cells(row));
  row->walls = wall_forces(state_);
  if (ranks_)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, row->walls[0][0].data(), 18, MPI_DOUBLE, MPI_SUM, comm_));
  PetscCall(measure_sides(interval, row));
  for (const Rigid<Dim>& r : take_rigids(state_)) {
    RigidRow rigid;
    double impulse[Dim];
    for (int d = 0; d < Dim; ++d) impulse[d] = r.impulse[d];
    if (ranks_ && !ranks_->forces_shared())
      PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, impulse, Dim, MPI_DOUBLE, MPI_SUM, comm_));
    for (int d = 0; d < Dim; ++d) {
      rigid.displacement[d] = r.pose.displacement[d];
      rigid.velocity[d] = velocity_of(row->rigids.size(), d, r.velocity[d], row->time);
      rigid.force[d] = interval > 0 ? impulse[d] / interval : 0;
    }
    row->rigids.push_back(rigid);
  }
  rigids_.widen(row->rigids);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Gravity at a time [s], where it follows a table, for what is measured.
template <class Space, class T, int Dim>
void TypedStepper<Space, T, Dim>::set_gravity(double time) {
  for (int d = 0; d < Dim && config_.gravity_table; ++d)
    state_.gravity[d] = gravity_at(config_, d, time - config_.time.start);
}

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::unbalanced_ratio(double time, double* ratio) {
  PetscFunctionBeginUser;
  collect_soil(state_);
  set_gravity(time);
  set_loads(time);
  sum_present_soil(state_);
  buoyancy_to_nodes(state_);
  loads_to_nodes(state_);
  if (ranks_) PetscCall(ranks_->add_present_soil(state_));
  if (state_.shear_fraction) PetscCall(strength_to_nodes(state_, ranks_.get()));
  const UnbalancedForces own = unbalanced_forces(state_, step_ > 0 ? step_ : critical_time_step(config_));
  double sums[2] = {own.force, own.weight};
  if (ranks_) PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, comm_));
  *ratio = sums[1] > 0 ? sums[0] / sums[1] : std::numeric_limits<double>::infinity();
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Component d of the velocity of rigid r [m/s]. `present`: on the device, that of the next step; a table
/// tells that of the time.
template <class Space, class T, int Dim>
double TypedStepper<Space, T, Dim>::velocity_of(std::size_t r, int d, double present, double time) const {
  return velocity_at(config_.rigids[r], d, present, time - config_.time.start);
}

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::fastest_wave(double compression, double* speed) {
  PetscFunctionBeginUser;
  collect_soil(state_);
  *speed = mpm::fastest_wave(state_, compression);
  if (ranks_) PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, speed, 1, MPI_DOUBLE, MPI_MAX, comm_));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::closing_speed(double* speed) {
  PetscFunctionBeginUser;
  collect_soil(state_);
  VelocityRange range = velocity_range(state_);
  const auto widen = [&range](int d, double velocity) {
    range.least[d] = std::min(range.least[d], velocity), range.most[d] = std::max(range.most[d], velocity);
  };
  const auto rigids = mirror_of(state_.rigids);
  for (int d = 0; d < Dim; ++d) {
    for (std::size_t r = 0; r < config_.rigids.size(); ++r)
      widen(d, config_.rigids[r].velocity[d]), widen(d, rigids(r).velocity[d]);
    for (const auto& pair : config_.mesh.sides)
      for (const SideConfig& side : pair) widen(d, side.velocity[d]);
  }
  if (ranks_) {
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, range.least, 3, MPI_DOUBLE, MPI_MIN, comm_));
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, range.most, 3, MPI_DOUBLE, MPI_MAX, comm_));
  }
  *speed = 0;
  for (int d = 0; d < Dim; ++d) *speed += range.most[d] - range.least[d];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// The state variables of a body's particles [from, to) that frames have, and of the parameters of which they
/// have own values (own_parameters), these. Every body has a plastic strain there, so that pictures of all
/// bodies may show it: zero where the law has none.
std::vector<StateField> state_fields(const std::vector<StateVariable>& variables,
                                     const std::vector<std::string>& own_parameters, const SoilFields& soil,
                                     std::size_t from, std::size_t to) {
  std::vector<StateField> fields;
  bool has_plastic_strain = false;
  for (std::size_t k = 0; k < variables.size(); ++k) {
    const StateVariable& variable = variables[k];
    const bool own = variable.parameter != nullptr && std::find(own_parameters.begin(), own_parameters.end(),
                                                                variable.parameter) != own_parameters.end();
    if (!variable.output && !own) continue;
    const auto begin = soil.history[k].begin();
    fields.push_back({own ? variable.parameter : variable.name,
                      {begin + static_cast<long>(from), begin + static_cast<long>(to)}});
    has_plastic_strain = has_plastic_strain || fields.back().name == "plastic_strain";
  }
  if (!has_plastic_strain) fields.push_back({"plastic_strain", std::vector<double>(to - from)});
  return fields;
}

/// The columns of the particles [from, to) that frames have.
template <int Dim>
void frame_columns(const SoilFields& soil, std::size_t from, std::size_t to, ParticleSnapshot* body) {
  for (const ParticleColumn& column : k_particle_columns) {
    const std::vector<double>& values = soil.*column.values;
    if (column.framed == Framed::no || values.empty()) continue;
    const int n = width_of(column.width, Dim, 0), wide = framed_width(column.width);
    std::vector<double>& framed = body->*column.values;
    framed.assign(wide * (to - from), 0);
    for (std::size_t p = from; p < to; ++p)
      for (int k = 0; k < n; ++k)
        framed[(p - from) * wide + framed_place(column.width, Dim, k)] = values[p * n + k];
  }
}

/// Where frames have pore pressures: adds those of the particles [from, to) to a body's fields, and makes its
/// stress total. `pore`: column of the excess pressure, -1 where there is none.
template <int Dim>
void add_pore_pressures(const Config& config, const SoilFields& soil, int pore, std::size_t from,
                        std::size_t to, ParticleSnapshot* body) {
  const Water<Dim> water = water_of<Dim>(config);
  std::vector<double> excess(to - from), total(to - from);
  for (std::size_t p = from; p < to; ++p) {
    Vector<double, Dim> x;
    for (int d = 0; d < Dim; ++d) x[d] = soil.position[p * Dim + d];
    const double hydrostatic = water.is_there() ? water.pressure(x) : 0.0;
    if (pore >= 0) excess[p - from] = soil.history[pore][p];
    total[p - from] = hydrostatic + excess[p - from];
    for (int k = 0; k < 3; ++k) body->stress[6 * (p - from) + k] -= hydrostatic;
  }
  body->state.push_back({"pore_pressure", std::move(total)});
  if (pore >= 0) body->state.push_back({k_excess_pore_pressure, std::move(excess)});
}

/// The half lengths of the particles [from, to), where domains stretch.
template <int Dim>
void add_half_lengths(const SoilFields& soil, std::size_t from, std::size_t to, ParticleSnapshot* body) {
  static constexpr const char* names[] = {"half_length_x", "half_length_y", "half_length_z"};
  for (int d = 0; d < Dim; ++d) {
    StateField field{names[d], {}};
    for (std::size_t p = from; p < to; ++p) field.values.push_back(soil.half_length[p * Dim + d]);
    body->state.push_back(std::move(field));
  }
}

/// The area of the faces of loads, as a vector, of the particles [from, to).
template <int Dim>
void add_load_areas(const SoilFields& soil, std::size_t from, std::size_t to, ParticleSnapshot* body) {
  static constexpr const char* names[] = {"load_area_x", "load_area_y", "load_area_z"};
  for (int d = 0; d < Dim; ++d) {
    StateField field{names[d], {}};
    for (std::size_t p = from; p < to; ++p) field.values.push_back(soil.load_area[p * Dim + d]);
    body->state.push_back(std::move(field));
  }
}

/// Along periodic directions, how many lengths of the mesh the particles [from, to) have gone beyond it.
template <int Dim>
void add_periods(const MeshConfig& mesh, const SoilFields& soil, std::size_t from, std::size_t to,
                 ParticleSnapshot* body) {
  static constexpr const char* names[] = {"periods_x", "periods_y", "periods_z"};
  for (int d = 0; d < Dim; ++d) {
    if (!is_periodic(mesh, d)) continue;
    StateField field{names[d], {}};
    for (std::size_t p = from; p < to; ++p) field.values.push_back(soil.periods[p * Dim + d]);
    body->state.push_back(std::move(field));
  }
}

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::snapshot(Snapshot* out) {
  PetscFunctionBeginUser;
  collect_soil(state_);
  const SoilFields soil = download_soil(state_);
  PetscCall(sum_soil());
  const std::vector<double> grid_velocity = grid_velocities(state_, order_for_host(state_));
  const bool splits = state_.soil.points.splits;
  std::vector<long> created(soil.id.begin(), soil.id.end());
  if (splits) created.assign(soil.ancestor.begin(), soil.ancestor.end());
  std::vector<double> height;
  PetscCall(heights_.look_up(created, &height));
  out->dim = Dim;
  out->bodies.clear(), out->rigids.clear(), out->nodes.clear();
  for (std::size_t b = 0; b < config_.bodies.size(); ++b) {
    const std::size_t from = soil.first[b], to = soil.first[b + 1];
    // Particles that were split have numbers of their own, whatever their body.
    const long first = splits ? 0 : first_[b], last = splits                  ? ids()
                                                      : b + 1 < first_.size() ? first_[b + 1]
                                                                              : total_;
    ParticleSnapshot body;
    body.name = config_.bodies[b].name;
    for (std::size_t p = from; p < to && ranks_; ++p) body.id.push_back(soil.id[p] - static_cast<int>(first));
    frame_columns<Dim>(soil, from, to, &body);
    body.grid_velocity.assign(3 * (to - from), 0);
    for (std::size_t p = from; p < to; ++p)
      for (int d = 0; d < Dim; ++d) {
        body.position[3 * (p - from) + d] += config_.mesh.lower[d];
        body.grid_velocity[3 * (p - from) + d] = grid_velocity[p * Dim + d];
      }
    const auto variables = state_variables(config_.materials[config_.bodies[b].material]);
    body.own_names = given_parameters(config_.bodies[b], variables);
    body.state = state_fields(variables, body.own_names, soil, from, to);
    if (has_pore_pressure(config_))  // of all bodies, so that pictures may show them
      add_pore_pressures<Dim>(config_, soil, state_.soil.points.history.pore, from, to, &body);
    add_periods<Dim>(config_.mesh, soil, from, to, &body);
    if (state_.soil.points.face_count > 0) add_load_areas<Dim>(soil, from, to, &body);
    if (state_.soil.points.has_domain) add_half_lengths<Dim>(soil, from, to, &body);
    body.reference_height.assign(height.begin() + from, height.begin() + to);
    if (ranks_) PetscCall(order_particles(comm_, last - first, &body));
    out->bodies.push_back(std::move(body));
  }
  const auto rigids = mirror_of(state_.rigids);
  for (std::size_t r = 0; r < config_.rigids.size(); ++r) {
    const std::vector<double> position = download_rigid_positions(state_, static_cast<int>(r));
    ParticleSnapshot rigid;
    rigid.name = config_.rigids[r].name;
    rigid.position.assign(3 * (position.size() / Dim), 0);
    rigid.velocity = rigid.position;
    for (std::size_t p = 0; p < position.size() / Dim; ++p)
      for (int d = 0; d < Dim; ++d) {
        rigid.position[3 * p + d] = position[p * Dim + d] + config_.mesh.lower[d];
        rigid.velocity[3 * p + d] = velocity_of(r, d, rigids(r).velocity[d], out->time);
      }
    out->rigids.push_back(std::move(rigid));
  }
  rigids_.widen(out->rigids);
  if (config_.output.nodes) {
    out->nodes = {node_snapshot<Dim>(download_nodes(state_), config_.mesh.lower)};
    if (ranks_) PetscCall(gather_nodes(comm_, &out->nodes[0]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::keep_heights(const Model& model) {
  PetscFunctionBeginUser;
  std::vector<long> id;
  std::vector<double> height;
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const BodyParticles& body = model.bodies[b];
    height.insert(height.end(), body.reference_height.begin(), body.reference_height.end());
    for (long p = 0; p < static_cast<long>(body.reference_height.size()); ++p)
      id.push_back(body.id.empty() ? first_[b] + p : body.id[p]);
  }
  PetscCall(heights_.keep(comm_, total_, id, height));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::save_for_starts(SavedState* saved) const {
  PetscFunctionBeginUser;
  SavedField height{"reference_height", 1, sizeof(double), {}};
  std::vector<long> created = saved->soil.id;
  for (const SavedField& field : saved->soil.fields)
    if (field.name == "ancestor") created.assign(field.values.begin(), field.values.end());
  PetscCall(heights_.look_up(created, &height.values));
  const auto& soil = state_.soil.points;
  if (!soil.has_own_mass) {  // else it is there
    const auto bodies = mirror_of(soil.bodies);
    SavedField mass{"mass", 1, sizeof(T), {}};
    for (const SavedField& field : saved->soil.fields)
      if (field.name == "body")
        for (const double b : field.values) mass.values.push_back(bodies(static_cast<int>(b)).mass);
    saved->soil.fields.push_back(std::move(mass));
  }
  saved->soil.fields.push_back(std::move(height));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
Failure TypedStepper<Space, T, Dim>::too_small() const {
  const auto& b = state_.batches;
  if (b.limit >= b.least) return {};
  constexpr double k_above = 1.0005;  // so that what is told takes no less
  return {formatted("-device_memory_limit: given %.4g GiB, takes at least %.4g GiB for these particles",
                    b.limit / k_gib, k_above * b.least / k_gib)};
}

template <class Space, class T, int Dim>
std::string TypedStepper<Space, T, Dim>::batches_report() const {
  const auto& b = state_.batches;
  if (!b.in_use() || b.all.empty()) return {};
  int most = 0, stay = 0;
  for (const auto& batch : b.all) {
    most = std::max(most, batch.last - batch.first);
    stay += batch.stays;
  }
  const int batches = static_cast<int>(b.all.size()), turns = batches - stay;
  std::string text = formatted(
      "%d batches of at most %d particles: %d stay on the device, %d take turns in %d places; "
      "%.4g of %.4g GiB of the device, %.4g GiB of the host",
      batches, most, stay, turns, b.places - stay, memory_of(state_) / k_gib, b.limit / k_gib,
      b.store.extent(0) / k_gib);
  const BatchCost& c = b.cost;
  if (turns == 0 || c.sampled == 0 || c.steps == c.sampled || stepping_ <= 0) return text;
  // Means of a step; what copies and kernels take alone is from the steps that were sampled.
  const double in = c.copied_in / c.steps, out = c.copied_out / c.steps;
  const double in_alone = c.in_seconds / c.sampled, out_alone = c.out_seconds / c.sampled;
  const double kernels = c.kernel_seconds / c.sampled, update = c.seconds / (c.steps - c.sampled);
  const double beside = std::max(0.0, stepping_ - c.seconds - c.sampled * (in_alone + kernels + out_alone));
  const double step = update + beside / c.steps;
  text += formatted("\n  a step copies %.4g MB to the device and %.4g MB back, alone at %.1f and %.1f GB/s",
                    in / 1e6, out / 1e6, in / in_alone / 1e9, out / out_alone / 1e9);
  text += formatted(
      "\n  with them the update of the particles takes %.4g us, %.1f %% of a step; its kernels alone "
      "%.4g us",
      1e6 * update, 100 * update / step, 1e6 * kernels);
  return text + formatted("\n  a step of %.4g us takes %.3g times as long as without copies", 1e6 * step,
                          step / (step - update + kernels));
}

#define MPM_INSTANTIATE(Space, T, Dim)                                                     \
  template PetscErrorCode TypedStepper<Space, T, Dim>::measure(double, HistoryRow*);       \
  template PetscErrorCode TypedStepper<Space, T, Dim>::unbalanced_ratio(double, double*);  \
  template void TypedStepper<Space, T, Dim>::set_gravity(double);                          \
  template PetscErrorCode TypedStepper<Space, T, Dim>::fastest_wave(double, double*);      \
  template PetscErrorCode TypedStepper<Space, T, Dim>::closing_speed(double*);             \
  template PetscErrorCode TypedStepper<Space, T, Dim>::snapshot(Snapshot*);                \
  template PetscErrorCode TypedStepper<Space, T, Dim>::keep_heights(const Model&);         \
  template PetscErrorCode TypedStepper<Space, T, Dim>::save_for_starts(SavedState*) const; \
  template Failure TypedStepper<Space, T, Dim>::too_small() const;                         \
  template std::string TypedStepper<Space, T, Dim>::batches_report() const;
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
