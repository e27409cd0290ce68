#include "parallel/kept_by_id.hpp"

#include <algorithm>
#include <cstring>

#include "common/collectives.hpp"

namespace mpm {
namespace {

/// A number on its way, and what it belongs to: an id, or the place where it was asked for.
struct Record {
  long of;
  double number;
};
/// Who asks for what.
struct Question {
  long id, place;
  int rank;
};

template <class R>
void put(const R& record, std::vector<char>& to) {
  const char* const bytes = reinterpret_cast<const char*>(&record);
  to.insert(to.end(), bytes, bytes + sizeof record);
}
template <class R, class F>
void for_each_record(const std::vector<char>& bytes, F&& f) {
  for (std::size_t at = 0; at < bytes.size(); at += sizeof(R)) {
    R record;
    std::memcpy(&record, &bytes[at], sizeof record);
    f(record);
  }
}

}  // namespace

PetscErrorCode KeptById::keep(MPI_Comm comm, long total, const std::vector<long>& id,
                              const std::vector<double>& number) {
  PetscFunctionBeginUser;
  const int ranks = size_of(comm);
  comm_ = comm;
  block_ = std::max(1L, (total + ranks - 1) / ranks);
  first_ = block_ * rank_of(comm);
  own_.assign(std::clamp(total - first_, 0L, block_), 0);
  std::vector<std::vector<char>> out(ranks);
  for (std::size_t n = 0; n < id.size(); ++n) {
    if (ranks == 1)
      own_[id[n]] = number[n];
    else
      put(Record{id[n], number[n]}, out[rank_of_block(id[n])]);
  }
  if (ranks == 1) PetscFunctionReturn(PETSC_SUCCESS);
  std::vector<char> in;
  PetscCall(exchange_records(comm, sizeof(Record), out, &in));
  for_each_record<Record>(in, [&](const Record& r) { own_[r.of - first_] = r.number; });
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode KeptById::look_up(const std::vector<long>& id, std::vector<double>* number) const {
  PetscFunctionBeginUser;
  const int ranks = size_of(comm_), rank = rank_of(comm_);
  number->assign(id.size(), 0);
  std::vector<std::vector<char>> out(ranks);
  for (std::size_t n = 0; n < id.size(); ++n) {
    if (ranks == 1)
      (*number)[n] = own_[id[n]];
    else
      put(Question{id[n], static_cast<long>(n), rank}, out[rank_of_block(id[n])]);
  }
  if (ranks == 1) PetscFunctionReturn(PETSC_SUCCESS);
  std::vector<char> in;
  PetscCall(exchange_records(comm_, sizeof(Question), out, &in));
  for (std::vector<char>& answers : out) answers.clear();
  for_each_record<Question>(in, [&](const Question& q) {
    put(Record{q.place, own_[q.id - first_]}, out[q.rank]);
  });
  PetscCall(exchange_records(comm_, sizeof(Record), out, &in));
  for_each_record<Record>(in, [&](const Record& r) { (*number)[r.of] = r.number; });
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
