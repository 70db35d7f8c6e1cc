#include "tests/evaluation/judge/job_judge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "drivers/simulator/arcos/battery.hpp"
#include "services/common/process/channels.hpp"
#include "services/jobs/job.hpp"

namespace luminav {
namespace {

constexpr double kTolerance = 0.25;  // [m] of a stop, as of a goal
constexpr double kReserve = 0.1;     // [V] above what is called empty
constexpr double kTogether = 2.5;    // [m] from the robot's middle to a visitor who was led there

}  // namespace

JobJudge::JobJudge(lcm::LCM& lcm, const Building& building, const JobPeople& people, const World& world)
    : places_(building.places), people_(people), world_(world), subscriber_(lcm) {
  subscriber_.on(channels::kJobStatus, &JobJudge::on_jobs, this);
  subscriber_.on(channels::kRobotStatus, &JobJudge::on_robot_status, this);
}

void JobJudge::on_robot_status(const robot_status_t& status) {
  if (status.battery_voltage > 0.0) {
    min_voltage_ = std::min(min_voltage_, status.battery_voltage);
  }
}

void JobJudge::on_jobs(const job_status_t& status) {
  for (auto& [id, record] : records_) {
    record.is_there = record.is_over;  // the last that are over are forgotten by and by
  }
  for (const job_state_t& job : status.jobs) {
    note(records_[job.id], job);
  }
}

void JobJudge::note(Record& record, const job_state_t& job) {
  const job_state_t& before = record.last;
  const bool is_over = job.state >= job_state_t::STATE_DONE;
  record.is_revived = record.is_revived || (record.is_over && !is_over);
  record.is_there = true;
  if (job.state == job_state_t::STATE_AT_STOP && (before.state != job.state || before.stop != job.stop)) {
    judge_place(record, job);
    record.tries += job.kind == job_t::KIND_HOME && job.stop + 1 == job.stop_count ? 1 : 0;
  }
  const char* const going_back = "goes back";
  record.returns += job.sentence.starts_with(going_back) && !before.sentence.starts_with(going_back) ? 1 : 0;
  if (job.kind == job_t::KIND_GUIDE && job.state != job_state_t::STATE_QUEUED && !record.is_over) {
    look_at_visitor(record);
  }
  if (is_over && !record.is_over) {
    record.is_charging = world_.is_on_charger();
  }
  record.is_over = is_over;
  record.last = job;
}

void JobJudge::look_at_visitor(Record& record) const {
  const Visitor* visitor = world_.visitor();
  record.is_deserted = record.is_deserted || (visitor != nullptr && visitor->has_turned_away());
  record.to_visitor = visitor == nullptr ? std::numeric_limits<double>::infinity()
                                         : (visitor->position() - world_.state().world_from_robot.position()).norm();
}

void JobJudge::judge_place(Record& record, const job_state_t& job) const {
  const std::string& name = job.stops.at(static_cast<std::size_t>(job.stop));
  const auto place = std::find_if(places_.begin(), places_.end(), [&](const Place& p) { return p.name == name; });
  if (place != places_.end()) {
    const double off = distance(world_.state().world_from_robot, place->pose);
    if (off > kTolerance) {
      record.misplaced = fmt::format("said to be at {}, was {:.2f} m from it", name, off);
    }
  }
}

std::string JobJudge::guide_complaint(const Record& record) {
  const bool is_done = record.last.state == job_state_t::STATE_DONE;
  const std::string& sentence = record.last.sentence;
  if (is_done && record.to_visitor > kTogether) {
    return fmt::format("done, but its visitor was {:.1f} m away", record.to_visitor);
  }
  if (!is_done && !record.is_deserted) {
    return fmt::format("not done, its visitor was {:.1f} m away: {}", record.to_visitor, sentence);
  }
  return is_done || record.returns > 0 ? "" : "did not go back for its visitor: " + sentence;
}

std::string JobJudge::complaint(std::int64_t id, const Record& record) const {
  const job_state_t& job = record.last;
  const PlannedJob* plan = people_.ordered(id);
  if (!record.is_over) {
    return fmt::format("not over: {}", job.sentence);
  }
  if (!record.misplaced.empty()) {
    return record.misplaced;
  }
  if (job.kind == job_t::KIND_GUIDE) {
    return guide_complaint(record);
  }
  const bool is_done = job.state == job_state_t::STATE_DONE;
  if (is_done != (plan == nullptr || plan->is_to_be_done)) {
    return fmt::format("{}: {}", is_done ? "done, but should not be" : "not done", job.sentence);
  }
  if (job.kind == job_t::KIND_HOME && is_done && !record.is_charging) {
    return fmt::format("does not charge: {}", job.sentence);
  }
  return "";
}

JobsResult JobJudge::result() const {
  JobsResult result;
  result.answers = people_.answers();
  result.min_voltage = min_voltage_;
  result.kills = kills_;
  std::size_t scheduled = 0;
  for (const auto& [id, record] : records_) {
    const job_state_t& job = record.last;
    ++result.jobs;
    result.lost += record.is_there ? 0 : 1;
    result.doubled += record.is_revived ? 1 : 0;
    result.returns += record.returns;
    result.guides_left += record.is_deserted ? 1 : 0;
    if (job.kind == job_t::KIND_HOME) {
      const bool is_done = job.state == job_state_t::STATE_DONE;
      result.homes += is_done ? 1 : 0;
      result.charging += is_done && record.is_charging ? 1 : 0;
      result.charger_tries += record.tries;
    }
    scheduled += job.sender == "schedule" ? 1 : 0;
    if (const std::string why = complaint(id, record); !why.empty()) {
      result.wrong.push_back(fmt::format("{} {} to {}: {}", name_of(static_cast<JobKind>(job.kind)), id,
                                         job.stops.empty() ? "" : job.stops.back(), why));
    } else {
      ++result.right;
    }
  }
  for (const std::int64_t id : people_.promised()) {
    result.lost += records_.contains(id) ? 0 : 1;
  }
  const auto never = static_cast<int>(people_.drawn().jobs.size() - people_.orders());
  result.jobs += never;
  if (never > 0) {
    result.wrong.push_back(fmt::format("{} jobs were never ordered: too many waited", never));
  }
  const std::size_t tours = people_.drawn().tours.size();
  result.doubled += scheduled > tours ? static_cast<int>(scheduled - tours) : 0;
  if (scheduled < tours) {
    result.jobs += static_cast<int>(tours - scheduled);
    result.wrong.push_back(fmt::format("{} tours did not start at their time", tours - scheduled));
  }
  for (const std::string& objection : people_.objections()) {
    result.wrong.push_back("objected to a request: " + objection);
  }
  return result;
}

std::string JobJudge::failure(const JobsResult& result) {
  if (result.lost + result.doubled > 0) {
    return fmt::format("{} jobs lost, {} doubled", result.lost, result.doubled);
  }
  if (result.min_voltage < Battery::kEmpty + kReserve) {
    return fmt::format("the battery was empty: {:.1f} V", result.min_voltage);
  }
  if (result.charging < result.homes) {
    return fmt::format("{} of {} times at home it did not charge", result.homes - result.charging, result.homes);
  }
  return result.wrong.empty() ? "" : result.wrong.front();
}

}  // namespace luminav
