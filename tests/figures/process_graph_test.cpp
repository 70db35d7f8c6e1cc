#include "tests/figures/process_graph.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temporary_folder.hpp"

namespace luminav {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kTable =
    "| name | what |\n| --- | --- |\n| a | b |\n\n"
    "| channel | type | rate | publisher | subscribers |\n| --- | --- | --- | --- | --- |\n"
    "| POSE | pose_t | 10 Hz | localizer | mapper, planner |\n"
    "| GOAL | goal_t | request | viewer, `scripts/goto` | planner |\n"
    "| NODE_STATUS | node_status_t | 1 Hz | every process | sheriff |\n";

TEST(ChannelTable, IsReadFromMarkdown) {
  const TemporaryFolder folder;
  const auto rows = read_channel_table(folder.write("README.md", kTable));
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[0].channel, "POSE");
  EXPECT_THAT(rows[0].subscribers, ElementsAre("mapper", "planner"));
  EXPECT_THAT(rows[1].publishers, ElementsAre("viewer", "scripts/goto"));
  EXPECT_ANY_THROW(read_channel_table(folder.write("empty.md", "no table here\n")));
}

TEST(ChannelTable, IsFoundInTheProjectsOwnReadme) {
  const auto rows = read_channel_table(std::filesystem::path(LUMINAV_SOURCE_DIR) / "lcmtypes/README.md");
  EXPECT_GE(rows.size(), 20U);
}

TEST(ProcessGraph, ShowsWhatIsPublishedByTheProcessesGiven) {
  const TemporaryFolder folder;
  const auto rows = read_channel_table(folder.write("README.md", kTable));
  const std::string svg = draw_process_graph({"localizer", "planner"}, rows);
  EXPECT_THAT(svg, HasSubstr(">POSE</text>"));
  EXPECT_THAT(svg, HasSubstr(">NODE_STATUS</text>"));
  EXPECT_THAT(svg, Not(HasSubstr(">GOAL</text>")));  // the viewer is not there
}

}  // namespace
}  // namespace luminav
