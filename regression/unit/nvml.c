/* Stands for the library of NVIDIA's driver: one GPU, whose counter of energy goes 100.0, 102.5, fails once,
 * 107.5 J. */

#include <string.h>

static const unsigned long long k_counts[] = {100000, 102500, 0, 107500}; /* mJ */
static int calls = 0;

int nvmlInit_v2(void) { return 0; }

int nvmlDeviceGetHandleByPciBusId_v2(const char* bus, void** device) {
  *device = &calls;
  return strcmp(bus, "00000000:1b:00.0") == 0 ? 0 : 6;
}

int nvmlDeviceGetTotalEnergyConsumption(void* device, unsigned long long* millijoules) {
  if (device != &calls || calls > 3) return 15;
  *millijoules = k_counts[calls++];
  return *millijoules == 0 ? 15 : 0;
}
