#include "tests/evaluation/detector_score/score_stage.hpp"

#include <time.h>

#include <stdexcept>
#include <utility>

#include "tests/evaluation/detector_score/frame_judgement.hpp"
#include "tests/evaluation/detector_score/visible_outline.hpp"

namespace luminav::score {
namespace {

double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

ScoreStage::ScoreStage(const simulated::CeilingModel& model, const DetectorParams& params,
                       const CameraDescription& told_camera, const Building& told,
                       std::vector<simulated::LampState> lamps)
    : truth_(model.building),
      renderer_(model),
      camera_(model.intrinsics, model.mounting),
      detector_(params, told_camera, catalogue_of(told)),
      lamps_(std::move(lamps)) {}

void ScoreStage::score_frame(const std::string& name, const Place& place, double factor, simulated::Exposure exposure,
                             bool jpeg, const FrameListener& listener, DetectorScore& score) {
  renderer_.set_world(place.daylight, lamps_, {});
  expose(renderer_, place.motion.world_from_robot, factor, exposure);
  GreyImage image;
  render(renderer_, place.motion, exposure, image);
  if (jpeg && !decoder_.decode(encoder_.encode(image.view(), 85), image)) {
    throw std::runtime_error("detector score: a JPEG of ours cannot be read");
  }
  std::vector<VisibleFixture> visible;
  for (std::size_t i = 0; i < truth_.fixtures.size(); ++i) {
    if (const auto imaged = image_of(truth_.fixtures[i], place.motion, camera_)) {
      const double share = seen_share(image.view(), camera_, truth_.fixtures[i], imaged->as_imaged);
      visible.push_back({*imaged, &truth_.fixtures[i], lamps_[i], false, share >= kSeenShare});
    }
  }
  const double before = thread_seconds();
  DetectorTrace trace;
  std::vector<Detection> detections = detector_.detect(image.view(), listener ? &trace : nullptr);
  score.seconds += thread_seconds() - before;
  ++score.frames;
  std::vector<std::string> complaints = judge(detections, visible, score);
  if (listener) {
    listener({name, &image, std::move(detections), std::move(complaints), std::move(trace)});
  }
}

}  // namespace luminav::score
