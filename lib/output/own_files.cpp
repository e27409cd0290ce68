#include "output/own_files.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string_view>
#include <system_error>

#include "common/hdf5_handle.hpp"
#include "common/text.hpp"

namespace mpm {
namespace fs = std::filesystem;

namespace {

constexpr std::string_view k_unfinished = ".tmp";
constexpr std::string_view k_hdf5 = "\x89HDF\r\n\x1a\n";

/// A file of text, or of a picture, and words that stand at its beginning.
struct Known {
  std::string_view name, words;
  bool written;  // by a run; else by scripts/plot
};
constexpr Known k_known[] = {{"history.csv", "step,time,dt,wall_time", true},
                             {"mpm.log", "mpm", true},
                             {"options.json", "{\n  \"version\"", true},
                             {"performance.json", "{\n  \"program\": \"mpm\"", true},
                             {"particles.xdmf", "<?xml version=\"1.0\"?>\n<Xdmf", true},
                             {"partition.csv", "step,time,patch_x", true},
                             {"element.csv", "time,sxx", true},
                             {"rasters.csv", "x,max_depth", true},
                             {"raster_max_depth.asc", "ncols", true},
                             {"raster_max_speed.asc", "ncols", true},
                             {"raster_arrival_time.asc", "ncols", true},
                             {"raster_final_depth.asc", "ncols", true},
                             {"element.png", "Matplotlib", false},
                             {"curve.png", "Matplotlib", false},
                             {"field.png", "Matplotlib", false},
                             {"runout.png", "Matplotlib", false},
                             {"velocity.png", "Matplotlib", false},
                             {"probes.png", "Matplotlib", false},
                             {"rasters.png", "Matplotlib", false},
                             {"profiles.png", "Matplotlib", false},
                             {"film.gif", "GIF8", false},
                             {"film.mp4", "ftyp", false}};

/// The number in PREFIX NUMBER .h5, as the program writes it: with at least so many digits.
std::optional<long> number_in(std::string_view name, std::string_view prefix, std::size_t digits) {
  constexpr std::string_view k_suffix = ".h5";
  if (!name.starts_with(prefix) || !name.ends_with(k_suffix) ||
      name.size() < prefix.size() + k_suffix.size() + digits)
    return std::nullopt;
  name.remove_prefix(prefix.size()), name.remove_suffix(k_suffix.size());
  const bool padded = name.size() > digits && name[0] == '0';
  if (padded || name.find_first_not_of("0123456789") != std::string_view::npos) return std::nullopt;
  return parse_integer(name);
}

std::string_view without_unfinished(std::string_view name) {
  if (name.ends_with(k_unfinished)) name.remove_suffix(k_unfinished.size());
  return name;
}

/// The first bytes of a file, at most so many as a header takes.
std::string beginning_of(const std::string& path) {
  std::string text(512, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  return text;
}

/// Whether the bytes are none or zero: what a crash of the machine leaves of a file.
bool is_lost(std::string_view beginning) {
  return beginning.find_first_not_of('\0') == std::string_view::npos;
}

bool has_seal(const std::string& path) {
  constexpr std::streamoff k_length = 200;  // more than a seal has
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = file.tellg();
  file.seekg(std::max<std::streamoff>(size - k_length, 0));
  const std::string end(std::istreambuf_iterator<char>(file), {});
  return end.find("\nmpm checkpoint, ") != std::string::npos;
}

/// Whether an HDF5 file has these attributes, or cannot be read and so is a damaged one of ours.
bool has_attributes(const std::string& path, std::array<const char*, 2> names) {
  const Quiet quiet;
  const Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (file.id < 0) return true;
  return std::all_of(names.begin(), names.end(),
                     [&](const char* name) { return H5Aexists(file.id, name) > 0; });
}

}  // namespace

std::optional<long> checkpoint_number(const std::string& name) { return number_in(name, "checkpoint_", 1); }
std::optional<long> frame_number(const std::string& name) { return number_in(name, "frame_", 5); }

bool is_written_name(const std::string& name, bool in_frames) {
  const std::string stem(without_unfinished(name));
  if (in_frames) return frame_number(stem).has_value();
  return checkpoint_number(stem) || std::any_of(std::begin(k_known), std::end(k_known),
                                                [&](const Known& k) { return k.written && k.name == stem; });
}

bool is_own_file(const std::string& path) {
  std::error_code error;
  const fs::file_type kind = fs::symlink_status(path, error).type();
  if (kind == fs::file_type::not_found) return true;  // a run that is going on has finished with it
  if (kind != fs::file_type::regular) return false;
  const std::string name = fs::path(path).filename().string(), stem(without_unfinished(name));
  const auto known = std::find_if(std::begin(k_known), std::end(k_known),
                                  [&](const Known& each) { return each.name == stem; });
  const bool checkpoint = checkpoint_number(stem).has_value();
  if (known == std::end(k_known) && !checkpoint && !frame_number(stem)) return false;
  const std::string beginning = beginning_of(path);
  if (stem != name || is_lost(beginning)) return true;
  if (known != std::end(k_known)) return beginning.find(known->words) != std::string::npos;
  if (checkpoint && has_seal(path)) return true;
  if (!beginning.starts_with(k_hdf5)) return false;
  return checkpoint ? has_attributes(path, {"since_rebuild", "history_crc"})
                    : has_attributes(path, {"time", "step"});
}

std::vector<std::string> written_names(const std::string& folder) {
  std::vector<std::string> found;
  for (const bool in_frames : {false, true}) {
    std::error_code error;
    const fs::path where = in_frames ? fs::path(folder) / "frames" : fs::path(folder);
    for (fs::directory_iterator it(where, error), end; !error && it != end; it.increment(error))
      if (is_written_name(it->path().filename().string(), in_frames)) found.push_back(it->path().string());
  }
  std::sort(found.begin(), found.end());
  return found;
}

std::string foreign_file(const std::string& folder) {
  for (const std::string& path : written_names(folder))
    if (!is_own_file(path)) return path;
  return "";
}

PetscErrorCode remove_own(const std::string& path, int* removed) {
  PetscFunctionBeginUser;
  if (!is_own_file(path)) PetscFunctionReturn(PETSC_SUCCESS);
  std::error_code failed;
  fs::remove(path, failed);
  PetscCheck(!failed, PETSC_COMM_SELF, PETSC_ERR_FILE_OPEN, "Cannot remove %s: %s", path.c_str(),
             failed.message().c_str());
  ++*removed;
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
