#include "apps/weir/interruption.h"

#include <csignal>

namespace weir::app {

namespace {

// A signal handler can reach nothing but a global.
std::atomic<bool> interruptionAsked = false;
static_assert(std::atomic<bool>::is_always_lock_free);

void onSignal(int) {
  interruptionAsked = true;
}

void handle(int signal) {
  struct sigaction action = {};
  action.sa_handler = onSignal;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART | static_cast<int>(SA_RESETHAND);
  sigaction(signal, &action, nullptr);
}

}  // namespace

Interruption::Interruption() {
  interruptionAsked = false;
  handle(SIGINT);
  handle(SIGTERM);
}

Interruption::~Interruption() {
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
}

const std::atomic<bool>& Interruption::asked() const {
  return interruptionAsked;
}

}  // namespace weir::app
