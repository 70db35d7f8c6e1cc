#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "services/common/building/building.hpp"
#include "tests/evaluation/sensing/fixture_view.hpp"

namespace luminav {

/// What a fixture looks like at the moment.
enum class FixtureLight { kLit, kHalf, kUnlitFaint, kUnlitMedium, kUnlitDark };
/// By the lamp's state and, of an unlit one, by how much darker than its tile it is [grey levels].
FixtureLight light_of(bool burns, bool half, double unlit_darker);

/// Under which circumstances a fixture is in the image.
struct SightingClass {
  static constexpr int kShapes = 3;
  static constexpr int kLights = 5;
  static constexpr int kEnds = 3;    // how many ends are in the image
  static constexpr int kShares = 9;  // of the area that is in the image
  static constexpr int kTurns = 3;   // how fast the robot turns
  static constexpr int kCount = kShapes * kLights * kEnds * kShares * kTurns;

  int shape = 0;
  int light = 0;
  int ends = 0;
  int share = 0;
  int turn = 0;

  [[nodiscard]] int index() const {
    return (((shape * kLights + light) * kEnds + ends) * kShares + share) * kTurns + turn;
  }
  static SightingClass at(int index);
  friend bool operator==(const SightingClass&, const SightingClass&) = default;
};
SightingClass class_of(FixtureShape shape, FixtureLight light, const FixtureView& view, double angular);

/// How far the picture moved from one frame to the next; correlation in time depends on it.
inline constexpr int kMotionClasses = 3;
int motion_class(const Pose2& before, const Pose2& now);

/// One detection of a fixture as it was measured, beside what a detector without error would have said. In the frame of
/// the fixture as imaged, turned such that the end is the far one when only one is in the image.
struct MeasuredSighting {
  double along = 0.0;          // [m] error
  double across = 0.0;         // [m]
  double turn = 0.0;           // [rad]
  double sigma_along = 0.01;   // [m] as reported
  double sigma_across = 0.01;  // [m]
  double sigma_turn = 0.01;    // [rad]
  double correlation = 0.0;    // of across and turn, as reported
  double length = 0.0;         // [m] reported, beyond the stretch that is seen
  double width = 0.0;          // [m] reported, beyond the true one
  double fit = 1.0;
  int state = 0;          // fixture_detection_t::STATE_*
  bool near_end = false;  // reported as visible
  bool far_end = false;
  bool clipped = false;
};

/// A detection where no fixture is, robot frame.
struct MeasuredFalseAlarm {
  Pose2 robot_from_fixture;
  std::array<double, 9> covariance{};
  double length = 0.0;  // [m]
  double width = 0.0;   // [m]
  double fit = 1.0;
  int shape = 0;  // fixture_detection_t::SHAPE_*
  int state = 0;  // fixture_detection_t::STATE_*
  bool near_end = false;
  bool far_end = false;
  bool clipped = false;
};

/// The rendered detector's behaviour as `evaluate --fit-sensing` measures it; geometric sensing draws from it.
class DetectorBehaviour {
 public:
  struct Bin {
    std::int64_t shown = 0;
    std::int64_t seen = 0;
  };

  std::string mode = "modern";
  std::string source;     // which runs it was measured on
  std::string agreement;  // what `--check-sensing` said of it; "" = not checked since it was measured
  std::vector<Bin> bins = std::vector<Bin>(SightingClass::kCount);
  std::vector<std::vector<MeasuredSighting>> sightings =
      std::vector<std::vector<MeasuredSighting>>(SightingClass::kCount);  // by class_of_errors
  std::array<double, kMotionClasses> keep_seen{};   // 0..1 probability that seen or missed is not drawn anew
  std::array<double, kMotionClasses> keep_error{};  // 0..1 the same for the error
  double false_alarms_begin = 0.0;                  // per frame
  double false_alarms_last = 0.0;                   // 0..1 that one is there in the next frame too
  std::vector<MeasuredFalseAlarm> false_alarms;

  /// Chooses for classes that were hardly met the ones most like them. Call it after filling the fields above.
  void prepare();
  [[nodiscard]] double seen_probability(const SightingClass& sighting) const;
  /// Measured errors of such sightings, by size across; never empty when anything was measured.
  [[nodiscard]] const std::vector<MeasuredSighting>& errors(const SightingClass& sighting) const;

  /// Errors are kept for fewer classes than probabilities: unlit is unlit, three shares, no matter how fast it turns.
  static SightingClass class_of_errors(SightingClass sighting);

 private:
  std::vector<int> nearest_bin_;
  std::vector<int> nearest_errors_;
};

/// Throws ConfigurationError for a file that cannot be read or is none of these.
DetectorBehaviour read_detector_behaviour(const std::filesystem::path& file);
std::string to_json(const DetectorBehaviour& behaviour);

}  // namespace luminav
