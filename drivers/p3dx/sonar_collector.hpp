#pragma once

#include <cstdint>
#include <luminav/sonar_t.hpp>
#include <vector>

#include "drivers/p3dx/arcos/information_packet.hpp"

namespace luminav {

/// The last reading of each disc, and which are new. A robot sends only those taken since its last packet.
class SonarCollector {
 public:
  SonarCollector(int discs, double maximum_range);

  /// `cycle` [us]: time between two pings of an array; the readings of a packet lie that far apart and are stamped so.
  void update(const InformationPacket& packet, std::int64_t utime, std::int64_t cycle);
  /// Forgets all: the robot may have been anywhere meanwhile.
  void clear();
  /// All but session and sequence.
  [[nodiscard]] sonar_t message() const;

 private:
  struct Disc {
    double range;  // [m]
    bool has_echo = false;
    bool fresh = false;
    std::int64_t utime = 0;  // [us] 0 = never
  };
  std::vector<Disc> discs_;
  double maximum_range_;
  std::int64_t utime_ = 0;
};

}  // namespace luminav
