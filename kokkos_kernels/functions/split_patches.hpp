#pragma once
// Which patches function 5 updates with which kernel of a device.

#include "data/contact_core.hpp"

namespace mpm {

/// Whether steps are done with split patches. The persistent step and batches have one kernel for all
/// patches.
template <class Space, class T, int Dim>
bool wants_split(const Core<Space, T, Dim>& s) {
  return is_device<Space> && s.plan.form != StepForm::persistent && s.plan.form != StepForm::out_of_core;
}

/// Makes State::split from the present lists, after the search for particles that are alone. On `stream`, for
/// which the host waits.
template <class Space, class T, int Dim>
void split_patches(ContactCore<Space, T, Dim>& s, const Space& stream);

}  // namespace mpm
