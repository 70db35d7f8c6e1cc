#include "services/common/log/log_appender.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <filesystem>

#include "services/common/configuration/whole_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace luminav {
namespace {

using testing::ElementsAre;

class LogAppenderTest : public testing::Test {
 protected:
  void write(LogAppender& log, const std::string& text) { log.write(++utime_, "CHANNEL", text.data(), text.size()); }

  /// What a log that is opened again has.
  std::vector<std::string> read() {
    std::vector<std::string> texts;
    const LogAppender log(file_,
                          [&](const LogEvent& event) { texts.emplace_back(event.data.begin(), event.data.end()); });
    return texts;
  }

  TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "new" / "survey.lcm";
  std::int64_t utime_ = 0;
};

TEST_F(LogAppenderTest, GoesOnWhereTheLogEnded) {
  for (const char* text : {"first", "second"}) {
    LogAppender log(file_, [](const LogEvent&) {});
    write(log, text);
  }
  EXPECT_THAT(read(), ElementsAre("first", "second"));
}

TEST_F(LogAppenderTest, WritesWhatTheLogWriterWrites) {
  const std::string whole = (folder_.path() / "whole.lcm").string();
  LogWriter writer(whole);
  for (const std::string text : {"first", "second"}) {
    LogAppender log(file_, [](const LogEvent&) {});
    write(log, text);
    writer.write(utime_, "CHANNEL", text.data(), text.size());
  }
  writer.finish();
  EXPECT_EQ(read_whole_file(file_), read_whole_file(whole));
}

TEST_F(LogAppenderTest, CutsOffWhatIsNotWhole) {
  {
    LogAppender log(file_, [](const LogEvent&) {});
    write(log, "first");
    write(log, "second");
  }
  std::filesystem::resize_file(file_, std::filesystem::file_size(file_) - 3);
  {
    LogAppender log(file_, [](const LogEvent&) {});
    write(log, "third");
  }
  EXPECT_THAT(read(), ElementsAre("first", "third"));
}

TEST_F(LogAppenderTest, KeepsAnotherProcessOut) {
  const LogAppender log(file_, [](const LogEvent&) {});
  EXPECT_THROW(LogAppender(file_, [](const LogEvent&) {}), std::runtime_error);
}

TEST_F(LogAppenderTest, LeavesAFileAloneThatIsNoLog) {
  const std::filesystem::path other = folder_.write("notes.txt", "what somebody wrote");
  EXPECT_THROW(LogAppender(other, [](const LogEvent&) {}), std::runtime_error);
  EXPECT_EQ(read_whole_file(other), "what somebody wrote");
}

TEST_F(LogAppenderTest, TakesBackWhatTheDiskDidNotTakeWhole) {
  const auto before = std::signal(SIGXFSZ, SIG_IGN);
  rlimit limit{};
  getrlimit(RLIMIT_FSIZE, &limit);
  const rlimit full{1000, limit.rlim_max};
  {
    LogAppender log(file_, [](const LogEvent&) {});
    write(log, "first");
    setrlimit(RLIMIT_FSIZE, &full);
    EXPECT_THROW(write(log, std::string(2000, 'x')), std::runtime_error);
    setrlimit(RLIMIT_FSIZE, &limit);
    write(log, "third");
  }
  std::signal(SIGXFSZ, before);
  EXPECT_THAT(read(), ElementsAre("first", "third"));
}

}  // namespace
}  // namespace luminav
