#include "output/frame_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <span>

#include "common/hdf5_handle.hpp"
#include "common/text.hpp"
#include "output/frame_surface.hpp"
#include "output/shared_file.hpp"

namespace mpm {
namespace {

constexpr long k_piece = 1 << 16;  // rows, at most

PetscErrorCode write_attribute(hid_t where, const std::string& path, const char* name, hid_t type,
                               const void* value) {
  PetscFunctionBeginUser;
  Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  PetscCall(check_hdf5(space.id, path, name));
  Handle attribute(H5Acreate2(where, name, type, space.id, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  PetscCall(check_hdf5(attribute.id, path, name));
  PetscCall(check_hdf5(H5Awrite(attribute.id, type, value), path, name));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode write_text(hid_t where, const std::string& path, const char* name, const std::string& text) {
  PetscFunctionBeginUser;
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  PetscCall(check_hdf5(type.id, path, name));
  PetscCall(check_hdf5(H5Tset_size(type.id, text.size()), path, name));
  PetscCall(write_attribute(where, path, name, type.id, text.data()));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// The unit of a dataset, as the text attribute `unit`.
PetscErrorCode write_unit(hid_t dataset, const std::string& path, const std::string& unit) {
  return write_text(dataset, path, "unit", unit);
}

hid_t file_type(const Field& field, Precision precision) {
  if (field.values == &ParticleSnapshot::number) return H5T_STD_I64LE;
  return precision == Precision::single && !is_exact(field) ? H5T_IEEE_F32LE : H5T_IEEE_F64LE;
}

/// In pieces that are compressed each by itself; the bytes of all numbers in a piece are put together first,
/// high bytes with high bytes, which differ little.
hid_t layout_of(long piece, int components, int compression) {
  const hid_t layout = H5Pcreate(H5P_DATASET_CREATE);
  const hsize_t sizes[2] = {static_cast<hsize_t>(piece), static_cast<hsize_t>(components)};
  if (compression == 0 || piece == 0) return layout;
  H5Pset_chunk(layout, components == 1 ? 1 : 2, sizes);
  H5Pset_shuffle(layout);
  H5Pset_deflate(layout, static_cast<unsigned>(compression));
  return layout;
}

/// A dataset of a field, N x components, or N where there is one component; to be closed by the caller.
PetscErrorCode create_field(hid_t group, const std::string& path, const Field& field, long rows,
                            Precision precision, hid_t layout, hid_t* data) {
  PetscFunctionBeginUser;
  const hsize_t sizes[2] = {static_cast<hsize_t>(rows), static_cast<hsize_t>(field.components)};
  Handle space(H5Screate_simple(field.components == 1 ? 1 : 2, sizes, nullptr), H5Sclose);
  PetscCall(check_hdf5(space.id, path, field.name));
  *data =
      H5Dcreate2(group, field.name, file_type(field, precision), space.id, H5P_DEFAULT, layout, H5P_DEFAULT);
  PetscCall(check_hdf5(*data, path, field.name));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// One dataset whose numbers are all here.
PetscErrorCode write_field(hid_t group, const std::string& path, const Field& field,
                           const ParticleSnapshot& particles, Precision precision, int compression) {
  PetscFunctionBeginUser;
  const std::vector<double>& values = *values_of(particles, field);
  const long count = static_cast<long>(particles.position.size() / 3);
  PetscCheck(values.size() == static_cast<size_t>(count) * field.components, PETSC_COMM_SELF,
             PETSC_ERR_ARG_SIZ, "%s of %s holds %zu numbers for %ld particles", field.name,
             particles.name.c_str(), values.size(), count);
  Handle layout(layout_of(std::min(count, k_piece), field.components, compression), H5Pclose);
  Handle data(-1, H5Dclose);
  PetscCall(create_field(group, path, field, count, precision, layout.id, &data.id));
  if (count > 0)
    PetscCall(check_hdf5(H5Dwrite(data.id, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()),
                         path, field.name));
  PetscCall(write_unit(data.id, path, field.unit));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// A dataset whose numbers come later, from all ranks: its place in the file is fixed now.
PetscErrorCode reserve_whole(hid_t group, const std::string& path, Precision precision, FrameSlab& slab) {
  PetscFunctionBeginUser;
  const char* name = slab.field->name;
  Handle layout(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  PetscCall(check_hdf5(layout.id, path, name));
  PetscCall(check_hdf5(H5Pset_alloc_time(layout.id, H5D_ALLOC_TIME_EARLY), path, name));
  PetscCall(check_hdf5(H5Pset_fill_time(layout.id, H5D_FILL_TIME_NEVER), path, name));
  Handle data(-1, H5Dclose);
  PetscCall(create_field(group, path, *slab.field, slab.rows, precision, layout.id, &data.id));
  PetscCall(write_unit(data.id, path, slab.field->unit));
  if (slab.rows > 0) slab.offset = static_cast<long long>(H5Dget_offset(data.id));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Reserves a dataset in pieces of known size. Zeros stand for them in this file, and are taken back from the
/// memory that it is in, if the system can do that: nobody reads them.
PetscErrorCode reserve_pieces(hid_t group, const std::string& path, Precision precision, int compression,
                              std::span<FrameSlab> slabs, int descriptor) {
  PetscFunctionBeginUser;
  const Field& field = *slabs.front().field;
  Handle layout(layout_of(slabs.front().rows, field.components, compression), H5Pclose);
  Handle data(-1, H5Dclose);
  const long rows = slabs.back().first + slabs.back().rows;
  PetscCall(create_field(group, path, field, rows, precision, layout.id, &data.id));
  PetscCall(write_unit(data.id, path, field.unit));
  for (FrameSlab& slab : slabs) {
    const hsize_t place[2] = {static_cast<hsize_t>(slab.first), 0};
    const std::string zeros(static_cast<size_t>(slab.size), '\0');
    unsigned skipped = 0;
    haddr_t address = HADDR_UNDEF;
    hsize_t size = 0;
    PetscCall(
        check_hdf5(H5Dwrite_chunk(data.id, H5P_DEFAULT, slab.skipped, place, zeros.size(), zeros.data()),
                   path, field.name));
    PetscCall(
        check_hdf5(H5Dget_chunk_info_by_coord(data.id, place, &skipped, &address, &size), path, field.name));
    slab.offset = static_cast<long long>(address);
    (void)::fallocate(descriptor, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, slab.offset, slab.size);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// The slabs that are to be reserved yet, and the file.
struct Reserve {
  std::span<FrameSlab> slabs;
  int descriptor;
};

/// `reserve` is null where all numbers are here.
PetscErrorCode write_group(hid_t file, const std::string& path, const ParticleSnapshot& particles,
                           Framed kind, Precision precision, const FrameStyle& style,
                           Reserve* reserve = nullptr) {
  PetscFunctionBeginUser;
  const char* name = particles.name.c_str();
  Handle group(H5Gcreate2(file, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  PetscCall(check_hdf5(group.id, path, name));
  if (!particles.own_names.empty())
    PetscCall(write_text(group.id, path, k_own_parameter, join(particles.own_names, ",")));
  for (const Field& field : frame_fields()) {
    if (!is_written(particles, field, kind, style)) continue;
    if (reserve == nullptr) {
      PetscCall(write_field(group.id, path, field, particles, precision, style.compression));
      continue;
    }
    std::span<FrameSlab>& slabs = reserve->slabs;
    const auto other = [&](const FrameSlab& s) { return s.body != &particles || s.field != &field; };
    const size_t count = std::find_if(slabs.begin(), slabs.end(), other) - slabs.begin();
    if (slabs.front().packed)
      PetscCall(reserve_pieces(group.id, path, precision, style.compression, slabs.first(count),
                               reserve->descriptor));
    else
      PetscCall(reserve_whole(group.id, path, precision, slabs.front()));
    slabs = slabs.subspan(count);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode write_groups(hid_t file, const std::string& path, const Snapshot& snapshot,
                            Precision precision, const FrameStyle& style, Reserve* reserve = nullptr) {
  PetscFunctionBeginUser;
  const long long step = snapshot.step, dim = snapshot.dim;
  PetscCall(write_attribute(file, path, "time", H5T_NATIVE_DOUBLE, &snapshot.time));
  PetscCall(write_attribute(file, path, "step", H5T_NATIVE_LLONG, &step));
  if (dim > 0) PetscCall(write_attribute(file, path, "dim", H5T_NATIVE_LLONG, &dim));
  if (!snapshot.stage.empty()) PetscCall(write_text(file, path, "stage", snapshot.stage));
  for (const ParticleSnapshot& body : snapshot.bodies)
    PetscCall(write_group(file, path, body, Framed::bodies, precision, style, reserve));
  for (const ParticleSnapshot& rigid : snapshot.rigids)
    PetscCall(write_group(file, path, rigid, Framed::all, precision, style));
  for (const ParticleSnapshot& rigid : snapshot.rigids) PetscCall(write_surface(file, path, rigid));
  for (const ParticleSnapshot& nodes : snapshot.nodes)
    PetscCall(write_group(file, path, nodes, Framed::nodes, precision, style));
  for (const ParticleSnapshot& contacts : snapshot.contacts)
    PetscCall(write_group(file, path, contacts, Framed::contacts, precision, style));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// A file in memory; to be closed by the caller.
PetscErrorCode create_in_memory(const std::string& path, hid_t* file) {
  constexpr size_t k_growth = 4 << 20;  // bytes
  PetscFunctionBeginUser;
  Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  PetscCall(check_hdf5(access.id, path, "access"));
  PetscCall(check_hdf5(H5Pset_fapl_core(access.id, k_growth, /*backing_store*/ false), path, "access"));
  *file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.id);
  PetscCall(check_hdf5(*file, path, "creation"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace

PetscErrorCode frame_image(const std::string& path, const Snapshot& snapshot, Precision precision,
                           const FrameStyle& style, std::string* image) {
  PetscFunctionBeginUser;
  const Quiet quiet;  // in the thread of the frames
  Handle file(-1, H5Fclose);
  PetscCall(create_in_memory(path, &file.id));
  PetscCall(write_groups(file.id, path, snapshot, precision, style));
  PetscCall(check_hdf5(H5Fflush(file.id, H5F_SCOPE_GLOBAL), path, "flush"));
  const ssize_t size = H5Fget_file_image(file.id, nullptr, 0);
  PetscCall(check_hdf5(size, path, "size"));
  image->resize(static_cast<size_t>(size));
  PetscCall(check_hdf5(H5Fget_file_image(file.id, image->data(), image->size()), path, "image"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

std::vector<FrameSlab> frame_slabs(const Snapshot& snapshot, Precision precision, const FrameStyle& style,
                                   int ranks) {
  std::vector<FrameSlab> slabs;
  for (const ParticleSnapshot& body : snapshot.bodies)
    for (const Field& field : frame_fields()) {
      if (!is_written(body, field, Framed::bodies, style)) continue;
      FrameSlab slab{.body = &body, .field = &field, .rows = body.total};
      slab.bytes = static_cast<int>(H5Tget_size(file_type(field, precision)));
      slab.packed = style.compression > 0 && body.total > 0;
      if (!slab.packed) {
        slab.size = static_cast<long long>(slab.bytes) * field.components * slab.rows;
        slabs.push_back(slab);
        continue;
      }
      const long piece = std::min(k_piece, (body.total + ranks - 1) / ranks);
      for (slab.first = 0; slab.first < body.total; slab.first += piece) {
        slab.rows = std::min(piece, body.total - slab.first);
        slabs.push_back(slab);
      }
    }
  return slabs;
}

PetscErrorCode pack_slab(const std::string& path, const std::vector<double>& values, int compression,
                         FrameSlab* slab, std::string* bytes) {
  PetscFunctionBeginUser;
  const Field& field = *slab->field;
  const long piece = static_cast<long>(values.size()) / field.components;
  const bool single = slab->bytes == sizeof(float);
  Handle file(-1, H5Fclose), data(-1, H5Dclose);
  PetscCall(create_in_memory(path, &file.id));
  Handle layout(layout_of(piece, field.components, compression), H5Pclose);
  PetscCall(create_field(file.id, path, field, piece, single ? Precision::single : Precision::double_,
                         layout.id, &data.id));
  PetscCall(check_hdf5(H5Dwrite(data.id, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()),
                       path, field.name));
  PetscCall(check_hdf5(H5Dflush(data.id), path, field.name));
  const hsize_t place[2] = {0, 0};
  hsize_t size = 0;
  PetscCall(check_hdf5(H5Dget_chunk_storage_size(data.id, place, &size), path, field.name));
  bytes->resize(size);
  PetscCall(check_hdf5(H5Dread_chunk(data.id, H5P_DEFAULT, place, &slab->skipped, bytes->data()), path,
                       field.name));
  slab->size = static_cast<long long>(size);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode lay_out_frame(const std::string& path, const Snapshot& snapshot, Precision precision,
                             const FrameStyle& style, int* descriptor, std::vector<FrameSlab>* slabs) {
  PetscFunctionBeginUser;
  std::string name;
  PetscCall(open_layout(&name, descriptor));
  Handle file(H5Fcreate(name.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose);
  ::unlink(name.c_str());
  PetscCall(check_hdf5(file.id, path, "creation"));
  Reserve reserve{*slabs, *descriptor};
  PetscCall(write_groups(file.id, path, snapshot, precision, style, &reserve));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
