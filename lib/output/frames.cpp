#include "output/frames.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "numbers.hpp"
#include "output/files.hpp"
#include "output/hdf5_handle.hpp"
#include "parallel/together.hpp"

namespace mpm {
namespace fs = std::filesystem;

namespace {

/// One field of a particle group. A new field is a line of k_fields.
struct Field {
  const char* name;
  const char* unit;
  int components;
  bool bodies_only;
  std::vector<double> ParticleSnapshot::*values;  // [components N]
};

constexpr Field k_fields[] = {
    {"position", "m", 3, false, &ParticleSnapshot::position},  // first: the geometry, always float64
    {"velocity", "m/s", 3, false, &ParticleSnapshot::velocity},
    {"grid_velocity", "m/s", 3, true, &ParticleSnapshot::grid_velocity},
    {"stress", "Pa", 6, true, &ParticleSnapshot::stress},
    {"volume", "m3", 1, true, &ParticleSnapshot::volume},
    {"plastic_strain", "-", 1, true, &ParticleSnapshot::plastic_strain},
};

/// Every HDF5 call passes here: a negative result is an error that names the file.
PetscErrorCode check(hid_t result, const std::string& path, const char* what) {
  PetscFunctionBeginUser;
  PetscCheck(result >= 0, PETSC_COMM_SELF, PETSC_ERR_LIB, "HDF5 failed at %s of %s", what, path.c_str());
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode write_attribute(hid_t where, const std::string& path, const char* name, hid_t type,
                               const void* value) {
  PetscFunctionBeginUser;
  Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  PetscCall(check(space.id, path, name));
  Handle attribute(H5Acreate2(where, name, type, space.id, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  PetscCall(check(attribute.id, path, name));
  PetscCall(check(H5Awrite(attribute.id, type, value), path, name));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// The unit of a dataset, as the text attribute `unit`.
PetscErrorCode write_unit(hid_t dataset, const std::string& path, const std::string& unit) {
  PetscFunctionBeginUser;
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  PetscCall(check(type.id, path, "unit"));
  PetscCall(check(H5Tset_size(type.id, unit.size()), path, "unit"));
  PetscCall(write_attribute(dataset, path, "unit", type.id, unit.data()));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// A dataset whose numbers come later, from all ranks: its place in the file is fixed now.
PetscErrorCode reserve_field(hid_t group, const std::string& path, const Field& field, hsize_t count, hid_t type,
                             long long* offset) {
  PetscFunctionBeginUser;
  const hsize_t sizes[2] = {count, static_cast<hsize_t>(field.components)};
  Handle space(H5Screate_simple(field.components == 1 ? 1 : 2, sizes, nullptr), H5Sclose);
  PetscCall(check(space.id, path, field.name));
  Handle how(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  PetscCall(check(how.id, path, field.name));
  PetscCall(check(H5Pset_alloc_time(how.id, H5D_ALLOC_TIME_EARLY), path, field.name));
  PetscCall(check(H5Pset_fill_time(how.id, H5D_FILL_TIME_NEVER), path, field.name));
  Handle data(H5Dcreate2(group, field.name, type, space.id, H5P_DEFAULT, how.id, H5P_DEFAULT), H5Dclose);
  PetscCall(check(data.id, path, field.name));
  PetscCall(write_unit(data.id, path, field.unit));
  *offset = static_cast<long long>(H5Dget_offset(data.id));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// One dataset, N x components, or N where there is one component.
PetscErrorCode write_field(hid_t group, const std::string& path, const Field& field,
                           const ParticleSnapshot& particles, hid_t type) {
  PetscFunctionBeginUser;
  const std::vector<double>& values = particles.*field.values;
  const size_t count = particles.position.size() / 3;
  PetscCheck(values.size() == count * field.components, PETSC_COMM_SELF, PETSC_ERR_ARG_SIZ,
             "%s of %s holds %zu numbers for %zu particles", field.name, particles.name.c_str(),
             values.size(), count);
  const hsize_t sizes[2] = {count, static_cast<hsize_t>(field.components)};
  Handle space(H5Screate_simple(field.components == 1 ? 1 : 2, sizes, nullptr), H5Sclose);
  PetscCall(check(space.id, path, field.name));
  Handle data(H5Dcreate2(group, field.name, type, space.id, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose);
  PetscCall(check(data.id, path, field.name));
  if (count > 0)
    PetscCall(check(H5Dwrite(data.id, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), path,
                    field.name));
  PetscCall(write_unit(data.id, path, field.unit));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// slabs: where the numbers belong, for those of several ranks; null where they are all here.
PetscErrorCode write_group(hid_t file, const std::string& path, const ParticleSnapshot& particles, bool body,
                           Precision precision, std::vector<FrameSlab>* slabs = nullptr, std::size_t number = 0) {
  PetscFunctionBeginUser;
  const char* name = particles.name.c_str();
  Handle group(H5Gcreate2(file, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  PetscCall(check(group.id, path, name));
  const hid_t real = precision == Precision::single ? H5T_IEEE_F32LE : H5T_IEEE_F64LE;
  for (const Field& field : k_fields) {
    if (!body && field.bodies_only) continue;
    const hid_t type = &field == k_fields ? H5T_IEEE_F64LE : real;
    if (slabs == nullptr) {
      PetscCall(write_field(group.id, path, field, particles, type));
      continue;
    }
    FrameSlab slab{number, field.values, field.components, static_cast<int>(H5Tget_size(type)), 0};
    PetscCall(reserve_field(group.id, path, field, particles.total, type, &slab.offset));
    slabs->push_back(slab);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode write_groups(hid_t file, const std::string& path, const Snapshot& snapshot,
                            Precision precision, std::vector<FrameSlab>* slabs = nullptr) {
  PetscFunctionBeginUser;
  const long long step = snapshot.step;
  PetscCall(write_attribute(file, path, "time", H5T_NATIVE_DOUBLE, &snapshot.time));
  PetscCall(write_attribute(file, path, "step", H5T_NATIVE_LLONG, &step));
  for (std::size_t b = 0; b < snapshot.bodies.size(); ++b)
    PetscCall(write_group(file, path, snapshot.bodies[b], true, precision, slabs, b));
  for (const ParticleSnapshot& rigid : snapshot.rigids)
    PetscCall(write_group(file, path, rigid, false, precision));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// The bytes of the frame as a file. HDF5 makes them in memory, for it does not survive a disk that fills
/// while it writes: its close fails, and its clean-up at the end of the program then crashes.
PetscErrorCode frame_image(const std::string& path, const Snapshot& snapshot, Precision precision,
                           std::string* image) {
  constexpr size_t k_growth = 4 << 20;  // bytes
  PetscFunctionBeginUser;
  Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  PetscCall(check(access.id, path, "access"));
  PetscCall(check(H5Pset_fapl_core(access.id, k_growth, /*backing_store*/ false), path, "access"));
  Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.id), H5Fclose);
  PetscCall(check(file.id, path, "creation"));
  PetscCall(write_groups(file.id, path, snapshot, precision));
  PetscCall(check(H5Fflush(file.id, H5F_SCOPE_GLOBAL), path, "flush"));
  const ssize_t size = H5Fget_file_image(file.id, nullptr, 0);
  PetscCall(check(size, path, "size"));
  image->resize(static_cast<size_t>(size));
  PetscCall(check(H5Fget_file_image(file.id, image->data(), image->size()), path, "image"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// The structure of a frame as a file of its own; `path` is for messages.
PetscErrorCode make_layout(const std::string& name, const std::string& path, const Snapshot& snapshot,
                           Precision precision, std::vector<FrameSlab>* slabs) {
  PetscFunctionBeginUser;
  Handle file(H5Fcreate(name.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose);
  PetscCall(check(file.id, path, "creation"));
  PetscCall(write_groups(file.id, path, snapshot, precision, slabs));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// `<DataItem>` that points at one dataset of a frame.
std::string data_item(const FrameEntry& frame, const FrameEntry::Group& group, const Field& field,
                      int real_bytes) {
  const int bytes = &field == k_fields ? 8 : real_bytes;
  std::string size = std::to_string(group.count);
  if (field.components > 1) size += " " + std::to_string(field.components);
  return "<DataItem Format=\"HDF\" NumberType=\"Float\" Precision=\"" + std::to_string(bytes) +
         "\" Dimensions=\"" + size + "\">" + frame.file + ":/" + group.name + "/" + field.name +
         "</DataItem>";
}

std::string format_attribute(const std::string& name, const char* kind, const std::string& item) {
  return "          <Attribute Name=\"" + name + "\" AttributeType=\"" + kind + "\" Center=\"Node\">" + item +
         "</Attribute>\n";
}

/// A symmetric tensor as six scalars, each a column of the dataset: XDMF's own Tensor6 has another order, and
/// VTK misreads the size of a Matrix.
std::string format_tensor(const std::string& name, const std::string& item, long particles) {
  constexpr const char* components[] = {"xx", "yy", "zz", "xy", "yz", "zx"};
  const std::string count = std::to_string(particles);
  std::string text;
  for (int k = 0; k < 6; ++k) {
    const std::string column = "<DataItem Format=\"XML\" NumberType=\"Int\" Dimensions=\"3 2\">0 " +
                               std::to_string(k) + " 1 1 " + count + " 1</DataItem>";
    text += format_attribute(
        name + "_" + components[k], "Scalar",
        "<DataItem ItemType=\"HyperSlab\" Dimensions=\"" + count + " 1\">" + column + item + "</DataItem>");
  }
  return text;
}

/// The grid of one body or rigid: a point a particle.
std::string format_grid(const FrameEntry& frame, const FrameEntry::Group& group, int real_bytes) {
  const std::string count = std::to_string(group.count);
  std::string text = "        <Grid Name=\"" + group.name + "\" GridType=\"Uniform\">\n";
  text += "          <Topology TopologyType=\"Polyvertex\" NumberOfElements=\"" + count +
          "\" NodesPerElement=\"1\"/>\n";
  text += "          <Geometry GeometryType=\"XYZ\">" + data_item(frame, group, k_fields[0], real_bytes) +
          "</Geometry>\n";
  for (const Field& field : k_fields) {
    if (&field == k_fields || (field.bodies_only && !group.body)) continue;
    const std::string item = data_item(frame, group, field, real_bytes);
    if (field.components == 6)
      text += format_tensor(field.name, item, group.count);
    else
      text += format_attribute(field.name, field.components == 3 ? "Vector" : "Scalar", item);
  }
  return text + "        </Grid>\n";
}

}  // namespace

std::string format_xdmf(const std::vector<FrameEntry>& frames, int real_bytes) {
  std::string text =
      "<?xml version=\"1.0\"?>\n<Xdmf Version=\"2.0\">\n  <Domain>\n"
      "    <Grid Name=\"particles\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
  for (const FrameEntry& frame : frames) {
    text +=
        "      <Grid Name=\"frame\" GridType=\"Collection\" CollectionType=\"Spatial\">\n        <Time "
        "Value=\"" +
        text_of(frame.time) + "\"/>\n";
    for (const FrameEntry::Group& group : frame.groups)
      if (group.count > 0) text += format_grid(frame, group, real_bytes);
    text += "      </Grid>\n";
  }
  return text + "    </Grid>\n  </Domain>\n</Xdmf>\n";
}

PetscErrorCode lay_out_frame(const std::string& path, const Snapshot& snapshot, Precision precision,
                             int* descriptor, std::vector<FrameSlab>* slabs) {
  PetscFunctionBeginUser;
  std::error_code error;
  const std::string memory = "/dev/shm";  // holes take no memory
  std::string name =
      (fs::is_directory(memory, error) ? memory : fs::temp_directory_path(error).string()) + "/mpm_frame_XXXXXX";
  *descriptor = ::mkostemp(name.data(), O_CLOEXEC);
  PetscCheck(*descriptor >= 0, PETSC_COMM_SELF, PETSC_ERR_FILE_OPEN, "Cannot open %s: %s", name.c_str(),
             std::strerror(errno));
  const auto forget = [&](PetscErrorCode result) {
    ::unlink(name.c_str());
    return result;
  };
  PetscCall(forget(make_layout(name, path, snapshot, precision, slabs)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode write_frame(const std::string& path, const Snapshot& snapshot, Precision precision) {
  PetscFunctionBeginUser;
  std::string image;
  PetscCall(frame_image(path, snapshot, precision, &image));
  PetscCall(replace_file(path, image));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void Frames::open(const std::string& folder, Precision precision, MPI_Comm comm) {
  comm_ = comm;
  folder_ = folder;
  precision_ = precision;
  entries_.clear();
}

PetscErrorCode Frames::write(const Snapshot& snapshot) {
  PetscFunctionBeginUser;
  char file[40];
  std::snprintf(file, sizeof file, "frames/frame_%05d.h5", count());
  if (size_of(comm_) == 1)
    PetscCall(write_frame(folder_ + "/" + file, snapshot, precision_));
  else
    PetscCall(write_frame_together(comm_, folder_ + "/" + file, snapshot, precision_));

  FrameEntry entry{file, snapshot.time, {}};
  for (const auto& body : snapshot.bodies)
    entry.groups.push_back(
        {body.name, body.total < 0 ? static_cast<long>(body.position.size() / 3) : body.total, true});
  for (const auto& rigid : snapshot.rigids)
    entry.groups.push_back({rigid.name, static_cast<long>(rigid.position.size() / 3), false});
  entries_.push_back(std::move(entry));
  const auto write_index = [&] {
    return replace_file(folder_ + "/particles.xdmf", format_xdmf(entries_, precision_ == Precision::single ? 4 : 8));
  };
  PetscCall(agree(comm_, rank_of(comm_) == 0 ? write_index() : PETSC_SUCCESS));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
