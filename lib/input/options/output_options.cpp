// Results that a run writes, and the checkpoint from which it goes on.

#include <filesystem>

#include "common/text.hpp"
#include "input/options/groups.hpp"
#include "output/frame_fields.hpp"

namespace mpm {
namespace {

/// Reads the options of frames.
void read_frames(OptionReader& in, OutputConfig& output) {
  const auto known = frame_field_names();
  const Option fields{
      .name = "output_fields",
      .meaning = "fields of the frames beside the position; those of bodies are left out of rigids",
      .standard = "all",
      .change = k_at_any_restart};
  const std::string takes = "names of fields: " + frame_field_list();
  std::vector<std::string> names;
  if (in.list_of(fields, takes, names)) {
    output.fields = names;
    for (const auto& name : names)
      if (std::find(known.begin(), known.end(), name) == known.end()) return in.reject(fields.name, takes);
  }
  in.integer({.name = "output_compression",
              .meaning = "level of the compression of frames, 0 for none",
              .unit = "-",
              .range = {.lowest = 0, .highest = 9},
              .change = k_at_any_restart},
             output.compression);
  in.word({.name = "output_nodes",
           .meaning = "on: frames also hold mass and velocity of the nodes, as group nodes",
           .change = k_at_any_restart},
          Words<bool>{{"on", true}, {"off", false}}, output.nodes);
  if (output.frames) return;
  for (const char* name : {"output_fields", "output_compression", "output_nodes"})
    if (in.given(name)) in.warn(name, "is not used, for -output_frames is off");
}

/// Reads when checkpoints are written, and the checkpoint to go on from.
void read_restarts(OptionReader& in, OutputConfig& output) {
  in.number({.name = "checkpoint_interval",
             .meaning = "simulated time between checkpoints, of which the last two are kept",
             .unit = "s",
             .range = k_positive,
             .change = k_always},
            output.checkpoint_interval);
  in.text({.name = "restart",
           .meaning = "checkpoint to go on from, or latest: the last sound one of the output folder",
           .change = k_at_any_restart},
          output.restart);
  if (const auto only = in.where("restart"); true)
    in.list_of({.name = "restart_change",
                .meaning = "what may differ from the checkpoint's run, of the options that may change by it",
                .change = k_at_any_restart},
               "names of options, as gravity,damping", output.restart_change);
  in.number(
      {.name = "wall_time_limit",
       .meaning = "time on the clock after which the run writes a checkpoint and stops with exit status 75",
       .unit = "s",
       .range = k_positive,
       .change = k_at_any_restart},
      output.wall_time_limit);
}

}  // namespace

void read_directory(OptionReader& in, const std::string& options_file, OutputConfig& output) {
  const std::string stem = std::filesystem::path(options_file).stem().string();
  output.directory = "out/" + (stem.empty() ? "mpm" : stem);
  in.text({.name = "output_dir",
           .meaning = "folder of the results",
           .standard = in.listing() ? "out/ and the stem of the options file" : "",
           .change = k_at_any_restart},
          output.directory);
}

void read_output(OptionReader& in, const std::string& options_file, double time_end, OutputConfig& output) {
  in.section("Output");
  output.interval = time_end / 50;
  output.history_interval = time_end / 500;
  const bool listing = in.listing();
  read_directory(in, options_file, output);
  in.word(
      {.name = "output_frames",
       .meaning = "off: no frames of the particles, as for measuring speed or where the disk is too small",
       .change = k_at_any_restart},
      Words<bool>{{"on", true}, {"off", false}}, output.frames);
  read_frames(in, output);
  in.number({.name = "output_interval",
             .meaning = "time between frames",
             .unit = "s",
             .range = k_positive,
             .standard = listing ? "a fiftieth of time_end" : "",
             .change = k_always},
            output.interval);
  in.word({.name = "output_energy",
           .meaning = "on: the history has an energy balance, which takes time in each step"},
          Words<bool>{{"on", true}, {"off", false}}, output.energy);
  in.number({.name = "history_interval",
             .meaning = "time between rows of the history",
             .unit = "s",
             .range = k_positive,
             .standard = listing ? "a five-hundredth of time_end" : "",
             .change = k_always},
            output.history_interval);
  read_restarts(in, output);
  in.word({.name = "output_partition",
           .meaning = "on: partition.csv has, at each frame, the patches of each rank",
           .change = k_at_any_restart},
          Words<bool>{{"on", true}, {"off", false}}, output.partition);
  in.word({.name = "progress",
           .meaning = "auto: a live line on a terminal, else a line each 10 %",
           .change = k_at_any_restart},
          Words<Progress>{{"auto", Progress::automatic}, {"on", Progress::on}, {"off", Progress::off}},
          output.progress);
}

void check_restart_change(OptionReader& in, const Config& config) {
  const std::string option = "restart_change";
  if (!in.listing() && config.output.restart.empty()) return in.not_taken(option, "there is no -restart");
  for (const std::string& name : config.output.restart_change)
    if (!name.empty() && !change_rule(name, config).listed)
      return in.reject(option,
                       "names of options among gravity, damping, those of the mesh's sides, of loads their "
                       "pressure and traction, of rigids their motion, loads and contact, of materials their "
                       "parameters, and the material of a body; " +
                           name + " is none");
}

}  // namespace mpm
