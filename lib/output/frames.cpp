#include "output/frames.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>

#include "numbers.hpp"
#include "output/files.hpp"
#include "output/hdf5_handle.hpp"
#include "parallel/together.hpp"

namespace mpm {
namespace fs = std::filesystem;

namespace {

/// The groups that have a field.
enum class Of { all, bodies, nodes };

/// One field of a group. A new field is a line of k_fields.
struct Field {
  const char* name;
  const char* unit;
  int components;
  Of of;
  std::vector<double> ParticleSnapshot::*values;  // [components N]
};

constexpr Field k_fields[] = {
    {"position", "m", 3, Of::all, &ParticleSnapshot::position},  // first: the geometry, always float64
    {"velocity", "m/s", 3, Of::all, &ParticleSnapshot::velocity},
    {"grid_velocity", "m/s", 3, Of::bodies, &ParticleSnapshot::grid_velocity},
    {"stress", "Pa", 6, Of::bodies, &ParticleSnapshot::stress},
    {"volume", "m3", 1, Of::bodies, &ParticleSnapshot::volume},
    {"plastic_strain", "-", 1, Of::bodies, &ParticleSnapshot::plastic_strain},
    {"mass", "kg", 1, Of::nodes, &ParticleSnapshot::mass},
    {"number", "-", 1, Of::nodes, &ParticleSnapshot::number},
};

/// Whether a group of this kind has a field in this style. Nodes have all of theirs.
bool is_written(const Field& field, Of group, const FrameStyle& style) {
  if (field.of != Of::all && field.of != group) return false;
  return &field == k_fields || group == Of::nodes || style.fields.empty() ||
         std::find(style.fields.begin(), style.fields.end(), field.name) != style.fields.end();
}

/// In pieces that are compressed each by itself; the bytes of all numbers in a piece are put together first,
/// high bytes with high bytes, which differ little.
hid_t layout_of(hsize_t rows, hsize_t components, int compression) {
  constexpr hsize_t k_piece = 1 << 16;  // rows
  const hid_t layout = H5Pcreate(H5P_DATASET_CREATE);
  const hsize_t piece[2] = {std::min(rows, k_piece), components};
  if (compression == 0 || rows == 0) return layout;
  H5Pset_chunk(layout, components == 1 ? 1 : 2, piece);
  H5Pset_shuffle(layout);
  H5Pset_deflate(layout, static_cast<unsigned>(compression));
  return layout;
}

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
PetscErrorCode reserve_field(hid_t group, const std::string& path, const Field& field, hsize_t count,
                             hid_t type, long long* offset) {
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
                           const ParticleSnapshot& particles, hid_t type, int compression) {
  PetscFunctionBeginUser;
  const std::vector<double>& values = particles.*field.values;
  const size_t count = particles.position.size() / 3;
  PetscCheck(values.size() == count * field.components, PETSC_COMM_SELF, PETSC_ERR_ARG_SIZ,
             "%s of %s holds %zu numbers for %zu particles", field.name, particles.name.c_str(),
             values.size(), count);
  const hsize_t sizes[2] = {count, static_cast<hsize_t>(field.components)};
  Handle space(H5Screate_simple(field.components == 1 ? 1 : 2, sizes, nullptr), H5Sclose);
  PetscCall(check(space.id, path, field.name));
  Handle layout(layout_of(count, sizes[1], compression), H5Pclose);
  Handle data(H5Dcreate2(group, field.name, type, space.id, H5P_DEFAULT, layout.id, H5P_DEFAULT), H5Dclose);
  PetscCall(check(data.id, path, field.name));
  if (count > 0)
    PetscCall(check(H5Dwrite(data.id, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), path,
                    field.name));
  PetscCall(write_unit(data.id, path, field.unit));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// slabs: where the numbers belong, for those of several ranks; null where they are all here.
PetscErrorCode write_group(hid_t file, const std::string& path, const ParticleSnapshot& particles, Of kind,
                           Precision precision, const FrameStyle& style,
                           std::vector<FrameSlab>* slabs = nullptr, std::size_t body = 0) {
  PetscFunctionBeginUser;
  const char* name = particles.name.c_str();
  Handle group(H5Gcreate2(file, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  PetscCall(check(group.id, path, name));
  const hid_t real = precision == Precision::single ? H5T_IEEE_F32LE : H5T_IEEE_F64LE;
  for (const Field& field : k_fields) {
    if (!is_written(field, kind, style)) continue;
    const bool number = field.values == &ParticleSnapshot::number;
    const hid_t type = number ? H5T_STD_I64LE : &field == k_fields ? H5T_IEEE_F64LE : real;
    if (slabs == nullptr) {
      PetscCall(write_field(group.id, path, field, particles, type, style.compression));
      continue;
    }
    FrameSlab slab{body, field.values, field.components, static_cast<int>(H5Tget_size(type)), 0};
    PetscCall(reserve_field(group.id, path, field, particles.total, type, &slab.offset));
    slabs->push_back(slab);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode write_groups(hid_t file, const std::string& path, const Snapshot& snapshot,
                            Precision precision, const FrameStyle& style,
                            std::vector<FrameSlab>* slabs = nullptr) {
  PetscFunctionBeginUser;
  const long long step = snapshot.step;
  PetscCall(write_attribute(file, path, "time", H5T_NATIVE_DOUBLE, &snapshot.time));
  PetscCall(write_attribute(file, path, "step", H5T_NATIVE_LLONG, &step));
  for (std::size_t b = 0; b < snapshot.bodies.size(); ++b)
    PetscCall(write_group(file, path, snapshot.bodies[b], Of::bodies, precision, style, slabs, b));
  for (const ParticleSnapshot& rigid : snapshot.rigids)
    PetscCall(write_group(file, path, rigid, Of::all, precision, style));
  for (const ParticleSnapshot& nodes : snapshot.nodes)
    PetscCall(write_group(file, path, nodes, Of::nodes, precision, style));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// The bytes of the frame as a file. HDF5 makes them in memory, for it does not survive a disk that fills
/// while it writes: its close fails, and its clean-up at the end of the program then crashes.
PetscErrorCode frame_image(const std::string& path, const Snapshot& snapshot, Precision precision,
                           const FrameStyle& style, std::string* image) {
  constexpr size_t k_growth = 4 << 20;  // bytes
  PetscFunctionBeginUser;
  Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  PetscCall(check(access.id, path, "access"));
  PetscCall(check(H5Pset_fapl_core(access.id, k_growth, /*backing_store*/ false), path, "access"));
  Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.id), H5Fclose);
  PetscCall(check(file.id, path, "creation"));
  PetscCall(write_groups(file.id, path, snapshot, precision, style));
  PetscCall(check(H5Fflush(file.id, H5F_SCOPE_GLOBAL), path, "flush"));
  const ssize_t size = H5Fget_file_image(file.id, nullptr, 0);
  PetscCall(check(size, path, "size"));
  image->resize(static_cast<size_t>(size));
  PetscCall(check(H5Fget_file_image(file.id, image->data(), image->size()), path, "image"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// The structure of a frame as a file of its own; `path` is for messages.
PetscErrorCode make_layout(const std::string& name, const std::string& path, const Snapshot& snapshot,
                           Precision precision, const FrameStyle& style, std::vector<FrameSlab>* slabs) {
  PetscFunctionBeginUser;
  Handle file(H5Fcreate(name.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose);
  PetscCall(check(file.id, path, "creation"));
  PetscCall(write_groups(file.id, path, snapshot, precision, style, slabs));
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

/// Whether a group of a frame has a field.
bool has_field(const FrameEntry::Group& group, const Field& field) {
  if ((field.of == Of::bodies && !group.body) || (field.of == Of::nodes && group.name != k_nodes))
    return false;
  return group.fields.empty() ||
         std::find(group.fields.begin(), group.fields.end(), field.name) != group.fields.end();
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
    if (&field == k_fields || !has_field(group, field)) continue;
    const std::string item = data_item(frame, group, field, real_bytes);
    if (field.components == 6)
      text += format_tensor(field.name, item, group.count);
    else
      text += format_attribute(field.name, field.components == 3 ? "Vector" : "Scalar", item);
  }
  return text + "        </Grid>\n";
}

/// Name of a frame relative to the output folder.
std::string file_name(int number) {
  char file[40];
  std::snprintf(file, sizeof file, "frames/frame_%05d.h5", number);
  return file;
}

/// What the index says of a group of a frame that is there; false where it cannot be read.
bool read_group(hid_t file, FrameEntry::Group& group) {
  Handle opened(H5Gopen2(file, group.name.c_str(), H5P_DEFAULT), H5Gclose);
  if (opened.id < 0) return false;
  for (const Field& field : k_fields)
    if (H5Lexists(opened.id, field.name, H5P_DEFAULT) > 0) {
      group.fields.push_back(field.name);
      group.body = group.body || field.of == Of::bodies;
    }
  Handle data(H5Dopen2(opened.id, k_fields[0].name, H5P_DEFAULT), H5Dclose);
  if (data.id < 0) return false;
  Handle space(H5Dget_space(data.id), H5Sclose);
  hsize_t sizes[2] = {0, 0};
  if (H5Sget_simple_extent_ndims(space.id) != 2) return false;
  H5Sget_simple_extent_dims(space.id, sizes, nullptr);
  group.count = static_cast<long>(sizes[0]);
  return true;
}

/// What the index says of a frame of an earlier part of the run; nothing where it is no longer there.
std::optional<FrameEntry> read_entry(const std::string& folder, const std::string& name,
                                     const std::vector<std::string>& groups) {
  const Quiet quiet;
  Handle file(H5Fopen((folder + "/" + name).c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (file.id < 0) return std::nullopt;
  FrameEntry entry{name, 0, {}};
  Handle time(H5Aopen(file.id, "time", H5P_DEFAULT), H5Aclose);
  if (time.id < 0 || H5Aread(time.id, H5T_NATIVE_DOUBLE, &entry.time) < 0) return std::nullopt;
  for (const std::string& group : groups) {
    if (group == k_nodes && H5Lexists(file.id, k_nodes, H5P_DEFAULT) <= 0) continue;
    entry.groups.push_back({group});
    if (!read_group(file.id, entry.groups.back())) return std::nullopt;
  }
  return entry;
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

std::vector<std::string> frame_field_names() {
  std::vector<std::string> names;
  for (const Field& field : k_fields)
    if (&field != k_fields && field.of != Of::nodes) names.push_back(field.name);
  return names;
}

PetscErrorCode lay_out_frame(const std::string& path, const Snapshot& snapshot, Precision precision,
                             const FrameStyle& style, int* descriptor, std::vector<FrameSlab>* slabs) {
  PetscFunctionBeginUser;
  std::error_code error;
  const std::string memory = "/dev/shm";  // holes take no memory
  std::string name = (fs::is_directory(memory, error) ? memory : fs::temp_directory_path(error).string()) +
                     "/mpm_frame_XXXXXX";
  *descriptor = ::mkostemp(name.data(), O_CLOEXEC);
  PetscCheck(*descriptor >= 0, PETSC_COMM_SELF, PETSC_ERR_FILE_OPEN, "Cannot open %s: %s", name.c_str(),
             std::strerror(errno));
  const auto forget = [&](PetscErrorCode result) {
    ::unlink(name.c_str());
    return result;
  };
  PetscCall(forget(make_layout(name, path, snapshot, precision, style, slabs)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode write_frame(const std::string& path, const Snapshot& snapshot, Precision precision,
                           const FrameStyle& style) {
  PetscFunctionBeginUser;
  std::string image;
  PetscCall(frame_image(path, snapshot, precision, style, &image));
  PetscCall(replace_file(path, image));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void Frames::open(const std::string& folder, Precision precision, const FrameStyle& style, MPI_Comm comm) {
  style_ = style;
  comm_ = comm;
  folder_ = folder;
  precision_ = precision;
  entries_.clear();
  count_ = 0;
}

PetscErrorCode Frames::resume(const Config& config, long count, MPI_Comm comm) {
  PetscFunctionBeginUser;
  open(config.output.directory, config.precision, {config.output.fields, config.output.compression}, comm);
  std::vector<std::string> names;
  for (const BodyConfig& body : config.bodies) names.push_back(body.name);
  for (const RigidConfig& rigid : config.rigids) names.push_back(rigid.name);
  names.push_back(k_nodes);
  count_ = static_cast<int>(count);
  if (rank_of(comm_) == 0)
    for (int n = 0; n < count_; ++n)
      if (auto entry = read_entry(folder_, file_name(n), names)) entries_.push_back(std::move(*entry));
  PetscCall(agree(comm_, entries_.empty() ? PETSC_SUCCESS : write_index()));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Frames::settle() const {
  PetscFunctionBeginUser;
  const bool due = count_ > 0 && rank_of(comm_) == 0;
  PetscCall(agree(comm_, due ? bring_to_disk(folder_ + "/frames") : PETSC_SUCCESS));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Frames::write_index() const {
  PetscFunctionBeginUser;
  PetscCall(replace_file(folder_ + "/particles.xdmf",
                         format_xdmf(entries_, precision_ == Precision::single ? 4 : 8)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Frames::write(const Snapshot& snapshot) {
  PetscFunctionBeginUser;
  const std::string file = file_name(count_);
  if (size_of(comm_) == 1)
    PetscCall(write_frame(folder_ + "/" + file, snapshot, precision_, style_));
  else
    PetscCall(write_frame_together(comm_, folder_ + "/" + file, snapshot, precision_, style_));

  FrameEntry entry{file, snapshot.time, {}};
  const std::vector<std::string>& fields = style_.fields;
  for (const auto& body : snapshot.bodies)
    entry.groups.push_back(
        {body.name, body.total < 0 ? static_cast<long>(body.position.size() / 3) : body.total, true, fields});
  for (const auto& rigid : snapshot.rigids)
    entry.groups.push_back({rigid.name, static_cast<long>(rigid.position.size() / 3), false, fields});
  for (const auto& nodes : snapshot.nodes)
    entry.groups.push_back({nodes.name, static_cast<long>(nodes.position.size() / 3), false});
  entries_.push_back(std::move(entry));
  ++count_;
  PetscCall(agree(comm_, rank_of(comm_) == 0 ? write_index() : PETSC_SUCCESS));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
