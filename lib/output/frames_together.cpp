// A frame of several ranks. Its structure is made by HDF5 in the memory of rank 0; the numbers are written by
// all ranks, each to its place, by MPI-IO. Where they are compressed, a rank makes whole pieces of them as
// HDF5 would, with rows that it has from its neighbours.

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <map>
#include <span>
#include <utility>

#include "output/files.hpp"
#include "output/frame_file.hpp"
#include "output/frames.hpp"
#include "parallel/together.hpp"

namespace mpm {
namespace {

/// Every call of MPI-IO passes here: it tells of a full disk.
PetscErrorCode check_io(int result, const std::string& path) {
  PetscFunctionBeginUser;
  if (result == MPI_SUCCESS) PetscFunctionReturn(PETSC_SUCCESS);
  char text[MPI_MAX_ERROR_STRING] = "";
  int length = 0;
  MPI_Error_string(result, text, &length);
  SETERRQ(PETSC_COMM_SELF, PETSC_ERR_FILE_WRITE, "Cannot write %s: %s", path.c_str(), text);
}

/// Copies bytes [from, to) of one descriptor to the same place of another.
PetscErrorCode copy_range(int in, int out, long long from, long long to, const std::string& path) {
  PetscFunctionBeginUser;
  std::vector<char> buffer(1 << 16);
  while (from < to) {
    const ssize_t got = ::pread(in, buffer.data(), std::min<long long>(buffer.size(), to - from), from);
    const ssize_t put = got > 0 ? ::pwrite(out, buffer.data(), got, from) : -1;
    PetscCheck(put > 0, PETSC_COMM_SELF, PETSC_ERR_FILE_WRITE, "Cannot write %s: %s", path.c_str(),
               std::strerror(errno));
    from += put;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Rank 0: the file with its full size on the disk, and all of it but the slabs. `made` stays open.
PetscErrorCode start_file(const std::string& path, const Snapshot& snapshot, Precision precision,
                          const FrameStyle& style, std::vector<FrameSlab>* slabs, int* made) {
  PetscFunctionBeginUser;
  int layout = -1;
  const PetscErrorCode failed = lay_out_frame(path, snapshot, precision, style, &layout, slabs);
  struct stat status {};
  if (failed == PETSC_SUCCESS) ::fstat(layout, &status);
  *made = failed ? -1 : ::open(path.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  const int full = *made < 0 ? errno : ::posix_fallocate(*made, 0, status.st_size);
  PetscErrorCode copied = PETSC_SUCCESS;
  std::vector<std::pair<long long, long long>> gaps;  // of the slabs: from, to
  for (const FrameSlab& slab : *slabs)
    if (slab.offset >= 0) gaps.emplace_back(slab.offset, slab.offset + slab.size);
  std::sort(gaps.begin(), gaps.end());
  gaps.emplace_back(status.st_size, status.st_size);
  long long at = 0;
  for (std::size_t n = 0; n < gaps.size() && !failed && full == 0 && !copied; at = gaps[n++].second)
    copied = copy_range(layout, *made, at, gaps[n].first, path);
  if (layout >= 0) ::close(layout);
  PetscCall(failed);
  PetscCheck(full == 0, PETSC_COMM_SELF, PETSC_ERR_FILE_WRITE, "Cannot write %s: %s", path.c_str(),
             std::strerror(full));
  PetscCall(copied);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// The rank that makes a piece of a body whose pieces have so many rows.
int maker_of(MPI_Comm comm, const FrameSlab& slab, long piece) {
  const long pieces = (slab.body->total + piece - 1) / piece;
  return static_cast<int>(slab.first / piece * size_of(comm) / pieces);
}

/// The rows of the pieces of a field that this rank makes, one after the other; the last piece of a field is
/// filled up with zeros.
PetscErrorCode collect_pieces(MPI_Comm comm, std::span<const FrameSlab> pieces, std::vector<double>* rows) {
  PetscFunctionBeginUser;
  const ParticleSnapshot& body = *pieces.front().body;
  const std::vector<double>& values = body.*pieces.front().field->values;
  const long width = pieces.front().field->components, piece = pieces.front().rows;
  const long end = body.first + static_cast<long>(values.size()) / width;
  std::vector<std::vector<char>> out(size_of(comm));
  for (const FrameSlab& slab : pieces) {
    const long from = std::max(slab.first, body.first), to = std::min(slab.first + slab.rows, end);
    if (from >= to) continue;
    const char* const first = reinterpret_cast<const char*>(values.data() + (from - body.first) * width);
    std::vector<char>& to_maker = out[maker_of(comm, slab, piece)];
    to_maker.insert(to_maker.end(), first, first + (to - from) * width * sizeof(double));
  }
  std::vector<char> in;  // in the order of ranks, which is that of rows
  PetscCall(exchange_records(comm, width * sizeof(double), out, &in));
  rows->assign((in.size() / (width * sizeof(double)) + piece - 1) / piece * piece * width, 0);
  if (!in.empty()) std::memcpy(rows->data(), in.data(), in.size());
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// The pieces that this rank makes, compressed, by number of their slab; the sizes of all.
PetscErrorCode pack_slabs(MPI_Comm comm, const std::string& path, int compression,
                          std::vector<FrameSlab>* slabs, std::map<std::size_t, std::string>* packed) {
  PetscFunctionBeginUser;
  PetscErrorCode failed = PETSC_SUCCESS;
  std::vector<long long> found(2 * slabs->size());  // sizes, filters
  for (std::size_t n = 0, next = 0; n < slabs->size(); n = next) {
    while (next < slabs->size() && (*slabs)[next].body == (*slabs)[n].body &&
           (*slabs)[next].field == (*slabs)[n].field)
      ++next;
    if (!(*slabs)[n].packed) continue;
    std::vector<double> rows, piece;
    PetscCall(collect_pieces(comm, std::span(*slabs).subspan(n, next - n), &rows));
    auto at = rows.begin();
    for (std::size_t k = n; k < next && !failed; ++k) {
      if (maker_of(comm, (*slabs)[k], (*slabs)[n].rows) != rank_of(comm)) continue;
      piece.assign(at, at + (*slabs)[n].rows * (*slabs)[n].field->components);
      at += static_cast<long>(piece.size());
      failed = pack_slab(path, piece, compression, &(*slabs)[k], &(*packed)[k]);
      found[2 * k] = (*slabs)[k].size, found[2 * k + 1] = (*slabs)[k].skipped;
    }
  }
  PetscCall(agree(comm, failed));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, found.data(), static_cast<int>(found.size()), MPI_LONG_LONG,
                             MPI_SUM, comm));
  for (std::size_t n = 0; n < slabs->size(); ++n)
    if ((*slabs)[n].packed)
      (*slabs)[n].size = found[2 * n], (*slabs)[n].skipped = static_cast<unsigned>(found[2 * n + 1]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// This rank's particles of one field, to their place in the file. Collective.
PetscErrorCode write_slab(MPI_File file, const FrameSlab& slab, const std::string& path) {
  PetscFunctionBeginUser;
  const std::vector<double>& values = slab.body->*slab.field->values;
  const int count = static_cast<int>(values.size());
  const MPI_Offset at = slab.offset + MPI_Offset(slab.bytes) * slab.field->components * slab.body->first;
  if (slab.bytes == sizeof(double)) {
    PetscCall(
        check_io(MPI_File_write_at_all(file, at, values.data(), count, MPI_DOUBLE, MPI_STATUS_IGNORE), path));
  } else {
    const std::vector<float> single(values.begin(), values.end());
    PetscCall(
        check_io(MPI_File_write_at_all(file, at, single.data(), count, MPI_FLOAT, MPI_STATUS_IGNORE), path));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// All ranks: the numbers of the bodies.
PetscErrorCode write_slabs(MPI_Comm comm, const std::string& path, const std::vector<FrameSlab>& slabs,
                           const std::map<std::size_t, std::string>& packed) {
  PetscFunctionBeginUser;
  MPI_File file;
  PetscCall(
      agree(comm, check_io(MPI_File_open(comm, path.c_str(), MPI_MODE_WRONLY, MPI_INFO_NULL, &file), path)));
  PetscErrorCode failed = PETSC_SUCCESS;
  const auto keep = [&](PetscErrorCode here) { failed = failed ? failed : here; };
  for (const FrameSlab& slab : slabs)  // go on after a failure: the calls are collective
    if (!slab.packed && slab.offset >= 0) keep(write_slab(file, slab, path));
  for (const auto& [n, bytes] : packed)
    keep(check_io(MPI_File_write_at(file, slabs[n].offset, bytes.data(), static_cast<int>(bytes.size()),
                                    MPI_BYTE, MPI_STATUS_IGNORE),
                  path));
  keep(check_io(MPI_File_close(&file), path));
  PetscCall(agree(comm, failed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Rank 0: the temporary file becomes the frame.
PetscErrorCode finish_file(int* made, const std::string& temporary, const std::string& path) {
  PetscFunctionBeginUser;
  const bool whole = ::fsync(*made) == 0 || errno == EINVAL;
  PetscCheck(whole && std::rename(temporary.c_str(), path.c_str()) == 0, PETSC_COMM_SELF,
             PETSC_ERR_FILE_WRITE, "Cannot write %s: %s", path.c_str(), std::strerror(errno));
  PetscCall(close_file(made, path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace

PetscErrorCode write_frame_together(MPI_Comm comm, const std::string& path, const Snapshot& snapshot,
                                    Precision precision, const FrameStyle& style) {
  PetscFunctionBeginUser;
  const std::string temporary = path + ".tmp";
  const bool first = rank_of(comm) == 0;
  std::vector<FrameSlab> slabs = frame_slabs(snapshot, precision, style, size_of(comm));
  std::map<std::size_t, std::string> packed;
  PetscCall(pack_slabs(comm, path, style.compression, &slabs, &packed));
  int made = -1;
  PetscErrorCode failed =
      agree(comm, first ? start_file(temporary, snapshot, precision, style, &slabs, &made) : PETSC_SUCCESS);
  if (!failed) {
    std::vector<long long> offsets;
    for (const FrameSlab& slab : slabs) offsets.push_back(slab.offset);
    MPI_Bcast(offsets.data(), static_cast<int>(offsets.size()), MPI_LONG_LONG, 0, comm);
    for (std::size_t n = 0; n < slabs.size(); ++n) slabs[n].offset = offsets[n];
    failed = write_slabs(comm, temporary, slabs, packed);
  }
  if (!failed) failed = agree(comm, first ? finish_file(&made, temporary, path) : PETSC_SUCCESS);
  if (first && failed) {
    if (made >= 0) ::close(made);
    ::unlink(temporary.c_str());
  }
  PetscCall(failed);
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
