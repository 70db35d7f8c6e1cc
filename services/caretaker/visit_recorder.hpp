#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <vector>

#include "services/caretaker/fixture_visit.hpp"
#include "services/common/ceiling/ceiling_view.hpp"
#include "services/common/ceiling/fixture_map.hpp"
#include "services/common/ceiling/odometry_history.hpp"

namespace luminav {

/// A pose of the robot in the world, as POSE has it.
struct KnownPose {
  OdometryReading reading;  // its pose is world_from_robot
  bool is_sure = false;     // TRACKING, and known well enough to say where a fixture hangs
};

/// What an image showed, and how light it was.
struct LookedAtFrame {
  SightingFrame frame;
  double grey = 0.0;  // 0..255 median of the image
};

struct VisitParams {
  double margin = 0.10;      // [m] to the border of the view, within which a fixture ought to be seen
  double max_offset = 0.60;  // [m] beside its place, beyond which a fixture is another one
  double absence = 2.0;      // [s] out of view that ends a visit
  double max_time = 600.0;   // [s] of a visit below which a robot parks
  int min_images = 5;        // fewer say nothing
};

/// Divides a drive into visits: which fixtures of the building were in view, how they looked, and what hung there that
/// the building's file does not have. Poses and frames come in the order of their stamps, each stream by itself.
class VisitRecorder {
 public:
  /// A visit that is over, by index of the fixture.
  struct Result {
    std::vector<std::pair<int, FixtureVisit>> fixtures;
    std::vector<StrangerVisit> strangers;
  };

  VisitRecorder(const CameraDescription& camera, std::vector<Fixture> fixtures, VisitParams params = {});

  void add_pose(const KnownPose& pose);
  void add_frame(const LookedAtFrame& frame);
  /// Takes the visits that ended since the last call.
  Result take_ended();
  /// Ends all visits, as at the end of a log.
  void end_all();

 private:
  struct OpenVisit {
    FixtureVisit visit;
    std::vector<Pose2> offsets;
    bool was_burning = false;  // in the last image
  };
  struct OpenStranger {
    StrangerVisit visit;
    std::vector<Pose2> poses;
    std::vector<double> lengths;
    std::vector<double> widths;
  };

  void look(const LookedAtFrame& looked, const OdometryReading& robot);
  /// The fixture that each sighting shows; -1 = none that the building has.
  [[nodiscard]] std::vector<int> match(const std::vector<FixtureSighting>& sightings, const Pose2& world_from_robot,
                                       const std::vector<int>& near) const;
  void count(int fixture, const FixtureSighting* sighting, const LookedAtFrame& looked, const Pose2& world_from_robot);
  void add_stranger(const FixtureSighting& sighting, std::int64_t utime, const Pose2& world_from_robot);
  void end_visits_before(std::int64_t utime);
  void end(int fixture, const OpenVisit& open);
  void end(OpenStranger& open);

  CeilingView view_;
  FixtureMap map_;
  VisitParams params_;
  double gate_;    // [m]
  double radius_;  // [m] of the view
  OdometryHistory poses_;
  std::deque<LookedAtFrame> waiting_;  // for the pose behind them
  std::map<int, OpenVisit> open_;
  std::vector<OpenStranger> strangers_;
  Result ended_;
};

}  // namespace luminav
