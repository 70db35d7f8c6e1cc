#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "drivers/camera/simulated/renderer.hpp"
#include "drivers/camera/simulated/truth.hpp"
#include "drivers/camera/sources/frame_source.hpp"
#include "drivers/simulator/world/world_truth.hpp"

namespace luminav {

/// Behaviour of the simulated webcam that no file of the user describes.
struct SimulatedCeilingParams {
  double rate = 15.0;            // [frames/s]
  double transfer_time = 0.040;  // [s] from the end of the last row's exposure until the driver has the frame
  double exposure_us = 8000.0;   // [us] when it is plugged in
  double gain = 1.0;             // when it is plugged in
  int setting_delay = 2;         // [frames] until a new exposure is in effect, as with UVC cameras
};

/// A webcam in the simulated world: renders what it would see of the ceiling from the true pose through the true
/// mounting, lens and shutter. A picture is exposed as soon as the truth of its last row is known, and handed on when
/// it arrives by the driver's clock or the stamps of the truth, whichever is ahead. Same truth and seed, same bytes.
class SimulatedCeiling final : public FrameSource {
 public:
  SimulatedCeiling(const WorldTruth& truth, std::uint64_t seed, const SimulatedCeilingParams& params = {});

  /// Where the robot is now and what burns; false when it is not newer than what was known.
  bool on_truth(const simulated::TruthSample& sample);

  /// When the picture that is exposed arrives.
  [[nodiscard]] std::optional<std::int64_t> due() const override;
  [[nodiscard]] bool take(std::int64_t now, Frame& frame) override;
  bool set_exposure(double exposure_us, double gain) override;
  [[nodiscard]] std::string fault() const override;
  [[nodiscard]] std::string description() const override;

  /// A picture from a pose of the robot standing still, with the light as it is when the run begins.
  void render_still(const Pose2& world_from_robot, double exposure_us, double gain, GreyImage& image);

 private:
  struct Setting {
    std::uint64_t from_frame;
    double exposure_us;
    double gain;
  };
  /// True mid-exposure [us] of the middle row of the frame that comes next.
  [[nodiscard]] double next_middle() const;
  /// Half of the time [us] over which a picture shows the robot's motion, at least 10 ms of it.
  [[nodiscard]] double half_shown() const;
  void start_frames_at(double middle);
  void apply_settings();
  /// True while an event of that kind lasts.
  [[nodiscard]] bool is_under_way(EventKind kind, const simulated::TruthSample& now) const;
  /// Exposes the next picture if the truth reaches its end; one of which the truth came too late is lost.
  void expose_next();
  [[nodiscard]] bool render_next(Frame& frame);

  SimulatedCeilingParams params_;
  double row_time_us_;     // [us]
  double time_offset_us_;  // [us] from stamp to truth
  simulated::CeilingRenderer renderer_;
  simulated::TruthBuffer truth_;
  bool running_ = false;
  bool unplugged_ = false;
  double first_middle_ = 0.0;       // [us] of the frame first_number_
  std::uint64_t first_number_ = 0;  // frames are numbered through, over gaps
  std::uint64_t number_ = 0;        // of the next frame
  Setting setting_;                 // in effect
  std::deque<Setting> asked_;
  Frame exposed_;                        // on its way to the driver
  std::optional<std::int64_t> arrives_;  // [us] true time; nothing = none is
  std::vector<simulated::TruePose> rows_;
  std::vector<ScenarioEvent> events_;  // that are the camera's own
  GreyImage last_;                     // picture, for one that freezes
};

}  // namespace luminav
