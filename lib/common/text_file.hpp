#pragma once
// Whole files in memory, and their words.

#include <optional>
#include <string>
#include <string_view>

namespace mpm {

/// Reads a regular file whole. Returns what it should have been, as the end of "takes ..."; empty where it
/// could be read. A file that needs more memory than is free, with `copies` of its size for what it becomes,
/// is refused before it is read.
std::string read_whole(const std::string& path, double copies, std::string& text);

/// The words of a text between blanks, tabulators and line ends, one after another.
class Words {
 public:
  explicit Words(std::string_view text) : rest_(text) {}
  /// The next word; empty at the end.
  std::string_view next();
  /// The next word as a finite number; none where it is not, or at the end.
  std::optional<double> number();
  /// The line that the last word was on, from 1.
  long line() const { return line_; }
  /// Passes over what is left of the line.
  void skip_line();

 private:
  std::string_view rest_;
  long line_ = 1;
};

}  // namespace mpm
