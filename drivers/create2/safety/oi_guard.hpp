#pragma once

#include "drivers/base/safety/guardian.hpp"

namespace luminav {

/// How a guardian stops a Create 2 and leaves it without power on its wheels.
GuardedRobot guarded_create2();

}  // namespace luminav
