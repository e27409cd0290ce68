#include "parallel/gather.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "common/collectives.hpp"

namespace mpm {
namespace {

/// The numbers of every field of a body, and their widths.
std::vector<std::pair<std::vector<double>*, int>> fields_of(ParticleSnapshot& body) {
  std::vector<std::pair<std::vector<double>*, int>> fields{{&body.grid_velocity, 3}};
  for (const ParticleColumn& column : k_particle_columns)
    if (column.framed != Framed::no && (column.carried != Carried::if_needed || body.has_flow))
      fields.emplace_back(&(body.*column.values), framed_width(column.width));
  for (StateField& state : body.state) fields.emplace_back(&state.values, 1);
  return fields;
}

/// Leaves out the rows that are not there.
void close_gaps(const std::vector<char>& there, int width, std::vector<double>& rows) {
  std::size_t kept = 0;
  for (std::size_t n = 0; n < there.size(); ++n)
    if (there[n] != 0)
      std::copy_n(rows.begin() + static_cast<long>(n) * width, width,
                  rows.begin() + static_cast<long>(kept++) * width);
  rows.resize(kept * width);
}

}  // namespace

PetscErrorCode order_particles(MPI_Comm comm, long total, ParticleSnapshot* body) {
  PetscFunctionBeginUser;
  const int ranks = size_of(comm), rank = rank_of(comm);
  const auto begin = [&](int r) { return total * r / ranks; };
  const std::size_t here = body->id.size();
  std::vector<int> to(here);  // rank of each particle
  for (std::size_t p = 0; p < here; ++p) {
    to[p] = static_cast<int>(body->id[p] * long(ranks) / std::max(total, 1L));
    while (body->id[p] >= begin(to[p] + 1)) ++to[p];
  }
  std::vector<char> there;  // of the ids of this rank: those that have left the run are not
  for (const auto& [values, width] : fields_of(*body)) {  // one at a time: each is there twice then
    const std::size_t row = width * sizeof(double), size = sizeof(double) + row;
    std::vector<std::vector<char>> out(ranks);
    for (std::size_t p = 0; p < here; ++p) {
      const double id = body->id[p];
      const char* const name = reinterpret_cast<const char*>(&id);
      const char* const numbers = reinterpret_cast<const char*>(&(*values)[p * width]);
      out[to[p]].insert(out[to[p]].end(), name, name + sizeof id);
      out[to[p]].insert(out[to[p]].end(), numbers, numbers + row);
    }
    std::vector<char> in;
    PetscCall(exchange_records(comm, size, out, &in));
    std::vector<double>& own = *values;
    own.assign((begin(rank + 1) - begin(rank)) * width, 0);
    there.assign(begin(rank + 1) - begin(rank), 0);
    for (std::size_t at = 0; at < in.size(); at += size) {
      double id = 0;
      std::memcpy(&id, &in[at], sizeof id);
      const std::size_t place = static_cast<std::size_t>(id) - begin(rank);
      there[place] = 1;
      std::memcpy(&own[place * width], &in[at + sizeof id], row);
    }
    close_gaps(there, width, own);
  }
  long counts[2] = {static_cast<long>(std::count(there.begin(), there.end(), 1)), 0};
  PetscCallMPI(MPI_Exscan(&counts[0], &counts[1], 1, MPI_LONG, MPI_SUM, comm));
  body->first = rank == 0 ? 0 : counts[1];
  PetscCallMPI(MPI_Allreduce(&counts[0], &body->total, 1, MPI_LONG, MPI_SUM, comm));
  body->id.clear();
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode gather_nodes(MPI_Comm comm, ParticleSnapshot* nodes) {
  using Record = std::array<double, 8>;  // number, mass, position, velocity
  PetscFunctionBeginUser;
  std::vector<std::vector<char>> out(size_of(comm));
  for (std::size_t n = 0; n < nodes->number.size(); ++n) {
    Record record{nodes->number[n], nodes->mass[n]};
    std::copy_n(&nodes->position[3 * n], 3, &record[2]);
    std::copy_n(&nodes->velocity[3 * n], 3, &record[5]);
    const char* const bytes = reinterpret_cast<const char*>(&record);
    out[0].insert(out[0].end(), bytes, bytes + sizeof record);
  }
  std::vector<char> in;
  PetscCall(exchange_records(comm, sizeof(Record), out, &in));
  std::vector<Record> all(in.size() / sizeof(Record));
  if (!all.empty()) std::memcpy(all.data(), in.data(), in.size());
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  nodes->number.clear(), nodes->mass.clear(), nodes->position.clear(), nodes->velocity.clear();
  for (const Record& record : all) {
    nodes->number.push_back(record[0]), nodes->mass.push_back(record[1]);
    nodes->position.insert(nodes->position.end(), &record[2], &record[2] + 3);
    nodes->velocity.insert(nodes->velocity.end(), &record[5], &record[5] + 3);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
