#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <lcm/lcm-cpp.hpp>
#include <luminav/camera_image_t.hpp>
#include <luminav/control_status_t.hpp>
#include <luminav/fixture_detections_t.hpp>
#include <luminav/grid_tile_t.hpp>
#include <luminav/hypotheses_t.hpp>
#include <luminav/job_status_t.hpp>
#include <luminav/navigation_status_t.hpp>
#include <luminav/node_status_t.hpp>
#include <luminav/odometry_t.hpp>
#include <luminav/path_t.hpp>
#include <luminav/pose_t.hpp>
#include <luminav/robot_status_t.hpp>
#include <luminav/sim_truth_t.hpp>
#include <luminav/sonar_t.hpp>
#include <luminav/survey_status_t.hpp>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "services/common/image/lamp_pictures.hpp"
#include "services/common/process/clock.hpp"
#include "services/common/process/event_loop.hpp"
#include "services/common/process/subscriber.hpp"
#include "services/viewer/helm.hpp"
#include "services/viewer/picture_store.hpp"
#include "services/viewer/request_desk.hpp"
#include "services/viewer/snapshot_board.hpp"
#include "services/viewer/viewer_config.hpp"

namespace luminav {

/// Listens to everything and keeps the newest of it on the board as server-sent events: "state" with each `show`,
/// "nodes" with each `show_processes`, "hypotheses", "path", "jobs", "survey", "picture" and "tile" when there is a new
/// one. Says how old each channel is by the clock of this host, since stamps come from another.
class ViewerNode {
 public:
  ViewerNode(lcm::LCM& lcm, const ViewerConfig& config, const Clock& clock, SnapshotBoard& board,
             PictureStore& pictures, RequestDesk& desk, Helm& helm);

  /// A tenth of a second has passed: puts the state on the board and wakes the readers.
  void show();
  /// A second has passed: processes, rates of the channels; asks for map tiles that are missing.
  void show_processes();

  /// A process on another machine than this that has the building's file, there, as planner@robot; "" = none.
  [[nodiscard]] std::string building_elsewhere(const std::string& host) const;

  [[nodiscard]] Health health() const { return {.reason = "", .dropped_inputs = subscriber_.dropped()}; }

 private:
  /// When a channel was last heard, how often since the last look, and how long after the robot's clock its stamps
  /// come.
  struct Reception {
    std::int64_t last = 0;  // [us] clock of this host
    int count = 0;
    double rate = 0.0;            // [1/s]
    std::optional<double> delay;  // [s] by the robot's newest stamp, so no two clocks are compared
  };
  struct NodeReport {
    node_status_t status;
    std::int64_t heard = 0;  // [us] clock of this host
  };
  /// Which pictures the page shows: not all, and none for the lamps, with which it would flicker.
  struct PictureChoice {
    std::int64_t shown_utime = 0;  // [us] stamp of the last one shown
    LampPictures for_lamps;
  };

  void on_pose(const pose_t& message);
  void on_hypotheses(const hypotheses_t& message);
  void on_navigation_status(const navigation_status_t& message);
  void on_control_status(const control_status_t& message);
  void on_path(const path_t& message);
  void on_job_status(const job_status_t& message);
  void on_survey_status(const survey_status_t& message);
  void on_grid_tile(const grid_tile_t& message);
  void on_sonar(const sonar_t& message);
  void on_odometry(const odometry_t& message);
  void on_robot_status(const robot_status_t& message);
  void on_fixture_detections(const fixture_detections_t& message);
  void on_camera_image(const camera_image_t& message);
  void on_node_status(const node_status_t& message);
  void on_sim_truth(const sim_truth_t& message);

  void heard(const char* channel, std::int64_t utime = 0);
  void show_picture(const fixture_detections_t* detections);
  void request_missing_tiles();
  [[nodiscard]] std::optional<Pose2> world_from_robot_at(std::int64_t utime) const;
  [[nodiscard]] std::string requests_json() const;

  lcm::LCM& lcm_;
  ViewerConfig config_;
  const Clock& clock_;
  SnapshotBoard& board_;
  PictureStore& pictures_;
  RequestDesk& desk_;
  Helm& helm_;
  Subscriber subscriber_;

  std::map<std::string, Reception> receptions_;
  std::map<std::string, std::string> newest_;  // JSON by the key it has in the state
  std::map<std::string, NodeReport> nodes_;
  std::int64_t newest_stamp_ = 0;  // [us] of ROBOT_STATUS and ODOMETRY
  std::deque<pose_t> recent_poses_;
  std::optional<camera_image_t> picture_;  // waits for its detections
  PictureChoice picture_choice_;
  std::int64_t map_session_ = 0;
  std::int64_t tiles_expected_ = 0;
  std::map<std::pair<int, int>, std::int32_t> tile_revisions_;
  int tile_requests_left_ = 0;
  std::int64_t tile_request_id_ = 0;
};

}  // namespace luminav
