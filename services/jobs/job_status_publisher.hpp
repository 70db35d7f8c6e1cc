#pragma once

#include <cstdint>
#include <lcm/lcm-cpp.hpp>
#include <luminav/job_status_t.hpp>
#include <utility>
#include <vector>

#include "services/common/process/channels.hpp"
#include "services/jobs/job_messages.hpp"

namespace luminav {

/// JOB_STATUS: at once when it says something else, and once a second: a datagram may get lost.
class JobStatusPublisher {
 public:
  explicit JobStatusPublisher(lcm::LCM& lcm) : lcm_(lcm) {}

  /// `utime`: a stamp of the robot [us]; after one that went back it speaks at once.
  void publish(const JobExecutor& executor, std::int64_t utime) {
    job_status_t status = status_from(executor);
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(status.getEncodedSize()));
    status.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    if (bytes == last_ && utime >= published_ && utime - published_ < kPeriod) {
      return;
    }
    last_ = std::move(bytes);
    published_ = utime;
    status.utime = utime;
    status.sequence = ++sequence_;
    lcm_.publish(channels::kJobStatus, &status);
  }
  /// Says it whether or not it was said.
  void repeat(const JobExecutor& executor, std::int64_t utime) {
    last_.clear();
    publish(executor, utime);
  }

 private:
  static constexpr std::int64_t kPeriod = 950'000;  // [us]

  lcm::LCM& lcm_;
  std::vector<std::uint8_t> last_;  // without its stamp
  std::int64_t published_ = 0;      // [us]
  std::int32_t sequence_ = 0;
};

}  // namespace luminav
