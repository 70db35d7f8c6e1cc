#include "services/launcher/deputy/deputy_journal.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

namespace luminav::launcher {
namespace {

std::string time_of_day(std::int64_t utime) {
  return fmt::format("{:%Y-%m-%d %H:%M:%S}", fmt::localtime(static_cast<std::time_t>(utime / kSecond)));
}

}  // namespace

DeputyJournal::DeputyJournal(std::filesystem::path folder, const RotatingLogParams& log,
                             const OutputPacerParams& output)
    : folder_(std::move(folder)), log_params_(log), output_(output) {
  if (!folder_.empty()) {
    log_ = std::make_unique<RotatingLog>(folder_ / "deputy.log", log_params_);
  }
}

void DeputyJournal::say(const Instant& now, const std::string& sentence) {
  output_.add("", sentence + "\n", now.steady);
  if (log_) {
    log_->write(fmt::format("{} {}\n", time_of_day(now.utime), sentence));
  }
  notice_(sentence);
}

void DeputyJournal::say_seldom(const Instant& now, const std::string& sentence) {
  constexpr std::int64_t kPause = kSecond;
  if (now.steady - last_seldom_at_ < kPause && last_seldom_at_ != 0) {
    return;
  }
  last_seldom_at_ = now.steady;
  say(now, sentence);
}

std::unique_ptr<RotatingLog> DeputyJournal::open_log(const std::string& command_id) const {
  return folder_.empty() ? nullptr : std::make_unique<RotatingLog>(folder_ / log_file_name(command_id), log_params_);
}

void DeputyJournal::add_output(const Instant& now, const std::string& command_id, std::string_view text,
                               RotatingLog* log) {
  output_.add(command_id, text, now.steady);
  if (log != nullptr && !log->write(text) && !log_failed_) {
    log_failed_ = true;
    say(now, fmt::format("cannot write {}; is the disk full?", log->file().string()));
  }
}

void DeputyJournal::note(const Instant& now, const std::string& what, RotatingLog* log) {
  if (log != nullptr) {
    log->write(fmt::format("--- {} {}\n", time_of_day(now.utime), what));
  }
}

std::vector<luminav_procman::procman_output_t> DeputyJournal::take_output(const Instant& now) {
  return output_.take(now.steady);
}

}  // namespace luminav::launcher
