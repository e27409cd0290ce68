#include "input/particle_file.hpp"

#include <algorithm>
#include <cmath>

#include "input/text.hpp"
#include "output/hdf5_handle.hpp"

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

 private:
  std::vector<double> refuse(const std::string& takes) {
    fault = takes;
    return {};
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
    std::vector<double> all(sizes[0] * components);
    if (H5Dread(data.id, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, all.data()) < 0)
      return refuse(wrong);
    return all;
  }
};

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

/// Empty where all volumes are positive and the same.
std::string unequal(const std::vector<double>& volume) {
  const auto [least, most] = std::minmax_element(volume.begin(), volume.end());
  if (*least > 0 && *most - *least <= 1e-6 * *most) return "";
  return "particles whose volumes are greater than 0 and, since all have one mass, the same; they are from " +
         text_of(*least) + " to " + text_of(*most);
}

}  // namespace

std::string read_particles(const std::string& path, const std::string& group, const MeshConfig& mesh, int dim,
                           ParticleTable& table) {
  const Quiet quiet;
  Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (file.id < 0) return "an HDF5 file that can be read";
  Handle opened(H5Gopen2(file.id, group.c_str(), H5P_DEFAULT), H5Gclose);
  if (opened.id < 0) return "a file with the group " + group;

  GroupReader in{opened.id, group};
  table.position = in.read("position", 3, dim);
  const auto volume = in.read("volume", 1, 1);
  if (in.has("velocity")) table.velocity = in.read("velocity", 3, dim);
  if (in.has("stress")) table.stress = in.read("stress", 6, dim == 2 ? 4 : 6);
  if (in.has("plastic_strain")) table.plastic_strain = in.read("plastic_strain", 1, 1);
  if (!in.fault.empty()) return in.fault;
  table.particle_volume = volume[0];
  const std::string fault = unequal(volume);
  return fault.empty() ? outside(table.position, mesh, dim) : fault;
}

}  // namespace mpm
