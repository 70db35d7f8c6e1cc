#include "services/surveyor/survey/fixture_passes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace luminav {
namespace {

constexpr double kGate = 0.10;                  // [m] between a sighting and where odometry puts the one before,
constexpr double kGateGrowth = 0.10;            // [m per m] and more the longer that is ago
constexpr double kGateHeading = radians(20.0);  // [rad] likewise
constexpr double kMemory = 1.5;                 // [m] driven, after which a fixture out of view has gone,
constexpr double kMemoryTurn = 0.75 * kPi;      // [rad] or turned
constexpr double kSizeTolerance = 0.25;         // fraction of a side: a file of kinds may be wrong
constexpr double kSizeMargin = 0.06;            // [m] beside that: blur, and bloom of a burning lamp
constexpr int kMinSightings = 3;                // fewer are a mistake of the detector's, or a look from afar

bool shows_all(const FixtureSighting& sighting) {
  return !sighting.clipped && sighting.state != SightingState::kHalf;
}

bool shows_an_end(const FixtureSighting& sighting) {
  return !sighting.clipped || sighting.near_end_visible || sighting.far_end_visible;
}

/// How badly a sighting's size fits a kind; more than 1 = not at all.
double misfit(const FixtureSighting& sighting, const Fixture& kind) {
  if (sighting.shape != kind.shape) {
    return std::numeric_limits<double>::infinity();
  }
  const auto side = [&](double seen, double true_length) {
    return std::abs(seen - true_length) / (kSizeTolerance * true_length + kSizeMargin);
  };
  // of one with half its lamps on, the width is that of the lamps
  const double across = sighting.state == SightingState::kHalf ? 0.0 : side(sighting.width, kind.width);
  const double along = sighting.clipped ? 0.0 : side(sighting.length, kind.length);
  return std::max(across, along);
}

/// A pass that may still go on.
struct OpenPass {
  FixturePass pass;
  Pose2 odom_from_fixture;
  double travelled = 0.0;  // [m] when it was seen last
  double heading = 0.0;    // [rad] of odometry, then
  bool has_theta = false;
  FixtureShape shape = FixtureShape::kRectangle;
};

class PassCollector {
 public:
  explicit PassCollector(const CeilingKinds& kinds) : kinds_(kinds) {}

  void add(const KeyFrame& frame, int index) {
    close_those_gone(frame);
    std::vector<bool> taken(open_.size(), false);
    for (const FixtureSighting& sighting : frame.sightings) {
      if (!shows_an_end(sighting) || nearest_kind(sighting) < 0) {
        continue;
      }
      const Pose2 seen = frame.odom_from_robot * sighting.robot_from_fixture;
      const int found = match(sighting, seen, frame.travelled, taken);
      if (found < 0) {
        open_.push_back({});
        taken.push_back(true);
      }
      const std::size_t at = found < 0 ? open_.size() - 1 : static_cast<std::size_t>(found);
      taken[at] = true;
      OpenPass& open = open_[at];
      open.pass.sightings.push_back({index, sighting});
      open.odom_from_fixture = seen;
      open.travelled = frame.travelled;
      open.heading = frame.odom_from_robot.theta;
      open.has_theta = sighting.has_theta;
      open.shape = sighting.shape;
    }
  }

  void close_all() {
    for (OpenPass& open : open_) {
      close(open);
    }
    open_.clear();
  }

  [[nodiscard]] std::vector<FixturePass> take() {
    std::sort(passes_.begin(), passes_.end(), [](const FixturePass& a, const FixturePass& b) {
      return a.sightings.front().frame < b.sightings.front().frame;
    });
    return std::move(passes_);
  }

 private:
  [[nodiscard]] int nearest_kind(const FixtureSighting& sighting) const {
    int best = -1;
    double least = 1.0;
    for (std::size_t k = 0; k < kinds_.kinds.size(); ++k) {
      const double value = misfit(sighting, kinds_.kinds[k]);
      if (value < least) {
        least = value;
        best = static_cast<int>(k);
      }
    }
    return best;
  }

  [[nodiscard]] int match(const FixtureSighting& sighting, const Pose2& seen, double travelled,
                          const std::vector<bool>& taken) const {
    int best = -1;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < open_.size(); ++i) {
      const OpenPass& open = open_[i];
      const double apart = distance(open.odom_from_fixture, seen);
      const double turned =
          std::abs(wrap_modulo(open.odom_from_fixture.theta - seen.theta, symmetry_period(sighting.shape)));
      const bool is_turned = open.has_theta && sighting.has_theta && turned > kGateHeading;
      const double gate = kGate + kGateGrowth * (travelled - open.travelled);
      if (!taken[i] && open.shape == sighting.shape && apart < std::min(least, gate) && !is_turned) {
        least = apart;
        best = static_cast<int>(i);
      }
    }
    return best;
  }

  void close_those_gone(const KeyFrame& frame) {
    const auto has_gone = [&](OpenPass& open) {
      const bool gone = frame.travelled - open.travelled > kMemory ||
                        std::abs(wrap_angle(frame.odom_from_robot.theta - open.heading)) > kMemoryTurn;
      if (gone) {
        close(open);
      }
      return gone;
    };
    open_.erase(std::remove_if(open_.begin(), open_.end(), has_gone), open_.end());
  }

  void close(OpenPass& open) {
    FixturePass& pass = open.pass;
    if (static_cast<int>(pass.sightings.size()) < kMinSightings) {
      return;
    }
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < kinds_.kinds.size(); ++k) {
      double sum = 0.0;
      for (const PassSighting& seen : pass.sightings) {
        sum += std::min(3.0, misfit(seen.sighting, kinds_.kinds[k]));  // one bad outline outvotes nothing
      }
      if (sum < least) {
        least = sum;
        pass.kind = static_cast<int>(k);
      }
    }
    passes_.push_back(std::move(pass));
  }

  const CeilingKinds& kinds_;
  std::vector<OpenPass> open_;
  std::vector<FixturePass> passes_;
};

}  // namespace

std::vector<FixturePass> find_passes(const std::vector<KeyFrame>& frames, const CeilingKinds& kinds) {
  PassCollector collector(kinds);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (i > 0 && frames[i].part != frames[i - 1].part) {
      collector.close_all();
    }
    collector.add(frames[i], static_cast<int>(i));
  }
  collector.close_all();
  return collector.take();
}

double excess_length(const std::vector<FixturePass>& passes, const CeilingKinds& kinds, int kind) {
  std::vector<double> excess;
  for (const FixturePass& pass : passes) {
    for (const PassSighting& seen : pass.sightings) {
      if (pass.kind == kind && shows_all(seen.sighting)) {
        excess.push_back(seen.sighting.length / kinds.kinds[static_cast<std::size_t>(kind)].length - 1.0);
      }
    }
  }
  if (excess.empty()) {
    return 0.0;
  }
  const auto middle = excess.begin() + static_cast<std::ptrdiff_t>(excess.size() / 2);
  std::nth_element(excess.begin(), middle, excess.end());
  return *middle;
}

}  // namespace luminav
