#pragma once

#include <functional>
#include <string>
#include <vector>

#include "services/common/process/event_loop.hpp"

namespace luminav {

/// What a base driver's node is to the process around it and to the program that simulates one. Runs by the clock it is
/// given and never waits.
class BaseDriver {
 public:
  BaseDriver() = default;
  BaseDriver(const BaseDriver&) = delete;
  BaseDriver& operator=(const BaseDriver&) = delete;
  virtual ~BaseDriver() = default;

  /// Reads and writes the line and runs what is due. To be called at least every 20 ms, and when descriptor() can be
  /// read.
  virtual void poll() = 0;
  /// How its guardian is told that the driver lives; done every 55 ms by poll(). A session that the guardian may have
  /// ended meanwhile is begun anew, once the guardian is done with the line.
  virtual void report_life(std::function<void()> tell_guardian) = 0;
  /// Of the line; -1 while there is none.
  [[nodiscard]] virtual int descriptor() const = 0;
  /// Grows each time the line is opened.
  [[nodiscard]] virtual int openings() const = 0;
  [[nodiscard]] virtual Health health() const = 0;
  /// What it listens to.
  [[nodiscard]] virtual const std::vector<std::string>& channels() const = 0;
  /// The robot stands for as long as there is a reason; "" = no more.
  virtual void hold(const std::string& why) = 0;
  /// From now on the robot is told to stand, whatever is commanded; true once it does, or does not answer.
  virtual bool stand_still() = 0;
  /// Stop, motors off, end of the session; to be called before the end. Bytes that the line does not take at once are
  /// lost.
  virtual void shut_down() = 0;
  /// The robot answers and its readings arrive.
  [[nodiscard]] virtual bool connected() const = 0;
  /// The state of the line in one sentence, for people; says what stops the robot should driver and guardian both die.
  [[nodiscard]] virtual std::string describe_line() const = 0;
};

}  // namespace luminav
