#include "tests/bench/bench_results.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "tests/support/temporary_folder.hpp"

namespace luminav {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr const char* kGoogle = R"({"context": {"num_cpus": 2, "mhz_per_cpu": 3000}, "benchmarks": [
  {"name": "cspace/200_mean", "run_name": "cspace/200", "aggregate_name": "mean", "real_time": 99, "cpu_time": 99, "time_unit": "ns"},
  {"name": "cspace/200_median", "run_name": "cspace/200", "aggregate_name": "median", "real_time": 30, "cpu_time": 20, "time_unit": "ns", "cells": 5},
  {"name": "cspace/200_cv", "run_name": "cspace/200", "aggregate_name": "cv", "real_time": 0.1, "cpu_time": 0.01, "time_unit": "ns"},
  {"name": "cspace_opencv/200", "run_name": "cspace_opencv/200", "real_time": 90, "cpu_time": 80, "time_unit": "ns"},
  {"name": "lcm/300/iterations:3000/manual_time", "run_name": "lcm/300/iterations:3000/manual_time", "real_time": 90000, "cpu_time": 7, "time_unit": "ns", "p50_us": 40}]})";

BenchResults google() {
  const TemporaryFolder folder;
  BenchResults results;
  add_google_results(folder.write("g.json", kGoogle), results);
  return results;
}

TEST(BenchResults, TakeTheMediansCpuTimeAndWallClockOnlyWhereThatIsMeasured) {
  const BenchResults results = google();
  ASSERT_EQ(results.results.size(), 3U);
  EXPECT_EQ(results.find("cspace/200")->time, 20.0);
  EXPECT_EQ(results.find("cspace/200")->noise, 0.01);
  EXPECT_EQ(results.find("lcm/300")->time, 40000.0);
  EXPECT_EQ(results.find("cspace/200")->counters, (std::vector<std::pair<std::string, double>>{{"cells", 5.0}}));
}

TEST(BenchResults, AreComparedWithThePeerOfTheSameRun) {
  EXPECT_EQ(peer_of(google(), "cspace/200")->name, "cspace_opencv/200");
  EXPECT_EQ(peer_of(google(), "cspace_opencv/200"), nullptr);
  EXPECT_THAT(bench_table(google(), nullptr), HasSubstr("4 x as fast as cspace_opencv/200"));
}

TEST(BenchResults, AreInNanosecondsWhateverUnitTheyWereWrittenIn) {
  const TemporaryFolder folder;
  BenchResults results;
  add_google_results(folder.write("g.json", R"({"context": {}, "benchmarks": [
    {"name": "plan/200", "cpu_time": 50, "time_unit": "us"}, {"name": "plan_mrpt/200", "cpu_time": 0.2, "time_unit": "ms"},
    {"name": "pf", "cpu_time": 999.7, "time_unit": "ns", "per_particle": 1.5e-8, "bytes_per_second": 2e9}]})"),
                     results);
  const std::string table = bench_table(results, nullptr);
  EXPECT_THAT(table, HasSubstr("50 us"));
  EXPECT_THAT(table, HasSubstr("4 x as fast as plan_mrpt/200"));
  EXPECT_THAT(table, HasSubstr("1 us"));
  EXPECT_THAT(table, HasSubstr("15 ns per_particle"));
  EXPECT_THAT(table, HasSubstr("2000 MB/s"));
}

TEST(BenchResults, SurviveTheirFile) {
  const TemporaryFolder folder;
  write_bench_results(folder.path() / "b.json", google());
  const BenchResults read = read_bench_results(folder.path() / "b.json");
  EXPECT_EQ(read.machine, "2 cores, 3000 MHz");
  EXPECT_EQ(bench_table(read, nullptr), bench_table(google(), nullptr));
}

TEST(BenchResults, SayWhatGotWorseBeyondNoise) {
  const BenchResults old = google();
  BenchResults now = google();
  now.results[0].time = 20.5;  // within 5 %
  now.results[1].time = 40.0;
  now.results[2].time = 80000.0;
  const std::string table = bench_table(now, &old);
  EXPECT_THAT(table, HasSubstr("same"));
  EXPECT_THAT(table, HasSubstr("50 % better"));
  EXPECT_THAT(table, HasSubstr("100 % WORSE"));
}

TEST(BenchResults, SayThatTheMachineWasBusy) {
  BenchResults results = google();
  EXPECT_THAT(bench_table(results, nullptr), Not(HasSubstr("BUSY")));
  results.load_before = 0.3;
  EXPECT_THAT(bench_table(results, nullptr), HasSubstr("BUSY"));
}

TEST(BenchResults, RefuseAnotherFile) {
  const TemporaryFolder folder;
  BenchResults results;
  EXPECT_ANY_THROW(add_google_results(folder.write("x.json", "{}"), results));
  EXPECT_ANY_THROW(add_google_results(folder.write("y.json", "hello"), results));
  EXPECT_ANY_THROW(add_google_results(folder.path() / "none.json", results));
  EXPECT_ANY_THROW(read_bench_results(folder.path() / "x.json"));
}

}  // namespace
}  // namespace luminav
