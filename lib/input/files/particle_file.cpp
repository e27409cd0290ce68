#include "input/files/particle_file.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/hdf5_handle.hpp"
#include "common/host_memory.hpp"
#include "common/regular_file.hpp"
#include "common/text.hpp"
#include "input/files/checkpoint_particles.hpp"
#include "physics/materials/tables.hpp"

namespace mpm {
namespace {

/// Reads the datasets of one group. The first fault is kept, and nothing is read after it.
struct GroupReader {
  hid_t group;
  std::string name;
  std::size_t rows = 0;  // of the first dataset read; all others must have as many
  std::string fault{};

  bool has(const char* field) const { return fault.empty() && H5Lexists(group, field, H5P_DEFAULT) > 0; }

  /// The first `kept` of the `components` of every row.
  std::vector<double> read(const char* field, int components, int kept) {
    const std::string what = name + "/" + field;
    if (fault.empty() && !has(field)) fault = "a file with the dataset " + what;
    if (!fault.empty()) return {};
    const std::vector<double> all = read_all(field, components);
    if (!fault.empty()) return {};
    if (rows == 0) rows = all.size() / components;
    std::vector<double> values;
    for (std::size_t n = 0; n < all.size(); ++n) {
      if (n % components >= std::size_t(kept)) continue;
      if (!std::isfinite(all[n]))
        return refuse("a file whose " + what + " is finite; that of particle " +
                      std::to_string(n / components) + " is not");
      values.push_back(all[n]);
    }
    return values;
  }
  /// Reads a field that may be missing; but where `needed`, the frame's -output_fields left it out.
  void read_if_there(const char* field, int components, int kept, bool needed, std::vector<double>& values) {
    if (has(field))
      values = read(field, components, kept);
    else if (needed && fault.empty())
      fault =
          std::string("a frame with ") + name + "/" + field + ", which -output_fields of its run left out";
  }

 private:
  std::vector<double> refuse(const std::string& takes) {
    fault = takes;
    return {};
  }

  /// Why so many rows cannot be meant, or read; empty if they can.
  static std::string absurd_size(hid_t data, hsize_t found, int components) {
    constexpr double k_most_particles = 2147483647, k_tightest = 1100;  // more than deflate can pack into one
    Handle type(H5Dget_type(data), H5Tclose);
    const double numbers = double(found) * components, bytes = numbers * double(H5Tget_size(type.id));
    if (double(found) > k_most_particles) return " has at most 2147483647 rows";
    if (bytes > k_tightest * double(H5Dget_storage_size(data)))
      return formatted(" holds what its size says, %.4g numbers", numbers);
    const double needed = 3 * numbers * sizeof(double), free = free_host_memory();
    if (free > 0 && needed > free)
      return formatted(" fits into memory: it needs about %.4g GB, and %.4g GB are free", needed / 1e9,
                       free / 1e9);
    return "";
  }

