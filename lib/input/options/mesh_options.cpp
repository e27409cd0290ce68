#include <cmath>

#include "base/patch_edge.hpp"
#include "common/text.hpp"
#include "input/options/groups.hpp"

namespace mpm {
namespace {

constexpr double k_furthest = 4e9;        // cells from the origin: round-off is 1e-6 of a cell there
constexpr double k_most_cells = 1 << 30;  // in a direction, so that cells and nodes count in an int

constexpr const char* k_top_default =
    "roller; at the side against gravity smooth, unless a body reaches it at the start";

void read_walls(OptionReader& in, int dim, MeshConfig& mesh) {
  Words<Wall> words;
  std::string meaning = "what holds at that side:";
  for (const SideWord& of : k_side_words) {
    meaning.append(words.empty() ? " " : "; ").append(of.meaning);
    words.emplace_back(of.word, of.kind);
  }
  for (int d = 0; d < 3; ++d)
    for (int side = 0; side < 2; ++side) {
      const std::string name = side_option(d, side);
      if (d >= dim && !in.listing()) {
        in.not_taken(name, "a mesh in 2D has no such side");
        continue;
      }
      const auto only = d == 2 ? in.where("dim", {"3"}) : in.always();
      in.word({.name = name,
               .meaning = meaning,
               .standard = d > 0 && side == 1 && in.listing() ? k_top_default : "",
               .change = k_by_choice},
              words, mesh.walls[d][side]);
    }
}

/// Periodic sides come in pairs, whole patches apart.
bool check_periodic(OptionReader& in, int dim, const MeshConfig& mesh) {
  const int edge = patch_edge(dim);
  bool sound = true;
  for (int d = 0; d < dim; ++d) {
    const bool is[2] = {mesh.walls[d][0] == Wall::periodic, mesh.walls[d][1] == Wall::periodic};
    const int cells = mesh.cells[d], rest = cells % edge;
    if (is[0] != is[1]) {
      in.reject(side_option(d, is[0] ? 1 : 0), "periodic, as -" + side_option(d, is[0] ? 0 : 1) + " is");
    } else if (is[0] && rest != 0) {
      const std::string fewer = cells > edge ? std::to_string(cells - rest) + " or " : "";
      in.reject(side_option(d, 0),
                "periodic in a mesh of a multiple of " + std::to_string(edge) + " cells along " + "xyz"[d] +
                    ": of " + fewer + std::to_string(cells - rest + edge) + ", not " + std::to_string(cells));
    } else {
      continue;
    }
    sound = false;
  }
  return sound;
}

bool count_cells(OptionReader& in, int dim, MeshConfig& mesh) {
  for (int d = 0; d < dim; ++d)
    if (!(mesh.upper[d] > mesh.lower[d])) {
      in.reject("mesh_upper", std::to_string(dim) + " numbers in m, each greater than that of -mesh_lower, " +
                                  text_of(mesh.lower, dim));
      return false;
    }
  for (int d = 0; d < dim; ++d) {
    const bool lower = std::abs(mesh.lower[d]) > std::abs(mesh.upper[d]);
    if (std::max(std::abs(mesh.lower[d]), std::abs(mesh.upper[d])) <= k_furthest * mesh.spacing) continue;
    in.reject(lower ? "mesh_lower" : "mesh_upper",
              "a corner at most " + text_of(k_furthest) + " cells of " + text_of(mesh.spacing) +
                  " m from the origin, since its coordinates do not separate particles further out");
    return false;
  }
  mesh.cells = {1, 1, 1};
  for (int d = 0; d < dim; ++d) {
    const double extent = mesh.upper[d] - mesh.lower[d], cells = std::round(extent / mesh.spacing);
    if (std::abs(extent - cells * mesh.spacing) > 1e-9 * extent || cells > k_most_cells) {
      const std::string most = cells > k_most_cells ? text_of(k_most_cells) + " at most" : "";
      in.reject("mesh_spacing", "a length in m that cuts the mesh's extent in " + std::string(1, "xyz"[d]) +
                                    ", " + text_of(extent) + ", into a whole number of cells" +
                                    (most.empty() ? "" : ", " + most));
      return false;
    }
    mesh.cells[d] = static_cast<int>(cells);
  }
  return true;
}

}  // namespace

bool read_mesh(OptionReader& in, int dim, MeshConfig& mesh) {
  in.section("Mesh");
  const auto errors = in.errors();
  in.vector({.name = "mesh_lower",
             .meaning = "lower corner of the mesh",
             .unit = "m",
             .range = k_coordinate,
             .required = true},
            dim, mesh.lower);
  in.vector({.name = "mesh_upper",
             .meaning = "upper corner of the mesh",
             .unit = "m",
             .range = k_coordinate,
             .required = true},
            dim, mesh.upper);
  in.number({.name = "mesh_spacing",
             .meaning = "edge of the square cells; the extent is a whole number of them",
             .unit = "m",
             .range = {.lowest = 0, .highest = 1e6, .open_lowest = true},
             .required = true},
            mesh.spacing);
  const bool sound = !in.listing() && in.errors() == errors && count_cells(in, dim, mesh);
  read_walls(in, dim, mesh);
  return sound && check_periodic(in, dim, mesh);
}

}  // namespace mpm
