#include "services/common/process/event_loop.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <vector>

#include "services/common/process/channels.hpp"
#include "tests/support/temporary_folder.hpp"

namespace luminav {
namespace {

/// What is said of a process while its loop runs, at most for five seconds.
class LoopWorld {
 public:
  LoopWorld() : inbox_(lcm) {
    inbox_.on(channels::kNodeStatus, &LoopWorld::on_status, this);
    loop.every(5'000'000, [this] {
      if (rounds_++ > 0) {
        loop.stop();
      }
    });
  }
  /// Ends the loop as soon as the process itself has said so.
  void run_until_it_says(std::int8_t state) {
    wanted_ = state;
    loop.run();
  }
  void on_status(const node_status_t& status) {
    if (status.host != "elsewhere") {
      said = status;
      own.instance = status.instance;
      if (status.state == wanted_) {
        loop.stop();
      }
    }
  }
  /// Another process of the name speaks too, from now on.
  void add_twin(const std::string& process) {
    loop.every(50'000, [this, process] {
      node_status_t twin{};
      twin.utime = 1;
      twin.process = process;
      twin.host = "elsewhere";
      twin.robot = "p3dx";
      twin.instance = 17;
      lcm.publish(channels::kNodeStatus, &twin);
    });
  }

  lcm::LCM lcm{"memq://"};
  EventLoop loop{lcm, "controller", "p3dx"};
  node_status_t said{};
  node_status_t own{};

 private:
  Subscriber inbox_;
  int rounds_ = 0;
  std::int8_t wanted_ = -1;
};

TEST(EventLoop, SaysFaultWhenAnotherProcessPlaysItsRole) {
  LoopWorld world;
  world.add_twin("controller");
  world.run_until_it_says(node_status_t::STATE_FAULT);
  EXPECT_EQ(world.said.state, node_status_t::STATE_FAULT);
  EXPECT_TRUE(world.said.reason.starts_with("two controllers on this network: ")) << world.said.reason;
  EXPECT_NE(world.said.reason.find("elsewhere"), std::string::npos) << world.said.reason;
  EXPECT_EQ(world.loop.conflict(), world.said.reason);
}

TEST(EventLoop, IsReadyBesideProcessesOfOtherRoles) {
  LoopWorld world;
  world.add_twin("planner");
  world.run_until_it_says(node_status_t::STATE_READY);
  EXPECT_EQ(world.said.state, node_status_t::STATE_READY);
  EXPECT_EQ(world.loop.conflict(), "");
}

TEST(EventLoop, TakesTheZonesOverThatAnotherProcessHas) {
  TemporaryFolder folder;
  const std::string hut = "name = \"hut\"\nceiling_height = 2.5\n";
  const std::filesystem::path file = folder.write("building.toml", hut);
  LoopWorld world;
  std::vector<std::size_t> zones;
  world.loop.follow_building(file, [&](const Building& building) { zones.push_back(building.zones.size()); });
  EXPECT_EQ(zones, std::vector<std::size_t>{0});
  folder.write("building.toml", hut + "[[zone]]\nname = \"stairs\"\npolygon = [[0, 0], [1, 0], [1, 1]]\n");
  node_status_t viewer{};
  viewer.utime = 1;
  viewer.process = "viewer";
  viewer.host = "elsewhere";
  viewer.building = "hut";
  viewer.building_hash = BuildingWatch(file).sum();
  world.lcm.publish(channels::kNodeStatus, &viewer);
  world.loop.every(20'000, [&] {
    if (world.said.building_hash == viewer.building_hash) {
      world.loop.stop();
    }
  });
  world.loop.run();
  EXPECT_EQ(zones, (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(world.said.building_hash, viewer.building_hash);
}

TEST(EventLoop, CallsBackWhenNoTimeIsLeft) {
  LoopWorld world;
  std::optional<std::int64_t> left;  // nothing: not now
  std::vector<int> called;
  world.loop.when_due([&] { return left; },
                      [&] {
                        called.push_back(1);
                        left.reset();
                        if (called.size() == 2) {
                          world.loop.stop();
                        }
                      });
  world.loop.when_due([&] { return std::optional<std::int64_t>(60'000'000); }, [&] { called.push_back(2); });
  world.loop.every(10'000, [&] { left = left ? 0 : 10'000; });
  world.loop.run();
  EXPECT_EQ(called, (std::vector<int>{1, 1}));
}

TEST(EventLoop, IsDegradedWhileItHearsNotEvenItself) {
  const TemporaryFolder folder;
  const std::string log = (folder.path() / "said.lcm").string();
  {
    lcm::LCM lcm("file://" + log + "?mode=w");  // takes what is said, and nothing is ever heard
    EventLoop loop(lcm, "controller", "p3dx");
    int rounds = 0;
    loop.every(3'700'000, [&] {
      if (rounds++ > 0) {
        loop.stop();
      }
    });
    loop.run();
  }
  std::vector<node_status_t> said;
  lcm::LogFile file(log, "r");
  for (const lcm::LogEvent* event = file.readNextEvent(); event != nullptr; event = file.readNextEvent()) {
    ASSERT_GT(said.emplace_back().decode(event->data, 0, event->datalen), 0);
  }
  ASSERT_GE(said.size(), 2U);
  EXPECT_EQ(said.front().state, node_status_t::STATE_READY) << "it may not have spoken yet";
  EXPECT_EQ(said.back().state, node_status_t::STATE_DEGRADED);
  EXPECT_EQ(said.back().reason, "hears not even itself on the network: its interface is gone");
}

TEST(EventLoop, LetsItsProcessHaveHalfAGigabyte) {
#ifdef LUMINAV_SANITIZED
  GTEST_SKIP() << "sanitizers need more and get it";
#endif
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_DATA, &before), 0);
  const rlimit as_much_as_may_be{before.rlim_max, before.rlim_max};  // other tests have limited it already
  ASSERT_EQ(setrlimit(RLIMIT_DATA, &as_much_as_may_be), 0);
  const LoopWorld world;
  rlimit limited{};
  EXPECT_EQ(getrlimit(RLIMIT_DATA, &limited), 0);
  setrlimit(RLIMIT_DATA, &before);
  EXPECT_EQ(limited.rlim_cur, std::min<rlim_t>(before.rlim_max, 512 << 20));
}

}  // namespace
}  // namespace luminav
