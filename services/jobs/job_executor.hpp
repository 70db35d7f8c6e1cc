#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "services/common/building/building.hpp"
#include "services/common/tours/jobs_file.hpp"
#include "services/jobs/job_queue.hpp"
#include "services/jobs/tour_schedule.hpp"
#include "services/jobs/watches/battery_watch.hpp"
#include "services/jobs/watches/drive_watch.hpp"
#include "services/jobs/watches/guide_watch.hpp"

namespace luminav {

struct JobParams {
  double handover_timeout = 600.0;   // [s] to wait for somebody who loads or unloads
  double question_timeout = 1800.0;  // [s] to wait for an answer before the job is given up
  double untouched = 2.0;            // [s] that nobody handles the robot before it drives on
  double idle_time = 0.0;            // [s] without a job before it drives home; 0 = never
  double charge_wait = 30.0;         // [s] for the charger to be noticed
  int charge_attempts = 3;           // to find its contacts, then a person is asked
  BatteryParams battery{};
  GuideParams guide{};
};

/// What a building knows that matters to jobs.
struct JobSite {
  std::string building{};
  std::vector<Place> places{};
  JobsFile jobs{};                          // home and stored tours
  std::shared_ptr<const PriorMap> walls{};  // null = no map
};

/// All that is known at one moment.
struct JobMoment {
  std::int64_t utime = 0;  // [us] a stamp of the robot, only to number goals with
  double seconds = 0.0;    // since the last moment; a clock that jumps is none
  std::optional<Navigation> navigation{};
  std::optional<Pose2> world_from_robot{};  // while it is known
  std::string handled{};                    // why it must not start: somebody handles it, or it cannot; "" = free
  double voltage = 0.0;                     // [V] 0 = unknown
  Charger charger = Charger::kNotHeard;     // by the robot's own word
  double driven = 0.0;                      // [m] forward since the last moment
  std::vector<Echo> echoes{};               // of its sonars since the last moment
};

/// The job service without its network: requests and moments in, one goal and the table of jobs out. One job is under
/// way at a time; it drives to its stops one by one, and what blocks it becomes a question.
class JobExecutor {
 public:
  JobExecutor(const JobParams& params, JobSite site);

  /// The building's places are others now. A job that is on its way to one goes on to where that was.
  void set_places(std::vector<Place> places) { site_.places = std::move(places); }
  /// Home and stored tours are these now. A job that was taken goes on as it was.
  void set_jobs(JobsFile jobs);
  /// Acts on a request, once.
  void take(const JobRequest& request, std::int64_t utime);
  /// A new job could not be kept: it is as if it had never come, and its sender is told why.
  void withdraw(std::int64_t request, const std::string& objection);
  void update(const JobMoment& moment);
  /// Starts the stored tours whose time has come.
  void tell_time(const LocalTime& now, std::int64_t utime);

  /// Takes up what was kept by a process that is gone, and its drive.
  void load(JobTable table);
  /// Nothing of what was loaded may move by itself: each job of it that is not over asks whether it is still to be
  /// done.
  void ask_for_left_over(const std::string& why);

  [[nodiscard]] const JobQueue& queue() const { return queue_; }
  [[nodiscard]] const JobTable& table() const { return queue_.table(); }
  [[nodiscard]] const JobSite& site() const { return site_; }
  /// The job under way; null = none.
  [[nodiscard]] const Job* active() const { return queue_.active(); }
  /// How its visitor follows, while it guides.
  [[nodiscard]] const GuideWatch& guide() const { return guide_; }
  /// To be published until the planner echoes it.
  [[nodiscard]] std::optional<DriveRequest> goal() const { return drive_.request(); }
  /// How fast the robot may drive for the job under way [m/s]; nothing = as fast as it does.
  [[nodiscard]] std::optional<double> speed_limit() const;
  /// The picture that is to be kept now; nothing = none.
  [[nodiscard]] std::optional<PhotoWish> wanted_photo() const;
  /// It is kept, or cannot be.
  void end_photo() { has_photo_ = true; }
  /// Gives the drive up, and says by what id; nothing when nothing drives.
  std::optional<DriveRequest> end();

 private:
  static constexpr int kUrgent = 1000;  // priority of a way home with an empty battery: it interrupts

  // requests
  std::string act_on(const JobRequest& request, std::int64_t utime);
  std::string add(const JobRequest& request);
  std::string confirm(Job& job, const std::string& word);
  std::string answer(Job& job, const std::string& word);
  void cancel(Job& job, std::int64_t utime);
  [[nodiscard]] std::string objection_to(const JobRequest& request) const;
  [[nodiscard]] std::string objection_to_stops(const std::vector<JobStop>& stops) const;
  [[nodiscard]] std::vector<JobStop> stops_of(const JobRequest& request) const;
  [[nodiscard]] const Place* place_called(const std::string& name) const;
  [[nodiscard]] const Tour* tour_called(const std::string& name) const;
  [[nodiscard]] std::optional<DriveTarget> target_of(const JobStop& stop) const;

  // driving
  void look_after_battery(const JobMoment& moment);
  void send_home(int priority, const std::string& why, std::int64_t utime);
  void start_next();
  void put_back(Job& job, std::int64_t utime);
  void drive(Job& job, const JobMoment& moment);
  void depart(Job& job, const JobMoment& moment);
  bool guide(Job& job, const JobMoment& moment);
  void stay(Job& job, const JobMoment& moment);
  void wait_for_word(Job& job, const JobStop& stop);
  void wait_for_charger(Job& job, const JobMoment& moment);
  void wait_for_answer(Job& job);
  void go_on(Job& job);
  void ask(Job& job, const std::string& text, std::vector<std::string> answers);
  void ask_about_drive(Job& job);
  void note_goal();

  JobParams params_;
  JobSite site_;
  JobQueue queue_;
  DriveWatch drive_;
  BatteryWatch battery_;
  GuideWatch guide_;
  std::vector<std::int64_t> left_over_;  // ids of the jobs that were loaded
  double waited_ = 0.0;                  // [s] at a stop or for an answer
  bool has_photo_ = false;               // of the stop at which it stands
  double untouched_ = 0.0;               // [s] that nobody has handled the robot
  double planner_silent_ = 0.0;          // [s]
  double idle_ = 0.0;                    // [s] without a job
  bool sent_for_battery_ = false;        // home, since it was full last
  bool sent_for_idleness_ = false;       // home, since it had a job last
};

}  // namespace luminav
