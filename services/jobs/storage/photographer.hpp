#pragma once

#include <cstdint>
#include <filesystem>
#include <lcm/lcm-cpp.hpp>
#include <luminav/camera_image_t.hpp>
#include <optional>
#include <string>

#include "services/common/process/subscriber.hpp"
#include "services/jobs/job_executor.hpp"
#include "services/jobs/job_inputs.hpp"
#include "services/jobs/storage/photo_store.hpp"

namespace luminav {

/// Keeps one picture of each stop that wants one. Fifteen of them a second are nobody's business here else: it listens
/// to the camera only while the robot stands at such a stop.
class Photographer {
 public:
  /// `folder` as PhotoStore has it; executor and inputs outlive it.
  Photographer(lcm::LCM& lcm, std::filesystem::path folder, JobExecutor& executor, const JobInputs& inputs)
      : lcm_(lcm), photos_(std::move(folder)), executor_(executor), inputs_(inputs) {}

  /// Begins or ends to listen, as the job under way wants. `now`: the robot's stamp [us]; what was taken before it is
  /// of the way there.
  void tick(std::int64_t now);
  [[nodiscard]] bool is_listening() const { return camera_.has_value(); }
  /// Why the last picture could not be kept; "" = it was.
  [[nodiscard]] const std::string& error() const { return error_; }

 private:
  void on_camera_image(const camera_image_t& message);

  lcm::LCM& lcm_;
  PhotoStore photos_;
  JobExecutor& executor_;
  const JobInputs& inputs_;
  std::string error_;
  std::int64_t since_ = 0;            // [us] stamp since when it stands where one is to be kept
  std::optional<Subscriber> camera_;  // while one is
};

}  // namespace luminav
