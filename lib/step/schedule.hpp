#pragma once
// Which step ends when, and at which steps rows and frames are due.

#include <algorithm>
#include <cmath>
#include <limits>

#include "mpm/config.hpp"
#include "step/stepper.hpp"

namespace mpm {

/// Steps until what moves by `increment` a step now, and in each step by `growth` more, has moved by `left`;
/// as if it were steady where it slows down.
inline double steps_to_move(double left, double increment, double growth) {
  if (!(left > 0)) return 0;
  const double faster = std::max(growth, 0.0);
  return 2 * left / std::max(increment + std::sqrt(increment * increment + 2 * faster * left), 1e-300);
}

/// The steps of a run: all of dt but the last, which ends at time_end. Where the step follows the stiffness
/// of the soil, what a schedule says of later steps holds until dt changes.
class Schedule {
 public:
  Schedule() = default;
  Schedule(const TimeConfig& time, const OutputConfig& output, double dt) : Schedule(time, output, dt, {}) {}
  /// From `begin` on with steps of dt.
  struct Begin {
    long step = 0;
    double time = 0;  // s
  };
  Schedule(const TimeConfig& time, const OutputConfig& output, double dt, Begin begin)
      : dt_(dt), end_(time.end), begin_(begin), output_(output) {
    const double left = time.end - begin.time;
    const long whole = static_cast<long>(std::floor(left / dt * (1 + 1e-12)));
    whole_ = begin.step + whole;
    all_ = whole_ + (left - whole * dt > 1e-9 * dt ? 1 : 0);
    last_ = time.max_steps ? std::min(*time.max_steps, all_) : all_;
  }

  Begin begin() const { return begin_; }
  long last_step() const { return last_; }
  /// The last step of full length.
  long last_whole_step() const { return whole_; }
  /// Length of the step that starts after `step` steps [s].
  double step_size(long step) const { return step < whole_ ? dt_ : end_ - start_of(whole_); }
  /// Time after `step` steps [s].
  double time_of(long step) const { return step >= all_ ? end_ : start_of(step); }

  /// `count` steps after `step` steps, which all have the length of the first.
  StepRange range(long step, long count) const {
    const bool whole = step < whole_;
    return {count, time_of(step), step_size(step), whole ? begin_.time : start_of(whole_),
            whole ? step - begin_.step : 0};
  }

  /// Whether a row or a frame is due though the run goes on after this step.
  bool row_in_turn(long step) const { return due(step, output_.history_interval); }
  bool frame_in_turn(long step) const { return due(step, output_.interval); }
  bool raster_in_turn(long step) const {
    return output_.raster_interval && due(step, *output_.raster_interval);
  }
  bool checkpoint_due(long step) const {
    return output_.checkpoint_interval && (step == last_ || due(step, *output_.checkpoint_interval));
  }
  /// The next step after `step` at which a row, a frame, a checkpoint or a look for rasters is due.
  long next_stop(long step) const {
    const auto next_of = [&](const std::optional<double>& interval) {
      return interval ? next(step, *interval) : last_;
    };
    return std::min({last_, next(step, output_.history_interval), next(step, output_.interval),
                     next_of(output_.checkpoint_interval), next_of(output_.raster_interval)});
  }

 private:
  double start_of(long step) const { return begin_.time + (step - begin_.step) * dt_; }
  /// The first step at or after a time.
  long step_at(double time) const {
    return begin_.step + static_cast<long>(std::ceil((std::min(time, 2 * end_) - begin_.time) / dt_ - 1e-9));
  }
  /// The first of them after `step`.
  long next(long step, double interval) const {
    const double multiple = std::floor(start_of(step) / interval * (1 + 1e-12) + 1e-9) + 1;
    return std::max(step_at(multiple * interval), step + 1);
  }
  bool due(long step, double interval) const { return step > 0 && next(step - 1, interval) == step; }

  double dt_ = 1, end_ = 0;
  Begin begin_;
  OutputConfig output_;
  long whole_ = 0, all_ = 0, last_ = 0;
};

}  // namespace mpm
