#pragma once
// Wall time and rebuilds of a run, and the report of its performance.

#include <chrono>
#include <string>
#include <utility>

#include "common/energy_meter.hpp"
#include "common/gpu_energy.hpp"
#include "run/clock.hpp"
#include "step/stepper.hpp"

namespace mpm {

/// Wall clock [s].
inline double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

struct Effort {
  /// Where the present stepper began.
  struct Part {
    long step = 0;
    double wall = 0, stepping = 0;  // s
    double time = 0;                // s, simulated
    double joules = 0, gpu = 0;     // J, of the energy of the processors and the GPU
  };

  double before = 0, begin = 0;  // s: wall time before a restart; wall clock at the first step since then
  double stepping = 0;           // s of wall time in steps and rebuilds
  long looks = 0;                // at what the steps of a batch came to
  RebuildCount rebuilds;
  Part part;
  double bandwidth = 0;  // bytes/s of the device's copy
  EnergyMeter energy;    // of this machine's processors
  double counted = 0;    // s, wall clock at which it was read last
  std::string gpu_bus;   // place of this rank's GPU on PCI; empty on a processor
  GpuEnergyMeter gpu;    // of it

  /// Begins to count the energy of a GPU.
  void count_gpu(std::string bus) {
    gpu_bus = std::move(bus);
    gpu = GpuEnergyMeter(gpu_bus);
  }
  double wall() const { return before + seconds_now() - begin; }
  /// Reads the counters of energy before they can begin anew twice.
  void count_energy() {
    constexpr double k_every = 30;  // s
    if (!energy.found() || seconds_now() - counted < k_every) return;
    energy.read();
    counted = seconds_now();
  }
};

/// Performance of this part of the run, or of its stage. Where it did no step the stepper may not be set up,
/// and is not asked. Collective.
Performance performance_of(const Job& job, const Clock& clock, Effort& effort, const Stepper& stepper);

/// The report at the end of the log, and performance.json, which scripts read. The file is written even where
/// no step was done: its outcome then says that the run has ended.
PetscErrorCode report_performance(Job& job, const Performance& p, const Stepper& stepper);

const char* word_of(Outcome outcome);

}  // namespace mpm
