#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <utility>

#include "services/common/configuration/building_watch.hpp"
#include "services/common/process/running_system.hpp"

namespace luminav {

/// The files of robot and building that this process was given. Of the building's it takes over what others change, as
/// BuildingWatch allows it.
class GivenFiles {
 public:
  /// Throws ConfigurationError or std::runtime_error.
  void set_robot(const std::filesystem::path& file) { files_ = identify(file, ""); }
  /// Calls back at once and after each change. Throws ConfigurationError or std::runtime_error.
  void follow_building(const std::filesystem::path& file, std::function<void(const Building&)> take) {
    building_.emplace(file);
    on_building_ = std::move(take);
    tell();
  }
  /// True when the building's file has changed, and is taken over. `heard`: only if it has that sum now.
  bool take_over(std::optional<std::int64_t> heard = {}) {
    const bool changed = building_ && (heard ? building_->take_over(*heard) : building_->take_over());
    if (changed) {
      tell();
    }
    return changed;
  }
  [[nodiscard]] const SystemFiles& files() const { return files_; }

 private:
  void tell() {
    files_.building = building_->building().name;
    files_.building_hash = building_->sum();
    if (on_building_) {
      on_building_(building_->building());
    }
  }

  SystemFiles files_;
  std::optional<BuildingWatch> building_;
  std::function<void(const Building&)> on_building_;
};

}  // namespace luminav
