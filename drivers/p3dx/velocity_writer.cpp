#include "drivers/p3dx/velocity_writer.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/p3dx/arcos/arcos_commands.hpp"
#include "services/common/geometry/angle.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kCycle = 50'000;     // [us] 18 bytes, which a line of 9600 baud moves in 19 ms
constexpr double kChangePeriod = 15'000.0;  // [us] on average: a controller at 50 Hz is not kept waiting
constexpr double kChangeBurst = 2.0;        // however uneven its messages arrive
constexpr std::int64_t kRepeat = 100'000;   // [us] nothing is acknowledged, so all is said again

}  // namespace

void VelocityWriter::restart() {
  known_ = false;
  angle_error_deg_ = 0.0;
}

int VelocityWriter::choose_turn_rate(double wanted_deg, std::int64_t now) {
  if (!known_) {
    angle_error_deg_ = 0.0;
  } else {
    const double elapsed = std::min(0.5, static_cast<double>(now - last_cycle_) * 1e-6);
    angle_error_deg_ += (degrees(wanted_.angular) - turn_rate_deg_s_) * elapsed;
  }
  if (wanted_deg == 0.0) {
    angle_error_deg_ = 0.0;  // standing means standing
    return 0;
  }
  const double corrected = wanted_deg + angle_error_deg_ / (1e-6 * kCycle);
  return static_cast<int>(std::clamp(std::round(corrected), std::floor(wanted_deg), std::ceil(wanted_deg)));
}

std::vector<std::vector<std::uint8_t>> VelocityWriter::poll(const DriveVelocity& wanted, std::int64_t now) {
  const std::int64_t since = now - last_cycle_;
  const bool changed = wanted != wanted_;
  change_allowance_ =
      std::min(kChangeBurst, change_allowance_ + static_cast<double>(now - change_allowance_at_) / kChangePeriod);
  change_allowance_at_ = now;
  const bool due = !known_ || since >= kCycle || (changed && change_allowance_ >= 1.0);
  if (!due) {
    return {};
  }
  const int velocity = static_cast<int>(std::lround(1000.0 * wanted.linear));
  const int turn_rate = choose_turn_rate(degrees(wanted.angular), now);
  std::vector<std::vector<std::uint8_t>> frames;
  if (!known_ || velocity != velocity_mm_s_ || now - last_velocity_ >= kRepeat) {
    frames.push_back(encode_command(ArcosCommand::kVelocity, velocity));
    last_velocity_ = now;
  }
  if (!known_ || turn_rate != turn_rate_deg_s_ || now - last_turn_rate_ >= kRepeat) {
    frames.push_back(encode_command(ArcosCommand::kTurnRate, turn_rate));
    last_turn_rate_ = now;
  }
  change_allowance_ = changed ? std::max(0.0, change_allowance_ - 1.0) : change_allowance_;
  known_ = true;
  wanted_ = wanted;
  velocity_mm_s_ = velocity;
  turn_rate_deg_s_ = turn_rate;
  last_cycle_ = now;
  return frames;
}

}  // namespace luminav
