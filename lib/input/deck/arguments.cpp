// Checks before PETSc reads the command line and the options files, because PETSc ends the program over a
// file that it cannot read, passes over words that belong to no option, and acts at once on options of its
// own that load libraries or write files.

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>

#include "common/text.hpp"
#include "input/deck/deck.hpp"
#include "input/deck/petsc_names.hpp"
#include "input/deck/report.hpp"

namespace mpm {
namespace {

/// Gives every process the texts of the first.
void share(MPI_Comm comm, std::vector<std::string>& texts) {
  std::string all;
  for (const auto& text : texts) all += text + '\0';
  unsigned long size = all.size();
  MPI_Bcast(&size, 1, MPI_UNSIGNED_LONG, 0, comm);
  all.resize(size);
  constexpr unsigned long k_piece = 1 << 30;  // MPI counts by int
  for (unsigned long from = 0; from < size; from += k_piece)
    MPI_Bcast(all.data() + from, static_cast<int>(std::min(k_piece, size - from)), MPI_CHAR, 0, comm);
  texts = split(all, '\0');
  texts.pop_back();
}

/// PETSc's own files, unless -skip_petscrc is on the command line.
void read_petscrc(const std::vector<std::string>& words, DeckReader& reader) {
  for (std::size_t k = 0; k < words.size(); ++k) {
    const std::string value = k + 1 < words.size() ? lower_case(words[k + 1]) : "";
    if (lower_case(words[k]) == "-skip_petscrc" && value != "false" && value != "0" && value != "no" &&
        value != "off")
      return;
  }
  std::error_code error;
  const char* home = std::getenv("HOME");
  if (home != nullptr && !std::filesystem::equivalent(home, ".", error))
    reader.read_file_if_there(std::string(home) + "/.petscrc", Source::petscrc);
  reader.read_file_if_there(".petscrc", Source::petscrc);
  reader.read_file_if_there("petscrc", Source::petscrc);
}

void read_environment(DeckReader& reader) {
  if (const char* given = std::getenv("PETSC_OPTIONS")) {
    std::vector<std::string> words;
    for (const auto& word : split(given, ' '))
      if (!word.empty()) words.push_back(word);
    reader.read_words(words, Source::environment, "PETSC_OPTIONS: ");
  }
  if (std::getenv("PETSC_OPTIONS_YAML") != nullptr)
    reader.errors.push_back("mpm: PETSC_OPTIONS_YAML: given, takes nothing: options are not read as YAML");
}

/// Words that belong to no option. A deck without -options_file is the cause of all else that is missing.
void report_strays(DeckReader& reader) {
  for (const auto& word : reader.strays) {
    std::error_code error;
    const bool deck =
        std::filesystem::path(word).extension() == ".opts" || std::filesystem::is_regular_file(word, error);
    if (reader.last_file.empty() && !reader.file_unread && deck) {
      reader.errors = {"mpm: " + printable(word) + ": given outside any option, takes -options_file " +
                       printable(word)};
      reader.file_unread = true;
      return;
    }
    reader.errors.push_back("mpm: " + printable(word) +
                            ": given outside any option, takes -NAME VALUE, and lists without spaces");
  }
}

/// Fault of an option of PETSc; empty where a run passes it on.
std::string fault_of_petsc(const std::string& key, const GivenOption& option) {
  if (key.starts_with("saws_")) return "nothing: there is no web server";
  return petsc_fault(key, option.value.value_or(""));
}

/// Takes the options of PETSc out of the list: those that are passed on go to report.petsc_words.
void take_petsc(std::vector<GivenOption>& options, std::vector<std::string>& errors, InputReport& report) {
  std::vector<GivenOption> ours;
  for (GivenOption& option : options) {
    const std::string key = lower_case(option.name).substr(1);
    if (!is_petsc_name(key)) {
      ours.push_back(std::move(option));
      continue;
    }
    if (const std::string fault = fault_of_petsc(key, option); !fault.empty()) {
      errors.push_back("mpm: " + printable(option.name) + ": given \"" +
                       printable(option.value.value_or("")) + "\", takes " + fault);
      continue;
    }
    if (key == "log_view") report.log_view = option.value.value_or("");
    report.petsc_words.push_back(option.name);
    if (option.value) report.petsc_words.push_back(*option.value);
  }
  options = std::move(ours);
}

/// All that the first process was given. `words` are those of PETSc's command line from here on.
void read_all(const std::vector<std::string>& line, InputReport& report) {
  DeckReader reader;
  read_petscrc(line, reader);
  read_environment(reader);
  reader.read_words(line, Source::command_line, "");
  report_strays(reader);
  auto options = reader.take();
  take_petsc(options, reader.errors, report);
  report.help = reader.help;
  report.file_unread = reader.file_unread;
  report.errors = reader.errors;
  report.files = reader.files;
  report.warnings = reader.notes;
  std::error_code error;  // a pipe gives the output no name
  if (std::filesystem::is_regular_file(reader.last_file, error)) report.options_file = reader.last_file;
  if (options.empty() && report.errors.empty() && !report.help) {
    report.errors.push_back("mpm: -options_file: " +
                            (reader.last_file.empty() ? "not given" : "given \"" + reader.last_file + "\"") +
                            ", takes a deck that holds options; -help lists all");
    report.file_unread = true;
  }
  std::map<std::string, const GivenOption*> last;
  for (const GivenOption& option : options) {
    const GivenOption*& former = last[lower_case(option.name)];
    if (former != nullptr) {
      report.replaced.push_back(lower_case(option.name).substr(1));
      report.replaced.push_back(former->value.value_or(""));
    }
    former = &option;
  }
  for (const auto& [name, option] : last)
    if (!option->former.empty()) {
      report.renamed.push_back(name.substr(1));
      report.renamed.push_back(option->former.substr(1));
    }
  if (report.file_unread) {
    report.petsc_words.clear();
    return;
  }
  for (const GivenOption& option : options) {
    report.words.push_back(option.name);
    if (option.value) report.words.push_back(*option.value);
  }
}

}  // namespace

void prepare_arguments(MPI_Comm comm, int* argc, char*** argv, InputReport& report) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  if (rank == 0) read_all({*argv + std::min(1, *argc), *argv + *argc}, report);
  std::vector<std::string> marks = {report.help ? "1" : "", report.file_unread ? "1" : "",
                                    report.options_file, report.log_view};
  for (auto* texts : {&report.words, &report.petsc_words, &report.errors, &report.warnings, &report.replaced,
                      &report.renamed, &report.files, &marks})
    share(comm, *texts);
  report.help = !marks[0].empty(), report.file_unread = !marks[1].empty();
  report.options_file = marks[2], report.log_view = marks[3];
  unsetenv("PETSC_OPTIONS"), unsetenv("PETSC_OPTIONS_YAML");  // they have been read

  // Keeps PETSc from printing options that were not used, because every one of them is reported here.
  report.petsc_words.insert(report.petsc_words.begin(), {"-skip_petscrc", "true", "-options_left", "false"});
  report.arguments = {*argc > 0 ? **argv : nullptr};
  for (auto& word : report.petsc_words) report.arguments.push_back(word.data());
  *argc = static_cast<int>(report.arguments.size());
  report.arguments.push_back(nullptr);
  *argv = report.arguments.data();
}

}  // namespace mpm
