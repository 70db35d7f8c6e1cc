#include "drivers/simulator/arcos/arcos_sonar.hpp"

#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

constexpr int kNoEcho = 5000;  // [mm]
constexpr int kNearest = 100;  // [mm] the disc still rings
constexpr std::size_t kLongestOrder = 16;

}  // namespace

ArcosSonar::ArcosSonar(const ConfigurationPacket& flash, bool all_at_once)
    : cycle_(1000 * flash.sonar_cycle), until_ping_(cycle_), all_at_once_(all_at_once) {
  for (int a = 0; a < kArrays; ++a) {
    Array& array = arrays_[static_cast<std::size_t>(a)];
    array.fitted = (a == 0 ? flash.has_front_sonar : flash.has_rear_sonar) != 0;
    array.on = array.fitted;
    for (int i = 0; i < kDiscsPerArray; ++i) {
      array.order.push_back(kDiscsPerArray * a + i);
    }
  }
}

void ArcosSonar::switch_arrays(int argument) {
  const int number = (argument >> 1) & 7;
  for (int a = 0; a < kArrays; ++a) {
    if (number == 0 || number == a + 1) {
      Array& array = arrays_[static_cast<std::size_t>(a)];
      array.on = array.fitted && (argument & 1) != 0;
    }
  }
}

void ArcosSonar::set_polling(std::span<const std::uint8_t> discs) {
  for (int a = 0; a < kArrays; ++a) {
    std::vector<int> order;
    for (const std::uint8_t number : discs) {
      if (number >= 1 && (number - 1) / kDiscsPerArray == a && order.size() < kLongestOrder) {
        order.push_back(number - 1);
      }
    }
    if (!order.empty() || discs.empty()) {
      arrays_[static_cast<std::size_t>(a)].order = order;
      arrays_[static_cast<std::size_t>(a)].next = 0;
    }
  }
}

void ArcosSonar::set_cycle(int milliseconds) {
  cycle_ = 1000 * std::clamp(milliseconds, 2, 120);
}

std::vector<int> ArcosSonar::step(std::int64_t microseconds) {
  std::vector<int> fired;
  until_ping_ -= microseconds;
  while (until_ping_ <= 0) {
    until_ping_ += cycle_;
    for (Array& array : arrays_) {
      if (!array.on || array.order.empty()) {
        continue;
      }
      if (all_at_once_) {
        fired.insert(fired.end(), array.order.begin(), array.order.end());
      } else {
        fired.push_back(array.order[array.next]);
        array.next = (array.next + 1) % array.order.size();
      }
    }
  }
  return fired;
}

void ArcosSonar::set_reading(int disc, double range) {
  const double limited = std::isfinite(range) ? std::clamp(range, 0.001 * kNearest, 0.001 * kNoEcho) : 0.001 * kNoEcho;
  const SonarReading reading{disc, static_cast<int>(std::lround(1000.0 * limited))};
  const auto same =
      std::find_if(readings_.begin(), readings_.end(), [&](const SonarReading& r) { return r.disc == disc; });
  if (same != readings_.end() && all_at_once_) {
    *same = reading;
  } else if (readings_.size() < 2 * kLongestOrder) {
    readings_.push_back(reading);
  }
}

std::vector<SonarReading> ArcosSonar::take_readings() {
  if (all_at_once_) {
    return readings_;
  }
  std::vector<SonarReading> taken;
  taken.swap(readings_);
  return taken;
}

int ArcosSonar::arrays_on() const {
  int mask = 0;
  for (std::size_t a = 0; a < arrays_.size(); ++a) {
    mask |= arrays_[a].on ? 1 << a : 0;
  }
  return mask;
}

}  // namespace luminav
