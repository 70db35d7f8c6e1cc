#include "drivers/p3dx/sonar_collector.hpp"

#include <algorithm>
#include <array>

namespace luminav {
namespace {

constexpr int kDiscsPerArray = 8;
constexpr std::size_t kMaxStaggered = 4;  // of an array and packet; more come from a robot that sends all at once

}  // namespace

SonarCollector::SonarCollector(int discs, double maximum_range)
    : discs_(static_cast<std::size_t>(discs), Disc{.range = maximum_range}), maximum_range_(maximum_range) {}

void SonarCollector::clear() {
  for (Disc& disc : discs_) {
    disc = Disc{.range = maximum_range_};
  }
}

void SonarCollector::update(const InformationPacket& packet, std::int64_t utime, std::int64_t cycle) {
  for (Disc& disc : discs_) {
    disc.fresh = false;
  }
  utime_ = 0;
  std::array<std::size_t, 4> per_array{};
  for (const SonarReading& reading : packet.sonar) {
    ++per_array[static_cast<std::size_t>(reading.disc / kDiscsPerArray)];
  }
  std::array<std::size_t, 4> seen{};
  for (const SonarReading& reading : packet.sonar) {
    const auto array = static_cast<std::size_t>(reading.disc / kDiscsPerArray);
    const std::size_t later = per_array[array] - ++seen[array];  // readings of this array that were taken after it
    if (reading.disc >= static_cast<int>(discs_.size())) {
      continue;
    }
    Disc& disc = discs_[static_cast<std::size_t>(reading.disc)];
    // The last one was taken somewhere within the last cycle: half of it on average.
    const std::int64_t age =
        per_array[array] <= kMaxStaggered ? cycle * static_cast<std::int64_t>(later) + cycle / 2 : 0;
    const double range = 0.001 * reading.range_mm;
    disc.has_echo = range < maximum_range_;
    disc.range = std::min(range, maximum_range_);
    disc.fresh = true;
    disc.utime = utime - age;
    utime_ = std::max(utime_, disc.utime);
  }
  if (utime_ == 0) {
    utime_ = utime;  // nothing new: the packet's own stamp
  }
}

sonar_t SonarCollector::message() const {
  sonar_t message{};
  message.utime = utime_;
  message.count = static_cast<std::int32_t>(discs_.size());
  for (const Disc& disc : discs_) {
    message.range.push_back(static_cast<float>(disc.range));
    message.has_echo.push_back(disc.has_echo ? 1 : 0);
    message.fresh.push_back(disc.fresh ? 1 : 0);
    message.range_utime.push_back(disc.utime);
  }
  return message;
}

}  // namespace luminav
