#include "input/deck/deck.hpp"

#include <fcntl.h>
#include <petscsys.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>

#include "common/text.hpp"
#include "input/deck/body_table.hpp"
#include "input/deck/renamed.hpp"

namespace mpm {
namespace {

constexpr std::size_t k_most_bytes = std::size_t(64) << 20;  // of a deck: an endless file is none
constexpr int k_most_files = 1000;                           // decks that include one another
constexpr int k_most_faults = 10;                            // lines reported for one deck

/// The words of a line of a deck, without its comment; a word may hold spaces in double quotes.
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

/// Bytes of a pipe that are there; none at its end, and where nobody has opened it for writing after
/// k_patience.
std::string piece_of_pipe(int descriptor, bool begun) {
  constexpr int k_patience = 10000, k_pause = 20;  // ms
  char piece[1 << 16];
  for (int waited = 0;;) {
    const ssize_t count = ::read(descriptor, piece, sizeof piece);
    if (count > 0) return {piece, static_cast<std::size_t>(count)};
    const bool slow = count < 0 && (errno == EAGAIN || errno == EINTR);  // there is somebody who writes
    if (!slow && (count < 0 || begun || (waited += k_pause) > k_patience)) return {};
    ::usleep(1000 * k_pause);
  }
}

/// The bytes of a file, and in `fault` what it should have been where it cannot be read.
std::string contents_of(const std::string& path, std::string& fault) {
  std::error_code error;
  const bool pipe = std::filesystem::is_fifo(path, error);
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | (pipe ? O_NONBLOCK : 0));
  std::string all;
  bool sound = descriptor >= 0 && !std::filesystem::is_directory(path, error);
  std::vector<char> piece(1 << 16);
  while (sound && all.size() <= k_most_bytes) {
    const auto before = all.size();
    if (pipe) {
      all += piece_of_pipe(descriptor, before > 0);
    } else {
      const ssize_t count = ::read(descriptor, piece.data(), piece.size());
      sound = count >= 0 || errno == EINTR;
      all.append(piece.data(), std::max<ssize_t>(count, 0));
    }
    if (all.size() == before) break;
  }
  if (descriptor >= 0) ::close(descriptor);
  if (pipe && all.empty()) fault = "a pipe that a deck is written to";
  if (!sound) fault = "a file that can be read";
  if (all.size() > k_most_bytes) fault = "a deck of at most 64 MiB";
  return fault.empty() ? all : std::string();
}

/// Identity of a file, by which a file that includes itself is found.
std::string identity_of(const std::string& path) {
  std::error_code error;
  const auto whole = std::filesystem::canonical(path, error);
  return error ? path : whole.string();
}

}  // namespace

bool is_option_name(const std::string& word) {
  PetscBool valid = PETSC_FALSE;
  return PetscOptionsValidKey(word.c_str(), &valid) == PETSC_SUCCESS && valid &&
         word.find('=') == std::string::npos;
}

void DeckReader::fail(const std::string& line) {
  errors.push_back("mpm: " + line);
  file_unread = true;
}

void DeckReader::add(const std::string& name, const std::optional<std::string>& value, Source source,
                     const std::string& where) {
  const std::string key = lower_case(name), given = value ? *value : "";
  if (key == "-help" || key == "--help" || key == "-h") {
    help = true;
  } else if (key == "-options_file") {
    if (source == Source::command_line) last_file = given;
    read_file(given, source == Source::command_line ? Source::deck : source, where);
  } else if (key == "-options_file_yaml" || key == "-options_string_yaml") {
    fail(where + name + ": given \"" + printable(given) +
         "\", takes nothing: a deck is lines -NAME VALUE, not YAML");
  } else if (key == "-prefix_push") {
    if (given.empty())
      fail(where + name + ": given \"\", takes the beginning of the names that follow, as a_");
    prefixes_.push_back(prefixes_.empty() ? given : prefixes_.back() + given);
  } else if (key == "-prefix_pop") {
    if (prefixes_.empty())
      fail(where + name + ": given without -prefix_push, takes its place after one");
    else
      prefixes_.pop_back();
  } else {
    std::string whole = prefixes_.empty() ? name : "-" + prefixes_.back() + name.substr(1);
    if (const auto alias = aliases_.find(lower_case(whole)); alias != aliases_.end()) whole = alias->second;
    keep(whole, value, source, where);
  }
}

