#include "services/jobs/storage/job_keeper.hpp"

#include <utility>

namespace luminav {
namespace {

constexpr std::int64_t kKeepPeriod = 20'000'000;  // [us] the table is kept anew: how long ago tells whether it goes on

}  // namespace

JobKeeper::JobKeeper(const JobsConfig& config, JobExecutor& executor)
    : executor_(executor),
      store_(config.state_folder),
      here_{.boot = config.boot, .building = config.site.building},
      kept_(here_) {
  if (std::optional<StoredJobs> stored = store_.recall()) {
    executor_.load(std::move(stored->table));
    kept_ = stored->kept;
  } else {
    has_gone_on_ = true;
  }
}

void JobKeeper::tick(std::int64_t utime) {
  here_.utime = utime;
  if (!has_gone_on_) {
    has_gone_on_ = true;
    if (const std::string why = objection_to_going_on(kept_, here_); !why.empty()) {
      executor_.ask_for_left_over(why);
    }
    kept_ = here_;
  }
  if (utime - kept_.utime > kKeepPeriod || utime < kept_.utime) {
    kept_.utime = utime;
  }
}

bool JobKeeper::keep() {
  try {
    store_.keep({executor_.table(), kept_});
    error_.clear();
  } catch (const std::exception& error) {
    error_ = error.what();
  }
  return error_.empty();
}

void JobKeeper::end() {
  kept_.ended = true;
  keep();
}

}  // namespace luminav
