#pragma once

#include <cstdint>
#include <lcm/lcm-cpp.hpp>
#include <luminav_procman/procman_deputy_info_t.hpp>
#include <luminav_procman/procman_discovery_t.hpp>
#include <optional>
#include <string>

#include "services/common/process/subscriber.hpp"
#include "services/launcher/instant.hpp"

namespace luminav::launcher {

/// A deputy's first half second: it asks whether somebody on the network has its name already, as procman's do.
class NameClaim {
 public:
  /// `nonce` tells two deputies of one name apart; of two that start at the same moment the lower one stays.
  NameClaim(lcm::LCM& lcm, std::string id, std::int64_t nonce);

  /// To be called about twenty times a second until it is settled.
  void tick(const Instant& now);
  /// Nobody else has the name.
  [[nodiscard]] bool settled() const { return settled_; }
  /// Says who has it, for people.
  [[nodiscard]] const std::optional<std::string>& conflict() const { return conflict_; }

 private:
  void on_discovery(const luminav_procman::procman_discovery_t& discovery);
  void on_info(const luminav_procman::procman_deputy_info_t& info);

  lcm::LCM& lcm_;
  std::string id_;
  std::int64_t nonce_;
  std::optional<std::int64_t> begun_;  // [us] steady
  std::int64_t last_question_ = 0;     // [us] steady
  bool settled_ = false;
  std::optional<std::string> conflict_;
  std::optional<Subscriber> subscriber_;  // until it is settled
};

}  // namespace luminav::launcher
