#pragma once

#include <cstdint>
#include <deque>
#include <lcm/lcm-cpp.hpp>
#include <luminav/sim_truth_t.hpp>
#include <optional>
#include <string>

#include "services/common/process/subscriber.hpp"

namespace luminav {

/// The simulator's truth of the last minute: when the robot stood and when it moved.
class TruthWatch {
 public:
  explicit TruthWatch(lcm::LCM& lcm);

  [[nodiscard]] const std::optional<sim_truth_t>& newest() const { return newest_; }
  [[nodiscard]] bool stands() const;
  /// First moment after `utime` [us] from which on the robot stood for at least 0.05 s.
  [[nodiscard]] std::optional<std::int64_t> stood_at(std::int64_t utime) const;
  /// First moment after `utime` [us] from which on the robot moved for at least 0.1 s.
  [[nodiscard]] std::optional<std::int64_t> moved_at(std::int64_t utime) const;
  /// Way driven so far [m], and time so far [s].
  [[nodiscard]] double driven() const { return driven_; }
  [[nodiscard]] double elapsed() const;
  [[nodiscard]] int contacts() const { return newest_ ? newest_->contacts : 0; }
  /// How it last touched something, in words; "" = it never did.
  [[nodiscard]] const std::string& last_contact() const { return last_contact_; }
  [[nodiscard]] int hard_contacts() const { return newest_ ? newest_->hard_contacts : 0; }
  /// Distance from the robot's centre to the nearest person [m]; 100 = none.
  [[nodiscard]] double nearest_person() const;
  /// Longest time between two messages since the last call [s]: how well the machine kept up.
  double take_longest_gap();

 private:
  struct Moment {
    std::int64_t utime;
    bool moves;
  };
  void on_truth(const sim_truth_t& truth);
  [[nodiscard]] std::optional<std::int64_t> first_stretch(std::int64_t utime, bool moves, std::int64_t length) const;

  Subscriber subscriber_;
  std::optional<sim_truth_t> newest_;
  std::deque<Moment> moments_;
  std::int64_t first_ = 0;
  double driven_ = 0.0;
  double longest_gap_ = 0.0;
  std::string last_contact_;
};

}  // namespace luminav
