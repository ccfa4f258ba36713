#include "framework/base/interruption.h"

#include <csignal>

namespace weir {

namespace {

// A signal handler can reach nothing but a global.
std::atomic<bool> interruptionAsked = false, warningGiven = false, savesOnWarning = false;
static_assert(std::atomic<bool>::is_always_lock_free);
thread_local bool mayEnd = false;
thread_local const std::atomic<bool>* alsoAsked = nullptr;

void onSignal(int) {
  interruptionAsked = true;
}

void onWarningSignal(int) {
  (savesOnWarning ? warningGiven : interruptionAsked) = true;
}

void handle(int signal, int flags, void (*handler)(int) = onSignal) {
  struct sigaction action = {};
  action.sa_handler = handler;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART | flags;
  sigaction(signal, &action, nullptr);
}

bool isIgnored(int signal) {
  struct sigaction action = {};
  return sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

}  // namespace

Interruption::Interruption() : Interruption(OnWarning::kEnd) {}

Interruption::Interruption(OnWarning onWarning) {
  interruptionAsked = warningGiven = false;
  savesOnWarning = onWarning == OnWarning::kSave;
  handle(SIGINT, static_cast<int>(SA_RESETHAND));
  handle(SIGTERM, static_cast<int>(SA_RESETHAND));
  handle(SIGUSR1, 0, onWarningSignal);
  if (!isIgnored(SIGHUP)) handle(SIGHUP, 0);
  std::signal(SIGXFSZ, SIG_IGN);  // for good: nobody wants it back
}

Interruption::~Interruption() {
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
  std::signal(SIGUSR1, SIG_DFL);
  if (!isIgnored(SIGHUP)) std::signal(SIGHUP, SIG_DFL);
}

const std::atomic<bool>& Interruption::asked() {
  return interruptionAsked;
}

const std::atomic<bool>& Interruption::warned() {
  return warningGiven;
}

InterruptibleWork::InterruptibleWork(const std::atomic<bool>* also) : outer_(mayEnd), outerAlso_(alsoAsked) {
  mayEnd = true;
  if (also != nullptr) alsoAsked = also;
}

InterruptibleWork::~InterruptibleWork() {
  mayEnd = mayEnd && outer_;  // what was ended is not ended again while the work around it cleans up
  alsoAsked = outerAlso_;
}

void InterruptibleWork::endIfAsked() {
  if (!mayEnd || !(interruptionAsked || (alsoAsked != nullptr && *alsoAsked))) return;
  mayEnd = false;
  throw Interrupted();
}

}  // namespace weir
