#include "checkpoint/id_blocks.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace mpm {
namespace {

/// Which rank's block a number falls into.
int rank_of_id(long id, long total, int ranks) {
  int rank = static_cast<int>(static_cast<double>(id) * ranks / std::max(total, 1L));
  rank = std::clamp(rank, 0, ranks - 1);
  while (rank > 0 && id < block_of(total, rank, ranks).first) --rank;
  while (rank + 1 < ranks && id >= block_of(total, rank + 1, ranks).first) ++rank;
  return rank;
}

/// How many rows go to and come from each rank, and where they begin.
struct Traffic {
  std::vector<int> to, to_begin, from, from_begin;
  int received = 0;

  static std::vector<int> begins(const std::vector<int>& counts) {
    std::vector<int> begin(counts.size(), 0);
    std::partial_sum(counts.begin(), counts.end() - 1, begin.begin() + 1);
    return begin;
  }
};

/// Rows of `width` numbers, put into the order of leaving, to the ranks where they belong.
template <class Number>
PetscErrorCode exchange(MPI_Comm comm, MPI_Datatype number, const Traffic& t, const std::vector<int>& order,
                        int width, std::vector<Number>& rows) {
  PetscFunctionBeginUser;
  std::vector<Number> leaving(order.size() * width), arriving(std::size_t(t.received) * width);
  for (std::size_t n = 0; n < order.size(); ++n)
    std::copy_n(rows.begin() + std::size_t(order[n]) * width, width, leaving.begin() + n * width);
  MPI_Datatype row;
  PetscCallMPI(MPI_Type_contiguous(width, number, &row));
  PetscCallMPI(MPI_Type_commit(&row));
  PetscCallMPI(MPI_Alltoallv(leaving.data(), t.to.data(), t.to_begin.data(), row, arriving.data(),
                             t.from.data(), t.from_begin.data(), row, comm));
  PetscCallMPI(MPI_Type_free(&row));
  rows = std::move(arriving);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Sends every point to the rank of its block.
PetscErrorCode send_to_blocks(MPI_Comm comm, long total, int ranks, SavedPoints& points) {
  PetscFunctionBeginUser;
  Traffic t;
  t.to.assign(ranks, 0), t.from.assign(ranks, 0);
  std::vector<int> goes_to(points.id.size()), order(points.id.size());
  for (std::size_t p = 0; p < points.id.size(); ++p)
    ++t.to[goes_to[p] = rank_of_id(points.id[p], total, ranks)];
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return goes_to[a] < goes_to[b]; });
  PetscCallMPI(MPI_Alltoall(t.to.data(), 1, MPI_INT, t.from.data(), 1, MPI_INT, comm));
  t.to_begin = Traffic::begins(t.to), t.from_begin = Traffic::begins(t.from);
  t.received = std::accumulate(t.from.begin(), t.from.end(), 0);
  PetscCall(exchange(comm, MPI_LONG, t, order, 1, points.id));
  PetscCall(exchange(comm, MPI_LONG, t, order, 1, points.address));
  for (SavedField& field : points.fields)
    PetscCall(exchange(comm, MPI_DOUBLE, t, order, field.components, field.values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Rows of `width` numbers in order of id, less those that are there twice.
template <class Number>
void put_in_order(const std::vector<long>& id, const IdBlock& block, int width, std::vector<Number>& rows) {
  std::vector<Number> ordered(std::size_t(block.count) * width);
  for (std::size_t p = 0; p < id.size(); ++p)
    std::copy_n(rows.begin() + p * width, width, ordered.begin() + (id[p] - block.first) * width);
  rows = std::move(ordered);
}

}  // namespace

IdBlock block_of(long total, int rank, int ranks) {
  const long first = total / ranks * rank + std::min<long>(rank, total % ranks);
  return {first, total / ranks + (rank < total % ranks ? 1 : 0), total};
}

PetscErrorCode bring_to_blocks(MPI_Comm comm, long total, long lost, SavedPoints& points, IdBlock* block) {
  PetscFunctionBeginUser;
  PetscMPIInt rank = 0, ranks = 1;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &ranks));
  const auto known = [&](long id) { return id >= 0 && id < total; };
  PetscCheck(std::all_of(points.id.begin(), points.id.end(), known), PETSC_COMM_SELF, PETSC_ERR_PLIB,
             "A particle has a number beyond those of the run, so there is no checkpoint");
  if (ranks > 1) PetscCall(send_to_blocks(comm, total, ranks, points));
  *block = block_of(total, rank, ranks);
  std::vector<char> there(block->count, 0);
  for (const long id : points.id) there[id - block->first] = 1;
  long missing = std::count(there.begin(), there.end(), 0);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &missing, 1, MPI_LONG, MPI_SUM, comm));
  PetscCheck(missing == lost, comm, PETSC_ERR_PLIB, "A particle is on no rank, so there is no checkpoint");
  put_in_order(points.id, *block, 1, points.address);
  for (std::size_t n = 0; n < there.size(); ++n)
    if (there[n] == 0) points.address[n] = -1;
  for (SavedField& field : points.fields) put_in_order(points.id, *block, field.components, field.values);
  points.id.resize(block->count);
  std::iota(points.id.begin(), points.id.end(), block->first);
  PetscFunctionReturn(PETSC_SUCCESS);
}

