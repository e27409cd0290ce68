#include "physics/materials/umat_library.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <mutex>

#include "physics/materials/shared_object.hpp"
#include "physics/materials/umat_end.hpp"
#include "physics/materials/umat_utilities.hpp"

namespace mpm {
namespace {

constexpr int k_name_length = 80;  // of CMNAME

// Fortran passes all arguments by reference and the length of a text by value behind them; C does not read
// the length.
using UmatFunction = void(double* stress, double* statev, double* ddsdde, double* sse, double* spd,
                          double* scd, double* rpl, double* ddsddt, double* drplde, double* drpldt,
                          const double* stran, const double* dstran, const double* time, const double* dtime,
                          const double* temp, const double* dtemp, const double* predef, const double* dpred,
                          const char* cmname, const int* ndi, const int* nshr, const int* ntens,
                          const int* nstatv, const double* props, const int* nprops, const double* coords,
                          const double* drot, double* pnewdt, const double* celent, const double* dfgrd0,
                          const double* dfgrd1, const int* noel, const int* npt, const int* layer,
                          const int* kspt, const int* jstep, const int* kinc, std::size_t cmname_length);
using SdviniFunction = void(double* statev, const double* coords, const int* nstatv, const int* ncrds,
                            const int* noel, const int* npt, const int* layer, const int* kspt);

/// Libraries may share the memory of COMMON blocks and of saved variables, so one lock serves all.
std::unique_lock<std::mutex> lock_unless(bool on_threads) {
  static std::mutex mutex;
  return on_threads ? std::unique_lock<std::mutex>() : std::unique_lock(mutex);
}

/// Number of the step, from 1 on, by the time and the step's length.
int number_of_step(double time, double dt) {
  if (!(time > 0) || !(dt > 0)) return 1;
  return static_cast<int>(std::min(time / dt + 1.5, double(std::numeric_limits<int>::max())));
}

/// Fortran's order of a matrix.
void by_columns(const double (&matrix)[3][3], double (&columns)[9]) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) columns[i + 3 * j] = matrix[i][j];
}

/// Largest C_ii of the normal components [Pa]; not finite where one is not.
double largest_normal_stiffness(const double* ddsdde, int ntens) {
  double largest = 0;
  for (int i = 0; i < 3; ++i) {
    const double stiffness = ddsdde[i * (ntens + 1)];
    if (!std::isfinite(stiffness)) return std::numeric_limits<double>::quiet_NaN();
    largest = std::max(largest, stiffness);
  }
  return largest;
}

std::vector<double> numbers_of(const std::string& list) {
  std::vector<double> numbers;
  for (std::size_t at = 0; at < list.size();) {
    const std::size_t end = std::min(list.find(',', at), list.size());
    numbers.push_back(std::strtod(list.substr(at, end - at).c_str(), nullptr));
    at = end + 1;
  }
  return numbers;
}

/// The address of NAME_ as Fortran writes it, or NAME as C does.
void* symbol(void* handle, const std::string& name) {
  void* const found = dlsym(handle, (name + "_").c_str());
  return found != nullptr ? found : dlsym(handle, name.c_str());
}

/// Why dlopen failed, without line ends.
std::string reason() {
  const char* const text = dlerror();
  std::string line = text != nullptr ? text : "no reason is given";
  std::replace(line.begin(), line.end(), '\n', ' ');
  return line;
}

}  // namespace

