#pragma once
// Options of decks, PETSc's own files, the environment and the command line, as one list. PETSc would end the
// program over a file that it cannot read, and does not read pipes on several ranks.

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace mpm {

/// Where an option comes from; a later source takes precedence.
enum class Source { petscrc, environment, deck, command_line };

/// An option as it was given. Its names have their dash.
struct GivenOption {
  std::string name;    // that of today
  std::string former;  // the name as it was given, where that is a former one
  std::optional<std::string> value;
  Source source = Source::command_line;
  std::string file;  // that holds it; empty where no file does
};

/// Reads options from words and files, with the files that these include (-options_file), prefixes
/// (-prefix_push, -prefix_pop) and aliases, as PETSc would. Former names of options become those of today, so
/// that precedence does not depend on which of them a source uses. Each mistake is a whole line in `errors`.
/// Call it on one process: a pipe can be read only once.
class DeckReader {
 public:
  /// Options in words, as of a command line. `where` begins the lines of mistakes: empty, or "FILE:3: ".
  void read_words(const std::vector<std::string>& words, Source source, const std::string& where);
  /// A deck and what it includes.
  void read_file(const std::string& path, Source source, const std::string& where);
  /// A deck that may be absent.
  void read_file_if_there(const std::string& path, Source source);
  /// The options, those that take precedence last. Call it once, after all has been read.
  std::vector<GivenOption> take();

  std::vector<std::string> errors;
  std::vector<std::string>
      notes;  // a whole line for each former name, and for each value that another deck replaced
  std::vector<std::string> strays;  // words that belong to no option
  std::string last_file;            // the last deck of the command line
  std::vector<std::string> files;   // all that were read
  bool help = false;                // -help was given
  bool file_unread = false;         // a deck was left out, or a part of it

 private:
  void read_text(const std::string& text, const std::string& path, Source source);
  void keep(const std::string& name, const std::optional<std::string>& value, Source source,
            const std::string& where);
  bool read_line(const std::vector<std::string>& words, Source source, const std::string& where);
  void add(const std::string& name, const std::optional<std::string>& value, Source source,
           const std::string& where);
  void fail(const std::string& line);

  void note_replaced();
  void add_rigid_bodies();

  std::vector<GivenOption> options_;

  std::vector<std::string> prefixes_, open_files_,
      open_names_;                              // of the files: what identifies them; their names
  std::map<std::string, std::string> aliases_;  // by lower-case name
  std::map<std::string, std::string> names_;    // as given, by file or source and by lower-case name of today
  int files_ = 0;
};

/// Whether a word is the name of an option.
bool is_option_name(const std::string& word);

}  // namespace mpm
