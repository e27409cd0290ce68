#include "input/deck/launch.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>

#include "common/text.hpp"

namespace mpm {
namespace {

enum class Takes { threads, device, yes_or_no, mapping };

struct Setting {
  const char* word;      // after --kokkos-
  const char* variable;  // of the environment
  Takes takes;
};
constexpr Setting k_settings[] = {
    {"num-threads", "KOKKOS_NUM_THREADS", Takes::threads},
    {"device-id", "KOKKOS_DEVICE_ID", Takes::device},
    {"disable-warnings", "KOKKOS_DISABLE_WARNINGS", Takes::yes_or_no},
    {"print-configuration", "KOKKOS_PRINT_CONFIGURATION", Takes::yes_or_no},
    {"tune-internals", "KOKKOS_TUNE_INTERNALS", Takes::yes_or_no},
    {"map-device-id-by", "KOKKOS_MAP_DEVICE_ID_BY", Takes::mapping},
};

/// Far more threads than processors help nobody, and their stacks do not fit.
long most_threads() {
  constexpr long k_least = 256, k_of_each = 8;
  return std::max(k_least, k_of_each * sysconf(_SC_NPROCESSORS_ONLN));
}

std::string whole_number(const std::string& value, long lowest, long highest) {
  const auto number = parse_integer(value);
  if (number && *number >= lowest && *number <= highest) return "";
  return "a whole number from " + std::to_string(lowest) + " to " + std::to_string(highest);
}

/// Values that a setting takes; empty where the value is one of them.
std::string fault_of(Takes takes, const std::string& value, int devices) {
  const std::string word = lower_case(value);
  const auto is_one_of = [&](const std::vector<std::string>& words) {
    return std::find(words.begin(), words.end(), word) != words.end();
  };
  switch (takes) {
    case Takes::threads: return whole_number(value, 1, most_threads());
    case Takes::device: return whole_number(value, 0, std::max(devices, 1) - 1);
    case Takes::yes_or_no: return is_one_of({"1", "0", "true", "false", "yes", "no"}) ? "" : "yes or no";
    default: return is_one_of({"random", "mpi_rank"}) ? "" : "random or mpi_rank";
  }
}

}  // namespace

std::vector<std::string> launch_faults(int argc, char** argv, int devices) {
  std::vector<std::string> faults;
  const auto check = [&](const std::string& name, const std::string& value, Takes takes) {
    const std::string fault = fault_of(takes, value, devices);
    if (!fault.empty())
      faults.push_back("mpm: " + name + ": given \"" + printable(value) + "\", takes " + fault);
  };
  for (const Setting& setting : k_settings) {
    if (const char* value = std::getenv(setting.variable)) check(setting.variable, value, setting.takes);
    const std::string name = std::string("--kokkos-") + setting.word;
    for (int k = 1; k < argc; ++k) {
      const std::string word = argv[k];
      const bool alone = word == name;
      if (word.starts_with(name + "="))
        check(name, word.substr(name.size() + 1), setting.takes);
      else if (alone && setting.takes != Takes::yes_or_no)
        faults.push_back("mpm: " + name + ": given without a value, takes " + name + "=VALUE");
    }
  }
  if (const char* value = std::getenv("OMP_NUM_THREADS"); value != nullptr && *value != '\0')
    check("OMP_NUM_THREADS", split(value)[0], Takes::threads);  // nested regions have none of our threads
  return faults;
}

}  // namespace mpm