/// Keeps an option by its name of today. Both of its names in one file, or both in the words of one source,
/// leave open which of the values is meant.
void DeckReader::keep(const std::string& name, const std::optional<std::string>& value, Source source,
                      const std::string& where) {
  const std::string present = present_name(name);
  const bool renamed = present != name;
  const std::string place =
      open_files_.empty() ? std::to_string(static_cast<int>(source)) : open_files_.back();
  const std::string& before = names_.insert({place + '\n' + lower_case(present), name}).first->second;
  if (lower_case(before) != lower_case(name))
    errors.push_back("mpm: " + where + name + ": given \"" + printable(value.value_or("")) +
                     "\", takes its place without " + before + ", which is another name of the same option");
  const std::string note = "mpm: note: " + name + " is now " + present;
  if (renamed && std::find(notes.begin(), notes.end(), note) == notes.end()) notes.push_back(note);
  options_.push_back(
      {present, renamed ? name : "", value, source, open_names_.empty() ? "" : open_names_.back()});
}

void DeckReader::read_words(const std::vector<std::string>& words, Source source, const std::string& where) {
  const auto open = prefixes_.size();
  for (std::size_t k = 0; k < words.size(); ++k) {
    if (!is_option_name(words[k])) {
      strays.push_back(where + words[k]);
      continue;
    }
    const bool has_value =
        k + 1 < words.size() && !is_option_name(words[k + 1]) && lower_case(words[k]) != "-prefix_pop";
    add(words[k], has_value ? std::optional(words[k + 1]) : std::nullopt, source, where);
    k += has_value;
  }
  if (prefixes_.size() > open)
    fail(where + "-prefix_push: given \"" + printable(prefixes_.back()) + "\", takes a -prefix_pop after it");
  prefixes_.resize(std::min(open, prefixes_.size()));
}

void DeckReader::read_file(const std::string& path, Source source, const std::string& where) {
  const std::string begin = where + "-options_file: given \"" + printable(path) + "\", takes ";
  const std::string suffix = lower_case(std::filesystem::path(path).extension().string());
  if (suffix == ".yaml" || suffix == ".yml") return fail(begin + "a deck of lines -NAME VALUE, not YAML");
  const std::string identity = identity_of(path);
  if (std::find(open_files_.begin(), open_files_.end(), identity) != open_files_.end())
    return fail(begin + "a file that does not include itself");
  if (++files_ > k_most_files) return fail(begin + "at most 1000 files");
  std::string fault;
  const std::string text = contents_of(path, fault);
  if (!fault.empty()) return fail(begin + fault);
  files.push_back(path);
  open_files_.push_back(identity), open_names_.push_back(path);
  read_text(text, path, source);
  open_files_.pop_back(), open_names_.pop_back();
}

void DeckReader::read_file_if_there(const std::string& path, Source source) {
  std::error_code error;
  if (std::filesystem::is_regular_file(path, error) && ::access(path.c_str(), R_OK) == 0)
    read_file(path, source, "");
}

bool DeckReader::read_line(const std::vector<std::string>& words, Source source, const std::string& where) {
  if (lower_case(words[0]) == "alias" && words.size() == 3 && is_option_name(words[1]) &&
      is_option_name(words[2])) {
    aliases_[lower_case(words[1])] = words[2];
    return true;
  }
  const bool has_value = words.size() == 2;
  if (words.size() > 2 || !is_option_name(words[0]) || (has_value && is_option_name(words[1]))) return false;
  add(words[0], has_value ? std::optional(words[1]) : std::nullopt, source, where);
  return true;
}

