#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/common/configuration/robot_file.hpp"
#include "services/controller/safety/sonar_firing.hpp"

namespace luminav {

/// What is to be thought of the ring.
enum class SonarTrust { kTrusted, kDoubted, kDead };

/// Holds what each disc hears against what map and own motion lead to expect. The base reports its maximum range, on
/// time, for a disc whose transducer or cable is dead, so ages say nothing. Each disc has one count of evidence that it
/// tells nothing of the world: up by one for a wall that faces it and was not heard, and for a range that stays the
/// same on the way towards what it measures; down when its range changes, or a wall is heard where it
/// must be. Readings from one place count once. The
/// discs of a half, which share a cable and a board, have one such count together, which any of them takes back. The
/// counts of both halves add up: a ring that is wholly deaf is noticed on half the distance.
class SonarWatch {
 public:
  static constexpr double kDead = 6.0;  ///< pieces of evidence from which a disc counts as dead
  static constexpr double kWall = 3.0;  ///< [m] up to which a wall that faces a disc must echo

  explicit SonarWatch(const SonarRing& ring) : ring_(ring), discs_(ring.robot_from_sonar.size()) {}

  /// The place of a firing in the building.
  struct Place {
    bool is_known = false;       // pose and map are
    std::optional<double> wall;  // [m] to the wall that faces the disc, if any
  };
  /// Takes up the firings of a disc in the order of their time.
  void add(const SonarFiring& firing, const Place& place);
  /// Relative motion across now is unknown. What was found out of the discs stays.
  void forget_motion();

  [[nodiscard]] SonarTrust trust() const;
  /// Plain sentence; "" when trusted.
  [[nodiscard]] std::string reason() const;
  [[nodiscard]] double evidence(std::size_t disc) const { return discs_[disc].evidence; }

 private:
  struct Disc {
    double evidence = 0.0;
    bool is_stuck = false;  // the last piece of evidence: it says the same; else it is deaf
    std::optional<SonarFiring> last;
    std::optional<Pose2> counted;     // where the last piece of evidence came from
    std::optional<SonarFiring> same;  // the first of those that say the same
  };
  /// Discs that look to one side, ahead or back.
  struct Half {
    double evidence = 0.0;
    double quiet = 0.0;  // [m] since one of them heard something
    std::optional<Pose2> odom_from_robot;
    std::optional<Pose2> counted;  // where the last piece of evidence came from
  };
  [[nodiscard]] Half& half_of(std::size_t disc);
  [[nodiscard]] bool is_new_place(const std::optional<Pose2>& counted, const SonarFiring& firing) const;
  /// One more piece of evidence, unless one was counted at this place.
  void count(const SonarFiring& firing, std::optional<Pose2>& counted, double& evidence) const;
  /// Has it come nearer to what it hears, or gone away, and the range is the same?
  [[nodiscard]] bool says_the_same(Disc& disc, const SonarFiring& firing) const;
  [[nodiscard]] bool is_silent_half(std::size_t disc, const SonarFiring& firing, bool is_stuck);
  [[nodiscard]] std::vector<std::size_t> discs_above(double evidence) const;

  SonarRing ring_;
  std::vector<Disc> discs_;
  Half ahead_;
  Half back_;
};

}  // namespace luminav
