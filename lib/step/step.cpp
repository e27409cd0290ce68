// One time step, in the paper's words.

#include "step/step.hpp"

#include "functions/energy_works.hpp"
#include "functions/find_strays.hpp"
#include "functions/interfaces.hpp"
#include "functions/light_rigids.hpp"
#include "functions/link_rigids.hpp"
#include "functions/part_forces.hpp"
#include "functions/pore_flow.hpp"
#include "functions/rigid_pairs.hpp"
#include "functions/split_patches.hpp"
#include "functions/step_kernels.hpp"
#include "functions/surface_loads.hpp"
#include "functions/update_about_nodes.hpp"
#include "functions/velocity_update.hpp"
#include "rebuild/batches.hpp"
#include "rebuild/rebuild.hpp"
#include "step/contact_at_sites.hpp"

namespace mpm {
namespace {

/// A step: its state, its length, and what it works with.
template <class Space, class T, int Dim>
struct Step {
  State<Space, T, Dim>& s;
  Timers& timers;
  double dt;                            // s
  Decomposition<Space, T, Dim>* ranks;  // null on one rank
  OverlapStream<Space>* overlap;        // null where there is none
  Rayleigh<Space, T, Dim>* rayleigh;    // null without it; steps are then separate

  /// The paper's step. Function 7, the rebuild, is the caller's, when the movement bound says so. Out of core
  /// functions 3 and 5 take the soil batch by batch, and what function 5 does may be functions 1 and 3 of the
  /// next step.
  PetscErrorCode separate() const {
    PetscFunctionBeginUser;
    PetscCall(run(StepPhase::reset, [&] { reset(); }));  // 1 initialise nodal variables
    PetscCall(
        run(StepPhase::rigid_to_nodes, [&] { rigids_to_nodes(s, s.space); }));  // 2 rigid bodies to nodes
    const bool beside = contacts_beside();
    if (beside) PetscCall(contacts_to_nodes(s, ranks, overlap->fork(s.space), true));
    PetscCall(run(StepPhase::soil_to_nodes, [&] {
      sum_soil(s.space, !beside);  // 3 soil to nodes
      buoyancy_to_nodes(s);        //   and what water carries of it
      loads_to_nodes(s);           //   and the loads on its surface
    }));
    if (ranks) PetscCall(ranks->add_soil(s));                      //   the sum over ranks
    if (!beside) PetscCall(contacts_to_nodes(s, ranks, s.space));  //   strength, how the soil of a field lies
    if (s.flow.in_use())
      PetscCall(run(StepPhase::soil_to_nodes, [&] { return flow_to_nodes(s, ranks); }));  //   water in pores
    complete_nodes(s.space);  //   particles that are alone
    if (beside) overlap->join(s.space);
    if (rayleigh)
      PetscCall(run(StepPhase::soil_to_nodes, [&] { return rayleigh_to_nodes(s, *rayleigh, ranks); }));
    PetscCall(run(StepPhase::nodes, [&] { return update_all_nodes(); }));  // 4 velocities, walls, contact
    if (s.energy.on)
      PetscCall(run(StepPhase::energy, [&] {
        add_node_works(s, dt);
        if (rayleigh) add_rayleigh_work(s, *rayleigh, dt);
      }));
    PetscCall(run(StepPhase::particles, [&] { return update_soil(); }));  // 5 stress, movement
    if (s.energy.on) PetscCall(run(StepPhase::energy, [&] { add_stress_work(s); }));
    PetscCall(run(StepPhase::rigids, [&] { return update_rigids(false); }));  // 6 move the rigid bodies
    if (s.energy.on)
      PetscCall(run(StepPhase::energy, [&] { add_rigid_work(s, !ranks || ranks->counts_forces()); }));
    PetscFunctionReturn(PETSC_SUCCESS);
  }

