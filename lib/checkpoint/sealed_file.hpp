#pragma once
// A file with a seal: a last line with the length of the file before that line, and the checksum (CRC-32) of
// that part. The seal reveals a truncated file or a changed byte before the content is read. HDF5 ignores
// bytes behind its own part.

#include <petscsys.h>

#include <cstdint>
#include <string>
#include <string_view>

namespace mpm {

/// The seal of a file of this length.
std::string seal_of(long bytes, std::uint32_t crc);

/// Writes `contents` and its seal to `path` under a temporary name, brings it to the disk, reads it from
/// there and compares, renames it and brings the new name to the disk. If any of this fails the temporary
/// file is removed and a former `path` stays as it was.
PetscErrorCode replace_sealed(const std::string& path, std::string_view contents);

/// Gives the file its seal at the end, where it was written by all ranks, and brings it to the disk. Each
/// rank reads its part of the file for the checksum. Collective.
PetscErrorCode seal_file(MPI_Comm comm, const std::string& path);

/// Compares a file with its seal; each rank reads a part of it. `fault` is what a whole file would be, or
/// empty. Collective.
PetscErrorCode check_seal(MPI_Comm comm, const std::string& path, std::string* fault);

}  // namespace mpm
