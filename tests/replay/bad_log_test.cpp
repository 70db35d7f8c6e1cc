#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <luminav/robot_status_t.hpp>

#include "tests/replay/replay_run.hpp"

namespace luminav {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::int64_t kSpan = 3'000'000;  // [us] of the drive that is used
const std::string kSource = LUMINAV_SOURCE_DIR "/tests/replay/logs/global.lcm";

/// What a replay does with logs that are not as they should be.
class BadLog : public testing::Test {
 protected:
  BadLog() : folder_(std::filesystem::temp_directory_path() / ("luminav-bad-log-" + std::to_string(getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~BadLog() override { std::filesystem::remove_all(folder_); }

  /// The first seconds of a good log, every event changed by `change`.
  std::string changed(const std::function<void(LogEvent&)>& change) const {
    const std::string file = (folder_ / "changed.lcm").string();
    LogReader log(kSource);
    LogWriter writer(file);
    LogEvent event;
    std::int64_t first = 0;
    while (log.next(event) && (first == 0 || event.utime - first < kSpan)) {
      first = first == 0 ? event.utime : first;
      change(event);
      writer.write(event.utime, event.channel, event.data.data(), event.data.size());
    }
    writer.finish();
    return file;
  }
  static ReplayReport replay(const std::string& file) {
    ReplayOptions options;
    options.log_file = file;
    options.robot_file = LUMINAV_SOURCE_DIR "/launch/robots/p3dx.toml";
    options.building_file = LUMINAV_SOURCE_DIR "/launch/buildings/laboratory/building.toml";
    options.nodes = {"localizer", "mapper"};
    return replay_log(options);
  }
  static std::string refusal(const std::string& file) {
    try {
      replay(file);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  }

  std::filesystem::path folder_;
};

TEST_F(BadLog, ThatIsGoodPasses) {
  const ReplayReport report = replay(changed([](LogEvent&) {}));
  EXPECT_THAT(report.failures, IsEmpty());
  EXPECT_EQ(report.log_damage, "");
  EXPECT_GT(report.replayed.poses, 20);
}

TEST_F(BadLog, CutIsUsedUpToTheCut) {
  const std::string file = changed([](LogEvent&) {});
  std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2 + 1);
  const ReplayReport report = replay(file);
  EXPECT_GT(report.replayed.poses, 5);
  EXPECT_THAT(report.log_damage, HasSubstr("cut at byte"));
  EXPECT_THAT(to_text(report), testing::EndsWith("events before it were used\n"));
}

TEST_F(BadLog, EmptyOrForeignIsRefusedInASentence) {
  std::ofstream(folder_ / "empty.lcm").close();
  std::ofstream(folder_ / "text.lcm") << "no log at all, but long enough to be one";
  EXPECT_THAT(refusal((folder_ / "empty.lcm").string()), HasSubstr("empty.lcm: the file is empty"));
  EXPECT_THAT(refusal((folder_ / "text.lcm").string()), HasSubstr("text.lcm: not an LCM log"));
  EXPECT_THAT(refusal((folder_ / "missing.lcm").string()), HasSubstr("missing.lcm: cannot be read"));
  EXPECT_THAT(refusal(folder_.string()), HasSubstr("cannot be read"));
}

TEST_F(BadLog, OfAnOlderMessageTypeFailsAndNamesTheChannel) {
  const ReplayReport report = replay(changed([](LogEvent& event) {
    if (event.channel == "SONAR") {
      event.data[3] = static_cast<std::uint8_t>(event.data[3] ^ 0x55U);  // in the fingerprint
    }
  }));
  EXPECT_THAT(report.failures, Contains(HasSubstr("SONAR: recorded with another version of its type")));
  EXPECT_GT(report.replayed.poses, 20);
}

TEST_F(BadLog, WithTwoRobotsFailsAndNamesThem) {
  int count = 0;
  const ReplayReport report = replay(changed([&](LogEvent& event) {
    if (event.channel == "ROBOT_STATUS") {
      robot_status_t status{};
      ASSERT_GT(status.decode(event.data.data(), 0, static_cast<int>(event.data.size())), 0);
      status.robot = ++count % 2 == 0 ? "ada" : "bob";
      event.data.resize(static_cast<std::size_t>(status.getEncodedSize()));
      status.encode(event.data.data(), 0, static_cast<int>(event.data.size()));
    }
  }));
  EXPECT_THAT(report.failures, Contains(HasSubstr("two robots are in the log (ada, bob)")));
}

TEST_F(BadLog, WithDamagedMessagesRefusesThoseAndGoesOn) {
  int count = 0;
  const ReplayReport report = replay(changed([&](LogEvent& event) {
    if (event.channel == "ODOMETRY" && ++count == 5) {
      event.data.resize(event.data.size() - 3);
    }
  }));
  EXPECT_GE(report.dropped, 1);
  EXPECT_GT(report.replayed.poses, 20);
}

}  // namespace
}  // namespace luminav
