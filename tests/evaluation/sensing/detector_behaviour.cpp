#include "tests/evaluation/sensing/detector_behaviour.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "services/common/configuration/toml_table.hpp"

namespace luminav {
namespace {

using nlohmann::json;

constexpr std::int64_t kEnoughShown = 30;
constexpr std::size_t kEnoughErrors = 8;
constexpr std::array<double, SightingClass::kShares - 1> kShareEdges{0.15, 0.25, 0.35, 0.45, 0.55, 0.7, 0.85, 0.999};
constexpr std::array<double, SightingClass::kTurns - 1> kTurnEdges{0.05, 0.4};  // [rad/s]

/// How unlike two classes are.
int unlikeness(const SightingClass& a, const SightingClass& b) {
  const bool a_unlit = a.light >= 2;
  const bool b_unlit = b.light >= 2;
  const int light = a.light == b.light ? 0 : (a_unlit && b_unlit ? 6 * std::abs(a.light - b.light) : 60);
  return (a.shape == b.shape ? 0 : 100) + light + 12 * std::abs(a.ends - b.ends) + 3 * std::abs(a.share - b.share) +
         2 * std::abs(a.turn - b.turn);
}

template <typename Enough>
std::vector<int> nearest(const Enough& enough) {
  std::vector<int> good;
  for (int i = 0; i < SightingClass::kCount; ++i) {
    if (enough(i)) {
      good.push_back(i);
    }
  }
  std::vector<int> result(SightingClass::kCount, -1);
  for (int i = 0; i < SightingClass::kCount; ++i) {
    int min = 1 << 20;
    for (const int other : good) {
      const int unlike = unlikeness(SightingClass::at(i), SightingClass::at(other));
      if (unlike < min) {
        min = unlike;
        result[static_cast<std::size_t>(i)] = other;
      }
    }
  }
  return result;
}

double rounded(double value) {
  if (value == 0.0 || !std::isfinite(value)) {
    return 0.0;
  }
  const double scale = std::pow(10.0, 2.0 - std::floor(std::log10(std::abs(value))));
  return std::round(value * scale) / scale;
}

json row_of(const MeasuredSighting& s) {
  return {rounded(s.along),
          rounded(s.across),
          rounded(s.turn),
          rounded(s.sigma_along),
          rounded(s.sigma_across),
          rounded(s.sigma_turn),
          rounded(s.correlation),
          rounded(s.length),
          rounded(s.width),
          rounded(s.fit),
          s.state,
          (s.near_end ? 1 : 0) + (s.far_end ? 2 : 0) + (s.clipped ? 4 : 0)};
}

MeasuredSighting sighting_of(const json& row) {
  MeasuredSighting s;
  s.along = row.at(0);
  s.across = row.at(1);
  s.turn = row.at(2);
  s.sigma_along = row.at(3);
  s.sigma_across = row.at(4);
  s.sigma_turn = row.at(5);
  s.correlation = row.at(6);
  s.length = row.at(7);
  s.width = row.at(8);
  s.fit = row.at(9);
  s.state = row.at(10);
  const int flags = row.at(11);
  s.near_end = (flags & 1) != 0;
  s.far_end = (flags & 2) != 0;
  s.clipped = (flags & 4) != 0;
  return s;
}

json row_of(const MeasuredFalseAlarm& f) {
  json covariance = json::array();
  for (const double value : f.covariance) {
    covariance.push_back(rounded(value));
  }
  return {rounded(f.robot_from_fixture.x),
          rounded(f.robot_from_fixture.y),
          rounded(f.robot_from_fixture.theta),
          covariance,
          rounded(f.length),
          rounded(f.width),
          rounded(f.fit),
          f.shape,
          f.state,
          (f.near_end ? 1 : 0) + (f.far_end ? 2 : 0) + (f.clipped ? 4 : 0)};
}

MeasuredFalseAlarm false_alarm_of(const json& row) {
  MeasuredFalseAlarm f;
  f.robot_from_fixture = {row.at(0), row.at(1), row.at(2)};
  f.covariance = row.at(3);
  f.length = row.at(4);
  f.width = row.at(5);
  f.fit = row.at(6);
  f.shape = row.at(7);
  f.state = row.at(8);
  const int flags = row.at(9);
  f.near_end = (flags & 1) != 0;
  f.far_end = (flags & 2) != 0;
  f.clipped = (flags & 4) != 0;
  return f;
}

}  // namespace

FixtureLight light_of(bool burns, bool half, double unlit_darker) {
  if (burns) {
    return half ? FixtureLight::kHalf : FixtureLight::kLit;
  }
  return unlit_darker < 18.0   ? FixtureLight::kUnlitFaint
         : unlit_darker < 28.0 ? FixtureLight::kUnlitMedium
                               : FixtureLight::kUnlitDark;
}

SightingClass SightingClass::at(int index) {
  SightingClass result;
  result.turn = index % kTurns;
  index /= kTurns;
  result.share = index % kShares;
  index /= kShares;
  result.ends = index % kEnds;
  index /= kEnds;
  result.light = index % kLights;
  result.shape = index / kLights;
  return result;
}

SightingClass class_of(FixtureShape shape, FixtureLight light, const FixtureView& view, double angular) {
  SightingClass result;
  result.shape = static_cast<int>(shape);
  result.light = static_cast<int>(light);
  result.ends = (view.near_end ? 1 : 0) + (view.far_end ? 1 : 0);
  result.share =
      static_cast<int>(std::upper_bound(kShareEdges.begin(), kShareEdges.end(), view.share) - kShareEdges.begin());
  result.turn =
      static_cast<int>(std::upper_bound(kTurnEdges.begin(), kTurnEdges.end(), std::abs(angular)) - kTurnEdges.begin());
  return result;
}

int motion_class(const Pose2& before, const Pose2& now) {
  const double moved = distance(before, now) + std::abs(wrap_angle(now.theta - before.theta));  // 1 m from the lens
  return moved < 0.002 ? 0 : (moved < 0.02 ? 1 : 2);
}

SightingClass DetectorBehaviour::class_of_errors(SightingClass sighting) {
  sighting.turn = 0;
  sighting.light = std::min(sighting.light, static_cast<int>(FixtureLight::kUnlitFaint));
  sighting.share = sighting.share < 3 ? 0 : (sighting.share < 6 ? 4 : 7);
  return sighting;
}

void DetectorBehaviour::prepare() {
  nearest_bin_ = nearest([&](int i) { return bins[static_cast<std::size_t>(i)].shown >= kEnoughShown; });
  for (auto& list : sightings) {
    std::stable_sort(list.begin(), list.end(),
                     [](const MeasuredSighting& a, const MeasuredSighting& b) { return a.across < b.across; });
  }
  nearest_errors_ = nearest([&](int i) { return sightings[static_cast<std::size_t>(i)].size() >= kEnoughErrors; });
}

double DetectorBehaviour::seen_probability(const SightingClass& sighting) const {
  const int nearest = nearest_bin_[static_cast<std::size_t>(sighting.index())];
  if (nearest < 0) {
    return 0.0;
  }
  const Bin& bin = bins[static_cast<std::size_t>(nearest)];
  return static_cast<double>(bin.seen) / static_cast<double>(bin.shown);
}

const std::vector<MeasuredSighting>& DetectorBehaviour::errors(const SightingClass& sighting) const {
  const int nearest = nearest_errors_[static_cast<std::size_t>(class_of_errors(sighting).index())];
  return sightings[static_cast<std::size_t>(std::max(nearest, 0))];
}

std::string to_json(const DetectorBehaviour& behaviour) {
  const auto numbers = [](const SightingClass& c) { return json{c.shape, c.light, c.ends, c.share, c.turn}; };
  std::string text = fmt::format(
      "{{\"mode\": {}, \"source\": {},\n\"agreement\": {},\n\"classes\": \"shape, light, ends, share, turn: "
      "detector_behaviour.hpp\",\n",
      json(behaviour.mode).dump(), json(behaviour.source).dump(), json(behaviour.agreement).dump());
  text += fmt::format("\"keep_seen\": {}, \"keep_error\": {},\n", json(behaviour.keep_seen).dump(),
                      json(behaviour.keep_error).dump());
  text += fmt::format("\"false_alarms_begin\": {}, \"false_alarms_last\": {},\n\"seen\": [",
                      behaviour.false_alarms_begin, behaviour.false_alarms_last);
  const char* separator = "\n";
  for (int i = 0; i < SightingClass::kCount; ++i) {
    const auto& bin = behaviour.bins[static_cast<std::size_t>(i)];
    if (bin.shown > 0) {
      text += fmt::format("{}[{},{},{}]", separator, numbers(SightingClass::at(i)).dump(), bin.shown, bin.seen);
      separator = ",\n";
    }
  }
  text += "],\n\"errors\": [";
  separator = "\n";
  for (int i = 0; i < SightingClass::kCount; ++i) {
    for (const MeasuredSighting& sighting : behaviour.sightings[static_cast<std::size_t>(i)]) {
      text += fmt::format("{}[{},{}]", separator, numbers(SightingClass::at(i)).dump(), row_of(sighting).dump());
      separator = ",\n";
    }
  }
  text += "],\n\"false_alarms\": [";
  separator = "\n";
  for (const MeasuredFalseAlarm& alarm : behaviour.false_alarms) {
    text += separator + row_of(alarm).dump();
    separator = ",\n";
  }
  return text + "]}\n";
}

DetectorBehaviour read_detector_behaviour(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) {
    throw ConfigurationError(fmt::format("{}: cannot be read; `evaluate --fit-sensing {}` measures it on rendered runs",
                                         file.string(), file.string()));
  }
  try {
    const json all = json::parse(in);
    const auto class_at = [](const json& numbers) {
      const SightingClass c{numbers.at(0), numbers.at(1), numbers.at(2), numbers.at(3), numbers.at(4)};
      if (!(SightingClass::at(c.index()) == c) || c.index() < 0 || c.index() >= SightingClass::kCount) {
        throw std::out_of_range("class " + numbers.dump());
      }
      return static_cast<std::size_t>(c.index());
    };
    DetectorBehaviour behaviour;
    behaviour.mode = all.at("mode");
    behaviour.source = all.at("source");
    behaviour.agreement = all.at("agreement");
    behaviour.keep_seen = all.at("keep_seen");
    behaviour.keep_error = all.at("keep_error");
    behaviour.false_alarms_begin = all.at("false_alarms_begin");
    behaviour.false_alarms_last = all.at("false_alarms_last");
    for (const json& row : all.at("seen")) {
      behaviour.bins[class_at(row.at(0))] = {row.at(1), row.at(2)};
    }
    for (const json& row : all.at("errors")) {
      behaviour.sightings[class_at(row.at(0))].push_back(sighting_of(row.at(1)));
    }
    for (const json& row : all.at("false_alarms")) {
      behaviour.false_alarms.push_back(false_alarm_of(row));
    }
    behaviour.prepare();
    return behaviour;
  } catch (const std::exception& error) {
    throw ConfigurationError(fmt::format("{}: not a detector's measured behaviour: {}", file.string(), error.what()));
  }
}

}  // namespace luminav
