#include "input/files/field_file.hpp"

#include <algorithm>
#include <cmath>

#include "common/hdf5_handle.hpp"
#include "common/host_memory.hpp"
#include "common/regular_file.hpp"
#include "common/text.hpp"

namespace mpm {
namespace {

constexpr double k_furthest = 1e9;  // m

/// dim finite numbers of an attribute.
bool read_vector(hid_t data, const char* name, int dim, Vec3& x) {
  if (H5Aexists(data, name) <= 0) return false;
  Handle item(H5Aopen(data, name, H5P_DEFAULT), H5Aclose);
  if (item.id < 0) return false;
  Handle space(H5Aget_space(item.id), H5Sclose);
  if (H5Sget_simple_extent_npoints(space.id) != dim) return false;
  if (H5Aread(item.id, H5T_NATIVE_DOUBLE, x.data()) < 0) return false;
  return std::all_of(x.begin(), x.begin() + dim, [](double v) { return std::abs(v) <= k_furthest; });
}

/// Why so many numbers cannot be meant, or read; empty if they can.
std::string size_fault(hid_t data, const std::string& key, double numbers) {
  constexpr double k_tightest = 1100;  // more than deflate can pack into one
  Handle type(H5Dget_type(data), H5Tclose);
  if (numbers * double(H5Tget_size(type.id)) > k_tightest * double(H5Dget_storage_size(data)))
    return "a file whose " + key + formatted(" holds what its size says, %.4g numbers", numbers);
  const double needed = 2 * numbers * sizeof(double), free = free_host_memory();
  if (free > 0 && needed > free)
    return "a file whose " + key +
           formatted(" fits into memory: it needs about %.4g GB, and %.4g GB are free", needed / 1e9,
                     free / 1e9);
  return "";
}

std::string read_data(hid_t file, const std::string& key, int dim, GridField& field) {
  if (H5Lexists(file, key.c_str(), H5P_DEFAULT) <= 0) return "a file with the dataset " + key;
  const std::string form = "a file whose " + key + " is a grid of numbers with " + std::to_string(dim) +
                           " axes, the vertical one first";
  Handle data(H5Dopen2(file, key.c_str(), H5P_DEFAULT), H5Dclose);
  if (data.id < 0) return form;
  Handle space(H5Dget_space(data.id), H5Sclose);
  hsize_t sizes[3] = {1, 1, 1};
  if (H5Sget_simple_extent_ndims(space.id) != dim) return form;
  H5Sget_simple_extent_dims(space.id, sizes, nullptr);
  double numbers = 1;
  for (int d = 0; d < dim; ++d) {
    field.count[d] = static_cast<long>(sizes[dim - 1 - d]);
    numbers *= static_cast<double>(sizes[d]);
    if (sizes[d] == 0) return form;
  }
  if (!read_vector(data.id, "lower", dim, field.lower) ||
      !read_vector(data.id, "spacing", dim, field.spacing) ||
      std::any_of(field.spacing.begin(), field.spacing.end(), [](double h) { return !(h > 0); }))
    return "a file whose " + key + " has the attributes lower and spacing, " + std::to_string(dim) +
           " numbers in m each, the spacing greater than 0";
  if (const std::string fault = size_fault(data.id, key, numbers); !fault.empty()) return fault;
  field.values.resize(static_cast<std::size_t>(numbers));
  if (H5Dread(data.id, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, field.values.data()) < 0)
    return form;
  for (std::size_t k = 0; k < field.values.size(); ++k)
    if (!std::isfinite(field.values[k]))
      return "a file whose " + key + " is finite; value " + std::to_string(k + 1) + " is not";
  return "";
}

}  // namespace

double GridField::at(const Vec3& x) const {
  std::array<std::size_t, 3> first{}, step{};
  Vec3 part{};
  std::size_t stride = 1;
  for (int d = 0; d < dim; ++d) {
    const double cells = std::clamp((x[d] - lower[d]) / spacing[d], 0.0, static_cast<double>(count[d] - 1));
    const long cell = std::clamp(static_cast<long>(cells), 0L, std::max(count[d] - 2, 0L));
    part[d] = cells - static_cast<double>(cell);
    first[d] = static_cast<std::size_t>(cell) * stride;
    step[d] = count[d] > 1 ? stride : 0;
    stride *= static_cast<std::size_t>(count[d]);
  }
  double value = 0;
  for (int corner = 0; corner < 1 << dim; ++corner) {
    double weight = 1;
    std::size_t place = 0;
    for (int d = 0; d < dim; ++d) {
      const bool far = corner >> d & 1;
      weight *= far ? part[d] : 1 - part[d];
      place += first[d] + (far ? step[d] : 0);
    }
    value += weight * values[place];
  }
  return value;
}

Vec3 GridField::place_of(std::size_t value) const {
  Vec3 x{};
  for (int d = 0; d < dim; ++d) {
    const auto points = static_cast<std::size_t>(count[d]);
    x[d] = lower[d] + spacing[d] * static_cast<double>(value % points);
    value /= points;
  }
  return x;
}

bool has_dataset(const std::string& path, const std::string& key) {
  if (!irregular_fault(path).empty()) return false;
  const Quiet quiet;
  Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  return file.id >= 0 && H5Lexists(file.id, key.c_str(), H5P_DEFAULT) > 0;
}

std::string read_field(const std::string& path, const std::string& key, int dim, GridField& field) {
  if (const std::string fault = irregular_fault(path); !fault.empty()) return fault;
  const Quiet quiet;
  field = {};
  field.dim = dim;
  Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (file.id < 0) return "an HDF5 file that can be read";
  return read_data(file.id, key, dim, field);
}

std::string uncovered(const GridField& field, const Bounds& bounds, double slack) {
  for (int d = 0; d < field.dim; ++d) {
    if (field.lower[d] <= bounds.lower[d] + slack && field.upper(d) >= bounds.upper[d] - slack) continue;
    return formatted("a field that covers the body, in %c from %.10g to %.10g; it has %.10g to %.10g",
                     "xyz"[d], bounds.lower[d], bounds.upper[d], field.lower[d], field.upper(d));
  }
  return "";
}

}  // namespace mpm
