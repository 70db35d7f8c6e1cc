#include "services/caretaker/caretaker_node.hpp"

#include <cmath>
#include <stdexcept>
#include <utility>

#include "services/common/ceiling/detection_conversion.hpp"
#include "services/common/process/channels.hpp"
#include "services/common/process/lcm_conversions.hpp"

namespace luminav {
namespace {

constexpr double kMaxSigma = 0.10;  // [m] of the pose: known worse, it says nothing of where a fixture hangs
constexpr int kMaxDetections = 200;

bool is_sure(const pose_t& message) {
  return message.state == pose_t::STATE_TRACKING && is_covariance(message.covariance) &&
         position_sigma(message) < kMaxSigma;
}

}  // namespace

CaretakerNode::CaretakerNode(lcm::LCM& lcm, const RobotDescription& robot, const Building& building,
                             std::filesystem::path file)
    : fixtures_(building.fixtures),
      time_offset_(static_cast<std::int64_t>(std::lround(1e6 * robot.camera.time_offset))),
      file_(std::move(file)),
      recorder_(robot.camera, building.fixtures),
      ledger_(file_.empty() ? LampLedger(building.name) : load_ledger(file_, building.name)),
      subscriber_(lcm) {
  subscriber_.on<pose_t>(channels::kPose, &CaretakerNode::on_pose, this);
  subscriber_.on<fixture_detections_t>(channels::kFixtureDetections, &CaretakerNode::on_fixture_detections, this);
}

Health CaretakerNode::health() const {
  Health health;
  health.degraded = !fault_.empty();
  health.reason = fault_;
  health.dropped_inputs = subscriber_.dropped();
  return health;
}

void CaretakerNode::on_pose(const pose_t& message) {
  if (!all_finite({message.x, message.y, message.theta, message.linear, message.angular})) {
    subscriber_.drop("POSE: not a number");
    return;
  }
  recorder_.add_pose({{message.utime,
                       message.session,
                       {message.x, message.y, wrap_angle(message.theta)},
                       message.linear,
                       message.angular},
                      is_sure(message)});
  keep_ended();
}

void CaretakerNode::on_fixture_detections(const fixture_detections_t& message) {
  if (message.count > kMaxDetections || !std::isfinite(message.median_grey)) {
    subscriber_.drop("FIXTURE_DETECTIONS: what no image can show");
    return;
  }
  if (lamp_pictures_.look(message.utime, message.exposure_us)) {
    return;  // in turn with these a lamp would seem to flicker
  }
  LookedAtFrame looked;
  looked.frame = to_frame(message);
  looked.frame.utime += time_offset_;
  looked.grey = message.median_grey;
  recorder_.add_frame(looked);
  keep_ended();
}

void CaretakerNode::keep_ended() {
  const VisitRecorder::Result ended = recorder_.take_ended();
  if (!ended.fixtures.empty() || !ended.strangers.empty()) {
    ledger_.add(ended, fixtures_);
    is_changed_ = true;
  }
}

void CaretakerNode::save() {
  if (!is_changed_ || file_.empty()) {
    return;
  }
  try {
    save_ledger(file_, ledger_);
    is_changed_ = false;
    fault_.clear();
  } catch (const std::runtime_error& error) {
    fault_ = error.what();
  }
}

void CaretakerNode::finish() {
  recorder_.end_all();
  keep_ended();
  save();
}

std::filesystem::path ledger_file(const std::filesystem::path& state_folder, const std::string& robot) {
  return state_folder / robot / "ceiling.json";
}

}  // namespace luminav
