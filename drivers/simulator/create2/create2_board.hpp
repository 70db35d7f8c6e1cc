#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "drivers/create2/oi/sensor_reading.hpp"
#include "drivers/simulator/base_board.hpp"

namespace luminav {

/// The microcontroller of a Create 2 (Open Interface): obeys start, safe, full, drive direct and the sensor stream, and
/// leaves safe mode by itself at an edge and with a wheel in the air. It keeps the last speed for ever.
class Create2Board final : public BaseBoard {
 public:
  explicit Create2Board(double wheel_base) : wheel_base_(wheel_base) {}

  void receive(std::span<const std::uint8_t> bytes) override;
  BoardOutputs step(double dt, const BoardInputs& inputs) override;
  void set_sonar_reading(int /*disc*/, double /*range*/) override {}
  std::vector<std::uint8_t> take_output() override;
  void on_line_closed() override { command_.clear(); }
  [[nodiscard]] int baud() const override { return 115200; }

  [[nodiscard]] OiMode mode() const { return mode_; }

 private:
  void obey();
  /// Reads its sensors once: by these it leaves safe mode, and tells them.
  void run_cycle(const BoardInputs& inputs);
  void stand();
  [[nodiscard]] double linear() const { return 0.5e-3 * (left_mm_s_ + right_mm_s_); }               // [m/s]
  [[nodiscard]] double angular() const { return 1e-3 * (right_mm_s_ - left_mm_s_) / wheel_base_; }  // [rad/s]
  [[nodiscard]] bool is_powered() const { return mode_ == OiMode::kSafe || mode_ == OiMode::kFull; }

  double wheel_base_;                  // [m]
  std::vector<std::uint8_t> command_;  // the beginning of one whose data is still to come
  std::vector<std::uint8_t> output_;
  std::vector<std::uint8_t> stream_;  // ids
  bool streams_ = false;
  OiMode mode_ = OiMode::kOff;
  int left_mm_s_ = 0;   // as told
  int right_mm_s_ = 0;  // as told
  double left_counts_ = 0.0;
  double right_counts_ = 0.0;
  std::int64_t until_cycle_ = 0;  // [us]
};

}  // namespace luminav
