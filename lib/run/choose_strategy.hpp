#pragma once
#include "common/model.hpp"
#include "run/job.hpp"

namespace mpm {

/// `-p2g auto`: gives the options the fastest strategy for the model, by trials with steps of dt [s]. A clear
/// result is kept for the device, named by a key. Collective.
PetscErrorCode choose_strategy(Job& job, const Model& model, double dt, const std::string& device);

}  // namespace mpm
