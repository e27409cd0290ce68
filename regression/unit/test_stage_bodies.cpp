// Bodies that stages place and remove, and soil whose law changes.

#include <catch2/catch_approx.hpp>
#include <catch2/catch_test_macros.hpp>
#include <cmath>

#include "check/overlap.hpp"
#include "common/text.hpp"
#include "input/geometry/shapes.hpp"
#include "input/options/groups.hpp"
#include "input/options/options.hpp"
#include "step/present_rigids.hpp"
#include "step/state_map.hpp"

using namespace mpm;

namespace {

const std::string k_deck =
    "-mesh_lower 0,0 -mesh_upper 8,6 -mesh_spacing 0.5 -time_end 1 -materials clay,cured -clay_model "
    "von_mises "
    "-clay_density 1500 -clay_young 1e6 -clay_poisson 0.3 -clay_su 1000 -cured_model linear_elastic "
    "-cured_density 1700 -cured_young 4e6 -cured_poisson 0.3 -bodies soil,fill -soil_material clay "
    "-soil_shape box "
    "-soil_lower 0,0 -soil_upper 8,2 -fill_material clay -fill_shape box -fill_lower 2,2 -fill_upper 6,3 "
    "-rigid_bodies plate -plate_shape box -plate_lower 3,4 -plate_upper 5,5 -stages one,two,three ";

InputReport read(const std::string& options) {
  Config config;
  InputReport report;
  REQUIRE(PetscOptionsClear(nullptr) == PETSC_SUCCESS);
  REQUIRE(PetscOptionsInsertString(nullptr, (k_deck + options).c_str()) == PETSC_SUCCESS);
  REQUIRE(read_options(nullptr, {Backend::serial}, config, report) == PETSC_SUCCESS);
  REQUIRE(PetscOptionsClear(nullptr) == PETSC_SUCCESS);
  return report;
}

Config stage_of(const InputReport& report, int stage) {
  INFO(join(report.errors, "\n"));
  REQUIRE(report.errors.empty());
  return report.stages.at(stage).config;
}

/// Two particles of each body of a configuration, at rest under a stress.
SavedState state_of(const Config& config, const std::vector<std::string>& columns,
                    const std::vector<std::string>& variables) {
  SavedState state;
  const std::size_t bodies = config.bodies.size(), count = 2 * bodies;
  state.columns = columns, state.variables = variables;
  state.unused.resize(bodies), state.lost.resize(bodies * k_lost);
  const auto field = [&](const char* name, int components, double value) {
    state.soil.fields.push_back({name, components, 8, std::vector<double>(count * components, value)});
  };
  field("coordinate", 2, 0.25), field("stress", 4, -1000);
  for (const std::string& column : columns) field(column.c_str(), 1, 7);
  field("body", 1, 0), field("reference_height", 1, 1.5);
  for (std::size_t p = 0; p < count; ++p) {
    state.soil.id.push_back(static_cast<long>(p)), state.soil.address.push_back(8 * 64);
    state.soil.fields[2 + columns.size()].values[p] = static_cast<double>(p / 2);
  }
  return state;
}

const std::vector<double>& values_of(const SavedState& state, const std::string& name) {
  for (const SavedField& field : state.soil.fields)
    if (field.name == name) return field.values;
  FAIL("no field " << name);
  return state.soil.fields[0].values;
}

}  // namespace

TEST_CASE("a stage places what the stages before do not have", "[stage_bodies]") {
  const InputReport report = read("-two_place fill,plate -three_remove plate");
  const Config one = stage_of(report, 0), two = stage_of(report, 1), three = stage_of(report, 2);
  CHECK((!one.bodies[0].absent && one.bodies[1].absent && one.rigids[0].absent));
  CHECK((two.bodies[0].from_before && !two.bodies[1].absent && !two.bodies[1].from_before));
  CHECK((two.stage.place == std::vector<int>{1} && two.stage.place_rigids == std::vector<int>{0}));
  CHECK((!two.rigids[0].absent && three.rigids[0].absent && three.bodies[1].from_before));
  CHECK(three.stage.remove_rigids == std::vector<int>{0});
}

TEST_CASE("soil keeps the density that it was created with", "[stage_bodies]") {
  const InputReport report = read("-two_soil_material cured -three_soil_material cured -three_place fill");
  const Config two = stage_of(report, 1), three = stage_of(report, 2);
  CHECK(density_of(stage_of(report, 0), two.bodies[0]) == 1500);
  CHECK((density_of(two, two.bodies[0]) == 1500 && density_of(three, three.bodies[0]) == 1500));
  CHECK(changed_laws(report.stages[0].config, two)[0] == 1);
  CHECK(changed_laws(two, three)[0] == 0);
  CHECK(changed_laws(report.stages[0].config, stage_of(read("-two_clay_su 2e3"), 1))[0] == 1);
}

