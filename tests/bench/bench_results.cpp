#include "tests/bench/bench_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "services/common/configuration/whole_file.hpp"

namespace luminav {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kMedianLatency = "p50_us";  // counter

Json read_json(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) {
    throw std::runtime_error(fmt::format("{}: cannot be read", file.string()));
  }
  std::string text{std::istreambuf_iterator<char>(in), {}};
  // Google Benchmark writes the relative spread of a counter that is always 0 as NaN, which is no JSON
  for (std::size_t at = text.find(": NaN"); at != std::string::npos; at = text.find(": NaN", at)) {
    text.replace(at, 5, ": null");
  }
  try {
    return Json::parse(text);
  } catch (const Json::exception&) {
    throw std::runtime_error(fmt::format("{}: is not JSON", file.string()));
  }
}

/// "plan/200/iterations:5/manual_time" -> "plan/200"
std::string plain_name(const std::string& name) {
  std::string plain;
  for (std::size_t start = 0; start <= name.size();) {
    const std::size_t end = std::min(name.find('/', start), name.size());
    const std::string part = name.substr(start, end - start);
    const bool is_setting =
        part == "manual_time" || part == "real_time" || part == "process_time" || part.find(':') != std::string::npos;
    if (!is_setting) {
      plain += (plain.empty() ? "" : "/") + part;
    }
    start = end + 1;
  }
  return plain;
}

/// Keys of Google Benchmark that are no counters.
bool is_counter(const std::string& key, const Json& value) {
  static constexpr const char* kKnown[] = {"family_index", "per_family_instance_index",
                                           "repetitions",  "repetition_index",
                                           "threads",      "iterations",
                                           "real_time",    "cpu_time"};
  return value.is_number() &&
         std::none_of(std::begin(kKnown), std::end(kKnown), [&](const char* known) { return key == known; });
}

/// Of one of the unit. All times are kept in nanoseconds, so that they can be compared.
double nanoseconds(const std::string& unit) {
  return unit == "us" ? 1e3 : (unit == "ms" ? 1e6 : (unit == "s" ? 1e9 : 1.0));
}

std::string time_text(double nanoseconds) {
  // what rounds up to 1000 of a unit is 1 of the next
  for (const auto& [unit, size] : {std::pair("ns", 1.0), {"us", 1e3}, {"ms", 1e6}}) {
    if (nanoseconds < 999.5 * size) {
      return fmt::format("{:.3g} {}", nanoseconds / size, unit);
    }
  }
  return fmt::format("{:.3g} s", 1e-9 * nanoseconds);
}

std::string time_text(const BenchResult& result) {
  return result.unit == "ns" ? time_text(result.time) : fmt::format("{:.3g} {}", result.time, result.unit);
}

std::string counter_text(const std::string& name, double value) {
  if (name.starts_with("per_")) {  // seconds
    return fmt::format("{} {}", time_text(1e9 * value), name);
  }
  if (name == "bytes_per_second") {
    return fmt::format("{:.0f} MB/s", 1e-6 * value);
  }
  return fmt::format("{} {:.4g}", name, value);
}

std::string change_text(const BenchResult& now, const BenchResult& before) {
  const double change = now.time / before.time - 1.0;
  const double threshold = std::max(0.05, 3.0 * std::hypot(now.noise, before.noise));
  if (std::abs(change) < threshold) {
    return "same";
  }
  return fmt::format("{:.0f} % {}", 100.0 * std::abs(change), change < 0.0 ? "better" : "WORSE");
}

}  // namespace

const BenchResult* BenchResults::find(const std::string& name) const {
  const auto found =
      std::find_if(results.begin(), results.end(), [&](const BenchResult& result) { return result.name == name; });
  return found == results.end() ? nullptr : &*found;
}

void add_google_results(const std::filesystem::path& file, BenchResults& results) {
  const Json json = read_json(file);
  if (!json.contains("benchmarks") || !json.contains("context")) {
    throw std::runtime_error(fmt::format("{}: was not written by a benchmark", file.string()));
  }
  if (results.machine.empty()) {
    results.machine =
        fmt::format("{} cores, {} MHz", json["context"].value("num_cpus", 0), json["context"].value("mhz_per_cpu", 0));
  }
  std::map<std::string, double> noise;
  for (const Json& entry : json["benchmarks"]) {
    const bool is_wall = entry.value("name", "").find("_time") != std::string::npos;
    const std::string name = plain_name(entry.value("run_name", entry.value("name", "")));
    const std::string aggregate = entry.value("aggregate_name", "");
    const double time = entry.value(is_wall ? "real_time" : "cpu_time", 0.0);
    if (aggregate == "cv") {
      noise[name] = entry.value(kMedianLatency, time);
    } else if (entry.value("error_occurred", false)) {
      throw std::runtime_error(fmt::format("{}: {}", name, entry.value("error_message", "failed")));
    } else if (aggregate.empty() || aggregate == "median") {
      BenchResult result{
          .name = name, .time = time * nanoseconds(entry.value("time_unit", "ns")), .unit = "ns", .counters = {}};
      for (const auto& [key, value] : entry.items()) {
        if (is_counter(key, value)) {
          result.counters.emplace_back(key, value.get<double>());
        }
      }
      // of a latency the median says more than the mean over all messages: one that waited for a core is longer than
      // all
      result.time = entry.contains(kMedianLatency) ? 1e3 * entry[kMedianLatency].get<double>() : result.time;
      results.results.push_back(std::move(result));
    }
  }
  for (BenchResult& result : results.results) {
    if (const auto found = noise.find(result.name); found != noise.end()) {
      result.noise = found->second;
    }
  }
}

