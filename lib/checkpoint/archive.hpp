#pragma once
// The layout of a checkpoint in HDF5: one list, which the writer and the reader both go through. Each item is
// at once what is written and where it is read to.

#include <algorithm>
#include <string>
#include <vector>

#include "checkpoint/checkpoint.hpp"
#include "common/text.hpp"

namespace mpm {

/// The motion of rigid bodies: numbers that every body has, and those of rotation where a body has turned.
template <class Archive>
void go_through_rigids(Archive& archive, std::vector<SavedRigid>& rigids) {
  using M = MotionTerms;
  struct Range {
    int first, last;
  };
  constexpr Range k_moves[] = {{M::displacement, M::moment}, {M::binned, M::rotation}};
  constexpr Range k_turns[] = {{M::moment, M::binned}, {M::rotation, M::size}};
  const auto gathered = [&](const auto& ranges) {
    std::vector<double> values;
    for (const SavedRigid& rigid : rigids)
      for (const Range& of : ranges)
        values.insert(values.end(), rigid.begin() + of.first, rigid.begin() + of.last);
    return values;
  };
  const auto spread = [&](const auto& ranges, const std::vector<double>& values) {
    auto from = values.begin();
    for (SavedRigid& rigid : rigids)
      for (const Range& of : ranges) {
        std::copy_n(from, of.last - of.first, rigid.begin() + of.first);
        from += of.last - of.first;
      }
  };
  std::vector<double> moves = gathered(k_moves), turns = gathered(k_turns);
  if (std::all_of(turns.begin(), turns.end(), [](double x) { return x == 0; })) turns.clear();
  archive.list("rigids", moves), archive.list_of_some("rigid_rotation", turns);
  constexpr std::size_t k_of_moves = M::moment + M::rotation - M::binned;
  rigids.resize(moves.size() / k_of_moves);
  spread(k_moves, moves);
  if (turns.size() == rigids.size() * (M::size - k_of_moves)) spread(k_turns, turns);
}

/// Goes through all of a checkpoint. An Archive has
///   value(path, number)           a number or text, as an attribute
///   list(path, vector)            numbers that every rank holds whole
///   list_of_some(path, vector)    likewise; a file without the list stands for an empty one
///   text(path, string)            any length
///   points(path, points, block)  a set of points, of which each rank holds a block
/// `soil`: the block of the particles.
template <class Archive>
void go_through(Archive& archive, Checkpoint& c, std::string& options, IdBlock& soil) {
  archive.value("version", c.version), archive.value("dim", c.dim), archive.value("ranks", c.ranks);
  archive.value("backend", c.backend), archive.value("precision", c.precision);
  archive.value("strategy", c.strategy), archive.value("step", c.run.step), archive.value("time", c.run.time);
  archive.value("dt", c.run.dt), archive.value("dt_since", c.run.dt_since);
  archive.value("last_dt", c.run.last_dt);
  archive.value("dt_since_time", c.run.dt_since_time), archive.value("last_row_time", c.run.last_row_time);
  archive.value("wall", c.run.wall), archive.value("stepping", c.run.stepping);
  archive.value("since_rebuild", c.run.rebuilds.since), archive.value("rebuilds", c.run.rebuilds.count);
  archive.value("longest", c.run.rebuilds.longest), archive.value("shortest", c.run.rebuilds.shortest);
  archive.value("history_bytes", c.history.bytes), archive.value("history_crc", c.history.crc);
  archive.value("frames", c.frames);
  archive.value("stage", c.run.stage.index), archive.value("stage_step", c.run.stage.step);
  archive.value("stage_time", c.run.stage.time), archive.value("stage_over", c.run.stage.over);
  archive.value("waves_due", c.run.waves.due), archive.value("waves_every", c.run.waves.every);
  archive.value("waves_speed", c.run.waves.speed);
  archive.list("rigid_zero", c.run.stage.rigid_zero), archive.list("rigid_begin", c.run.stage.rigid_begin);
  archive.value("bound", c.state.bound), archive.value("increment", c.state.increment);
  archive.value("margin", c.state.margin), archive.value("due_in", c.state.due_in);
  archive.text("options", options);

  archive.points("soil", c.state.soil, soil);
  go_through_rigids(archive, c.state.rigids);
  archive.list_of_some("joints", c.state.joints), archive.list_of_some("rigid_supports", c.state.supports);
  archive.value("particles", c.state.particles), archive.list("lost", c.state.lost);
  archive.list("unused", c.state.unused);
  std::string columns = join(c.state.columns), variables = join(c.state.variables, "\n");
  archive.text("columns", columns), archive.text("variables", variables);
  c.state.columns = columns.empty() ? std::vector<std::string>{} : split(columns);
  c.state.variables = split(variables, '\n');
  archive.list("energy", c.state.energy);
  archive.value("alone_known", c.state.alone_known), archive.list("alone", c.state.alone);
  archive.list("bounds", c.state.bounds), archive.list("owners", c.state.owners);
  archive.list("impulse_address", c.state.impulse.address);
  archive.list("impulse", c.state.impulse.values);
  archive.list_of_some("pair_contacts", c.state.pairs.contacts);
  archive.list_of_some("pair_impulses", c.state.pairs.impulses);
  archive.list_of_some("part_impulses", c.state.part_impulses);
  archive.list_of_some("interfaces", c.state.interfaces);
  archive.list("side_kinds", c.state.sides.kinds), archive.list("side_nodes", c.state.sides.values);
  archive.list("side_columns", c.state.sides.columns);
  archive.list("section_lost", c.state.sections), archive.list("section_zero", c.probes.section_zero);
  archive.list("followed", c.probes.followed), archive.list("followed_start", c.probes.start);
  archive.list("raster_depth", c.rasters.most_depth), archive.list("raster_speed", c.rasters.most_speed);
  archive.list("raster_arrival", c.rasters.arrival);
}

/// Options in force as text: a line each of name, value, unit and whether the default holds, by tabulators.
std::string text_of_options(const std::vector<EffectiveOption>& options);
/// False where the text is none.
bool options_of_text(const std::string& text, std::vector<EffectiveOption>& options);

}  // namespace mpm