TEST_CASE("what stages place is checked against each other", "[stage_bodies]") {
  const auto errors_of = [](const std::string& options) { return join(read(options).errors, "\n"); };
  CHECK(errors_of("-two_place fill -three_place fill").find("no earlier stage places") != std::string::npos);
  CHECK(errors_of("-two_remove fill -three_place fill").find("not removed before") != std::string::npos);
  CHECK(errors_of("-two_place soil,fill").find("the first stage has no soil") != std::string::npos);
  CHECK(errors_of("-three_place plate -two_end displacement -two_end_rigid plate -two_end_displacement 1")
            .find("in the run in this stage") != std::string::npos);
  CHECK(errors_of("-two_clay_density 1600").find("may not change at a stage") != std::string::npos);
  CHECK(errors_of("-two_clay_young 2e6 -two_clay_poisson 0.2").empty());
}

TEST_CASE("what a stage places meets the soil where it has moved to", "[stage_bodies]") {
  Config two = stage_of(read("-two_place fill"), 1);
  Present present{std::vector<std::vector<double>>(2), std::vector<Vec3>(1)};
  const auto fill_soil = [&](double top) {  // particles of the ground, a quarter of a metre apart
    present.soil[0].clear();
    for (double y = top - 0.125; y > 0; y -= 0.25)
      for (double x = 0.125; x < 8; x += 0.25) present.soil[0].insert(present.soil[0].end(), {x, y});
  };
  const auto overlap = [&] {
    std::vector<Overlap> found;
    REQUIRE(find_overlaps_at_stage(PETSC_COMM_SELF, two, present, &found) == PETSC_SUCCESS);
    return found.empty() ? 0.0 : found[0].volume;
  };
  fill_soil(2.0);
  CHECK(overlap() == 0);
  fill_soil(2.2);  // less than a particle
  CHECK(overlap() == 0);
  fill_soil(2.5);
  CHECK(overlap() == Catch::Approx(4 * 0.5).epsilon(0.05));
  two.bodies[1].cut_out_bodies = {0};
  CHECK(overlap() == 0);
  std::vector<double> fill;
  for (double y = 2.125; y < 3; y += 0.25)
    for (double x = 2.125; x < 6; x += 0.25) fill.insert(fill.end(), {x, y});
  const auto cut = cut_at_stage(two, 1, present, fill);
  CHECK(std::count(cut.begin(), cut.end(), 1) == 2 * 16);
}

TEST_CASE("a rigid body that has moved is met where it is", "[stage_bodies]") {
  Config two = stage_of(read("-two_place fill -plate_motion prescribed -plate_velocity 0,-1"), 1);
  Present present{std::vector<std::vector<double>>(2), {{0, -1.5, 0}}};
  std::vector<Overlap> found;
  REQUIRE(find_overlaps_at_stage(PETSC_COMM_SELF, two, present, &found) == PETSC_SUCCESS);
  REQUIRE(found.size() == 1);
  CHECK(found[0].volume == Catch::Approx(2 * 0.5).epsilon(0.1));
  two.bodies[1].cut_out = {0};
  const auto cut = cut_at_stage(two, 1, present, {4.0, 2.3, 4.0, 2.7, 2.5, 2.7});
  CHECK(cut == std::vector<char>{0, 1, 0});
  found.clear();
  REQUIRE(find_overlaps_of_placed(PETSC_COMM_SELF, two, {1}, &found) == PETSC_SUCCESS);
  CHECK(found.empty());  // as it was placed it is above the fill
}

TEST_CASE("rigid bodies that are not there leave no number in a state and come back", "[stage_bodies]") {
  Config config;
  config.rigids.resize(3);
  for (int r = 0; r < 3; ++r) config.rigids[r].name = std::string(1, static_cast<char>('a' + r));
  config.rigids[1].absent = true;
  PresentRigids present(config);
  CHECK(present.narrowed(config).rigids.size() == 2);
  constexpr int of_rigid = MotionTerms::impulse_size;
  SavedState state;
  for (int r = 0; r < 3; ++r) state.rigids.push_back({r + 1.0, 0, 0});
  state.impulse.address = {64, 65};
  for (int k = 1; k <= 6 * ImpulseTerms::size; ++k) state.impulse.values.push_back(k);
  for (int rank = 0; rank < 2; ++rank)
    for (int k = 0; k < k_saved_bounds + 3 * of_rigid; ++k) state.bounds.push_back(100 * rank + k);
  const SavedState whole = state;
  present.narrow(state);
  CHECK((state.rigids.size() == 2 && state.rigids[1][MotionTerms::displacement] == 3));
  CHECK(state.impulse.values == std::vector<double>{1, 2, 3, 7, 8, 9, 10, 11, 12, 16, 17, 18});
  REQUIRE(state.bounds.size() == 2 * (k_saved_bounds + 2 * of_rigid));
  CHECK(state.bounds[2 * k_saved_bounds + 3 * of_rigid] == 100 + k_saved_bounds + 2 * of_rigid);
  present.widen(state);
  CHECK((state.rigids.size() == 3 && state.rigids[1][MotionTerms::displacement] == 2));
  CHECK(state.impulse.values ==
        std::vector<double>{1, 2, 3, 0, 0, 0, 7, 8, 9, 10, 11, 12, 0, 0, 0, 16, 17, 18});
  CHECK(state.bounds.size() == whole.bounds.size());
  std::vector<RigidRow> rows(2);
  rows[1].force[0] = 5;
  present.widen(rows);
  CHECK((rows.size() == 3 && rows[1].displacement[0] == 2 && rows[1].force[0] == 0 && rows[2].force[0] == 5));
}

