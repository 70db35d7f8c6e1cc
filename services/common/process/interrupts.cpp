#include "services/common/process/interrupts.hpp"

#include <signal.h>

namespace luminav {
namespace {

volatile sig_atomic_t g_interrupted = 0;

void on_interrupt(int) {
  g_interrupted = 1;
}

}  // namespace

void catch_interrupts() {
  struct sigaction action {};
  action.sa_handler = on_interrupt;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  sigaction(SIGHUP, &action, nullptr);
}

bool is_interrupted() {
  return g_interrupted != 0;
}

bool take_interrupt() {
  const bool was = is_interrupted();
  g_interrupted = 0;
  return was;
}

}  // namespace luminav
