#pragma once
// Text to values and back: strict, locale-free.

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/numbers.hpp"

namespace mpm {

/// The whole text as a finite number; none where it is empty, has anything more, overflows, or is inf or nan.
std::optional<double> parse_number(std::string_view text);

/// The whole text as a whole number; none as above.
std::optional<long> parse_integer(std::string_view text);

/// As sprintf, to a string of up to 511 characters.
__attribute__((format(printf, 1, 2))) std::string formatted(const char* format, ...);

/// Numbers as on the command line.
std::string text_of(std::span<const double> x);
/// The first `dim` components.
std::string text_of(const std::array<double, 3>& x, int dim);

/// The pieces between the separators: "a,,b" gives a, empty, b; an empty text gives one empty piece.
std::vector<std::string> split(std::string_view text, char separator = ',');

/// The pieces with the separator between them.
std::string join(const std::vector<std::string>& pieces, std::string_view separator = ",");

/// At most 100 bytes of a text that a user gave, and ? for each that a terminal would not show.
std::string printable(std::string_view text);

/// "a, b or c".
std::string one_of(const std::vector<std::string>& words);

/// The option of a side of the mesh, mesh_xmin ... mesh_zmax. d: direction; side: 0 lower, 1 upper.
std::string side_option(int d, int side);

/// ASCII lower case: PETSc's options ignore case.
std::string lower_case(std::string_view text);

/// Whether a text has characters below the blank, as a line end or a tabulator has; these in a form that
/// stays in its line: \n, \t, \x1b.
bool has_control(std::string_view text);
std::string visible(std::string_view text);

/// Letters to insert, remove, replace or swap with their neighbour to get from one word to the other.
int edit_distance(std::string_view a, std::string_view b);

/// The nearest of the words, none where all are further than a third of the word's length (2 letters at
/// least).
std::optional<std::string> nearest(std::string_view word, const std::vector<std::string>& words);

}  // namespace mpm