TEST_CASE("a new law takes the variables that both have, and begins the others", "[stage_bodies]") {
  const InputReport report = read(
      "-clay_su_gradient 100 -clay_su_datum 2 -two_clay_su 3e3 -two_fill_material cured "
      "-two_cured_pore_stiffness 1e7");
  const Config one = stage_of(report, 0), two = stage_of(report, 1);
  SavedState state =
      state_of(one, {"plastic_strain", "strength"}, {"plastic_strain,strength", "plastic_strain,strength"});
  const SavedState fresh =
      state_of(two, {"plastic_strain", "strength", "excess_pore_pressure"}, {"plastic_strain,strength", ""});
  CHECK(map_state(two, changed_laws(one, two), fresh, state).empty());
  CHECK(values_of(state, "stress") == std::vector<double>(16, -1000));
  const std::vector<double> strain = values_of(state, "plastic_strain");
  CHECK((strain.size() == 4 && strain[0] == 7 && strain[1] == 7));
  CHECK((strain[2] == 0 && strain[3] == 0));                                  // elastic soil has none
  CHECK(values_of(state, "strength")[0] == Catch::Approx(3000 + 100 * 0.5));  // by the reference height
  CHECK(values_of(state, "excess_pore_pressure") == std::vector<double>(4, 0.0));
}

TEST_CASE("pores that begin to drain leave the effective stress", "[stage_bodies]") {
  const InputReport report = read("-clay_pore_stiffness 1e7 -two_clay_pore_stiffness 0");
  const Config one = stage_of(report, 0), two = stage_of(report, 1);
  SavedState state = state_of(one, {"plastic_strain", "strength", "excess_pore_pressure"},
                              {"plastic_strain,strength", "plastic_strain,strength"});
  const SavedState fresh =
      state_of(two, {"plastic_strain", "strength"}, {"plastic_strain,strength", "plastic_strain,strength"});
  CHECK(map_state(two, changed_laws(one, two), fresh, state).empty());
  CHECK((values_of(state, "stress")[0] == -993 && values_of(state, "stress")[2] == -993));
  CHECK(values_of(state, "stress")[3] == -1000);  // shear
}

TEST_CASE("soil that a law cannot start from is reported with its place", "[stage_bodies]") {
  const InputReport report = read(
      "-materials clay,cured,cam -cam_model cam_clay -cam_density 1500 -cam_critical_state_ratio 1 "
      "-cam_lambda 0.1 "
      "-cam_kappa 0.02 -cam_poisson 0.3 -cam_specific_volume 2 -cam_ocr 1.5 -two_soil_material cam");
  const Config one = stage_of(report, 0), two = stage_of(report, 1);
  SavedState state =
      state_of(one, {"plastic_strain", "strength"}, {"plastic_strain,strength", "plastic_strain,strength"});
  const SavedState fresh =
      state_of(two, {"column_0", "column_1", "column_2", "column_3", "column_4"},
               {"preconsolidation,specific_volume,parted_volume", "plastic_strain,strength"});
  for (SavedField& field : state.soil.fields)
    if (field.name == "stress") field.values.assign(16, 1000);  // tension
  CHECK(map_state(two, changed_laws(one, two), fresh, state).find("the particle of body soil at") == 0);
}

TEST_CASE("particles that join keep their ids", "[stage_bodies]") {
  const Config two = stage_of(read("-two_place fill"), 1);
  const std::vector<std::string> columns = {"plastic_strain", "strength"},
                                 both = {"plastic_strain,strength", "plastic_strain,strength"};
  SavedState state = state_of(two, columns, both);
  const SavedState fresh = state_of(two, columns, both);
  state.soil.id.resize(2), state.soil.address.resize(2);  // of the ground alone
  for (SavedField& field : state.soil.fields) field.values.resize(2 * field.components);
  state.unused = {0, 2};
  add_bodies({1}, fresh, state);
  CHECK(state.soil.id == std::vector<long>{0, 1, 2, 3});
  CHECK(state.unused == std::vector<long>{0, 0});
  CHECK(values_of(state, "body") == std::vector<double>{0, 0, 1, 1});
}
