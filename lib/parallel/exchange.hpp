#pragma once
// The exchange of nodal values between ranks by MPI, through PetscSF on lists of owners, or by messages from
// and to a device's memory, which a PetscSF without CUDA cannot use.

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

  /// Collective on comm. begin: first entry of each neighbour, and the number of all entries; by_sf: for
  /// start and finish.
  PetscErrorCode set_up(MPI_Comm comm, const std::vector<int>& neighbours, const std::vector<int>& begin,
                        bool by_sf);
  /// Where this rank's entries begin in each neighbour's buffer.
  const std::vector<int>& there() const { return there_; }
  /// Starts and ends an exchange of `width` values of type `real` an entry.
  PetscErrorCode start(MPI_Datatype real, int width, const void* out, void* in);
  PetscErrorCode finish();
  /// The exchange by one message to each neighbour.
  PetscErrorCode start_messages(MPI_Datatype real, int width, const void* out, void* in);
  PetscErrorCode finish_messages();

 private:
  PetscErrorCode make_sf(MPI_Comm comm);
  PetscErrorCode unit_of(MPI_Datatype real, int width, MPI_Datatype* unit);

  struct Unit {
    MPI_Datatype real;
    int width;
    MPI_Datatype type;
  };
  MPI_Comm comm_ = MPI_COMM_NULL;
  std::vector<int> neighbours_, begin_, there_;
  std::vector<MPI_Request> requests_;
  PetscSF sf_ = nullptr;
  std::vector<Unit> units_;
  MPI_Datatype under_way_ = MPI_DATATYPE_NULL;
  const void* out_ = nullptr;
  void* in_ = nullptr;
};

}  // namespace mpm