void UmatLibrary::call(UmatCall& c, double* states, int count, bool on_threads) const {
  const int ndi = 3, nshr = dim == 2 ? 1 : 3, ntens = ndi + nshr,
            nprops = static_cast<int>(properties.size()), noel = c.id + 1, one = 1, jstep[4] = {1, 0, 0, 0},
            kinc = number_of_step(c.time, c.dt);
  constexpr double k_large = 1e10;  // PNEWDT before the call
  constexpr double k_short = 1e-6;  // s, where there is no step: laws divide by it
  const double dt = c.dt > 0 ? c.dt : k_short;
  double ddsdde[36] = {}, ddsddt[6] = {}, drplde[6] = {}, rpl = 0, drpldt = 0, pnewdt = k_large, none = 0,
         time[2] = {c.time, c.time}, drot[9], before[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, after[9];
  by_columns(c.rotation, drot), by_columns(c.gradient, after);
  for (int d = 0; d < 3; ++d) after[4 * d] += 1;
  const auto lock = lock_unless(on_threads);
  const WatchedUmat watched({.library = this, .call = &c, .step = kinc});
  try {
    reinterpret_cast<UmatFunction*>(umat)(
        c.stress, count > 0 ? states : &none, ddsdde, &c.energy[0], &c.energy[1], &c.energy[2], &rpl, ddsddt,
        drplde, &drpldt, c.strain, c.strain_increment, time, &dt, &none, &none, &none, &none,
        material.c_str(), &ndi, &nshr, &ntens, &count, nprops > 0 ? properties.data() : &none, &nprops,
        c.position, drot, &pnewdt, &spacing, before, after, &noel, &one, &one, &one, jstep, &kinc,
        k_name_length);
    c.gave_up = c.gave_up || pnewdt < 1;
  } catch (const UmatExit&) {
    c.gave_up = true;
  }
  c.modulus = largest_normal_stiffness(ddsdde, ntens);
}

void UmatLibrary::start(UmatCall& at, double* states, int count, bool on_threads) const {
  for (int k = 0; k < count; ++k) states[k] = state_start.empty() ? 0 : state_start[k];
  if (sdvini == nullptr || count == 0 || !state_start.empty()) return;
  const int coordinates = dim, noel = at.id + 1, one = 1;
  const auto lock = lock_unless(on_threads);
  const WatchedUmat watched({.library = this, .call = &at});
  try {
    reinterpret_cast<SdviniFunction*>(sdvini)(states, at.position, &count, &coordinates, &noel, &one, &one,
                                              &one);
  } catch (const UmatExit&) {
    at.gave_up = true;
  }
}

std::shared_ptr<const UmatLibrary> open_umat(const std::string& material, const UmatTexts& texts, int dim,
                                             const std::array<double, 3>& lower, double spacing,
                                             std::string& key, std::string& takes) {
  const std::filesystem::path path = texts.library;
  key = "library";
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) {
    takes = "a shared library, which is a regular file that can be read";
    return nullptr;
  }
  if (const std::string fault = fault_of_shared_object(path.string()); !fault.empty()) {
    takes = "a shared library that can be loaded; " + fault;
    return nullptr;
  }
  keep_umat_utilities();
  // A path with a slash: dlopen does not look for it elsewhere.
  const std::string place = path.has_parent_path() ? path.string() : "./" + path.string();
  auto library = std::make_shared<UmatLibrary>();
  library->name = material, library->path = texts.library;
  const WatchedUmat watched({.library = library.get()});  // functions that the library runs as it is loaded
  library->handle = {dlopen(place.c_str(), RTLD_NOW | RTLD_LOCAL), [](void* handle) {
                       if (handle != nullptr) dlclose(handle);
                     }};
  if (library->handle == nullptr) {
    takes = "a shared library that can be loaded; " + reason();
    return nullptr;
  }
  library->umat = symbol(library->handle.get(), "umat");
  library->sdvini = symbol(library->handle.get(), "sdvini");
  if (library->umat == nullptr) {
    takes = "a shared library with a subroutine UMAT (symbol umat_, or umat of C); it has none";
    return nullptr;
  }
  library->material = material;
  for (char& c : library->material) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  library->material.resize(k_name_length, ' ');
  library->properties = numbers_of(texts.properties), library->state_start = numbers_of(texts.state_start);
  library->dim = dim, library->lower = lower, library->spacing = spacing;
  key.clear();
  return library;
}

}  // namespace mpm
