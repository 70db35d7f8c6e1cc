#include "services/viewer/process_desk.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <luminav/node_status_t.hpp>
#include <nlohmann/json.hpp>

#include "services/common/process/channels.hpp"
#include "services/common/process/subscriber.hpp"

namespace luminav {
namespace {

using launcher::Instant;
using launcher::kSecond;
using Json = nlohmann::json;
constexpr std::int64_t kNow = 1'700'000'000'000'000;  // [us]

// A deputy that runs one program, `lcm-logger` called "recorder", and does as it is told at once.
class ProcessDeskTest : public ::testing::Test {
 protected:
  ProcessDeskTest() : subscriber_(procman_) {
    subscriber_.on(channels::kProcmanOrders, &ProcessDeskTest::on_orders, this);
  }
  void on_orders(const luminav_procman::procman_orders_t& orders) {
    for (const auto& ordered : orders.cmds) {
      if (ordered.cmd.command_id != "recorder") {
        continue;
      }
      pid_ = ordered.force_quit != 0 ? 0 : ordered.desired_runid != run_ ? pid_ + 1 : pid_;
      run_ = ordered.desired_runid;
    }
  }
  void say_what_runs() {
    luminav_procman::procman_command_status_t status{};
    status.cmd.exec_str = "lcm-logger";
    status.cmd.command_id = "recorder";
    status.cmd.group = "recording";
    status.pid = pid_;
    status.actual_runid = run_;
    luminav_procman::procman_deputy_info_t info{};
    info.utime = kNow + elapsed_;
    info.deputy_id = "desk";
    info.cmds.push_back(status);
    info.ncmds = 1;
    procman_.publish(channels::kProcmanInfo, &info);
  }
  void run(double seconds, bool has_deputy = true) {
    for (const std::int64_t end = elapsed_ + static_cast<std::int64_t>(seconds * 1e6); elapsed_ < end;) {
      elapsed_ += 50'000;
      if (has_deputy && elapsed_ % 200'000 == 0) {
        say_what_runs();
      }
      while (procman_.handleTimeout(0) > 0) {
      }
      desk_.tick({.steady = elapsed_, .utime = kNow + elapsed_});
    }
  }

  lcm::LCM procman_{"memq://"};
  lcm::LCM data_{"memq://"};
  Subscriber subscriber_;
  ProcessDesk desk_{procman_, data_};
  std::int64_t elapsed_ = 0;  // [us]
  std::int32_t pid_ = 0;
  std::int32_t run_ = 0;
};

TEST_F(ProcessDeskTest, StartsAndStopsWhatADeputyLists) {
  run(1.0);
  EXPECT_EQ(pid_, 0);
  desk_.order({.name = "recorder", .action = ProcessOrder::Action::kStart}, kNow);
  run(5.0);
  EXPECT_NE(pid_, 0);
  Json shown = Json::parse(desk_.json());
  EXPECT_EQ(shown["order"]["fate"], "done");
  EXPECT_EQ(shown["commands"][0]["name"], "recorder");
  EXPECT_EQ(shown["commands"][0]["running"], true);
  desk_.order({.name = "recorder", .action = ProcessOrder::Action::kStop}, kNow);
  run(5.0);
  EXPECT_EQ(pid_, 0);
  EXPECT_EQ(Json::parse(desk_.json())["order"]["fate"], "done");
}

TEST_F(ProcessDeskTest, OnlyWatchesUntilSomebodyOrders) {
  run(5.0);
  EXPECT_EQ(run_, 0);
  EXPECT_TRUE(Json::parse(desk_.json())["order"].is_null());
}

TEST_F(ProcessDeskTest, GoesOnShowingWhenAProcessSaysWhatIsNoNumber) {
  run(1.0);
  desk_.order({.name = "recorder", .action = ProcessOrder::Action::kStart}, kNow);
  run(1.0);
  node_status_t status{};
  status.utime = 1;
  status.process = "lcm-logger";
  status.state = node_status_t::STATE_READY;
  for (const double share : {0.25, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    status.cpu_fraction = share;
    data_.publish(channels::kNodeStatus, &status);
    while (data_.handleTimeout(0) > 0) {
    }
    run(0.5);
    EXPECT_EQ(Json::parse(desk_.json())["commands"][0]["cpu"], 0.25);
  }
}

TEST_F(ProcessDeskTest, RefusesWhatNobodyRuns) {
  EXPECT_THROW(desk_.order({.name = "recorder"}, kNow), RequestError);  // no deputy yet
  run(1.0);
  EXPECT_THROW(desk_.order({.name = "mapper"}, kNow), RequestError);
}

TEST_F(ProcessDeskTest, SaysWhenTheDeputyIsGone) {
  run(1.0);
  run(6.0, false);
  desk_.order({.name = "recorder"}, kNow);
  run(20.0, false);
  EXPECT_EQ(Json::parse(desk_.json())["order"]["fate"], "failed");
}

}  // namespace
}  // namespace luminav
