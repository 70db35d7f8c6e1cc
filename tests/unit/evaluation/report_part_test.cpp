#include "tests/evaluation/report/report_part.hpp"

#include <gmock/gmock.h>

#include <limits>

#include "services/common/configuration/configuration_error.hpp"
#include "tests/evaluation/report/html_report.hpp"

namespace luminav {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double kThird = 1.0 / 3.0;

RunReport run(int i) {
  RunReport report;
  report.scenario = i % 2 == 0 ? "even" : "odd";
  report.seed = static_cast<std::uint64_t>(1000 + i);
  report.suite = "worlds";
  report.group = report.scenario;
  report.passed = i % 3 != 0;
  report.failure = report.passed ? "" : "goal 1 was missed: \"so\"\n";
  report.simulated_s = 100.0 + kThird * i;
  report.cpu_s = 0.1 + 0.01 * kThird;
  report.localized = i != 1;
  report.localized_after_m = kThird * i;
  report.resolvable_after_m = i == 2 ? std::numeric_limits<double>::infinity() : i - 1.0;
  report.tracking_ratio = kThird;
  if (i > 2) {
    report.in_view_position_rms_m = 0.01 * kThird * i;
    report.nees = kThird;
  }
  report.driven_m = 10.0 * kThird;
  report.goals.push_back({1.0, kThird, report.passed, false, false, kThird, std::nullopt, 12.0, -1.0, "so"});
  report.drive.contacts.push_back({kThird, "wall", 1.0, 2.0, 3.0, 0.1, 0.2, 4});
  report.map = {i == 3, kThird, kThird, kThird, kThird};
  if (i == 4) {
    report.zones = {0.0, kThird, kThird, kThird, 1.0, kThird};
    report.jobs = {2, 1, 0, 0, 3, 1, 0, 1, 1, 2, 11.9, 4, {"job 2 was given up"}};
  }
  report.processes.push_back({"all", kThird, 12.5, 1});
  report.world_table = "noise";
  report.trail = {{{1.0, 2.0, kThird}, {1.0, 2.1, kThird}, {0.0, 0.0, 0.0}, 2, 1, 0.0},
                  {{2.0, 2.0, kThird}, {2.0, 2.1, kThird}, {1.0, 0.0, 0.0}, 2, 1, 5.0 + kThird}};
  report.log = {"a line"};
  return report;
}

ReportPart whole() {
  ReportPart part;
  part.suite = "worlds";
  part.mode = "default";
  part.sensing = "geometric";
  part.sensing_remark = "not checked\n";
  part.detector = {{"bright", 5, kThird, kThird, kThird, kThird, kThird, 1.0}};
  for (int i = 0; i < 7; ++i) {
    part.runs.push_back(run(i));
    part.plan.push_back("run " + std::to_string(i));
  }
  return part;
}

ReportPart cut(const ReportPart& all, const Shard& shard) {
  ReportPart part = all;
  part.shard = shard;
  part.runs = runs_of_shard(all.runs, shard);
  part.detector = shard.index == 1 ? all.detector : std::vector<DetectorCondition>();
  return part_of_cbor(to_cbor(part), "file");
}

TEST(ReportPart, PartsInAnyOrderMakeTheReportOfTheWhole) {
  const ReportPart all = whole();
  for (const int count : {1, 3, 8}) {  // of eight parts one has no run
    std::vector<std::pair<std::string, ReportPart>> parts;
    for (int i = count; i >= 1; --i) {
      parts.emplace_back("file", cut(all, {i, count}));
    }
    const ReportPart again = joined(parts);
    EXPECT_EQ(to_json(again), to_json(all));
    EXPECT_EQ(html_report({to_json(again), again.sensing_remark, 1.0}, again.runs),
              html_report({to_json(all), all.sensing_remark, 1.0}, all.runs));
  }
}

TEST(ReportPart, RefusesPartsThatMakeNoWhole) {
  const ReportPart all = whole();
  const std::pair first("a", cut(all, {1, 2}));
  const std::pair second("b", cut(all, {2, 2}));
  EXPECT_THAT([&] { joined({first}); }, ThrowsMessage<std::runtime_error>(HasSubstr("2/2 is missing")));
  EXPECT_THAT([&] { joined({first, second, first}); }, ThrowsMessage<std::runtime_error>(HasSubstr("there twice")));
  ReportPart other = all;
  other.plan.back() = "run 8";
  EXPECT_THAT(
      [&] {
        joined({first, {"c", cut(other, {2, 2})}});
      },
      ThrowsMessage<std::runtime_error>(HasSubstr("a and c: are parts of different evaluations")));
}

TEST(ReportPart, RefusesFilesThatAreNone) {
  const std::string cbor = to_cbor(whole());
  for (const std::string& text : {std::string(), std::string("{}"), cbor.substr(0, cbor.size() / 2)}) {
    EXPECT_THAT([&] { part_of_cbor(text, "x.part"); }, ThrowsMessage<std::runtime_error>(HasSubstr("x.part")));
  }
  ReportPart short_of_one = whole();
  short_of_one.runs.pop_back();
  EXPECT_THROW(part_of_cbor(to_cbor(short_of_one), "x"), std::runtime_error);
}

TEST(Shard, TakesEveryNth) {
  EXPECT_THAT(runs_of_shard(std::vector{0, 1, 2, 3, 4}, read_shard("2/3")), ElementsAre(1, 4));
  for (const char* wrong : {"", "1", "0/3", "4/3", "1/", "/2", "-1/2", "1/2x", "a/b", "1/0"}) {
    EXPECT_THROW(read_shard(wrong), ConfigurationError) << wrong;
  }
}

}  // namespace
}  // namespace luminav
