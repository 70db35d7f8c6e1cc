#pragma once

#include <cstdint>
#include <lcm/lcm-cpp.hpp>
#include <luminav/fixture_detections_t.hpp>
#include <luminav/sim_truth_t.hpp>
#include <map>
#include <optional>
#include <vector>

#include "drivers/camera/simulated/lighting.hpp"
#include "drivers/simulator/geometry/random_stream.hpp"
#include "tests/evaluation/sensing/detector_behaviour.hpp"

namespace luminav {

/// Camera and detector in one, without pictures: projects the true fixtures through the true camera, as rendering
/// would, and draws from the rendered detector's measured behaviour which of them are reported, with what errors and
/// covariance, and what is reported where nothing is. Frames come when the simulated camera's would. Same truth and
/// seed, same messages. `behaviour` must outlive it.
class GeometricSensing {
 public:
  GeometricSensing(lcm::LCM& lcm, const WorldTruth& world, const Building& believed,
                   const CameraDescription& believed_camera, const DetectorBehaviour& behaviour, std::uint64_t seed);

  /// Publishes the detections of every frame that is due.
  void on_truth(const sim_truth_t& truth);

 private:
  /// What stays the same for a fixture, or not, from one frame to the next.
  struct Luck {
    std::int64_t frame = -1;
    double seen = 0.0;   // 0..1
    double error = 0.0;  // 0..1
  };
  struct FalseAlarm {
    Pose2 world_from_fixture;
    const MeasuredFalseAlarm* measured;
  };

  void publish_frame(double middle);
  void see_fixture(const FixtureView& view, double middle, double angular, int motion);
  void raise_false_alarms(const Pose2& world_from_robot);
  void report(const FixtureView& view, const MeasuredSighting& measured);
  [[nodiscard]] std::optional<Eigen::Vector2d> pixel_of(const Eigen::Vector2d& point, double height) const;

  lcm::LCM& lcm_;
  WorldTruth world_;
  std::vector<Fixture> believed_;
  double ceiling_height_;
  CeilingCamera believed_camera_;
  const DetectorBehaviour& behaviour_;
  CeilingViewer viewer_;
  simulated::CeilingLight light_;
  simulated::TruthBuffer truth_;
  RandomStream random_;
  std::int64_t stamp_offset_;  // [us] from the truth to the stamp of detections
  double frame_time_;          // [us] from the first row to the last
  bool running_ = false;
  double first_middle_ = 0.0;  // [us]
  std::int64_t first_number_ = 0;
  std::int64_t number_ = 0;  // of the next frame
  std::optional<Pose2> last_pose_;
  std::vector<FixtureView> views_;
  std::map<std::size_t, Luck> lucks_;
  std::vector<FalseAlarm> false_alarms_;
  std::vector<simulated::LampState> lamps_;
  fixture_detections_t message_{};
};

}  // namespace luminav
