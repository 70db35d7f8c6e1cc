#pragma once

#include <lcm/lcm-cpp.hpp>
#include <luminav/job_status_t.hpp>
#include <luminav/robot_status_t.hpp>
#include <map>
#include <string>
#include <vector>

#include "drivers/simulator/world/world.hpp"
#include "services/common/building/building.hpp"
#include "services/common/process/subscriber.hpp"
#include "tests/evaluation/report/run_report.hpp"
#include "tests/evaluation/runs/job_people.hpp"

namespace luminav {

/// Watches by the truth what becomes of each job.
class JobJudge {
 public:
  JobJudge(lcm::LCM& lcm, const Building& building, const JobPeople& people, const World& world);

  void note_kill() { ++kills_; }
  [[nodiscard]] JobsResult result() const;
  /// The first thing that must not be, one sentence; "" = all is well.
  [[nodiscard]] static std::string failure(const JobsResult& result);

 private:
  struct Record {
    job_state_t last{};
    bool is_over = false;
    bool is_revived = false;
    bool is_there = true;      // in the newest table
    bool is_charging = false;  // by the truth, when it ended
    int returns = 0;           // for its visitor
    bool is_deserted = false;  // its visitor turned away before it ended
    double to_visitor = 0.0;   // [m] when it ended
    int tries = 0;             // to drive into the dock
    std::string misplaced{};   // where it said to be and was not
  };

  void on_jobs(const job_status_t& status);
  void on_robot_status(const robot_status_t& status);
  void note(Record& record, const job_state_t& job);
  void look_at_visitor(Record& record) const;
  void judge_place(Record& record, const job_state_t& job) const;
  /// Why it did not end as it should; "" = it did.
  [[nodiscard]] std::string complaint(std::int64_t id, const Record& record) const;
  [[nodiscard]] static std::string guide_complaint(const Record& record);

  std::vector<Place> places_;
  const JobPeople& people_;
  const World& world_;
  std::map<std::int64_t, Record> records_;
  double min_voltage_ = 100.0;  // [V]
  int kills_ = 0;
  Subscriber subscriber_;
};

}  // namespace luminav
