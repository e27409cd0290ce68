#include "common/gpu_energy.hpp"

#include <dlfcn.h>

namespace mpm {
namespace {

/// A function of a library; null where it has none of this name.
template <class Function>
Function function_of(void* library, const char* name) {
  return reinterpret_cast<Function>(dlsym(library, name));
}

}  // namespace

// The library stays loaded to the end of the program: its users outside this class may have opened it too.
GpuEnergyMeter::GpuEnergyMeter(const std::string& bus, const char* library) {
  void* const nvml = bus.empty() ? nullptr : dlopen(library, RTLD_NOW | RTLD_LOCAL);
  if (nvml == nullptr) return;
  const auto start = function_of<int (*)()>(nvml, "nvmlInit_v2");
  const auto find = function_of<int (*)(const char*, void**)>(nvml, "nvmlDeviceGetHandleByPciBusId_v2");
  const auto count = function_of<Counter>(nvml, "nvmlDeviceGetTotalEnergyConsumption");
  if (start == nullptr || find == nullptr || count == nullptr) return;
  constexpr int k_success = 0;  // NVML_SUCCESS
  if (start() != k_success || find(bus.c_str(), &device_) != k_success) return;
  if (count(device_, &first_) != k_success) return;
  counter_ = count;
  last_ = first_;
}

double GpuEnergyMeter::joules() {
  unsigned long long now = 0;
  if (counter_ != nullptr && counter_(device_, &now) == 0 && now > last_) last_ = now;
  return 1e-3 * double(last_ - first_);
}

}  // namespace mpm
