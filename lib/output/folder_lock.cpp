#include "output/folder_lock.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <ctime>
#include <fstream>
#include <map>
#include <sstream>

#include "output/files.hpp"

namespace mpm {
namespace {

/// Record that a run writes into its lock behind the first line, by the first word of each line: host, boot,
/// process, birth, since.
using Record = std::map<std::string, std::string>;
constexpr const char* k_first_line = "mpm lock of the run that writes into this folder\n";

std::string first_line(const char* path) {
  std::string line;
  std::getline(std::ifstream(path) >> std::ws, line);
  return line;
}

/// When a process of this machine began, in ticks since the boot; empty if there is none of that number. A
/// number is given again to another process, which began later.
std::string birth_of(const std::string& process) {
  constexpr int k_field = 20;  // of those behind the name, which may hold blanks, in /proc/PID/stat
  const std::string line = first_line(("/proc/" + process + "/stat").c_str());
  const auto name_end = line.rfind(')');
  if (name_end == std::string::npos) return "";
  std::istringstream fields(line.substr(name_end + 1));
  std::string field;
  for (int n = 0; n < k_field; ++n) fields >> field;
  return field;
}

std::string boot_id() { return first_line("/proc/sys/kernel/random/boot_id"); }

Record own_record() {
  char host[256] = "unknown", date[64] = "";
  gethostname(host, sizeof host - 1);
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  std::strftime(date, sizeof date, "%Y-%m-%d %H:%M:%S %z", &local);
  const std::string process = std::to_string(::getpid());
  return {{"host", host},
          {"boot", boot_id()},
          {"process", process},
          {"birth", birth_of(process)},
          {"since", date}};
}

/// `foreign`: it is no lock of this program.
Record read_record(int descriptor, bool* foreign) {
  char buffer[2000];
  const ssize_t length = ::pread(descriptor, buffer, sizeof buffer, 0);
  const std::string text(buffer, length > 0 ? static_cast<std::size_t>(length) : 0);
  const std::string first = k_first_line;
  const bool cut = text.find_first_not_of('\0') == std::string::npos || first.starts_with(text);
  *foreign = !cut && !text.starts_with(first);
  if (cut || *foreign) return {};
  std::istringstream lines(text.substr(first.size()));
  Record record;
  std::string key, value;
  while (lines >> key && std::getline(lines >> std::ws, value)) record[key] = value;
  return record;
}

std::string in_words(Record record) {
  if (record["process"].empty()) return "another run that has just begun";
  return "process " + record["process"] + " on " + record["host"] + ", since " + record["since"];
}

/// Whether the process of a record may be running, as far as this machine can find out.
bool may_live(Record record) {
  const Record own = own_record();
  if (record["process"].empty()) return false;
  if (record["host"] != own.at("host")) return true;
  return record["boot"] == own.at("boot") && record["birth"] == birth_of(record["process"]);
}

enum class Answer { ours, others, no_locks };

Answer lock(int descriptor) {
  struct flock whole {};
  whole.l_type = F_WRLCK;
  whole.l_whence = SEEK_SET;
  int result;
  do result = ::fcntl(descriptor, F_OFD_SETLK, &whole);
  while (result != 0 && errno == EINTR);
  if (result == 0) return Answer::ours;
  return errno == EAGAIN || errno == EACCES ? Answer::others : Answer::no_locks;
}

/// Whether the name still means the open file: who held it may have removed it meanwhile.
bool is_still(int descriptor, const std::string& path) {
  struct stat open = {};
  struct stat named = {};
  return ::fstat(descriptor, &open) == 0 && ::stat(path.c_str(), &named) == 0 &&
         open.st_ino == named.st_ino && open.st_dev == named.st_dev;
}

PetscErrorCode write_record(int descriptor, const std::string& path) {
  PetscFunctionBeginUser;
  std::string text = k_first_line;
  for (const auto& [key, value] : own_record()) text += key + " " + value + "\n";
  PetscCheck(::ftruncate(descriptor, 0) == 0, PETSC_COMM_SELF, PETSC_ERR_FILE_WRITE, "Cannot write %s: %s",
             path.c_str(), std::strerror(errno));
  PetscCall(write_all(descriptor, text, path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace

PetscErrorCode FolderLock::take(const std::string& folder, std::string* other) {
  PetscFunctionBeginUser;
  other->clear();
  while (!held()) {
    path_ = folder + "/mpm.lock";
    const int file = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW, 0666);
    PetscCheck(file >= 0, PETSC_COMM_SELF, PETSC_ERR_FILE_OPEN, "Cannot open %s: %s", path_.c_str(),
               std::strerror(errno));
    const Answer answer = lock(file);
    bool foreign = false;
    const Record before = read_record(file, &foreign);
    if (foreign) *other = "the file " + path_ + ", which is no lock of this program";
    if (!foreign && (answer == Answer::others || (answer == Answer::no_locks && may_live(before))))
      *other =
          in_words(before) + (answer == Answer::no_locks ? "; remove " + path_ + " if it has ended" : "");
    if (!other->empty()) {
      ::close(file);
      PetscFunctionReturn(PETSC_SUCCESS);
    }
    if (!is_still(file, path_)) {
      ::close(file);
      continue;
    }
    descriptor_ = file;  // from here on released with this
    left_by_ = before.empty() ? "" : in_words(before);
    PetscCall(write_record(file, path_));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

void FolderLock::release() {
  if (!held()) return;
  ::unlink(path_.c_str());
  ::close(descriptor_);
  descriptor_ = -1;
}

}  // namespace mpm
