#pragma once
// Energy counter of a GPU.

#include <string>

namespace mpm {

/// Energy that a GPU of NVIDIA has taken since this object was made, by the counter of its driver (NVML:
/// nvmlDeviceGetTotalEnergyConsumption, GPUs since Volta), with all that runs on the GPU. Nothing is found
/// where the library is not there, or does not know the GPU or its energy.
class GpuEnergyMeter {
 public:
  GpuEnergyMeter() = default;
  /// bus: place of the GPU on PCI, as 00000000:1b:00.0; empty for none.
  explicit GpuEnergyMeter(const std::string& bus, const char* library = "libnvidia-ml.so.1");

  bool found() const { return counter_ != nullptr; }
  /// J, from the start to the present; the last value where the driver gives none now.
  double joules();

 private:
  using Counter = int (*)(void* device, unsigned long long* millijoules);
  Counter counter_ = nullptr;
  void* device_ = nullptr;
  unsigned long long first_ = 0, last_ = 0;  // mJ
};

}  // namespace mpm
