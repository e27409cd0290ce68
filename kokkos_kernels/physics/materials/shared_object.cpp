#include "physics/materials/shared_object.hpp"

#include <elf.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <vector>

namespace mpm {
namespace {

/// The program's own header, as the linker has put it at the beginning of the process.
extern "C" const Elf64_Ehdr __ehdr_start;

/// Reads `count` entries of a table at `offset`; none where the file is too short.
template <class Entry>
std::vector<Entry> table_of(std::ifstream& file, std::uint64_t size, std::uint64_t offset,
                            std::size_t count) {
  if (offset > size || count > (size - offset) / sizeof(Entry)) return {};
  std::vector<Entry> entries(count);
  file.seekg(static_cast<std::streamoff>(offset));
  file.read(reinterpret_cast<char*>(entries.data()), static_cast<std::streamsize>(count * sizeof(Entry)));
  if (!file) entries.clear();
  return entries;
}

/// Bytes that a part of a file needs, at most the largest number.
std::uint64_t end_of(std::uint64_t offset, std::uint64_t length) {
  return length > UINT64_MAX - offset ? UINT64_MAX : offset + length;
}

/// Bytes that a file must have by its headers.
std::uint64_t needed_bytes(std::ifstream& file, std::uint64_t size, const Elf64_Ehdr& head) {
  std::uint64_t most = std::max(end_of(head.e_phoff, std::uint64_t(head.e_phnum) * sizeof(Elf64_Phdr)),
                                end_of(head.e_shoff, std::uint64_t(head.e_shnum) * sizeof(Elf64_Shdr)));
  for (const auto& part : table_of<Elf64_Phdr>(file, size, head.e_phoff, head.e_phnum))
    most = std::max(most, end_of(part.p_offset, part.p_filesz));
  for (const auto& part : table_of<Elf64_Shdr>(file, size, head.e_shoff, head.e_shnum))
    if (part.sh_type != SHT_NOBITS && part.sh_type != SHT_NULL)
      most = std::max(most, end_of(part.sh_offset, part.sh_size));
  return most;
}

}  // namespace

std::string fault_of_shared_object(const std::string& path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  const std::streamoff end = file.tellg();
  if (!file || end < 0) return "it cannot be read";
  const std::uint64_t size = static_cast<std::uint64_t>(end);
  file.seekg(0);
  Elf64_Ehdr head{};
  file.read(reinterpret_cast<char*>(&head), sizeof head);
  const auto read = static_cast<std::size_t>(file.gcount());
  if (read < SELFMAG || std::memcmp(head.e_ident, ELFMAG, SELFMAG) != 0) return "it is no ELF file";
  if (read < sizeof head) return "it is cut short: its header is not whole";
  file.clear();
  if (head.e_ident[EI_CLASS] != ELFCLASS64 || head.e_ident[EI_DATA] != __ehdr_start.e_ident[EI_DATA] ||
      head.e_machine != __ehdr_start.e_machine)
    return "it is for another processor";
  if (head.e_type != ET_DYN)
    return "it is an ELF file, but not a shared library; scripts/build_umat makes one";
  if (head.e_phnum == 0 || head.e_phentsize != sizeof(Elf64_Phdr) ||
      (head.e_shnum > 0 && head.e_shentsize != sizeof(Elf64_Shdr)))
    return "it has an ELF header that is not sound";
  const std::uint64_t needed = needed_bytes(file, size, head);
  if (needed > size)
    return "it is cut short: it has " + std::to_string(size) + " bytes, and its headers give " +
           std::to_string(needed);
  return "";
}

}  // namespace mpm
