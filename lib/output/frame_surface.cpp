#include "output/frame_surface.hpp"

#include "common/hdf5_handle.hpp"

namespace mpm {
namespace {

/// Writes rows of three numbers.
PetscErrorCode write_rows(hid_t group, const std::string& path, const char* name, std::size_t rows,
                          hid_t file_type, hid_t type, const void* values, hid_t* data) {
  PetscFunctionBeginUser;
  const hsize_t sizes[2] = {rows, 3};
  Handle space(H5Screate_simple(2, sizes, nullptr), H5Sclose);
  PetscCall(check_hdf5(space.id, path, name));
  *data = H5Dcreate2(group, name, file_type, space.id, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  PetscCall(check_hdf5(*data, path, name));
  PetscCall(check_hdf5(H5Dwrite(*data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), path, name));
  PetscFunctionReturn(PETSC_SUCCESS);
}

long rows_of(hid_t group, const char* name) {
  Handle data(H5Dopen2(group, name, H5P_DEFAULT), H5Dclose);
  if (data.id < 0) return 0;
  Handle space(H5Dget_space(data.id), H5Sclose);
  hsize_t sizes[2] = {0, 0};
  if (H5Sget_simple_extent_ndims(space.id) != 2) return 0;
  H5Sget_simple_extent_dims(space.id, sizes, nullptr);
  return static_cast<long>(sizes[0]);
}

}  // namespace

std::string surface_group(const std::string& rigid) { return rigid + "_surface"; }

PetscErrorCode write_surface(hid_t file, const std::string& path, const ParticleSnapshot& rigid) {
  PetscFunctionBeginUser;
  if (rigid.triangles.empty()) PetscFunctionReturn(PETSC_SUCCESS);
  const std::string name = surface_group(rigid.name);
  Handle group(H5Gcreate2(file, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  PetscCall(check_hdf5(group.id, path, name.c_str()));
  Handle vertices(-1, H5Dclose), triangles(-1, H5Dclose);
  PetscCall(write_rows(group.id, path, "vertices", rigid.vertices.size() / 3, H5T_IEEE_F64LE,
                       H5T_NATIVE_DOUBLE, rigid.vertices.data(), &vertices.id));
  PetscCall(write_rows(group.id, path, "triangles", rigid.triangles.size() / 3, H5T_STD_I32LE, H5T_NATIVE_INT,
                       rigid.triangles.data(), &triangles.id));
  PetscFunctionReturn(PETSC_SUCCESS);
}

SurfaceSize surface_size(hid_t file, const std::string& rigid) {
  const std::string name = surface_group(rigid);
  if (H5Lexists(file, name.c_str(), H5P_DEFAULT) <= 0) return {};
  Handle group(H5Gopen2(file, name.c_str(), H5P_DEFAULT), H5Gclose);
  if (group.id < 0) return {};
  return {rows_of(group.id, "vertices"), rows_of(group.id, "triangles")};
}

std::string surface_grid(const std::string& file, const std::string& rigid, const SurfaceSize& size) {
  const std::string name = surface_group(rigid), triangles = std::to_string(size.triangles);
  const auto item = [&](const char* type, const char* bytes, long rows, const char* what) {
    return std::string("<DataItem Format=\"HDF\" NumberType=\"") + type + "\" Precision=\"" + bytes +
           "\" Dimensions=\"" + std::to_string(rows) + " 3\">" + file + ":/" + name + "/" + what +
           "</DataItem>";
  };
  return "        <Grid Name=\"" + name + "\" GridType=\"Uniform\">\n" +
         "          <Topology TopologyType=\"Triangle\" NumberOfElements=\"" + triangles + "\">" +
         item("Int", "4", size.triangles, "triangles") + "</Topology>\n" +
         "          <Geometry GeometryType=\"XYZ\">" + item("Float", "8", size.vertices, "vertices") +
         "</Geometry>\n        </Grid>\n";
}

}  // namespace mpm
