#pragma once

namespace luminav {

/// `operator job ORDER`: gives the robot jobs, lists, confirms, cancels and answers. Returns the exit status: 0 taken
/// or done, 1 nobody answers, 3 refused, 4 it failed, 6 cancelled, 130 interrupted.
int run_job(int argc, char** argv);

}  // namespace luminav
