#pragma once
// The exchange of nodal values between ranks, through PetscSF on lists of owners.

#include <petscsf.h>

#include <vector>

namespace mpm {

/// Sends each neighbour its entries and receives as many from it: entry n of the receive buffer is the
/// neighbour's value of the node of entry n of the send buffer.
class NodeExchange {
 public:
  NodeExchange() = default;
  NodeExchange(const NodeExchange&) = delete;
  NodeExchange& operator=(const NodeExchange&) = delete;
  ~NodeExchange();

  /// Collective on comm. begin: first entry of each neighbour, and the number of all entries.
  PetscErrorCode set_up(MPI_Comm comm, const std::vector<int>& neighbours, const std::vector<int>& begin);
  /// Starts and ends an exchange of `width` values of type `real` an entry.
  PetscErrorCode start(MPI_Datatype real, int width, const void* out, void* in);
  PetscErrorCode finish();

 private:
  PetscErrorCode unit_of(MPI_Datatype real, int width, MPI_Datatype* unit);

  struct Unit {
    MPI_Datatype real;
    int width;
    MPI_Datatype type;
  };
  PetscSF sf_ = nullptr;
  std::vector<Unit> units_;
  MPI_Datatype under_way_ = MPI_DATATYPE_NULL;
  const void* out_ = nullptr;
  void* in_ = nullptr;
};

}  // namespace mpm
