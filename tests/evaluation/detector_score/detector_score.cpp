#include "tests/evaluation/detector_score/detector_score.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "services/common/geometry/angle.hpp"

namespace luminav::score {
namespace {

double ratio(double part, double whole) {
  return whole > 0.0 ? part / whole : 0.0;
}

}  // namespace

void DetectorScore::add(const DetectorScore& o) {
  frames += o.frames;
  visible += o.visible;
  seen += o.seen;
  plain += o.plain;
  plain_seen += o.plain_seen;
  whole += o.whole;
  whole_seen += o.whole_seen;
  reported += o.reported;
  wrong += o.wrong;
  wrong_state += o.wrong_state;
  cut_only_frames += o.cut_only_frames;
  cut_used_frames += o.cut_used_frames;
  measured += o.measured;
  centre_px2 += o.centre_px2;
  worst_px = std::max(worst_px, o.worst_px);
  heading2 += o.heading2;
  position2 += o.position2;
  robot_heading2 += o.robot_heading2;
  cut_measured += o.cut_measured;
  across2 += o.across2;
  cut_heading2 += o.cut_heading2;
  normalised_count += o.normalised_count;
  normalised += o.normalised;
  normalised_along += o.normalised_along;
  normalised_across += o.normalised_across;
  normalised_heading += o.normalised_heading;
  seconds += o.seconds;
}

double DetectorScore::precision() const {
  return reported == 0 ? 1.0 : ratio(reported - wrong, reported);
}
double DetectorScore::recall() const {
  return ratio(seen, visible);
}
double DetectorScore::plain_recall() const {
  return plain == 0 ? 1.0 : ratio(plain_seen, plain);
}
double DetectorScore::whole_recall() const {
  return ratio(whole_seen, whole);
}
double DetectorScore::cut_use() const {
  return ratio(cut_used_frames, cut_only_frames);
}
double DetectorScore::centre_rms_px() const {
  return std::sqrt(ratio(centre_px2, measured));
}
double DetectorScore::heading_rms_deg() const {
  return degrees(std::sqrt(ratio(heading2, measured)));
}
double DetectorScore::position_rms_mm() const {
  return 1e3 * std::sqrt(ratio(position2, measured));
}
double DetectorScore::robot_heading_rms_deg() const {
  return degrees(std::sqrt(ratio(robot_heading2, measured)));
}
double DetectorScore::cut_across_rms_mm() const {
  return 1e3 * std::sqrt(ratio(across2, cut_measured));
}
double DetectorScore::cut_heading_rms_deg() const {
  return degrees(std::sqrt(ratio(cut_heading2, cut_measured)));
}
double DetectorScore::consistency() const {
  return ratio(normalised, normalised_count);
}
double DetectorScore::milliseconds() const {
  return 1e3 * ratio(seconds, frames);
}

std::string score_table_header() {
  return fmt::format(
      "{:<20} {:>6} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>6} {:>5} {:>5} "
      "{:>5} {:>6} {:>7}",
      "condition", "frames", "precis", "recall", "whole", "cutuse", "px rms", "px max", "deg rms", "mm rms", "deg rob",
      "cut mm", "cut deg", "nees", "n_al", "n_ac", "n_th", "state", "ms");
}

std::string score_table_row(const std::string& name, const DetectorScore& s) {
  return fmt::format(
      "{:<20} {:>6} {:>7.4f} {:>7.4f} {:>7.4f} {:>7.4f} {:>7.3f} {:>7.2f} {:>7.4f} {:>7.2f} {:>7.3f} "
      "{:>7.2f} {:>7.3f} {:>6.2f} {:>5.2f} {:>5.2f} {:>5.2f} {:>6} {:>7.3f}",
      name, s.frames, s.precision(), s.recall(), s.whole_recall(), s.cut_use(), s.centre_rms_px(), s.worst_px,
      s.heading_rms_deg(), s.position_rms_mm(), s.robot_heading_rms_deg(), s.cut_across_rms_mm(),
      s.cut_heading_rms_deg(), s.consistency(), ratio(s.normalised_along, s.normalised_count),
      ratio(s.normalised_across, s.normalised_count), ratio(s.normalised_heading, s.normalised_count), s.wrong_state,
      s.milliseconds());
}

}  // namespace luminav::score
