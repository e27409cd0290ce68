#include "step/typed_stepper.hpp"

#include <algorithm>

#include "common/courant.hpp"
#include "common/f_bar.hpp"
#include "common/text.hpp"
#include "device/device_agrees.hpp"
#include "functions/find_strays.hpp"
#include "functions/interfaces.hpp"
#include "functions/part_forces.hpp"
#include "functions/pore_flow.hpp"
#include "functions/step_kernels.hpp"
#include "rebuild/about_nodes.hpp"
#include "rebuild/batches.hpp"
#include "rebuild/limit_volumes.hpp"
#include "step/body_input.hpp"
#include "step/flow_input.hpp"
#include "step/follow_soil.hpp"
#include "step/interface_input.hpp"
#include "step/interface_snapshot.hpp"
#include "step/pair_input.hpp"
#include "step/water.hpp"
#include "transfer/restore_state.hpp"

namespace mpm {

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::set_up(Model&& model, Failure* failure) {
  PetscFunctionBeginUser;
  auto& s = run_.state;
  const Config& config = run_.config;
  PetscCheck(device_agrees(s.space), PETSC_COMM_SELF, PETSC_ERR_LIB,
             "kernels do not see what the host sends them: this Kokkos was built so that nvcc and the host "
             "compiler lay out "
             "views differently; build it with Kokkos_ENABLE_IMPL_MDSPAN=OFF");
  PetscCall(loop_.set_up(model.from_run));
  ids_.assign(model.bodies, Dim);
  PetscCall(snapshots_.keep_heights(&model.bodies));
  PetscCall(ids_.leave_out(run_.comm, Dim, &model.bodies));
  GridInput grid{config.mesh.spacing, config.mesh.cells, model.patches, config.mesh.walls};
  const std::vector<MaterialInput> materials = material_input(config);
  const std::vector<BodyInput> bodies = body_input<Dim>(config, model.bodies);
  const std::vector<RigidInput> rigids = rigid_input(config, model.rigids);
  resampling_.set_up();
  set_options(model);
  PetscCallCXX(sides_.set_up(&grid));
  PetscCallCXX(links_.set_up());
  PetscCallCXX(loads_.set_up(model.face_count, carried_masses(config, rigids)));
  PetscCallCXX(upload_pairs(s, pair_input(config), config.mesh.spacing));
  Fault fault{};
  PetscCallCXX(fault = upload(s, grid, materials, bodies, rigids));
  PetscCallCXX(upload_interfaces(s, interface_input(config)));
  PetscCallCXX(upload_flow(s, flow_input(config)));
  if (s.flow.in_use()) weigh_saturated(s, s.never_paused);
  if (model.owners.empty()) choose_bins(bodies);
  if (fault.kind == FaultKind::none) PetscCallCXX((sort_and_list(s), begin_domains(s)));
  *failure = fault.kind == FaultKind::none ? reports_.failure_of_limit() : reports_.failure_of(fault);
  PetscCall(run_.share(failure));
  if (!model.owners.empty() && failure->what.empty()) {
    s.f_bar.fraction = f_bar_range(config).largest;
    run_.ranks = std::make_unique<Decomposition<Space, T, Dim>>();
    PetscCallCXX(PetscCall(run_.ranks->start(run_.comm, config.partition, model.owners, s)));
  }
  s.f_bar.keeps_stress = false;
  if (failure->what.empty()) PetscCallCXX(list_sites(s));
  if (config.output.energy && failure->what.empty()) PetscCallCXX(PetscCall(energy_.begin()));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
void TypedStepper<Space, T, Dim>::set_options(const Model& model) {
  auto& s = run_.state;
  const Config& config = run_.config;
  const bool together = !model.owners.empty();
  s.p2g.strategy = config.p2g.strategy, s.p2g.margin = config.p2g.margin;
  s.p2g.mosaic_cells = config.p2g.mosaic_cells;
  for (int d = 0; d < Dim; ++d) s.gravity[d] = gravity_on_soil(config)[d];
  s.water = water_of_kernels<Dim>(config);
  if (!together && !config.p2g.rebuild_interval) s.rebuild_late = GlobalBound::k_late;
  s.batches.limit = config.device_memory_limit.value_or(0) * k_gib;
  s.scheme.damping = config.damping;
  // Friction takes the mean normal impulse over the time in which the fastest wave crosses so many cells:
  // some periods with which the impulse of a node rings with the waves of its cells. With five, a block
  // creeps that has 1.04 times the friction that it needs.
  constexpr double k_friction_cells = 10;
  s.friction_time = k_friction_cells * critical_time_step(config);
  s.scheme.flip_fraction = config.flip_fraction;
  if (config.velocity_update == VelocityUpdate::xpic) s.scheme.xpic_order = config.xpic_order;
  s.soil.points.has_affine = config.velocity_update == VelocityUpdate::apic;
  s.strays.rule = config.stray_particles;
  s.soil.points.has_domain = config.particle_domain != ParticleDomain::fixed;
  s.soil.points.rings = config.geometry == Geometry::axisymmetric;
  s.soil.points.splits = config.particle_domain == ParticleDomain::split;
  s.scheme.rim_scale = rim_scale(config);
  // On several ranks the pressure of a cell is averaged once all its particles are here.
  s.f_bar.fraction = together ? 0 : f_bar_range(config).largest;
  s.f_bar.keeps_stress = model.from_run;
  s.energy.on = config.output.energy;
}

/// The forced interval between rebuilds is that of the margin which the user knows.
template <class Space, class T, int Dim>
void TypedStepper<Space, T, Dim>::choose_bins(const std::vector<BodyInput>& bodies) {
  auto& s = run_.state;
  auto& config = run_.config.p2g;
  double half_length = 0;
  for (const BodyInput& body : bodies) half_length = std::max(half_length, body.half_length);
  if (config.bins == BinsOf::cells || config.rebuild_interval || !wants_bins_about_nodes(s, half_length))
    return;
  s.p2g.about_nodes = true;
  s.p2g.margin = config.margin = std::min(config.margin, margin_about_nodes(half_length));
}

template <class Space, class T, int Dim>
std::string TypedStepper<Space, T, Dim>::bins_report() const {
  return run_.state.p2g.about_nodes ? "bins about nodes" : "";
}

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::advance(const StepRange& range, Batch* batch) {
  PetscFunctionBeginUser;
  if (run_.state.sides.unknown != 0) {
    loads_.set_time(range.time);
    PetscCall(sides_.begin());
  }
  PetscCall(loop_.advance(range, batch));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::rebuild(double elapsed, Failure* failure) {
  PetscFunctionBeginUser;
  Timers& timers = loop_.timers();
  const bool sampling = timers.sampling();
  timers.sample(true);
  std::vector<double> table;  // of the sides, of all ranks: other ranks may come to reach their nodes
  if (run_.ranks) PetscCall(sides_.gather(&table));
  PetscErrorCode failed = PETSC_SUCCESS;
  const auto work = [&] { failed = sort_soil(elapsed, failure); };
  PetscCallCXX(
      PetscCall(timers.run(StepPhase::rebuild, work, [&] { run_.state.space.fence("mpm::rebuild"); })));
  PetscCall(failed);
  if (failure->what.empty()) PetscCall(sides_.put(table));
  timers.sample(sampling);
  if (!run_.ranks && failure->what.empty()) *failure = reports_.failure_of_limit();
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::sort_soil(double elapsed, Failure* failure) {
  PetscFunctionBeginUser;
  auto& s = run_.state;
  const BeyondMask<Space> beyond = probes_.mark_beyond();
  limit_volumes(s);
  PetscCall(mpm::follow_soil(s, run_.ranks.get()));
  locate(s);
  const Control control = read_control(s);
  *failure = control.fault_count > 0 ? reports_.failure_of(control.fault) : Failure{};
  PetscCall(run_.share(failure));
  if (control.lost > 0) {
    note_lost(s);
    probes_.add_lost(beyond);
  }
  if (!failure->what.empty()) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(resampling_.split_and_merge());
  if (run_.ranks)
    PetscCall(run_.ranks->rebuild(s));
  else
    sort_and_list(s);
  PetscCall(resampling_.correct_positions(elapsed));
  begin_domains(s);
  list_sites(s);
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::follow_soil() {
  PetscFunctionBeginUser;
  auto& s = run_.state;
  loop_.join();
  PetscCallCXX(PetscCall(mpm::follow_soil(s, run_.ranks.get())));
  PetscCallCXX(begin_domains(s));
  s.summed = {};  // by the former domains
  s.batches.loaded = false;
  s.space.fence("mpm::follow_soil");
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::measure(double interval, HistoryRow* row) {
  PetscFunctionBeginUser;
  loads_.set_time(row->time);
  PetscCall(measures_.measure_bodies(&row->bodies));
  PetscCall(loads_.measure(row));
  if (run_.state.energy.on) PetscCall(energy_.measure(row));
  PetscCall(measures_.count_cells(row));
  PetscCall(sides_.measure(interval, row));
  PetscCall(measures_.measure_rigids(interval, row));
  PetscCallCXX(links_.measure(interval, row));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::unbalanced_ratio(double time, double* ratio) {
  PetscFunctionBeginUser;
  collect_soil(run_.state);
  loads_.set_time(time);
  PetscCall(measures_.unbalanced_ratio(present_step(), ratio));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
double TypedStepper<Space, T, Dim>::present_step() const {
  const double dt = loop_.step_size();
  return dt > 0 ? dt : critical_time_step(run_.config);
}

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::snapshot(Snapshot* snapshot) {
  PetscFunctionBeginUser;
  PetscCall(snapshots_.take(snapshot));
  loads_.set_time(snapshot->time);
  PetscCall(add_interfaces(run_, present_step(), snapshot));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::keep_balance(const EnergyRow& before) {
  PetscFunctionBeginUser;
  HistoryRow now;
  PetscCall(measures_.measure_bodies(&now.bodies));
  PetscCall(loads_.measure(&now));
  PetscCall(energy_.keep(before, &now));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::save(SavedState* saved) const {
  PetscFunctionBeginUser;
  collect_soil(run_.state);
  PetscCallCXX(*saved = save_state(run_.state));
  PetscCallCXX(saved->pairs = save_pairs(run_.state));
  PetscCallCXX(saved->part_impulses = save_part_impulses(run_.state));
  PetscCallCXX(saved->interfaces = save_interface_totals(run_.state));
  PetscCall(run_.sum(saved->interfaces.data(), static_cast<int>(saved->interfaces.size())));
  PetscCall(snapshots_.save_for_starts(saved));
  ids_.save(saved);
  PetscCall(energy_.save(saved));
  PetscCall(loads_.save(saved));
  PetscCall(probes_.save(saved));
  PetscCall(measures_.save_strays(saved));
  links_.save(saved);
  if (run_.ranks) PetscCall(run_.ranks->save(saved));
  run_.rigids.widen(*saved);
  PetscCall(sides_.save(&saved->sides));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::restore(SavedState&& saved, long since_rebuild, bool* rebuilt) {
  PetscFunctionBeginUser;
  auto& s = run_.state;
  run_.rigids.narrow(saved);
  const double margin = run_.config.p2g.margin;
  const auto& forced = run_.config.p2g.rebuild_interval;
  if (forced) saved.due_in = 0;
  // By another rule the rebuild may be due already.
  const bool unforeseen = saved.due_in == 0 && saved.bound > 0 &&
                          rebuild_due(saved.bound, saved.increment, margin, GlobalBound::k_late);
  // A larger margin may be that of bins of cells, where the checkpoint's bins are about nodes.
  const bool near = forced ? saved.margin < margin : saved.margin != margin || unforeseen;
  *rebuilt = saved.bound > margin || near || (forced && since_rebuild >= *forced);
  if (!run_.is_first()) std::fill(saved.lost.begin(), saved.lost.end(), 0);  // rank 0 has them
  Failure unfit;
  PetscCallCXX(unfit.what = take_saved(s, saved));
  PetscCallCXX(restore_pairs(s, saved.pairs));
  PetscCallCXX(restore_part_impulses(s, saved.part_impulses));
  if (run_.is_first()) PetscCallCXX(restore_interface_totals(s, saved.interfaces));
  links_.restore(saved);
  loads_.restore(saved);
  energy_.restore(saved);
  probes_.restore(saved);
  ids_.restore(saved, s.soil.points.splits);
  PetscCall(check_saved(unfit));
  if (run_.ranks) {
    PetscCallCXX(PetscCall(run_.ranks->restore(s, saved)));
  } else {
    PetscCallCXX(list_saved(s));
    PetscCallCXX(finish_saved(s, saved));
  }
  PetscCallCXX(PetscCall(sides_.restore(saved.sides)));
  Failure failure = reports_.failure_of_limit();
  if (*rebuilt && failure.what.empty()) PetscCall(rebuild(0, &failure));
  PetscCheck(failure.what.empty(), PETSC_COMM_SELF, PETSC_ERR_FP, "The checkpoint's %s",
             failure.what.c_str());
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::check_saved(Failure unfit) const {
  PetscFunctionBeginUser;
  double held = run_.state.soil.points.count;
  for (const Lost& of_body : run_.state.strays.lost) held += of_body.count + of_body.merged;
  if (run_.sum_of(held) != static_cast<double>(ids_.particles()) && unfit.what.empty())
    unfit.what = "the number of particles";
  PetscCall(run_.share(&unfit));
  PetscCheck(unfit.what.empty(), run_.comm, PETSC_ERR_ARG_SIZ,
             "-restart: given \"%s\", takes a checkpoint of what the options describe; they differ in %s",
             run_.config.output.restart.c_str(), unfit.what.c_str());
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define MPM_INSTANTIATE(Space, T, Dim) template class TypedStepper<Space, T, Dim>;
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