void DeckReader::read_text(const std::string& text, const std::string& path, Source source) {
  const auto open = prefixes_.size();
  std::vector<std::string> wrong;
  int good = 0, number = 0;
  for (const std::string& line : split(text, '\n')) {
    const std::string at = printable(path) + ":" + std::to_string(++number) + ": ";
    const auto words = words_of(line);
    if (words.empty()) continue;
    if (line.find('\0') == std::string::npos && read_line(words, source, at))
      ++good;
    else
      wrong.push_back(at + "given \"" + printable(join(words, " ")) +
                      "\", takes -NAME VALUE, and lists without spaces");
  }
  const int faults = static_cast<int>(wrong.size());
  if (good == 0 && faults > 2)
    return fail(printable(path) + ": given " + std::to_string(faults) +
                " lines of another form, takes a deck: lines -NAME VALUE");
  for (int k = 0; k < std::min(faults, k_most_faults); ++k) fail(wrong[k]);
  if (faults > k_most_faults)
    fail(printable(path) + ": given " + std::to_string(faults - k_most_faults) +
         " more such lines, takes -NAME VALUE in each");
  if (prefixes_.size() != open)
    fail(printable(path) +
         ": given unequal numbers of -prefix_push and -prefix_pop, takes one for each other");
  prefixes_.resize(std::min(open, prefixes_.size()));
}

/// A line for each value of a deck that a later line of another deck replaced.
void DeckReader::note_replaced() {
  std::map<std::string, const GivenOption*> known;
  for (const GivenOption& option : options_) {
    if (option.source != Source::deck) continue;
    const GivenOption*& before = known[lower_case(option.name)];
    if (before != nullptr && before->file != option.file && before->value != option.value)
      notes.push_back("mpm: note: " + printable(option.name) + " \"" + printable(option.value.value_or("")) +
                      "\" of " + printable(option.file) + " replaces \"" +
                      printable(before->value.value_or("")) + "\" of " + printable(before->file));
    before = &option;
  }
}

/// Adds the rigid bodies of the table that -rigid_bodies_file names: their names behind those of
/// -rigid_bodies, and each cell as an option of its body, which gives way to all others.
void DeckReader::add_rigid_bodies() {
  const auto last = [&](const char* name) -> const GivenOption* {
    const GivenOption* found = nullptr;
    for (const GivenOption& option : options_)
      if (lower_case(option.name) == name && (found == nullptr || option.source >= found->source))
        found = &option;
    return found;
  };
  const GivenOption* const file = last("-rigid_bodies_file");
  if (file == nullptr || !file->value) return;
  std::string fault;
  const std::string path = *file->value;
  const std::vector<RowOptions> rows = rows_of_bodies(contents_of(path, fault), &fault);
  if (!fault.empty()) return fail("-rigid_bodies_file: given \"" + printable(path) + "\", takes " + fault);
  files.push_back(path);
  const GivenOption* const listed = last("-rigid_bodies");
  const Source source = listed == nullptr ? file->source : std::max(listed->source, file->source);
  std::vector<std::string> names;
  if (listed != nullptr && listed->value) names.push_back(*listed->value);
  for (const RowOptions& row : rows) {
    names.push_back(row.name);
    for (const auto& [option, value] : row.options)
      options_.push_back({option, "", value, Source::petscrc, path});
  }
  options_.push_back({"-rigid_bodies", "", join(names), source, path});
}

std::vector<GivenOption> DeckReader::take() {
  note_replaced();
  add_rigid_bodies();
  std::stable_sort(options_.begin(), options_.end(),
                   [](const GivenOption& a, const GivenOption& b) { return a.source < b.source; });
  return std::move(options_);
}

}  // namespace mpm