void add_demo_report(const std::filesystem::path& file, BenchResults& results) {
  const Json json = read_json(file);
  for (const Json& process : json.at("processes")) {
    results.results.push_back({.name = "process/" + process.at("name").get<std::string>(),
                               .time = process.at("cpu_percent").get<double>(),
                               .unit = "% of a core",
                               .counters = {{"rss_MB", process.at("rss_mb").get<double>()}}});
  }
}

BenchResults read_bench_results(const std::filesystem::path& file) {
  const Json json = read_json(file);
  BenchResults results;
  try {
    results.machine = json.at("machine").get<std::string>();
    results.load_before = json.at("load_before").get<double>();
    for (const Json& entry : json.at("results")) {
      BenchResult result{.name = entry.at("name"),
                         .time = entry.at("time"),
                         .unit = entry.at("unit"),
                         .noise = entry.at("noise"),
                         .counters = {}};
      for (const auto& [key, value] : entry.at("counters").items()) {
        result.counters.emplace_back(key, value.get<double>());
      }
      results.results.push_back(std::move(result));
    }
  } catch (const Json::exception&) {
    throw std::runtime_error(fmt::format("{}: was not written by scripts/bench", file.string()));
  }
  return results;
}

void write_bench_results(const std::filesystem::path& file, const BenchResults& results) {
  Json json = {{"machine", results.machine}, {"load_before", results.load_before}, {"busy", results.is_busy()}};
  json["results"] = Json::array();
  for (const BenchResult& result : results.results) {
    Json counters = Json::object();
    for (const auto& [key, value] : result.counters) {
      counters[key] = value;
    }
    json["results"].push_back({{"name", result.name},
                               {"time", result.time},
                               {"unit", result.unit},
                               {"noise", result.noise},
                               {"counters", counters}});
    if (const BenchResult* peer = peer_of(results, result.name)) {
      json["results"].back()["peer"] = peer->name;
    }
  }
  write_whole_file(file, json.dump(2) + "\n");
}

const BenchResult* peer_of(const BenchResults& results, const std::string& name) {
  const std::size_t slash = name.find('/');
  const std::string family = name.substr(0, slash);
  const std::string rest = slash == std::string::npos ? "" : name.substr(slash);
  const std::map<std::string, std::string> fixed = {{"detector/modern", "detector/opencv"},
                                                    {"lcm/300", "udp_multicast/300"},
                                                    {"lcm/30000", "udp_multicast/30000"},
                                                    {"lcm_node/300", "lcm/300"},
                                                    {"lcm_node/30000", "lcm/30000"}};
  if (const auto found = fixed.find(name); found != fixed.end()) {
    return results.find(found->second);
  }
  for (const char* suffix : {"_mrpt", "_opencv"}) {
    if (const BenchResult* peer = results.find(family + suffix + rest)) {
      return peer;
    }
  }
  return nullptr;
}

std::string bench_table(const BenchResults& results, const BenchResults* old) {
  std::string table = fmt::format("{:<28}{:>12}{:>8}   {}\n", "benchmark", "time", "noise",
                                  old ? "change, peer, counters" : "peer, counters");
  for (const BenchResult& result : results.results) {
    table += fmt::format("{:<28}{:>12}{:>6.1f} %  ", result.name, time_text(result), 100.0 * result.noise);
    if (old != nullptr) {
      const BenchResult* before = old->find(result.name);
      table += fmt::format(" {}", before == nullptr ? "new" : change_text(result, *before));
    }
    const BenchResult* peer = peer_of(results, result.name);
    if (peer != nullptr && result.time > 0.0) {
      table += fmt::format(" {:.2g} x as fast as {}", peer->time / result.time, peer->name);
    }
    for (const auto& [key, value] : result.counters) {
      table += "  " + counter_text(key, value);
    }
    table += '\n';
  }
  if (results.is_busy()) {
    table += fmt::format(
        "Measured on a BUSY machine (others took {:.0f} % of its processors before it began): don't quote.\n",
        100.0 * results.load_before);
  }
  return table;
}

}  // namespace luminav
