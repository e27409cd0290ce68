#include "input/files/stl_file.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "common/text.hpp"
#include "common/text_file.hpp"
#include "input/files/obj_file.hpp"

namespace mpm {
namespace {

constexpr std::size_t k_header = 84, k_triangle = 50;  // bytes of a binary file
constexpr double k_most = 7e8, k_largest = 1e9;        // triangles; m

std::uint32_t count_of(std::string_view text) {
  std::uint32_t count;
  std::memcpy(&count, text.data() + 80, sizeof count);
  return std::endian::native == std::endian::little ? count : __builtin_bswap32(count);
}

float real_at(const char* bytes) {
  std::uint32_t bits;
  std::memcpy(&bits, bytes, sizeof bits);
  if (std::endian::native != std::endian::little) bits = __builtin_bswap32(bits);
  return std::bit_cast<float>(bits);
}

/// A binary file may begin as an ASCII one does, but its length is that of its triangles.
bool is_binary(std::string_view text) {
  return text.size() >= k_header && text.size() == k_header + k_triangle * std::size_t(count_of(text));
}

bool is_obj(const std::string& path) { return lower_case(path).ends_with(".obj"); }

bool is_ascii(std::string_view text) {
  return lower_case(text.substr(0, 5)) == "solid" &&
         text.substr(0, 1000).find('\0') == std::string_view::npos;
}

std::string read_binary(std::string_view text, double scale, std::vector<Vec3>& corners) {
  const std::size_t count = count_of(text);
  corners.reserve(3 * count);
  for (std::size_t k = 0; k < count; ++k)
    for (int c = 0; c < 3; ++c) {
      Vec3& x = corners.emplace_back();
      for (int d = 0; d < 3; ++d) {
        x[d] = scale * real_at(text.data() + k_header + k * k_triangle + 12 * (c + 1) + 4 * d);
        if (!(std::abs(x[d]) <= k_largest))
          return formatted("coordinates of at most 1e9 m; triangle %zu has others", k + 1);
      }
    }
  return "";
}

/// facet normal n n n, outer loop, three times vertex x y z, endloop, endfacet.
std::string read_ascii(std::string_view text, double scale, std::vector<Vec3>& corners) {
  Words words(text);
  const auto fault = [&words](const char* takes) {
    return formatted("an STL file: line %ld takes %s", words.line(), takes);
  };
  for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
    const std::string key = lower_case(word);
    if (key == "vertex") {
      Vec3& x = corners.emplace_back();
      for (double& coordinate : x) {
        const auto number = words.number();
        if (!number || !(std::abs(*number * scale) <= k_largest))
          return fault("3 numbers behind \"vertex\", of at most 1e9 m");
        coordinate = *number * scale;
      }
    } else if (key == "endloop" || key == "endfacet") {
      if (corners.size() % 3 != 0) return fault("3 vertices before it");
    } else if (key == "normal") {
      for (int d = 0; d < 3; ++d) words.next();  // what they are does not matter
    } else if (key == "endsolid" || key == "solid") {
      words.skip_line();  // the solid's name
    } else if (key != "facet" && key != "outer" && key != "loop") {
      return fault("facet, normal, outer, loop, vertex, endloop, endfacet or endsolid");
    }
  }
  if (corners.size() % 3 != 0) return "an STL file whose last triangle has 3 vertices";
  return "";
}

}  // namespace

std::string read_stl(const std::string& path, double scale, std::shared_ptr<const TriangleSurface>& surface,
                     const Vec3& offset) {
  std::string text;
  constexpr double k_copies = 14;  // of the triangles' bytes: corners, vertices, edges, the tree and the bins
  std::string fault = read_whole(path, k_copies, text);
  if (!fault.empty()) return fault;
  std::vector<Vec3> corners;
  const bool binary = !is_obj(path) && is_binary(text);
  if (binary && count_of(text) > k_most) return formatted("an STL file of at most %.0f triangles", k_most);
  if (is_obj(path))
    fault = read_obj(text, scale, corners);
  else if (binary)
    fault = read_binary(text, scale, corners);
  else if (is_ascii(text))
    fault = read_ascii(text, scale, corners);
  else if (text.size() >= k_header)
    fault = formatted("an STL file: its header says %u triangles, %.0f bytes, and it has %zu bytes",
                      count_of(text), double(k_header) + double(k_triangle) * count_of(text), text.size());
  else
    fault = "an STL file, ASCII or binary";
  if (!fault.empty()) return fault;
  for (Vec3& x : corners)
    for (int d = 0; d < 3; ++d) x[d] += offset[d];
  const auto read = std::make_shared<const TriangleSurface>(corners);
  fault = fault_of(*read);
  if (fault.empty()) surface = read;
  return fault;
}

}  // namespace mpm
