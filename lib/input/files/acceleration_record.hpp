#pragma once
// Velocities from a record of accelerations, with the drift of its baseline taken out.

#include <string>

#include "mpm/config.hpp"

namespace mpm {

/// Correction of the velocities that a record integrates to: none; less a straight line, so that the
/// velocity ends at zero; or less a parabola, so that the displacement ends at zero too.
enum class BaselineCorrection { none, linear, quadratic };

/// Velocity and displacement at the end of a record, and its largest accelerations by size.
struct RecordFigures {
  Vec3 velocity{}, displacement{}, largest{};  // m/s, m, m/s2
};

/// A record, integrated from rest at its first point.
struct IntegratedRecord {
  TimeTable velocities;  // m/s, straight between its points, which may be closer than those of the record
  RecordFigures before, after;
};

/// Integrates a table of accelerations [m/s2] exactly at its points. Between them the straight lines of the
/// result are within 1e-4 of the largest velocity.
IntegratedRecord integrate(const TimeTable& accelerations, BaselineCorrection correction);

/// The figures of a record in words, for the log.
std::string report_of(const IntegratedRecord& record, BaselineCorrection correction, int dim);

}  // namespace mpm
