#pragma once
// The functions of a time step, except the interpolation to nodes; each is one function of the paper.

#include "base/spaces.hpp"
#include "base/step_features.hpp"
#include "data/floors.hpp"
#include "data/nodes.hpp"
#include "data/particles.hpp"
#include "data/step_plan.hpp"

namespace mpm {

template <class Space, class T, int Dim>
struct TimedLoads;
struct LoadClock;

/// The plan of the steps until the next rebuild, on one rank; several ranks may overlap theirs. After lists
/// are made. features: of the run, as they are; launch_has_room: ends_in_launch.
template <class Space, class T, int Dim>
StepPlan plan_step(const ContactCore<Space, T, Dim>& s, const Features& features, bool launch_has_room);

/// 1. Sets the nodal sums to zero, where they have to be.
template <class Space, class T, int Dim>
void reset_nodes(ContactCore<Space, T, Dim>& s);

/// Part of 3, of submerged soil: adds to the force at each node what the water weighs that the soil displaces
/// there (s.nodes.displaced), against gravity.
template <class Space, class T, int Dim>
void add_buoyancy(Core<Space, T, Dim>& s);

/// 4. Nodal velocities and accelerations, boundary conditions, contact (Eqs (6), (8)-(10)). Leaves the
/// contact forces in s.contact.forces. Where the plan has sums_ahead and not writes_sums, it leaves the nodal
/// sums at zero, which is function 1 of the next step. dt [s]. stream: that of the nodes near rigids, if the
/// plan has nodes_apart; the others are on s.space.
template <class Space, class T, int Dim>
void update_nodes(State<Space, T, Dim>& s, double dt, const Space& stream);
template <class Space, class T, int Dim>
void update_nodes(State<Space, T, Dim>& s, double dt) {
  update_nodes(s, dt, s.space);
}
/// Brings to the nodes the sums that update_particles has left in windows for update_nodes.
template <class Space, class T, int Dim>
void finish_sums(ContactCore<Space, T, Dim>& s);
/// Persistent steps, which the program has for GPUs alone (persistent_launch.hpp).
/// Whether one launch has room for function 5 with function 3 of the next step, function 6, and function 2 of
/// the next step.
template <class Space, class T, int Dim>
bool ends_in_launch(const State<Space, T, Dim>& s);
template <class Space, class T, int Dim>
void update_and_end(State<Space, T, Dim>& s, double dt);

/// Whether the next steps are to be persistent, many in one launch: functions 4 to 6, and 1 to 3 of the next
/// step. Persistent steps need the sums of this step. They exclude contact with friction, and rigids that
/// move by the force on them while their normals come from the mass gradient. They pay where patches are few.
template <class Space, class T, int Dim>
bool can_persist(const State<Space, T, Dim>& s);
/// Launches as many of the next `most` steps as one launch may do; returns how many it will do, if the steps
/// are not paused before.
template <class Space, class T, int Dim>
int run_persistent_steps(State<Space, T, Dim>& s, double dt, long most);
/// Ends the pause of steps whose teams were not co-resident on the device. From then on a launch does one
/// step.
template <class Space, class T, int Dim>
void resume_single_steps(State<Space, T, Dim>& s);

/// 5. Strains, stresses and material properties; velocities and positions of the soil (Eqs (11)-(13)). Leaves
/// the furthest movement of a particle in s.control. Where sums_ahead, adds the soil as it then is to the
/// nodes. dt [s]. aside: the stream of the patches that are not common, where State::split lists them.
template <class Space, class T, int Dim>
void update_particles(ContactCore<Space, T, Dim>& s, double dt, const Space& aside);
template <class Space, class T, int Dim>
void update_particles(ContactCore<Space, T, Dim>& s, double dt) {
  update_particles(s, dt, s.space);
}
/// update_particles for some of the slots, where sums_ahead.
template <class Space, class T, int Dim>
void update_particles(ContactCore<Space, T, Dim>& s, double dt, const Part<Space>& part, const Space& aside);

/// Forces of the soil on the rigids in this step, from s.contact.forces to s.rigid_force [N]; else
/// move_rigids does it.
template <class Space, class T, int Dim>
void sum_forces(ContactCore<Space, T, Dim>& s, const Space& stream);

/// Moves the rigid bodies where they are many on a device, else move_rigids does it. Where s.rigids_ahead
/// tells of it, move_rigids does not do it again.
template <class Space, class T, int Dim>
void move_many_rigids(ContactCore<Space, T, Dim>& s, const TimedLoads<Space, T, Dim>& timed, double dt,
                      const Space& stream);

/// 6. Moves the rigid bodies (Eq. 7), counts the step, sets what follows tables in time for the next, and
/// adds what any point can have moved to the bound. dt [s]. Linked bodies have been moved by link_rigids.
template <class Space, class T, int Dim>
void move_rigids(ContactCore<Space, T, Dim>& s, const TimedLoads<Space, T, Dim>& timed, double dt,
                 const Space& stream);
template <class Space, class T, int Dim>
void move_rigids(State<Space, T, Dim>& s, double dt) {
  move_rigids(s, s.timed, dt, s.space);
}

/// Sets what follows tables in time for the next step, which is the first of the clock. move_rigids sets it
/// for the steps after.
template <class Space, class T, int Dim>
void begin_loads(const ContactCore<Space, T, Dim>& s, const TimedLoads<Space, T, Dim>& loads,
                 const LoadClock& clock);

/// Coordinates of the rigids' points, where their mass gives a normal, from where the rigids are.
template <class Space, class T, int Dim>
void move_rigid_points(ContactCore<Space, T, Dim>& s, const Space& stream);

/// Copy of the control block on the host. Waits for the steps before it.
template <class Space, class T, int Dim>
Control read_control(const Core<Space, T, Dim>& s);

/// Sets the count of steps since the last read_control to zero.
template <class Space, class T, int Dim>
void restart_count(const Core<Space, T, Dim>& s);

}  // namespace mpm
