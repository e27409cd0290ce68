#include "output/frame_index.hpp"

#include "common/hdf5_handle.hpp"
#include "common/numbers.hpp"
#include "output/frame_fields.hpp"

namespace mpm {
namespace {

/// `<DataItem>` that points at one dataset of a frame.
std::string data_item(const FrameEntry& frame, const FrameEntry::Group& group, const Field& field,
                      int real_bytes) {
  const bool number = field.values == &ParticleSnapshot::number;
  const int bytes = number || is_exact(field) ? 8 : real_bytes;
  std::string size = std::to_string(group.count);
  if (field.components > 1) size.append(" ").append(std::to_string(field.components));
  return std::string("<DataItem Format=\"HDF\" NumberType=\"") + (number ? "Int" : "Float") +
         "\" Precision=\"" + std::to_string(bytes) + "\" Dimensions=\"" + size + "\">" + frame.file + ":/" +
         group.name + "/" + field.name + "</DataItem>";
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
  return std::find(group.fields.begin(), group.fields.end(), field.name) != group.fields.end();
}

/// The grid of one body or rigid: a point a particle.
std::string format_grid(const FrameEntry& frame, const FrameEntry::Group& group, int real_bytes) {
  const std::string count = std::to_string(group.count);
  std::string text = "        <Grid Name=\"" + group.name + "\" GridType=\"Uniform\">\n";
  text += "          <Topology TopologyType=\"Polyvertex\" NumberOfElements=\"" + count +
          "\" NodesPerElement=\"1\"/>\n";
  text += "          <Geometry GeometryType=\"XYZ\">" +
          data_item(frame, group, frame_fields()[0], real_bytes) + "</Geometry>\n";
  for (const Field& field : frame_fields()) {
    if (is_position(field) || !has_field(group, field)) continue;
    const std::string item = data_item(frame, group, field, real_bytes);
    if (field.components == 6)
      text += format_tensor(field.name, item, group.count);
    else
      text += format_attribute(field.name, field.components == 3 ? "Vector" : "Scalar", item);
  }
  return text + "        </Grid>\n";
}

/// Reads the entry of the index for a group of a frame that is there; false where it cannot be read.
bool read_group(hid_t file, FrameEntry::Group& group) {
  Handle opened(H5Gopen2(file, group.name.c_str(), H5P_DEFAULT), H5Gclose);
  if (opened.id < 0) return false;
  for (const Field& field : frame_fields())
    if (H5Lexists(opened.id, field.name, H5P_DEFAULT) > 0) group.fields.push_back(field.name);
  Handle data(H5Dopen2(opened.id, frame_fields()[0].name, H5P_DEFAULT), H5Dclose);
  if (data.id < 0) return false;
  Handle space(H5Dget_space(data.id), H5Sclose);
  hsize_t sizes[2] = {0, 0};
  if (H5Sget_simple_extent_ndims(space.id) != 2) return false;
  H5Sget_simple_extent_dims(space.id, sizes, nullptr);
  group.count = static_cast<long>(sizes[0]);
  return true;
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
    for (const FrameEntry::Group& group : frame.groups)
      if (group.surface.triangles > 0) text += surface_grid(frame.file, group.name, group.surface);
    text += "      </Grid>\n";
  }
  return text + "    </Grid>\n  </Domain>\n</Xdmf>\n";
}

std::optional<FrameEntry> read_entry(const std::string& folder, const std::string& name,
                                     const std::vector<std::string>& groups, std::size_t always) {
  const Quiet quiet;
  Handle file(H5Fopen((folder + "/" + name).c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (file.id < 0) return std::nullopt;
  FrameEntry entry{name, 0, {}};
  Handle time(H5Aopen(file.id, "time", H5P_DEFAULT), H5Aclose);
  if (time.id < 0 || H5Aread(time.id, H5T_NATIVE_DOUBLE, &entry.time) < 0) return std::nullopt;
  std::size_t n = 0;
  for (const std::string& group : groups) {
    if (n++ >= always && H5Lexists(file.id, group.c_str(), H5P_DEFAULT) <= 0) continue;
    entry.groups.push_back({group});
    if (!read_group(file.id, entry.groups.back())) return std::nullopt;
    entry.groups.back().surface = surface_size(file.id, group);
  }
  return entry;
}

}  // namespace mpm
