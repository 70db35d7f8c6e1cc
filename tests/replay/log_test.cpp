#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <lcm/lcm-cpp.hpp>
#include <luminav/fixture_detections_t.hpp>
#include <luminav/grid_tile_t.hpp>
#include <luminav/hypotheses_t.hpp>
#include <luminav/odometry_t.hpp>
#include <luminav/pose_t.hpp>
#include <luminav/robot_status_t.hpp>
#include <luminav/sim_truth_t.hpp>
#include <luminav/sonar_t.hpp>
#include <luminav_procman/procman_deputy_info_t.hpp>

#include "services/common/log/log_file.hpp"
#include "tests/replay/comparison/divergence.hpp"
#include "tests/replay/log_reading/log_survey.hpp"
#include "tests/replay/log_reading/message_schema.hpp"

namespace luminav {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

template <typename Message>
LogEvent event_of(std::int64_t utime, const std::string& channel, const Message& message) {
  LogEvent event{utime, channel, std::vector<std::uint8_t>(static_cast<std::size_t>(message.getEncodedSize()))};
  message.encode(event.data.data(), 0, static_cast<int>(event.data.size()));
  return event;
}

LogEvent odometry_event(std::int64_t utime, std::int32_t sequence, double x = 0.0) {
  odometry_t message{};
  message.utime = utime;
  message.session = 7;
  message.sequence = sequence;
  message.x = x;
  return event_of(utime, "ODOMETRY", message);
}

class LogTest : public testing::Test {
 protected:
  LogTest() : folder_(std::filesystem::temp_directory_path() / ("luminav-log-test-" + std::to_string(getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~LogTest() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string write(const std::string& name, const std::vector<LogEvent>& events) const {
    LogWriter writer(path(name));
    for (const LogEvent& event : events) {
      writer.write(event.utime, event.channel, event.data.data(), event.data.size());
    }
    return writer.finish();
  }

  std::filesystem::path folder_;
};

TEST_F(LogTest, WritesWhatLcmReads) {
  write("a.lcm", {odometry_event(1'000'000, 1), odometry_event(1'100'000, 2)});
  lcm::LogFile log(path("a.lcm"), "r");
  ASSERT_TRUE(log.good());
  const lcm::LogEvent* first = log.readNextEvent();
  ASSERT_NE(first, nullptr);
  EXPECT_EQ(first->channel, "ODOMETRY");
  EXPECT_EQ(first->timestamp, 1'000'000);
  odometry_t message{};
  EXPECT_GT(message.decode(first->data, 0, first->datalen), 0);
  EXPECT_EQ(message.sequence, 1);
  const lcm::LogEvent* second = log.readNextEvent();
  ASSERT_NE(second, nullptr);
  EXPECT_EQ(second->eventnum, 1);
  EXPECT_EQ(log.readNextEvent(), nullptr);
}

TEST_F(LogTest, SumsUpAnEmptyLogAsTheStandardSays) {
  // FIPS 180-4: SHA-256 of nothing
  EXPECT_EQ(LogWriter("").finish(), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

TEST_F(LogTest, ReadsBackWhatItWrote) {
  const std::vector<LogEvent> events = {odometry_event(5, 1), {6, "EMPTY", {}}, odometry_event(7, 2)};
  write("a.lcm", events);
  LogReader log(path("a.lcm"));
  LogEvent event;
  for (const LogEvent& expected : events) {
    ASSERT_TRUE(log.next(event));
    EXPECT_EQ(event.utime, expected.utime);
    EXPECT_EQ(event.channel, expected.channel);
    EXPECT_EQ(event.data, expected.data);
  }
  EXPECT_FALSE(log.next(event));
  EXPECT_EQ(log.damage(), "");
}

TEST_F(LogTest, UsesALogThatWasCutAnywhereUpToTheCut) {
  write("a.lcm", {odometry_event(5, 1), odometry_event(6, 2)});
  const std::uintmax_t whole = std::filesystem::file_size(path("a.lcm"));
  for (std::uintmax_t size = whole / 2 + 1; size < whole; ++size) {
    std::filesystem::copy_file(path("a.lcm"), path("cut.lcm"), std::filesystem::copy_options::overwrite_existing);
    std::filesystem::resize_file(path("cut.lcm"), size);
    LogReader log(path("cut.lcm"));
    LogEvent event;
    EXPECT_TRUE(log.next(event));
    EXPECT_FALSE(log.next(event));
    EXPECT_THAT(log.damage(), HasSubstr("cut at byte")) << size;
    EXPECT_THAT(log.damage(), HasSubstr("the 1 events before it were used"));
  }
}

TEST_F(LogTest, GoesOnBehindDamagedBytes) {
  write("a.lcm", {odometry_event(5, 1)});
  write("b.lcm", {odometry_event(6, 2)});
  std::ofstream out(path("c.lcm"), std::ios::binary);
  out << std::ifstream(path("a.lcm"), std::ios::binary).rdbuf()
      << "\xED\xA1\xDA\x01 nothing of an event, but long enough to look like one"
      << std::ifstream(path("b.lcm"), std::ios::binary).rdbuf();
  out.close();
  LogReader log(path("c.lcm"));
  LogEvent event;
  EXPECT_TRUE(log.next(event));
  EXPECT_TRUE(log.next(event));
  EXPECT_EQ(event.utime, 6);
  EXPECT_FALSE(log.next(event));
  EXPECT_THAT(log.damage(), HasSubstr("damaged"));
}

TEST_F(LogTest, LosesOneEventToALengthThatReachesBeyondTheFile) {
  write("a.lcm", {odometry_event(5, 1), odometry_event(6, 2), odometry_event(7, 3)});
  const auto third = static_cast<std::streamoff>(std::filesystem::file_size(path("a.lcm")) / 3);
  std::fstream file(path("a.lcm"), std::ios::binary | std::ios::in | std::ios::out);
  file.seekp(third + 25);  // sync word, number, time and channel's length; then the data's
  file.put('\x01');
  file.close();
  LogReader log(path("a.lcm"));
  LogEvent event;
  EXPECT_TRUE(log.next(event));
  EXPECT_TRUE(log.next(event));
  EXPECT_EQ(event.utime, 7);
  EXPECT_FALSE(log.next(event));
  EXPECT_FALSE(log.is_cut());
  EXPECT_EQ(log.skipped(), static_cast<std::uint64_t>(third));
}

TEST_F(LogTest, RefusesWhatIsNoLogWithOneSentence) {
  std::ofstream(path("empty")).close();
  std::ofstream(path("text")) << "a text, long enough for an event of a log";
  for (const auto& [name, words] :
       {std::pair{"empty", "empty"}, {"text", "not an LCM log"}, {"missing", "cannot be read"}}) {
    try {
      LogReader log(path(name));
      FAIL() << name;
    } catch (const std::runtime_error& error) {
      EXPECT_THAT(error.what(), HasSubstr(words));
    }
  }
}

TEST_F(LogTest, LeavesNothingWhenItIsNotFinished) {
  {
    LogWriter writer(path("a.lcm"));
    writer.write(1, "A", "x", 1);
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

TEST(MessageSchema, ComputesTheFingerprintsOfTheGeneratedCode) {
  const MessageSchemas& schemas = MessageSchemas::built_in();
  const auto fingerprint = [&](const char* name) {
    return static_cast<std::int64_t>(schemas.find(std::string_view(name))->fingerprint);
  };
  EXPECT_EQ(fingerprint("pose_t"), pose_t::getHash());
  EXPECT_EQ(fingerprint("odometry_t"), odometry_t::getHash());
  EXPECT_EQ(fingerprint("fixture_detections_t"), fixture_detections_t::getHash());
  EXPECT_EQ(fingerprint("grid_tile_t"), grid_tile_t::getHash());
  EXPECT_EQ(fingerprint("hypotheses_t"), hypotheses_t::getHash());
  EXPECT_EQ(fingerprint("robot_status_t"), robot_status_t::getHash());
  EXPECT_EQ(fingerprint("sim_truth_t"), sim_truth_t::getHash());
  EXPECT_EQ(fingerprint("sonar_t"), sonar_t::getHash());
  EXPECT_EQ(fingerprint("procman_deputy_info_t"), luminav_procman::procman_deputy_info_t::getHash());
}

TEST(MessageSchema, DecodesNestedTypesWithUnits) {
  fixture_detections_t message{};
  message.utime = -3;
  message.count = 1;
  message.detections.resize(1);
  message.detections[0].x = 1.25;
  const auto values = MessageSchemas::built_in().decode(event_of(1, "A", message).data);
  ASSERT_TRUE(values);
  EXPECT_EQ((*values)[0].path, "utime");
  EXPECT_EQ(std::get<std::int64_t>((*values)[0].value), -3);
  EXPECT_THAT(*values, Contains(testing::AllOf(
                           testing::Field(&FieldValue::path, "detections[0].x"), testing::Field(&FieldValue::unit, "m"),
                           testing::Field(&FieldValue::value, testing::VariantWith<double>(1.25)))));
}

TEST(MessageSchema, GivesTheFirstElementsOfNestedTypesToo) {
  fixture_detections_t message{};
  message.count = 3;
  message.detections.resize(3);
  const auto values = MessageSchemas::built_in().decode(event_of(1, "A", message).data, 2);
  ASSERT_TRUE(values);
  const auto has = [&](const std::string& path) {
    return std::any_of(values->begin(), values->end(), [&](const FieldValue& value) { return value.path == path; });
  };
  EXPECT_TRUE(has("detections[1].x"));
  EXPECT_FALSE(has("detections[2].x"));
}

TEST(MessageSchema, RefusesAMessageCutAnywhere) {
  sonar_t message{};
  message.count = 2;
  message.range = {1.0F, 2.0F};
  message.has_echo = {1, 0};
  message.fresh = {1, 1};
  message.range_utime = {5, 6};
  const LogEvent event = event_of(1, "SONAR", message);
  ASSERT_TRUE(MessageSchemas::built_in().decode(event.data));
  for (std::size_t size = 0; size < event.data.size(); ++size) {
    EXPECT_FALSE(
        MessageSchemas::built_in().decode({event.data.begin(), event.data.begin() + static_cast<std::ptrdiff_t>(size)}))
        << size;
  }
}

TEST(LogSurvey, CountsLossesStampsOutOfOrderAndGaps) {
  LogSurvey survey;
  survey.add(odometry_event(1'000'000, 1));
  survey.add(odometry_event(1'100'000, 2));
  survey.add(odometry_event(2'000'000, 5));  // 3 and 4 are lost
  LogEvent late = odometry_event(1'500'000, 6);
  late.utime = 2'100'000;
  survey.add(late);
  const ChannelSurvey& odometry = survey.channels().at("ODOMETRY");
  EXPECT_EQ(odometry.type, "odometry_t");
  EXPECT_EQ(odometry.count, 4);
  EXPECT_EQ(odometry.lost, 2);
  EXPECT_EQ(odometry.out_of_order, 1);
  EXPECT_NEAR(odometry.longest_gap, 0.9, 1e-9);
  EXPECT_NEAR(odometry.rate(), 3.0 / 1.1, 1e-9);
  EXPECT_NEAR(odometry.latencies.back(), 0.6, 1e-9);
  EXPECT_THAT(survey.objections(), Contains(HasSubstr("2 messages are missing")));
}

TEST(LogSurvey, TakesTilesThatGoOutAgainForNoDisorder) {
  LogSurvey survey;
  grid_tile_t tile{};
  for (const std::int64_t stamp : {1, 3, 2, 3}) {
    tile.utime = stamp * 1'000'000;
    survey.add(event_of(4'000'000, "GRID_TILE", tile));
  }
  EXPECT_EQ(survey.channels().at("GRID_TILE").undecodable, 0);
  EXPECT_EQ(survey.channels().at("GRID_TILE").out_of_order, 0);
}

TEST(LogSurvey, NamesForeignTypesAndASecondRobot) {
  LogSurvey survey;
  LogEvent foreign = odometry_event(1, 1);
  foreign.data[0] = static_cast<std::uint8_t>(foreign.data[0] ^ 0xFF);
  survey.add(foreign);
  for (const char* robot : {"ada", "bob"}) {
    robot_status_t status{};
    status.robot = robot;
    survey.add(event_of(2, "ROBOT_STATUS", status));
  }
  EXPECT_THAT(survey.objections(), Contains(HasSubstr("ODOMETRY: no known type")));
  EXPECT_THAT(survey.objections(), Contains(HasSubstr("2 robots in it (ada, bob)")));
}

TEST(LogSurvey, TakesALostConnectionForNoSecondSender) {
  const auto senders = [](const std::vector<std::int64_t>& sessions) {
    LogSurvey survey;
    std::int64_t utime = 0;
    for (const std::int64_t session : sessions) {
      robot_status_t status{};
      status.utime = ++utime;
      status.session = session;
      survey.add(event_of(utime, "ROBOT_STATUS", status));
    }
    return survey.objections();
  };
  EXPECT_THAT(senders({0, 7, 0, 0, 7, 0, 8}), Not(Contains(HasSubstr("two senders"))));
  EXPECT_THAT(senders({7, 8, 7}), Contains(HasSubstr("two senders")));
}

TEST(LogSurvey, KnowsThatLcmTestsItself) {
  LogSurvey survey;
  LogEvent event = odometry_event(1, 1);
  event.channel = "LCM_SELF_TEST";
  event.data = {'l', 'c', 'm', ' ', 's', 'e', 'l', 'f', ' ', 't', 'e', 's', 't', 0};
  survey.add(event);
  EXPECT_THAT(survey.objections(), Not(Contains(HasSubstr("LCM_SELF_TEST"))));
}

TEST(Divergence, NamesChannelTimeAndFieldOfTheFirstDifference) {
  DivergenceWatch watch;
  for (const std::int64_t utime : {10, 20, 30}) {
    watch.recorded(odometry_event(utime, static_cast<std::int32_t>(utime), 1.0));
    watch.replayed(odometry_event(utime, static_cast<std::int32_t>(utime), utime < 20 ? 1.0 : 1.5));
  }
  watch.finish();
  const ChannelDivergence& odometry = watch.channels().at("ODOMETRY");
  EXPECT_EQ(watch.first_channel(), "ODOMETRY");
  EXPECT_EQ(odometry.identical, 1);
  EXPECT_EQ(odometry.first_utime, 20);
  EXPECT_EQ(odometry.first_what, "x recorded 1 replayed 1.5");
}

TEST(Divergence, CountsMissingMessagesAsDifference) {
  DivergenceWatch watch;
  watch.recorded(odometry_event(10, 1));
  watch.finish();
  EXPECT_EQ(watch.first_channel(), "ODOMETRY");
}

}  // namespace
}  // namespace luminav
