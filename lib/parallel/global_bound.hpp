#pragma once
// The movement bound over all ranks. Each step posts a nonblocking reduction, which a later step ends. The
// bound of the other ranks is therefore some steps old, and a reserve in the margin covers these steps.

#include <petscsys.h>

#include <array>
#include <optional>

namespace mpm {

/// The report of a rank on its last step.
struct BoundReport {
  double bound = 0;      // cells, that any point can have moved since the last rebuild
  double increment = 0;  // cells, of the last step
  double stopped = 0;    // 1: a rank does no more steps: its bound passed the margin, or there is a fault
};

class GlobalBound {
 public:
  /// Steps between what a report says and the step that it decides on: the report posted in a step is of the
  /// step before the last one, whose end nobody has to wait for, and is read one step later.
  static constexpr int k_late = 3;

  GlobalBound() = default;
  GlobalBound(const GlobalBound&) = delete;
  GlobalBound& operator=(const GlobalBound&) = delete;

  /// Starts the reduction of this rank's report.
  PetscErrorCode post(MPI_Comm comm, const BoundReport& own);
  /// Ends the reduction of the last report but one; `known`: whether there is such a report. The bound is the
  /// sum of the largest increments, as on one rank; without a step since the lists were built it is 0.
  PetscErrorCode last_but_one(bool* known, BoundReport* all);
  /// The last report of this rank, if its reduction is under way.
  std::optional<BoundReport> pending() const {
    const Reduction& r = reductions_[last_];
    if (!r.posted) return std::nullopt;
    return BoundReport{r.own[0], r.own[1], r.own[2]};
  }
  /// The sum of the largest increments since the lists were built, as far as reports have arrived.
  double sum() const { return sum_; }
  void set_sum(double sum) { sum_ = sum; }
  /// Steps to a rebuild that was already due in the checkpoint of a restart; 0: none.
  int due_in() const { return due_in_; }
  void set_due_in(int steps) { due_in_ = steps; }
  /// Call it once a step. Whether that rebuild is due now.
  bool count_down() { return due_in_ > 0 && --due_in_ == 0; }
  /// Ends all reductions under way.
  PetscErrorCode drain();
  /// The largest report of all ranks now; waits for them.
  static PetscErrorCode now(MPI_Comm comm, BoundReport* report);

 private:
  struct Reduction {
    std::array<double, 3> own{}, all{};
    MPI_Request request = MPI_REQUEST_NULL;
    bool posted = false;
  };
  std::array<Reduction, 2> reductions_;
  int last_ = 0;
  double sum_ = 0;  // cells
  int due_in_ = 0;
};

}  // namespace mpm
