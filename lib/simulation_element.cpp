// -element_path: the run of a single material point.

#include <cstdio>

#include "common/collectives.hpp"
#include "common/material_table.hpp"
#include "common/text.hpp"
#include "element/drive.hpp"
#include "element/table.hpp"
#include "input/run_options.hpp"
#include "output/files.hpp"
#include "simulation_body.hpp"
#include "step/stepper.hpp"

namespace mpm {
namespace {

PointMaterial material_of(const Config& config) {
  const MaterialConfig& material = config.materials[0];
  return {model_index(material.model), material.parameters, material.object, config.element.height};
}

/// The point as its path starts: state variables that the file gives take the place of the law's own.
DrivenPoint start_of(const Config& config) {
  const ElementConfig& path = config.element;
  DrivenPoint point{.now = point_start(material_of(config), config.dim, path.stress), .time = path.time};
  for (const auto& [k, value] : path.state) point.now.state[k] = value;
  return point;
}

/// Drives the point to the end of its path, or to the row where that fails. The rows of the table.
std::string drive(const Config& config, std::string* failure) {
  const ElementConfig& path = config.element;
  const bool single = config.precision == Precision::single;
  const PointLaw law = point_law(material_of(config), single, config.dim);
  const double tolerance = single ? k_element_tolerance_single : k_element_tolerance_double;
  const auto state = state_variables(config.materials[0]);
  DrivenPoint point = start_of(config);
  std::string rows = element_header(state) + element_line(state, point);
  for (std::size_t n = 0; n < path.rows.size(); ++n) {
    const std::string why = drive_row(law, path.rows[n], path.parts, tolerance, point, path.sums);
    if (!why.empty()) {
      *failure =
          formatted("row %zu of the path (line %ld), time %.9g s: ", n + 1, path.rows[n].line, point.time) +
          why;
      break;
    }
    rows += element_line(state, point);
  }
  return rows;
}

}  // namespace

/// The output folder and the log's first lines.
PetscErrorCode Simulation::Body::open_element() {
  PetscFunctionBeginUser;
  const bool first = rank_of(comm) == 0;
  const std::string& folder = config.output.directory;
  int removed = 0;
  PetscCall(log.start(comm, config.output.progress));
  if (!config.dry_run) {
    PetscCall(agree(comm, first ? make_folder(folder) : PETSC_SUCCESS));
    PetscCall(lock_folder());
    if (!report.errors.empty()) {
      PetscCall(print_errors(comm, report));
      outcome = Outcome::bad_input;
      PetscFunctionReturn(PETSC_SUCCESS);
    }
    PetscCall(agree(comm, first ? prepare_output_folder(folder, &removed, false) : PETSC_SUCCESS));
    PetscCall(place_log_view(report, folder));
    PetscCall(agree(comm, log.open(folder)));
  }
  PetscCall(log.line(format_header(k_version, kokkos_version(), processor_name(), ranks())));
  for (const std::string& warning : report.warnings) PetscCall(log.line(warning));
  if (removed > 0)
    PetscCall(log.print("%d files of an earlier run were removed from %s", removed, folder.c_str()));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// The path on the first rank, and element.csv, which has the rows before a failure.
PetscErrorCode Simulation::Body::drive_element(std::string* failure) {
  PetscFunctionBeginUser;
  PetscErrorCode written = PETSC_SUCCESS;
  if (rank_of(comm) == 0) {
    std::string rows;
    PetscCallCXX(rows = drive(config, failure));
    written = replace_file(config.output.directory + "/element.csv", rows);
  }
  PetscCall(agree(comm, written));
  PetscCall(share_text(comm, failure));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Simulation::Body::run_element() {
  PetscFunctionBeginUser;
  const ElementConfig& path = config.element;
  const std::string& folder = config.output.directory;
  PetscCall(open_element());
  if (outcome != Outcome::finished) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(log.print("a single point of %s (%s), %zu rows of %d parts from %s, in %dD and %s precision",
                      config.materials[0].name.c_str(), config.materials[0].model.c_str(), path.rows.size(),
                      path.parts, path.file.c_str(), config.dim, word_of(config.precision)));
  if (!path.timed)
    PetscCall(
        log.line("the path has no column time or dt: each row takes 1 s, which counts where the law depends "
                 "on the rate"));
  if (config.dry_run) {
    PetscCall(log.line("a dry run: nothing was written"));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(log.line("options in force\n" + format_options(report.options)));
  PetscCall(agree(
      comm, rank_of(comm) == 0 ? write_options_json(folder, k_version, report.options) : PETSC_SUCCESS));
  std::string failure;
  PetscCall(drive_element(&failure));
  if (!failure.empty()) {
    outcome = Outcome::failed;
    PetscCall(log.error("mpm: " + failure));
  }
  PetscCall(log.print("%s; results are in %s", failure.empty() ? "finished" : "failed", folder.c_str()));
  PetscCall(agree(comm, log.close()));
  lock.release();
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