void leave_out_lost(SavedPoints& points) {
  std::size_t kept = 0;
  for (std::size_t p = 0; p < points.id.size(); ++p) {
    if (points.address[p] == -1) continue;
    points.id[kept] = points.id[p], points.address[kept] = points.address[p];
    for (SavedField& field : points.fields) {
      if (field.values.size() != points.id.size() * field.components) continue;
      const auto row = field.values.begin() + static_cast<long>(p) * field.components;
      std::copy_n(row, field.components, field.values.begin() + static_cast<long>(kept) * field.components);
    }
    ++kept;
  }
  if (kept == points.id.size()) return;
  for (SavedField& field : points.fields) field.values.resize(kept * field.components);
  points.id.resize(kept), points.address.resize(kept);
}

long ids_without_particle(const SavedState& state) {
  double lost = 0;
  for (std::size_t k = 0; k < state.lost.size(); k += k_lost)
    lost += state.lost[k + k_lost_left] + state.lost[k + k_lost_merged];
  return std::lround(lost) + std::accumulate(state.unused.begin(), state.unused.end(), 0L);
}

PetscErrorCode bring_together(MPI_Comm comm, SavedState* state) {
  PetscFunctionBeginUser;
  IdBlock block;
  PetscCall(bring_to_blocks(comm, state->particles, ids_without_particle(*state), state->soil, &block));
  PetscCall(gather_impulse(comm, state->impulse));
  leave_out_lost(state->soil);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode gather_impulse(MPI_Comm comm, SavedImpulse& impulse) {
  PetscFunctionBeginUser;
  PetscMPIInt ranks = 1;
  PetscCallMPI(MPI_Comm_size(comm, &ranks));
  const int own = static_cast<int>(impulse.address.size());
  int numbers = own == 0 ? 0 : static_cast<int>(impulse.values.size() / own);  // of a node
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &numbers, 1, MPI_INT, MPI_MAX, comm));
  std::vector<int> counts(ranks), values(ranks);
  PetscCallMPI(MPI_Allgather(&own, 1, MPI_INT, counts.data(), 1, MPI_INT, comm));
  for (int r = 0; r < ranks; ++r) values[r] = counts[r] * numbers;
  const auto begin = Traffic::begins(counts), values_begin = Traffic::begins(values);
  std::vector<long> address(begin.back() + counts.back());
  std::vector<double> all(address.size() * numbers);
  PetscCallMPI(MPI_Allgatherv(impulse.address.data(), own, MPI_LONG, address.data(), counts.data(),
                              begin.data(), MPI_LONG, comm));
  PetscCallMPI(MPI_Allgatherv(impulse.values.data(), own * numbers, MPI_DOUBLE, all.data(), values.data(),
                              values_begin.data(), MPI_DOUBLE, comm));
  std::vector<int> order(address.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return address[a] < address[b]; });
  impulse = {};
  for (const int n : order) {
    if (!impulse.address.empty() && impulse.address.back() == address[n]) continue;
    impulse.address.push_back(address[n]);
    impulse.values.insert(impulse.values.end(), all.begin() + std::size_t(n) * numbers,
                          all.begin() + std::size_t(n + 1) * numbers);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