  /// Function 5 goes on to functions 1 and 3 of the next step, so that these are here behind a rebuild alone.
  /// The overlap stream moves the rigids and updates the nodes near them, while the main stream updates the
  /// other nodes. The main stream learns of a pause one step late; the rebuild discards what it computed
  /// then.
  PetscErrorCode fused() const {
    PetscFunctionBeginUser;
    const bool ends = s.plan.form == StepForm::persistent && !timers.sampling();
    const bool parts = has_stream(), parted = parts && s.summed.soil;
    const Space& stream = parted ? overlap->fork(s.space) : joined();
    PetscCall(run(StepPhase::reset, [&] { reset(); }));
    PetscCall(run(StepPhase::rigid_to_nodes, [&] { rigids_to_nodes(s, stream); }));
    const bool beside = contacts_beside() && !s.summed.contacts;
    if (beside) PetscCall(contacts_to_nodes(s, ranks, overlap->fork(s.space)));
    PetscCall(run(StepPhase::soil_to_nodes, [&] { sum_soil(stream); }));
    if (ranks) PetscCall(ranks->add_soil(s, stream));
    if (!beside) PetscCall(contacts_to_nodes(s, ranks, stream));
    complete_nodes(stream);
    if (beside) overlap->join(s.space);
    PetscCall(run(StepPhase::nodes, [&] { return update_nodes_on(stream); }));
    if (parted) overlap->join(s.space);
    if (parted && !ranks) move_rigids_ahead(stream);
    PetscCall(run(StepPhase::particles, [&] { return update_patches_and(ends); }));
    if (!ends) PetscCall(run(StepPhase::rigids, [&] { return update_rigids(parts && !ranks); }));
    PetscFunctionReturn(PETSC_SUCCESS);
  }

  /// The sums at nodes that ranks share are made first, and travel while the inner patches are computed: in
  /// function 3, or where function 5 goes on to the sums of the next step there.
  PetscErrorCode overlapped() const {
    PetscFunctionBeginUser;
    const bool parts = has_stream(), parted = parts && s.summed.soil, moves = parts && s.plan.sums_ahead;
    const Space& stream = parted ? overlap->fork(s.space) : joined();
    PetscCall(run(StepPhase::reset, [&] { reset(); }));
    PetscCall(run(StepPhase::rigid_to_nodes, [&] { rigids_to_nodes(s, stream); }));
    PetscCall(run(StepPhase::soil_to_nodes, [&] { return send_soil(); }));
    PetscCall(ranks->add_soil(s, stream));
    PetscCall(contacts_to_nodes(s, ranks, s.space));
    complete_nodes(stream);
    PetscCall(run(StepPhase::nodes, [&] { return update_nodes_on(stream); }));
    if (parted) overlap->join(s.space);
    if (parted && moves && !ranks->forces_shared()) sum_forces(s, stream);
    PetscCall(
        run(StepPhase::particles, [&] { return s.plan.sums_ahead ? update_and_send() : update_soil(); }));
    PetscCall(run(StepPhase::rigids, [&] { return update_rigids(moves); }));
    PetscFunctionReturn(PETSC_SUCCESS);
  }

  /// Does up to `left` steps in one launch where the sums of the first step are there, else one step. Reduces
  /// `left` by the number of steps done.
  PetscErrorCode persistent(long* left) const {
    PetscFunctionBeginUser;
    if constexpr (is_device<Space>) {
      if (!timers.sampling() && s.scheme.kick == 1 && can_persist(s)) {
        const long most = *left;
        const auto steps = [&] {  // functions 4 to 6, and 1 to 3 of the next step
          const long done = run_persistent_steps(s, dt, most);
          *left -= done;
          return done;
        };
        joined();
        PetscCall(timers.run_many(StepPhase::persistent, most, steps, [&] { s.space.fence("mpm::step"); }));
        PetscFunctionReturn(PETSC_SUCCESS);
      }
    }
    --*left;
    PetscCall(fused());
    PetscFunctionReturn(PETSC_SUCCESS);
  }

 private:
  /// Runs one function of the paper and times it. work() returns an error code or nothing.
  template <class Work>
  PetscErrorCode run(StepPhase f, Work&& work) const {
    PetscFunctionBeginUser;
    PetscErrorCode failed = PETSC_SUCCESS;
    const auto all = [&] {
      if constexpr (std::is_void_v<decltype(work())>)
        work();
      else
        failed = work();
    };
    PetscCall(timers.run(f, all, [&] { s.space.fence("mpm::step"); }));
    PetscCall(failed);
    PetscFunctionReturn(PETSC_SUCCESS);
  }

