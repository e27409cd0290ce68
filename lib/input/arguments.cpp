// What must be checked before PETSc reads the command line and the options files: it ends the program over a
// file that it cannot read and passes over words that belong to no option.

#include <filesystem>
#include <fstream>

#include "input/options.hpp"
#include "input/text.hpp"

namespace mpm {
namespace {

bool is_key(const std::string& word) {
  PetscBool valid = PETSC_FALSE;
  return PetscOptionsValidKey(word.c_str(), &valid) == PETSC_SUCCESS && valid;
}

/// The words of a line of an options file, without its comment; a word may hold spaces in double quotes.
std::vector<std::string> words_of(const std::string& line) {
  std::vector<std::string> words;
  const std::string text = line.substr(0, line.find('#'));
  constexpr const char* k_blank = " \t\r";
  for (auto at = text.find_first_not_of(k_blank); at != std::string::npos;
       at = text.find_first_not_of(k_blank, at)) {
    const bool quoted = text[at] == '"';
    const auto end = quoted ? text.find('"', at + 1) : text.find_first_of(k_blank, at);
    const auto from = at + quoted;
    words.push_back(text.substr(from, end == std::string::npos ? end : end - from));
    if (end == std::string::npos) break;
    at = end + quoted;
  }
  return words;
}

/// One line of text for each mistake in an options file.
std::vector<std::string> faults_of(const std::string& path) {
  std::error_code error;
  std::ifstream file(path);
  if (!file || std::filesystem::is_directory(path, error))
    return {"mpm: -options_file: given \"" + path + "\", takes a file that can be read"};
  if (!std::filesystem::is_regular_file(path, error))
    return {};  // a pipe can be read only once, which is PETSc's
  std::vector<std::string> faults;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    const auto words = words_of(line);
    if (words.empty() || (words[0] == "alias" && words.size() == 3)) continue;
    if (words.size() > 2 || !is_key(words[0]) || (words.size() == 2 && is_key(words[1])))
      faults.push_back("mpm: " + path + ":" + std::to_string(number) + ": given \"" + join(words, " ") +
                       "\", takes -NAME VALUE, and lists without spaces");
  }
  return faults;
}

/// faults_of() on the first process, told to all.
std::vector<std::string> common_faults(MPI_Comm comm, const std::string& path) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  std::string all = rank == 0 ? join(faults_of(path), "\n") : "";
  int size = static_cast<int>(all.size());
  MPI_Bcast(&size, 1, MPI_INT, 0, comm);
  all.resize(size);
  MPI_Bcast(all.data(), size, MPI_CHAR, 0, comm);
  return size == 0 ? std::vector<std::string>{} : split(all, '\n');
}

}  // namespace

void prepare_arguments(MPI_Comm comm, int* argc, char** argv, InputReport& report) {
  int kept = 1;
  const auto keep = [&](int k) { argv[kept++] = argv[k]; };
  for (int k = 1; k < *argc; ++k) {
    const std::string word = argv[k], key = lower_case(word);
    const bool has_value = k + 1 < *argc && !is_key(argv[k + 1]) && key != "-prefix_pop";
    if (!is_key(word)) {
      report.errors.push_back("mpm: " + word +
                              ": given outside any option, takes -NAME VALUE, and lists without spaces");
      continue;
    }
    const bool help = key == "-help" || key == "--help" || key == "-h", file = key == "-options_file";
    report.help = report.help || help;
    bool pass = !help;
    if (file) {
      report.options_file = has_value ? argv[k + 1] : "";
      const auto faults = common_faults(comm, report.options_file);
      report.errors.insert(report.errors.end(), faults.begin(), faults.end());
      pass = faults.empty();
      report.file_unread = report.file_unread || !pass;
    }
    if (pass) keep(k);
    if (has_value && pass) keep(k + 1);
    k += has_value;
  }
  *argc = kept;
  argv[kept] = nullptr;
}

}  // namespace mpm
