// A frame of several ranks. Where numbers are compressed, a rank makes whole pieces of them as HDF5 would,
// with rows that it has from its neighbours.

#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <list>
#include <map>
#include <span>

#include "common/collectives.hpp"
#include "output/files.hpp"
#include "output/frame_file.hpp"
#include "output/frames.hpp"
#include "output/shared_file.hpp"

namespace mpm {
namespace {

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
  const std::vector<double>& values = *values_of(body, *pieces.front().field);
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

/// Stretches of the slabs that this rank writes. Numbers that have to be changed first are kept in `single`.
std::vector<Stretch> stretches_of(const std::vector<FrameSlab>& slabs,
                                  const std::map<std::size_t, std::string>& packed,
                                  std::list<std::vector<float>>* single) {
  std::vector<Stretch> stretches;
  for (std::size_t n = 0; n < slabs.size(); ++n) {
    const FrameSlab& slab = slabs[n];
    Stretch stretch{.offset = slab.offset, .size = slab.offset < 0 ? 0 : slab.size, .shared = !slab.packed};
    if (const auto own = packed.find(n); own != packed.end()) {
      stretch.place = slab.offset, stretch.rows = static_cast<long long>(own->second.size());
      stretch.data = own->second.data();
    } else if (!slab.packed) {
      const std::vector<double>& values = *values_of(*slab.body, *slab.field);
      stretch.width = slab.bytes * slab.field->components;
      stretch.place = slab.offset + stretch.width * slab.body->first;
      stretch.rows = static_cast<long long>(values.size()) / slab.field->components;
      stretch.data = slab.bytes == sizeof(double) ? static_cast<const void*>(values.data())
                                                  : single->emplace_back(values.begin(), values.end()).data();
    }
    stretches.push_back(stretch);
  }
  return stretches;
}

}  // namespace

PetscErrorCode write_frame_together(MPI_Comm comm, const std::string& path, const Snapshot& snapshot,
                                    Precision precision, const FrameStyle& style) {
  PetscFunctionBeginUser;
  const std::string temporary = path + ".tmp";
  const bool first = rank_of(comm) == 0;
  std::vector<FrameSlab> slabs = frame_slabs(snapshot, precision, style, size_of(comm));
  std::map<std::size_t, std::string> packed;
  std::list<std::vector<float>> single;
  PetscCall(pack_slabs(comm, path, style.compression, &slabs, &packed));
  int layout = -1;
  PetscErrorCode failed =
      agree(comm, first ? lay_out_frame(path, snapshot, precision, style, &layout, &slabs) : PETSC_SUCCESS);
  if (!failed) {
    std::vector<long long> offsets;
    for (const FrameSlab& slab : slabs) offsets.push_back(slab.offset);
    MPI_Bcast(offsets.data(), static_cast<int>(offsets.size()), MPI_LONG_LONG, 0, comm);
    for (std::size_t n = 0; n < slabs.size(); ++n) slabs[n].offset = offsets[n];
    failed = write_shared_file(comm, temporary, layout, stretches_of(slabs, packed, &single));
  }
  if (layout >= 0) ::close(layout);
  PetscCall(failed);
  failed = agree(comm, first ? rename_file(temporary, path) : PETSC_SUCCESS);
  if (first && failed) ::unlink(temporary.c_str());
  PetscCall(failed);
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
