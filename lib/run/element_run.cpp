#include "run/element_run.hpp"

#include "common/material_table.hpp"
#include "common/text.hpp"
#include "element/drive.hpp"
#include "element/table.hpp"
#include "input/deck/run_options.hpp"
#include "output/files.hpp"
#include "run/setup.hpp"
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

/// The output folder and the log's first lines.
PetscErrorCode open_element(Job& job) {
  PetscFunctionBeginUser;
  Log& log = job.log;
  const Config& config = job.config;
  const bool first = job.is_first();
  const std::string& folder = config.output.directory;
  int removed = 0;
  PetscCall(log.start(job.comm, config.output.progress));
  if (!config.dry_run) {
    PetscCall(take_folder(job));
    if (!job.goes_well()) PetscFunctionReturn(PETSC_SUCCESS);
    PetscCall(agree(job.comm, first ? prepare_output_folder(folder, &removed, false) : PETSC_SUCCESS));
    PetscCall(place_log_view(job.report, folder));
    PetscCall(agree(job.comm, log.open(folder)));
  }
  PetscCall(log.line(format_header(k_version, kokkos_version(), processor_name(), job.ranks())));
  for (const std::string& warning : job.report.warnings) PetscCall(log.line(warning));
  if (removed > 0)
    PetscCall(log.print("%d files of an earlier run were removed from %s", removed, folder.c_str()));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// The path on the first rank, and element.csv, which has the rows before a failure.
PetscErrorCode drive_element(const Job& job, std::string* failure) {
  PetscFunctionBeginUser;
  PetscErrorCode written = PETSC_SUCCESS;
  if (job.is_first()) {
    std::string rows;
    PetscCallCXX(rows = drive(job.config, failure));
    written = replace_file(job.config.output.directory + "/element.csv", rows);
  }
  PetscCall(agree(job.comm, written));
  PetscCall(share_text(job.comm, failure));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace

PetscErrorCode run_element(Job& job) {
  PetscFunctionBeginUser;
  Log& log = job.log;
  const Config& config = job.config;
  const ElementConfig& path = config.element;
  const std::string& folder = config.output.directory;
  PetscCall(open_element(job));
  if (job.outcome != Outcome::finished) PetscFunctionReturn(PETSC_SUCCESS);
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
  PetscCall(log.line("options in force\n" + format_options(job.report.options)));
  PetscCall(agree(
      job.comm, job.is_first() ? write_options_json(folder, k_version, job.report.options) : PETSC_SUCCESS));
  std::string failure;
  PetscCall(drive_element(job, &failure));
  if (!failure.empty()) {
    job.outcome = Outcome::failed;
    PetscCall(log.error("mpm: " + failure));
  }
  PetscCall(log.print("%s; results are in %s", failure.empty() ? "finished" : "failed", folder.c_str()));
  PetscCall(agree(job.comm, log.close()));
  job.lock.release();
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
