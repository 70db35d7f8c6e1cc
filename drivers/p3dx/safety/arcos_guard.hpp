#pragma once

#include "drivers/base/safety/guardian.hpp"

namespace luminav {

/// How a guardian stops a robot with an ARCOS controller and leaves it.
GuardedRobot guarded_arcos();

}  // namespace luminav
