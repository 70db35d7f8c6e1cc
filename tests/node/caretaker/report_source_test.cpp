#include "services/caretaker/tool/report_source.hpp"

#include <gmock/gmock.h>

#include <stdexcept>

#include "tests/support/temporary_folder.hpp"

namespace luminav {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

ReportSource source_in(const TemporaryFolder& folder) {
  ReportSource source;
  source.robot_file = LUMINAV_SOURCE_DIR "/launch/robots/p3dx.toml";
  source.building_file = LUMINAV_SOURCE_DIR "/launch/buildings/laboratory/building.toml";
  source.state = folder.path().string();
  return source;
}

TEST(ReportSource, TakesTheLedgerOfTheRobotAndItsBuilding) {
  const TemporaryFolder folder;
  const CeilingRecord nothing = read_record(source_in(folder));
  EXPECT_EQ(nothing.ledger.size(), 0U);
  LampLedger ledger("laboratory");
  VisitRecorder::Result seen;
  seen.fixtures.emplace_back(0, FixtureVisit{});
  ledger.add(seen, nothing.building.fixtures);
  save_ledger(nothing.ledger_file, ledger);
  EXPECT_EQ(read_record(source_in(folder)).ledger.size(), 1U);
}

TEST(ReportSource, PlaysLogsInPlaceOfIt) {
  const TemporaryFolder folder;
  ReportSource source = source_in(folder);
  source.logs = {LUMINAV_SOURCE_DIR "/tests/replay/logs/clip.lcm"};
  EXPECT_EQ(read_record(source).ledger.building(), "laboratory");
  source.logs.push_back((folder.path() / "none.lcm").string());
  EXPECT_THAT([&] { (void)read_record(source); },
              ThrowsMessage<std::runtime_error>(HasSubstr("none.lcm: cannot be read as an LCM log")));
}

}  // namespace
}  // namespace luminav
