#include "transfer/velocity_gradients.hpp"

#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace mpm {
namespace {

using Cell = std::array<int, 3>;
using Square = std::array<std::array<double, 3>, 3>;

/// Rows of C with C M = R, M symmetric and not negative, by elimination with diagonal pivots; a direction
/// whose pivot is at most `least` gets zero.
Square solve(Square M, Square R, double least, int dim) {
  std::array<bool, 3> used{};
  for (int n = 0; n < dim; ++n) {
    int best = -1;
    for (int d = 0; d < dim; ++d)
      if (!used[d] && (best < 0 || M[d][d] > M[best][best])) best = d;
    if (!(M[best][best] > least)) break;
    used[best] = true;
    for (int row = 0; row < dim; ++row) {
      if (row == best) continue;
      const double factor = M[row][best] / M[best][best];
      for (int d = 0; d < dim; ++d) M[row][d] -= factor * M[best][d];
      for (int d = 0; d < dim; ++d) R[d][row] -= factor * R[d][best];
    }
  }
  Square C{};
  for (int e = 0; e < dim; ++e)
    for (int d = 0; d < dim && used[e]; ++d) C[d][e] = R[d][e] / M[e][e];
  return C;
}

}  // namespace

std::vector<double> velocity_gradients(const std::vector<double>& position,
                                       const std::vector<double>& velocity, int dim,
                                       const std::array<int, 3>& period) {
  const std::size_t count = position.size() / dim;
  const auto in_period = [&](int d, int at) {
    return period[d] == 0 || (at >= 0 && at < period[d]) ? at : at < 0 ? at + period[d] : at - period[d];
  };
  const auto way = [&](std::size_t p, std::size_t q, int d) {
    const double to = position[q * dim + d] - position[p * dim + d];
    return period[d] == 0 ? to : to - period[d] * std::round(to / period[d]);
  };
  const auto cell_of = [&](std::size_t p) {
    Cell c{};
    for (int d = 0; d < dim; ++d) c[d] = static_cast<int>(std::floor(position[p * dim + d]));
    return c;
  };
  std::map<Cell, std::vector<std::size_t>> in;
  for (std::size_t p = 0; p < count; ++p) in[cell_of(p)].push_back(p);

  std::vector<double> gradient;
  gradient.reserve(count * dim * dim);
  for (std::size_t p = 0; p < count; ++p) {
    Square M{}, R{};
    std::size_t neighbours = 0;
    const Cell own = cell_of(p);
    for (int n = 0; n < (dim == 3 ? 27 : 9); ++n) {
      const auto found = in.find({in_period(0, own[0] + n % 3 - 1), in_period(1, own[1] + n / 3 % 3 - 1),
                                  in_period(2, own[2] + (dim == 3 ? n / 9 - 1 : 0))});
      if (found == in.end()) continue;
      neighbours += found->second.size();
      for (const std::size_t q : found->second)
        for (int e = 0; e < dim; ++e) {
          const double r = way(p, q, e);
          for (int d = 0; d < dim; ++d) {
            M[d][e] += way(p, q, d) * r;
            R[d][e] += (velocity[q * dim + d] - velocity[p * dim + d]) * r;
          }
        }
    }
    // A layer of one particle has no gradient across: over less than this, differences are noise.
    constexpr double k_flat = 0.1;  // cells, root mean square
    const Square C = solve(M, R, k_flat * k_flat * static_cast<double>(neighbours), dim);
    for (int d = 0; d < dim; ++d) gradient.insert(gradient.end(), C[d].begin(), C[d].begin() + dim);
  }
  return gradient;
}

}  // namespace mpm