  std::vector<double> read_all(const char* field, int components) {
    const std::string wrong = "a file whose " + name + "/" + field + " is " +
                              (rows == 0 ? "N" : std::to_string(rows)) +
                              (components == 1 ? "" : " x " + std::to_string(components)) + " numbers";
    Handle data(H5Dopen2(group, field, H5P_DEFAULT), H5Dclose);
    if (data.id < 0) return refuse(wrong);
    Handle space(H5Dget_space(data.id), H5Sclose);
    const int rank = components == 1 ? 1 : 2;
    hsize_t sizes[2] = {0, 1};
    if (H5Sget_simple_extent_ndims(space.id) != rank ||
        H5Sget_simple_extent_dims(space.id, sizes, nullptr) < 0 || sizes[0] == 0 ||
        sizes[1] != hsize_t(components) || (rows > 0 && sizes[0] != rows))
      return refuse(wrong);
    if (const std::string absurd = absurd_size(data.id, sizes[0], components); !absurd.empty())
      return refuse("a file whose " + name + "/" + field + absurd);
    std::vector<double> all(sizes[0] * components);
    if (H5Dread(data.id, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, all.data()) < 0)
      return refuse(wrong);
    return all;
  }
};

/// A number that the file has as an attribute.
template <class Number>
bool read_attribute(hid_t file, const char* name, hid_t type, Number* number) {
  if (H5Aexists(file, name) <= 0) return false;
  Handle item(H5Aopen(file, name, H5P_DEFAULT), H5Aclose);
  if (item.id < 0) return false;
  Handle space(H5Aget_space(item.id), H5Sclose);
  return H5Sget_simple_extent_npoints(space.id) == 1 && H5Aread(item.id, type, number) >= 0;
}

/// Between two rebuilds of its lists a run may have a particle up to half a cell outside the mesh, which the
/// next one puts back to a wall or lets go. Such particles come to the side of the mesh; how many did. Those
/// that have passed a periodic side come to where they are within the mesh.
long put_inside(const MeshConfig& mesh, int dim, std::vector<double>& position) {
  constexpr double k_furthest = 0.5, k_inside = 1e-6;  // cells; inside in single precision too
  long count = 0;
  for (std::size_t p = 0; p < position.size() / dim; ++p) {
    bool moved = false;
    for (int d = 0; d < dim; ++d) {
      double& x = position[p * dim + d];
      const double cells = (x - mesh.lower[d]) / mesh.spacing, last = mesh.cells[d] - k_inside;
      if (cells >= 0 && std::floor(cells) < mesh.cells[d]) continue;
      if (cells < -k_furthest || cells > mesh.cells[d] + k_furthest) continue;
      if (is_periodic(mesh, d)) {
        x += (cells < 0 ? 1 : -1) * (mesh.upper[d] - mesh.lower[d]);
        x = std::clamp(x, mesh.lower[d], mesh.lower[d] + last * mesh.spacing);
        continue;
      }
      x = mesh.lower[d] + (cells < 0 ? k_inside : last) * mesh.spacing;
      moved = true;
    }
    count += moved;
  }
  return count;
}

/// Empty where every particle is in a cell of the mesh.
std::string outside(const std::vector<double>& position, const MeshConfig& mesh, int dim) {
  for (std::size_t n = 0; n < position.size(); ++n) {
    const int d = static_cast<int>(n % dim);
    const double cell = std::floor((position[n] - mesh.lower[d]) / mesh.spacing);
    if (cell >= 0 && cell < mesh.cells[d]) continue;
    const auto at = std::span(position).subspan(n - d, dim);
    return "particles inside the mesh, " + text_of(mesh.lower, dim) + " to " + text_of(mesh.upper, dim) +
           "; particle " + std::to_string(n / dim) + " is at " + text_of(at);
  }
  return "";
}

/// Empty where all numbers are greater than 0.
std::string not_positive(const std::vector<double>& numbers, const char* what) {
  for (std::size_t p = 0; p < numbers.size(); ++p)
    if (!(numbers[p] > 0))
      return std::string("particles whose ") + what + " is greater than 0; that of particle " +
             std::to_string(p) + " is " + text_of(numbers[p]);
  return "";
}

/// Whether the particles of a group of a frame had their own values of this parameter.
bool has_own(hid_t group, const std::string& parameter) {
  if (H5Aexists(group, k_own_parameter) <= 0) return false;
  Handle item(H5Aopen(group, k_own_parameter, H5P_DEFAULT), H5Aclose);
  Handle type(H5Aget_type(item.id), H5Tclose);
  if (H5Tget_class(type.id) != H5T_STRING || H5Tis_variable_str(type.id) != 0) return false;
  std::string text(H5Tget_size(type.id), '\0');
  if (H5Aread(item.id, type.id, text.data()) < 0) return false;
  const auto keys = split(text);
  return std::find(keys.begin(), keys.end(), parameter) != keys.end();
}

/// The group of a frame, or of a file laid out as one.
std::string read_group(hid_t file, const ParticleSource& source, int dim, ParticleTable& table) {
  long long dim_there = dim, step = 0;
  double time = 0;
  const bool frame = read_attribute(file, "dim", H5T_NATIVE_LLONG, &dim_there) &&
                     read_attribute(file, "step", H5T_NATIVE_LLONG, &step) &&
                     read_attribute(file, "time", H5T_NATIVE_DOUBLE, &time);
  if (dim_there != dim) return "a frame of a run in " + std::to_string(dim) + "D";
  Handle opened(H5Gopen2(file, source.group.c_str(), H5P_DEFAULT), H5Gclose);
  if (opened.id < 0) return "a file with the group " + source.group;
  GroupReader in{opened.id, source.group};
  for (const ParticleColumn& column : k_particle_columns) {
    if (column.carried == Carried::checkpoints || !wanted(column, source)) continue;
    std::vector<double>& values = table.*column.values;
    const int width = width_of(column.width, 3, 0), kept = width_of(column.width, dim, 0);
    if (column.carried == Carried::always)
      values = in.read(column.name, width, kept);
    else
      in.read_if_there(column.name, width, kept, frame && column.carried != Carried::if_needed, values);
  }
  std::vector<double> pore_pressure;
  if (!table.stress.empty()) in.read_if_there("pore_pressure", 1, 1, false, pore_pressure);
  add_pressure(pore_pressure, dim, table.stress);  // total stress becomes effective
  // A run of another law has none of this law's variables, but for the plastic strain, which all frames have.
  const bool same_law = std::any_of(source.state.begin(), source.state.end(), [&](const std::string& name) {
    return name != "plastic_strain" && name != k_excess_pore_pressure && in.has(name.c_str());
  });
  for (const std::string& name : source.state) {
    StateField field{name, {}};
    const bool needed = frame &&
                        name != k_excess_pore_pressure &&  // the run of the frame may have been drained
                        (same_law || name == "plastic_strain");
    in.read_if_there(name.c_str(), 1, 1, needed, field.values);
    if (!field.values.empty()) table.state.push_back(std::move(field));
  }
  for (const std::string& key : source.parameters) {
    StateField field{key, {}};
    in.read_if_there(key.c_str(), 1, 1, frame && has_own(opened.id, key), field.values);
    if (!field.values.empty()) table.own_parameters.push_back(std::move(field));
  }
  if (frame) table.origin = "frame of step " + std::to_string(step) + ", " + text_of(time) + " s";
  return in.fault;
}

}  // namespace

bool wanted(const ParticleColumn& column, const ParticleSource& source) {
  if (column.given_by == GivenBy::velocity) return source.velocity;
  if (column.given_by == GivenBy::stress) return source.stress;
  return column.carried != Carried::never;
}

std::string read_particles(const ParticleSource& source, const MeshConfig& mesh, int dim,
                           ParticleTable& table) {
  if (const std::string fault = irregular_fault(source.path); !fault.empty()) return fault;
  const Quiet quiet;
  table = {};
  std::string fault;
  bool checkpoint = false;
  {
    Handle file(H5Fopen(source.path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
    if (file.id < 0) return "an HDF5 file that can be read";
    checkpoint = H5Aexists(file.id, "strategy") > 0;  // a frame has none
    if (!checkpoint) fault = read_group(file.id, source, dim, table);
  }
  if (checkpoint) fault = read_checkpoint_particles(source, mesh, dim, table);
  if (!table.origin.empty()) table.put_inside = put_inside(mesh, dim, table.position);
  if (fault.empty()) fault = not_positive(table.volume, "volume");
  if (fault.empty()) fault = not_positive(table.mass, "mass");
  return fault.empty() ? outside(table.position, mesh, dim) : fault;
}

void add_pressure(const std::vector<double>& pressure, int dim, std::vector<double>& stress) {
  const std::size_t components = dim == 2 ? 4 : 6;
  if (stress.size() != components * pressure.size()) return;
  for (std::size_t p = 0; p < pressure.size(); ++p)
    for (std::size_t k = 0; k < 3; ++k) stress[components * p + k] += pressure[p];
}

double mean_density(const ParticleTable& table, double of_material) {
  if (table.mass.empty()) return of_material;
  return std::accumulate(table.mass.begin(), table.mass.end(), 0.0) /
         std::accumulate(table.volume.begin(), table.volume.end(), 0.0);
}

long listed_particles(const std::string& path, const std::string& group) {
  if (!irregular_fault(path).empty()) return 0;
  const Quiet quiet;
  Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (file.id < 0) return 0;
  const bool checkpoint = H5Aexists(file.id, "strategy") > 0;  // there all bodies are in one group
  const std::string data_set = checkpoint ? "soil/address" : group + "/volume";
  Handle data(H5Dopen2(file.id, data_set.c_str(), H5P_DEFAULT), H5Dclose);
  if (data.id < 0) return 0;
  Handle space(H5Dget_space(data.id), H5Sclose);
  return std::max<long>(static_cast<long>(H5Sget_simple_extent_npoints(space.id)), 0);
}

}  // namespace mpm
