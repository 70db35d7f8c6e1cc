#include "tests/evaluation/detector_score/luminaire_scenes.hpp"

#include <fmt/format.h>

#include <cmath>
#include <tuple>

#include "drivers/simulator/geometry/random_stream.hpp"
#include "drivers/simulator/world/scenario.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "tests/evaluation/detector_score/score_stage.hpp"

namespace luminav::score {
namespace {

using simulated::LampState;
using Kind = LuminaireKind;

constexpr double kClutterRoom = 3.7;  // [m] from a thing to the lamps around it
constexpr int kSide = 5;              // luminaires in a row and in a column

Fixture fixture_like(FixtureShape shape, double length, double width, int lamps, double below = 0.0) {
  return {.id = 0,
          .shape = shape,
          .world_from_fixture = {},
          .length = length,
          .width = width,
          .height = below,
          .lamps = lamps};
}

std::vector<LuminaireScene> luminaires_lit() {
  constexpr auto kLong = FixtureShape::kRectangle;
  constexpr auto kSquare = FixtureShape::kSquare;
  constexpr auto kRound = FixtureShape::kRound;
  const auto scene = [](const char* name, Kind kind, const Fixture& like) {
    LuminaireScene made;
    made.name = name;
    made.kind = kind;
    made.like = like;
    return made;
  };
  std::vector<LuminaireScene> all{
      scene("louvre, two tubes", Kind::kLouvre, fixture_like(kLong, 1.2, 0.3, 2)),
      scene("louvre, three tubes", Kind::kLouvre, fixture_like(kSquare, 0.6, 0.6, 3)),
      scene("louvre, four tubes", Kind::kLouvre, fixture_like(kSquare, 0.6, 0.6, 4)),
      scene("louvres end to end", Kind::kLouvre, fixture_like(kLong, 1.2, 0.3, 2)),
      scene("batten, one tube", Kind::kBatten, fixture_like(kLong, 1.2, 0.06, 1)),
      scene("batten, two tubes", Kind::kBatten, fixture_like(kLong, 1.2, 0.14, 2)),
      scene("battens end to end", Kind::kBatten, fixture_like(kLong, 1.2, 0.06, 1)),
      scene("opal panel", Kind::kOpal, fixture_like(kSquare, 0.6, 0.6, 1)),
      scene("opal panel, framed", Kind::kOpalFramed, fixture_like(kLong, 1.2, 0.3, 2)),
      scene("prismatic cover", Kind::kPrismatic, fixture_like(kLong, 1.2, 0.3, 2)),
      scene("linear pendant", Kind::kPendant, fixture_like(kLong, 1.2, 0.15, 1, 0.4)),
      scene("downlight", Kind::kDownlight, fixture_like(kRound, 0.2, 0.2, 1)),
      scene("high bay", Kind::kHighBay, fixture_like(kRound, 0.45, 0.45, 1, 0.5)),
  };
  for (LuminaireScene& made : all) {
    if (made.name.ends_with("end to end")) {
      made.pitch_x = made.like.length;
    }
    if (made.kind == Kind::kHighBay) {
      made.ceiling = 5.5;
      made.pitch_x = made.pitch_y = 3.0;
    }
  }
  return all;
}

Building ceiling_of(const LuminaireScene& scene) {
  Building building;
  building.name = scene.name;
  building.ceiling_height = scene.ceiling;
  if (scene.is_clutter) {  // lamps of the kinds that the detector looks for light the ceiling from beyond the view
    constexpr int kAround = 16;
    for (int i = 0; i < kAround; ++i) {
      const double angle = 2.0 * kPi * i / kAround;
      Fixture fixture = fixture_like(FixtureShape::kRectangle, 1.2, i % 2 == 0 ? 0.3 : 0.15, i % 2 == 0 ? 2 : 1);
      fixture.id = i + 1;
      fixture.height = scene.ceiling;
      fixture.world_from_fixture = {kClutterRoom * std::cos(angle), kClutterRoom * std::sin(angle), 0.0};
      building.fixtures.push_back(fixture);
    }
    return building;
  }
  for (int i = 0; i < kSide * kSide; ++i) {
    Fixture fixture = scene.like;
    fixture.id = i + 1;
    fixture.height = scene.ceiling - scene.like.height;
    fixture.world_from_fixture = {scene.pitch_x * (i % kSide - 2), scene.pitch_y * (i / kSide - 2), 0.0};
    building.fixtures.push_back(fixture);
  }
  return building;
}

void score_world(const DetectorScoreOptions& options, const LuminaireScene& scene, int world,
                 const FrameListener& listener, DetectorScore& score) {
  const std::uint64_t seed = options.first_seed + static_cast<std::uint64_t>(world);
  const RobotDescription robot = read_robot(read_scenario(options.scenario).robot_file);
  const WorldSpread spread;
  RandomStream random(seed, "luminaires " + scene.name + scene.state);
  simulated::CeilingModel model;
  model.building = ceiling_of(scene);
  model.intrinsics = robot.camera.intrinsics;
  model.mounting = robot.camera.mounting;
  model.grey_noise = spread.grey_noise;
  model.luminaires.assign(model.building.fixtures.size(), scene.kind);
  model.seed = seed;
  for (std::size_t i = 0; i < model.building.fixtures.size(); ++i) {
    model.unlit_darker.push_back(random.uniform(spread.min_unlit_darker, spread.max_unlit_darker));
  }
  if (scene.is_clutter) {
    model.clutter.push_back({.kind = scene.clutter.kind,
                             .world_from_item = {},
                             .length = scene.clutter.length,
                             .width = scene.clutter.width,
                             .height = scene.ceiling - scene.clutter.below});
  }
  DetectorParams params;
  params.mode = options.mode;
  const std::vector<LampState> lamps(model.building.fixtures.size(), scene.lamp);
  ScoreStage stage(model, params, robot.camera, model.building, lamps);
  for (int frame = 0; frame < options.frames; ++frame) {
    Place place;
    place.daylight = scene.daylight;
    const double reach = scene.is_clutter ? 0.8 : 0.5;
    place.motion.world_from_robot = {random.uniform(-reach, reach) * (scene.is_clutter ? 1.0 : scene.pitch_x),
                                     random.uniform(-reach, reach) * (scene.is_clutter ? 1.0 : scene.pitch_y),
                                     random.uniform(-kPi, kPi)};
    simulated::Exposure exposure;
    exposure.number = static_cast<std::uint64_t>(frame);
    stage.score_frame(fmt::format("{}_{}_{}_{}", scene.name, scene.state, seed, frame), place, 1.0, exposure,
                      options.jpeg, listener, score);
  }
}

}  // namespace

const std::vector<LuminaireScene>& luminaire_scenes() {
  static const std::vector<LuminaireScene> all = [] {
    std::vector<LuminaireScene> scenes;
    for (const LuminaireScene& lit : luminaires_lit()) {
      for (const auto& [state, lamp, daylight] :
           {std::tuple("lit", LampState::kOn, 0.3), {"half", LampState::kHalf, 0.3}, {"off", LampState::kOff, 0.8}}) {
        scenes.push_back(lit);
        scenes.back().state = state;
        scenes.back().lamp = lamp;
        scenes.back().daylight = daylight;
      }
    }
    for (const simulated::UsualClutter& usual : simulated::usual_clutter()) {
      LuminaireScene& scene = scenes.emplace_back();
      scene.name = usual.name;
      scene.state = "by day";
      scene.daylight = 0.6;
      scene.is_clutter = true;
      scene.clutter = usual;
    }
    return scenes;
  }();
  return all;
}

DetectorScore score_scene(const DetectorScoreOptions& options, const LuminaireScene& scene,
                          const FrameListener& listener) {
  DetectorScore score;
  for (int world = 0; world < options.worlds; ++world) {
    score_world(options, scene, world, listener, score);
  }
  return score;
}

}  // namespace luminav::score
