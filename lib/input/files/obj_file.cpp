#include "input/files/obj_file.hpp"

#include <cmath>

#include "common/text.hpp"
#include "common/text_file.hpp"

namespace mpm {
namespace {

constexpr double k_largest = 1e9;  // m

/// The words of a line behind its key.
std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> out;
  Words words(line);
  for (std::string_view word = words.next(); !word.empty(); word = words.next()) out.push_back(word);
  return out;
}

/// The vertex of a corner of a face, as 3, 3/1 or 3/1/2, from 1 on, or from the last one back where it is
/// negative; -1 where there is none.
long vertex_of(std::string_view word, std::size_t vertices) {
  const auto number = parse_number(word.substr(0, word.find('/')));
  const auto count = static_cast<double>(vertices);
  if (!number || *number != std::floor(*number) || std::abs(*number) > count || *number == 0) return -1;
  return std::lround(*number > 0 ? *number - 1 : count + *number);
}

}  // namespace

std::string read_obj(std::string_view text, double scale, std::vector<Vec3>& corners) {
  std::vector<Vec3> vertices;
  long number = 0;
  while (!text.empty()) {
    ++number;
    const std::size_t end = text.find('\n');
    const auto words = words_of(text.substr(0, end));
    text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
    if (words.empty() || (words[0] != "v" && words[0] != "f")) continue;  // normals, textures, names
    if (words.size() < 4)
      return formatted("an OBJ file: line %ld takes 3 numbers or more behind \"%s\"", number,
                       std::string(words[0]).c_str());
    if (words[0] == "v") {
      Vec3& x = vertices.emplace_back();
      for (int d = 0; d < 3; ++d) {
        const auto coordinate = parse_number(words[d + 1]);
        if (!coordinate || !(std::abs(*coordinate * scale) <= k_largest))
          return formatted("an OBJ file: line %ld takes 3 numbers of at most 1e9 m", number);
        x[d] = *coordinate * scale;
      }
      continue;
    }
    std::vector<long> face;
    for (std::size_t c = 1; c < words.size(); ++c) {
      face.push_back(vertex_of(words[c], vertices.size()));
      if (face.back() < 0)
        return formatted("an OBJ file: line %ld takes numbers of the %zu vertices before it", number,
                         vertices.size());
    }
    for (std::size_t c = 1; c + 1 < face.size(); ++c)
      for (const long v : {face[0], face[c], face[c + 1]}) corners.push_back(vertices[v]);
  }
  return corners.empty() ? "an OBJ file with vertices (v) and faces (f)" : "";
}

}  // namespace mpm