  /// Whether nodes near rigids may go to the overlap stream. Functions that are timed have the device for
  /// themselves, and contact of deformable bodies is for all nodes at once.
  bool has_stream() const {
    return overlap && s.plan.nodes_aside && !s.interfaces.in_use() && !timers.sampling();
  }
  /// The state's own stream, behind all work of the overlap stream.
  const Space& joined() const {
    if (overlap) overlap->join(s.space);
    return s.space;
  }

  void reset() const {
    if (!s.summed.soil) reset_nodes(s);
  }
  /// Whether the overlap stream makes the sums of contact between deformable bodies, which take few
  /// particles, while the main stream sums the soil. What water carries needs the memory of the strengths.
  bool contacts_beside() const {
    return is_device<Space> && overlap && !ranks && s.interfaces.in_use() && !s.water.is_there() &&
           !timers.sampling();
  }
  void sum_soil(const Space& stream, bool boundary = true) const {
    if (ranks) finish_sums(s);
    soil_to_nodes(s, stream, boundary);
  }
  /// Marks, in runs that need it, the particles that are alone until a rebuild, and the patches that go to
  /// the overlap stream.
  void complete_nodes(const Space& stream) const {
    if (!s.strays.known) mark_strays(s, stream);
    if (wants_split(s) && s.split.parts.empty()) split_patches(s, stream);
  }
  /// The velocity at the end of the step of light rigid bodies. All ranks do the same rounds, also where the
  /// steps of one are paused.
  PetscErrorCode solve_for_light(bool damps, const Space& stream) const {
    PetscFunctionBeginUser;
    begin_light_rigids(s, dt, damps, stream);
    for (int n = 0; n < k_light_rounds; ++n) {
      bool open = true;
      sum_light_rigids(s, dt, damps, stream);
      if (ranks)
        PetscCall(ranks->add_light_sums(s, stream, &open));
      else
        open = light_rigids_open(s);
      if (!open) break;
      solve_light_rigids(s, dt, damps, stream);
    }
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  /// Function 4, after contact of deformable bodies, with the velocity at the end of the step of rigid bodies
  /// that are light, and with the flux of the water in the pores.
  PetscErrorCode update_nodes_on(const Space& stream) const {
    PetscFunctionBeginUser;
    if (s.flow.in_use()) couple_flow(s, dt);
    if (s.interfaces.in_use()) {
      press_fields(s, dt, true);
      add_interface_totals(s, contacts_beside() ? overlap->fork(s.space) : s.space);
    }
    if (s.light_rigids.in_use) {
      PetscCall(solve_for_light(false, stream));
      if (s.scheme.damping > 0) PetscCall(solve_for_light(true, stream));
    }
    update_nodes(s, dt, stream);
    if (contacts_beside()) joined();
    if (s.flow.in_use()) update_flux(s, dt);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  /// Function 4, contact at sites, and the work of loads and their areas.
  PetscErrorCode update_all_nodes() const {
    PetscFunctionBeginUser;
    PetscCall(update_nodes_on(s.space));
    if (s.at_sites.in_use) PetscCall(contact_at_sites(s, dt, ranks));
    if (s.loads.in_use()) follow_surfaces(s, s.loads, s.energy, dt);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  /// Function 5 of a part of the soil, or of all of it. The overlap stream takes the patches that are not
  /// common, and those near contact, of which it then sums what the contact of the next step needs.
  template <class... Some>
  PetscErrorCode update_patches(const Some&... part) const {
    PetscFunctionBeginUser;
    if (s.p2g.about_nodes && s.f_bar.fraction > 0) sum_dilatations(s);
    const bool aside = overlap && s.split.has_early() && !timers.sampling();
    const Space& stream = aside ? overlap->fork(s.space) : s.space;
    update_particles(s, dt, part..., stream);
    if (aside && contacts_beside() && s.summed.soil) {
      PetscCall(contacts_to_nodes(s, ranks, stream, true));
      s.summed.boundary = s.summed.contacts = true;
    }
    if (aside) overlap->join(s.space);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  /// Function 5, and with the same launch the end of the step where `ends`.
  PetscErrorCode update_patches_and(bool ends) const {
    PetscFunctionBeginUser;
    if constexpr (is_device<Space>)
      if (ends) {
        update_and_end(s, dt);
        PetscFunctionReturn(PETSC_SUCCESS);
      }
    PetscCall(update_patches());
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscErrorCode update_soil() const {
    PetscFunctionBeginUser;
    PetscCall(update_velocities(s, ranks));
    if (s.flow.in_use()) update_pores(s, dt);
    if (s.batches.in_use())
      update_by_batches(s, dt);
    else
      PetscCall(update_patches());
    if (s.flow.in_use()) weigh_saturated(s, s.control);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  /// Under the forces of all ranks.
  PetscErrorCode update_rigids(bool on_stream) const {
    PetscFunctionBeginUser;
    if (ranks) PetscCall(ranks->add_forces(s));
    const Space& stream = on_stream ? overlap->fork(s.space) : s.space;
    if (!s.rigids_ahead) push_rigids(stream);
    move_rigids(s, s.timed, dt, stream);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  /// Adds the contact of rigid bodies with each other, and the impulses on their parts.
  void push_rigids(const Space& stream) const {
    if (s.part_forces.count > 0) add_part_impulses(s, dt, stream);
    if (s.pairs.in_use()) {
      if (!s.forces_summed) sum_forces(s, stream);
      contact_of_rigids(s, dt, stream);
    }
    if (s.links.in_use()) link_rigids(s, dt, stream);
  }
  /// Sums the forces on the rigids and moves them while function 5 updates the particles: function 5 reads no
  /// rigid.
  void move_rigids_ahead(const Space& stream) const {
    sum_forces(s, stream);
    push_rigids(stream);
    move_many_rigids(s, s.timed, dt, stream);
    s.rigids_ahead = true;
  }
  /// Function 3, the border first, unless its sums have been sent already.
  PetscErrorCode send_soil() const {
    PetscFunctionBeginUser;
    finish_sums(s);
    if (!ranks->sent_ahead()) {
      soil_to_nodes(s, ranks->border(s));
      PetscCall(ranks->send_ahead(s));
    }
    soil_to_nodes(s, ranks->inner(s));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  /// Function 5 with the sums of the next step, the border first.
  PetscErrorCode update_and_send() const {
    PetscFunctionBeginUser;
    const Part<Space> border = ranks->border(s);
    update_particles(s, dt, border, border.space);
    PetscCall(ranks->send_ahead(s));
    PetscCall(update_patches(ranks->inner(s)));
    ranks->join(s);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
};

}  // namespace

template <class Space, class T, int Dim>
PetscErrorCode step(State<Space, T, Dim>& s, Timers& timers, double dt, Decomposition<Space, T, Dim>* ranks,
                    OverlapStream<Space>* overlap, long* left, Rayleigh<Space, T, Dim>* rayleigh) {
  PetscFunctionBeginUser;
  const Step<Space, T, Dim> step{s, timers, dt, ranks, overlap, rayleigh};
  long one = 1;
  if (left == nullptr) left = &one;
  if (s.plan.form != StepForm::persistent) --*left;
  switch (s.plan.form) {
    case StepForm::separate:
    case StepForm::out_of_core: PetscCall(step.separate()); break;
    case StepForm::fused: PetscCall(step.fused()); break;
    case StepForm::overlapped: PetscCall(step.overlapped()); break;
    case StepForm::persistent: PetscCall(step.persistent(left)); break;
  }
  s.scheme.kick = 1;
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define MPM_INSTANTIATE(Space, T, Dim)                                                                \
  template PetscErrorCode step(State<Space, T, Dim>&, Timers&, double, Decomposition<Space, T, Dim>*, \
                               OverlapStream<Space>*, long*, Rayleigh<Space, T, Dim>*);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
