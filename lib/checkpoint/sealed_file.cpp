#include "checkpoint/sealed_file.hpp"

#include <fcntl.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <vector>

#include "common/checksum.hpp"
#include "common/collectives.hpp"
#include "common/regular_file.hpp"
#include "common/text.hpp"
#include "output/files.hpp"

namespace mpm {
namespace {

constexpr const char* k_form = "\nmpm checkpoint, %020ld bytes before this line, crc32 %08x\n";
constexpr size_t k_piece = 16 << 20;  // bytes read at once

/// A descriptor that is closed with its scope.
struct Descriptor {
  int id = -1;
  ~Descriptor() {
    if (id >= 0) ::close(id);
  }
};

/// Checksum of `bytes` of a file from `from` on; false where it has fewer.
bool checksum_of(int descriptor, long from, long bytes, std::uint32_t* crc) {
  std::vector<char> piece(std::min<size_t>(k_piece, std::max<long>(bytes, 1)));
  *crc = checksum(0, {});
  while (bytes > 0) {
    const ssize_t got = ::pread(descriptor, piece.data(), std::min<size_t>(piece.size(), bytes), from);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    *crc = checksum(*crc, {piece.data(), static_cast<size_t>(got)});
    from += got, bytes -= got;
  }
  return true;
}

/// Bytes of an open file; -1 if there is none.
long bytes_in(int descriptor) {
  return descriptor < 0 ? -1 : static_cast<long>(::lseek(descriptor, 0, SEEK_END));
}

/// Checksum of the first `bytes` of a file that every rank has open; each reads its part. `whole`: all could.
PetscErrorCode common_checksum(MPI_Comm comm, int descriptor, long bytes, std::uint32_t* crc, bool* whole) {
  PetscFunctionBeginUser;
  PetscMPIInt rank = 0, ranks = 1;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &ranks));
  const long first = bytes / ranks * rank;
  const long length = bytes < 0 ? 0 : rank + 1 == ranks ? bytes - first : bytes / ranks;
  std::uint32_t own = 0;
  int good = bytes >= 0 && checksum_of(descriptor, first, length, &own) ? 1 : 0;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &good, 1, MPI_INT, MPI_MIN, comm));
  std::vector<long> lengths(ranks);
  std::vector<std::uint32_t> parts(ranks);
  PetscCallMPI(MPI_Allgather(&length, 1, MPI_LONG, lengths.data(), 1, MPI_LONG, comm));
  PetscCallMPI(MPI_Allgather(&own, 1, MPI_UINT32_T, parts.data(), 1, MPI_UINT32_T, comm));
  *crc = parts[0];
  for (int r = 1; r < ranks; ++r)
    *crc = static_cast<std::uint32_t>(::crc32_combine(*crc, parts[r], lengths[r]));
  *whole = good != 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Reads the file from the disk again and compares with what was meant.
PetscErrorCode verify(const std::string& path, long bytes, std::uint32_t crc) {
  PetscFunctionBeginUser;
  const Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC)};
  PetscCheck(file.id >= 0, PETSC_COMM_SELF, PETSC_ERR_FILE_READ, "Cannot read %s again: %s", path.c_str(),
             std::strerror(errno));
  ::posix_fadvise(file.id, 0, 0, POSIX_FADV_DONTNEED);  // from the disk, not from memory, where it can be
  std::uint32_t found = 0;
  PetscCheck(checksum_of(file.id, 0, bytes, &found) && found == crc, PETSC_COMM_SELF, PETSC_ERR_FILE_READ,
             "%s does not read as it was written: the disk is faulty", path.c_str());
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Behind the bytes of an open file, and on the disk.
PetscErrorCode append_seal(int descriptor, const std::string& path, long bytes, std::uint32_t crc) {
  PetscFunctionBeginUser;
  PetscCheck(::lseek(descriptor, 0, SEEK_END) == bytes, PETSC_COMM_SELF, PETSC_ERR_FILE_WRITE,
             "Cannot write %s", path.c_str());
  PetscCall(write_all(descriptor, seal_of(bytes, crc), path));
  PetscCheck(::fsync(descriptor) == 0 || errno == EINVAL, PETSC_COMM_SELF, PETSC_ERR_FILE_WRITE,
             "Cannot write %s: %s", path.c_str(), std::strerror(errno));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace

std::string seal_of(long bytes, std::uint32_t crc) { return formatted(k_form, bytes, crc); }

PetscErrorCode replace_sealed(const std::string& path, std::string_view contents) {
  PetscFunctionBeginUser;
  const std::string temporary = path + ".tmp";
  const std::uint32_t crc = checksum(0, contents);
  const std::string seal = seal_of(static_cast<long>(contents.size()), crc);
  PetscErrorCode failed = write_new_file(temporary, {contents, seal});
  const long bytes = static_cast<long>(contents.size() + seal.size());
  if (!failed) failed = verify(temporary, bytes, checksum(crc, seal));
  if (!failed) failed = rename_file(temporary, path);
  if (failed) ::unlink(temporary.c_str());
  PetscCall(failed);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode seal_file(MPI_Comm comm, const std::string& path) {
  PetscFunctionBeginUser;
  PetscMPIInt rank = 0;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  const Descriptor file{::open(path.c_str(), O_RDWR | O_CLOEXEC)};
  const long bytes = bytes_in(file.id);
  std::uint32_t crc = 0;
  bool whole = true;
  PetscCall(common_checksum(comm, file.id, bytes, &crc, &whole));
  PetscCheck(whole, comm, PETSC_ERR_FILE_READ, "Cannot read %s again", path.c_str());
  PetscCall(agree(comm, rank == 0 ? append_seal(file.id, path, bytes, crc) : PETSC_SUCCESS));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode check_seal(MPI_Comm comm, const std::string& path, std::string* fault) {
  PetscFunctionBeginUser;
  *fault = irregular_fault(path);
  PetscCall(share_text(comm, fault));
  if (!fault->empty()) PetscFunctionReturn(PETSC_SUCCESS);
  const Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)};
  const int reason = errno;
  const std::string blank = seal_of(0, 0);
  const long length = static_cast<long>(blank.size()), bytes = bytes_in(file.id) - length;
  std::string seal(blank.size(), ' ');
  std::uint32_t crc = 0;
  bool whole = true;
  PetscCall(common_checksum(comm, file.id, bytes, &crc, &whole));
  const size_t words = blank.find(',');  // up to here all seals are alike
  if (file.id < 0)
    *fault = "a checkpoint that can be read: " + std::string(std::strerror(reason));
  else if (!whole || ::pread(file.id, seal.data(), seal.size(), bytes) != length ||
           seal.substr(0, words) != blank.substr(0, words))
    *fault = "a whole checkpoint; this one is cut short, or is none";
  else if (seal != seal_of(bytes, crc))
    *fault = "a checkpoint whose checksum is right; this one is damaged";
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
