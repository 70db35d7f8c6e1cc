#include "tests/replay/replay_verdict.hpp"

#include <fmt/format.h>

namespace luminav {
namespace {

constexpr std::int8_t kOccupiedEvidence = 17;  // log-odds x 20: more likely occupied than 70 %

}  // namespace

MapComparison compare_maps(const std::optional<OccupancyGrid>& recorded, const std::optional<OccupancyGrid>& replayed) {
  MapComparison result;
  if (!recorded || !replayed || !(recorded->geometry == replayed->geometry)) {
    return result;
  }
  result.measured = true;
  std::int64_t both = 0;
  for (std::size_t i = 0; i < recorded->evidence.size(); ++i) {
    const bool was = recorded->evidence[i] >= kOccupiedEvidence;
    const bool is = replayed->evidence[i] >= kOccupiedEvidence;
    result.recorded_cells += was ? 1 : 0;
    result.replayed_cells += is ? 1 : 0;
    both += was && is ? 1 : 0;
  }
  const std::int64_t either = result.recorded_cells + result.replayed_cells - both;
  result.difference = either > 0 ? static_cast<double>(either - both) / static_cast<double>(either) : 0.0;
  return result;
}

void append_verdict(const ReplayTolerances& limit, ReplayReport& r) {
  const auto fail = [&r](std::string sentence) { r.failures.push_back(std::move(sentence)); };
  if (r.has_poses && r.replayed.poses == 0) {
    fail("the localizer sent no POSE");
  }
  if (r.has_poses && r.replayed.poses > 0 && (r.has_truth || r.recorded.poses > 0)) {
    const char* reference = r.has_truth ? "true poses" : "recorded poses";
    if (r.recorded.localized_s >= 0.0 && r.replayed.localized_s < 0.0) {
      fail(fmt::format("never TRACKING, recorded after {:.1f} s", r.recorded.localized_s));
    } else if (r.recorded.localized_s >= 0.0 && r.replayed.localized_s - r.recorded.localized_s > limit.localized) {
      fail(fmt::format("TRACKING after {:.1f} s, recorded after {:.1f} s, allowed {:.1f} s later",
                       r.replayed.localized_s, r.recorded.localized_s, limit.localized));
    }
    if (r.replayed.compared == 0 && r.replayed.localized_s >= 0.0) {
      fail(fmt::format("nothing to compare with: the {} come too seldom", reference));
    }
    if (r.replayed.position_rms > limit.position) {
      fail(fmt::format("position {:.3f} m RMS from the {}, allowed {:.3f} m", r.replayed.position_rms, reference,
                       limit.position));
    }
    if (r.replayed.heading_rms > limit.heading) {
      fail(fmt::format("heading {:.2f} deg RMS from the {}, allowed {:.2f} deg", degrees(r.replayed.heading_rms),
                       reference, degrees(limit.heading)));
    }
    if (r.replayed.wrong_s > limit.wrong) {
      fail(fmt::format("confidently wrong for {:.1f} s, first {:.1f} s after the start, allowed {:.1f} s",
                       r.replayed.wrong_s, static_cast<double>(r.replayed.wrong_utime - r.first_utime) * 1e-6,
                       limit.wrong));
    }
    if (r.recorded.poses > 0 && r.replayed.tracking_ratio < r.recorded.tracking_ratio - limit.tracking) {
      fail(fmt::format("TRACKING {:.1f} % of the time, recorded {:.1f} %, allowed {:.1f} less",
                       100.0 * r.replayed.tracking_ratio, 100.0 * r.recorded.tracking_ratio, 100.0 * limit.tracking));
    }
  }
  if (r.map.measured && r.map.difference > limit.map) {
    fail(fmt::format("{:.1f} % of the occupied cells stand in one map only, allowed {:.1f} %", 100.0 * r.map.difference,
                     100.0 * limit.map));
  }
  if (limit.exact && !r.divergence.first_channel().empty()) {
    fail("not the recorded bytes");
  }
}

}  // namespace luminav
