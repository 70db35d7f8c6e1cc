#include "services/jobs/storage/job_store.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/common/configuration/configuration_error.hpp"
#include "services/common/configuration/whole_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace luminav {
namespace {

StoredJobs some_jobs() {
  StoredJobs stored;
  stored.kept = {"boot", "laboratory", 5'000'000, false};
  Job job;
  job.id = 1'764'184'500'123'456;
  job.kind = JobKind::kCarry;
  job.stops = {{.place = "lab", .confirm = "loaded"},
               {.pose = {0.1 + 0.2, -1e-3, 3.0}, .has_theta = true, .pause = 2.5}};
  job.state = JobState::kAsking;
  job.stop = 1;
  job.goal_id = 77;
  job.question = Question{"opened \"or\" shut?\n", {"opened", "give up"}};
  stored.table.jobs = {job};
  stored.table.active = job.id;
  stored.table.open_goal = 77;
  stored.table.echoes = {{5, ""}, {6, "no place \"ä\""}};
  stored.table.toured = {{"morning", 46'000}};
  return stored;
}

TEST(JobStore, RecallsWhatItKept) {
  const TemporaryFolder folder;
  JobStore(folder.path()).keep(some_jobs());
  const auto recalled = JobStore(folder.path()).recall();
  ASSERT_TRUE(recalled);
  const StoredJobs kept = some_jobs();
  EXPECT_EQ(recalled->kept.boot, "boot");
  EXPECT_EQ(recalled->kept.utime, 5'000'000);
  ASSERT_EQ(recalled->table.jobs.size(), 1U);
  const Job& job = recalled->table.jobs[0];
  EXPECT_EQ(job.id, kept.table.jobs[0].id);
  EXPECT_EQ(job.kind, JobKind::kCarry);
  EXPECT_EQ(job.stops[1].pose.x, 0.1 + 0.2) << "to the last digit: goals are compared";
  EXPECT_EQ(job.stops[0].confirm, "loaded");
  EXPECT_EQ(job.question->text, kept.table.jobs[0].question->text);
  EXPECT_EQ(job.goal_id, 77);
  EXPECT_EQ(recalled->table.echoes[1].objection, "no place \"ä\"");
  EXPECT_EQ(recalled->table.toured.at("morning"), 46'000);
}

TEST(JobStore, ThrowsNobodysJobsAwayWhenItsFileIsDamaged) {
  const TemporaryFolder folder;
  EXPECT_FALSE(JobStore(folder.path()).recall());
  JobStore(folder.path()).keep(some_jobs());
  const std::string whole = read_whole_file(folder.path() / "jobs.json");
  for (const std::string& text :
       {std::string(), std::string("{}"), std::string("[1]"), whole.substr(0, whole.size() / 2),
        std::string(whole).replace(whole.find("\"stop\": 1"), 9, "\"stop\": 9"),
        std::string(whole).replace(whole.find("\"kind\": 1"), 9, "\"kind\": 8")}) {
    folder.write("jobs.json", text);
    EXPECT_THROW((void)JobStore(folder.path()).recall(), ConfigurationError) << text;
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "jobs.json"));
  }
}

TEST(JobStore, LetsJobsGoOnAfterACrashAMomentAgoAlone) {
  const JobCircumstances kept{"boot", "laboratory", 1'000'000'000, false};
  const auto after = [&](double seconds) {
    return JobCircumstances{"boot", "laboratory", kept.utime + static_cast<std::int64_t>(seconds * 1e6), false};
  };
  EXPECT_EQ(objection_to_going_on(kept, after(100.0)), "");
  EXPECT_NE(objection_to_going_on(kept, after(180.0)), "");
  EXPECT_NE(objection_to_going_on(kept, after(-1.0)), "");
  EXPECT_NE(objection_to_going_on(kept, {"another boot", "laboratory", kept.utime, false}), "");
  EXPECT_NE(objection_to_going_on(kept, {"boot", "office", kept.utime, false}), "");
  EXPECT_NE(objection_to_going_on({"", "laboratory", kept.utime, false}, {"", "laboratory", kept.utime, false}), "");
  EXPECT_NE(objection_to_going_on({"boot", "laboratory", kept.utime, true}, after(1.0)), "");
}

}  // namespace
}  // namespace luminav
