#include "drivers/base/safety/stop_latch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <sstream>
#include <system_error>

#include "services/common/configuration/whole_file.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kRetryPeriod = 1'000'000;  // [us]

std::string to_line(const StopRequests& requests) {
  std::string sender = requests.sender();
  std::replace(sender.begin(), sender.end(), '\n', ' ');
  return fmt::format("{} {} {}\n", requests.engaged() ? 1 : 0, requests.id(), sender);
}

/// Nothing when it is not a line that to_line() wrote, to its end.
std::optional<StopRequests> read_line(const std::string& text) {
  std::istringstream in(text);
  int engaged = -1;
  std::int64_t id = 0;
  std::string sender;
  const bool is_whole = !text.empty() && text.find('\n') == text.size() - 1;
  if (!is_whole || !(in >> engaged >> id) || (engaged != 0 && engaged != 1)) {
    return std::nullopt;
  }
  in.ignore();
  std::getline(in, sender);
  return StopRequests(id, engaged != 0, sender);
}

/// Only where nothing was ever kept there is no stop.
StopRequests read_kept(const std::filesystem::path& file) {
  std::error_code error;
  const bool is_there = std::filesystem::exists(std::filesystem::symlink_status(file, error));
  if (!is_there && (!error || error == std::errc::no_such_file_or_directory)) {
    return {};
  }
  try {
    if (const auto kept = read_line(read_whole_file(file))) {
      return *kept;
    }
  } catch (const std::exception&) {
    // as one that is damaged
  }
  return {0, true, "this driver, which cannot read the stop that was kept"};
}

std::string write(const std::filesystem::path& file, const std::string& line) {
  try {
    make_folders(file.parent_path());
    write_whole_file(file, line);
    return "";
  } catch (const std::exception& error) {
    return fmt::format("the stop would not survive a restart: {}", error.what());
  }
}

}  // namespace

StopLatch::StopLatch(const std::filesystem::path& folder) {
  if (!folder.empty()) {
    file_ = folder / "stop";
    requests_ = read_kept(file_);
  }
}

bool StopLatch::request(std::int64_t id, bool engaged, const std::string& sender) {
  const bool was_engaged = requests_.engaged();
  if (requests_.take(id, engaged, sender) != StopRequests::Verdict::kTaken) {
    return false;
  }
  kept_ = false;
  return engaged != was_engaged;
}

void StopLatch::save(std::int64_t now) {
  if (file_.empty()) {
    return;
  }
  if (writing_.valid() && writing_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
    look_at_writing(now);
  }
  const bool waits = !trouble_.empty() && now < retry_at_ && now > retry_at_ - 2 * kRetryPeriod;
  if (kept_ || writing_.valid() || waits) {
    return;
  }
  kept_ = true;
  writing_ = std::async(std::launch::async, write, file_, to_line(requests_));
}

void StopLatch::look_at_writing(std::int64_t now) {
  trouble_ = writing_.get();
  if (!trouble_.empty()) {
    kept_ = false;
    retry_at_ = now + kRetryPeriod;
  }
}

void StopLatch::finish_saving() {
  if (writing_.valid()) {
    look_at_writing(0);
  }
}

}  // namespace luminav
