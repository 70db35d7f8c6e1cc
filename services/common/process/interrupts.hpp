#pragma once

namespace luminav {

/// Catches SIGINT, SIGTERM and SIGHUP (Ctrl-C, a closed terminal) from now on: they end what a command waits for, not
/// the program, so that it can take back what it has ordered. For commands of a person; services have the event loop.
void catch_interrupts();
/// True once a signal was caught, until it is taken.
[[nodiscard]] bool is_interrupted();
/// True when a signal was caught since the last call.
[[nodiscard]] bool take_interrupt();

}  // namespace luminav
