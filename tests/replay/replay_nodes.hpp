#pragma once

#include <cstdint>
#include <filesystem>
#include <lcm/lcm-cpp.hpp>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace luminav {

/// Names of the nodes that can be replayed, in the order of their stages.
const std::vector<std::string>& replayable_nodes();
/// Channels that a node reads and writes.
const std::set<std::string>& inputs_of(const std::string& node);
const std::set<std::string>& outputs_of(const std::string& node);

struct ReplayNodesConfig {
  std::filesystem::path robot_file;
  std::filesystem::path building_file;
  std::set<std::string> nodes;
  std::optional<std::uint64_t> localizer_seed;  // nothing: the localizer's own
  double camera_shift = 0.0;    // [m] the detector believes its camera that much too far ahead; for tests
  std::int64_t utc_offset = 0;  // [s] of the time of day where the log was recorded, by which zones have hours
};

/// Today's nodes on one memq:// handle, without a state folder: nothing of an earlier run gets in, nothing is kept.
class ReplayNodes {
 public:
  /// Throws ConfigurationError for what the files have wrong and for unknown nodes.
  explicit ReplayNodes(const ReplayNodesConfig& config);
  ~ReplayNodes();

  [[nodiscard]] lcm::LCM& lcm();
  /// What they write, and what they read but none of them writes.
  [[nodiscard]] const std::set<std::string>& outputs() const { return outputs_; }
  [[nodiscard]] const std::set<std::string>& inputs() const { return inputs_; }
  /// Messages that the nodes refused.
  [[nodiscard]] std::int64_t dropped() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
  std::set<std::string> inputs_;
  std::set<std::string> outputs_;
};

}  // namespace luminav
