#include "apps/weir/shown_run.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <optional>
#include <string_view>
#include <utility>

#include "framework/base/interruption.h"

namespace weir::app {

namespace {

std::optional<int> terminalWidth() {
  if (isatty(STDERR_FILENO) == 0) return std::nullopt;
  constexpr int kUsualWidth = 80;
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : kUsualWidth;
}

double monotonicSeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// While it lives, messages of the program make the line of progress go away first.
class MessagesAboveLine {
 public:
  MessagesAboveLine(Program& program, Progress& progress) : program_(program), progress_(progress) {
    program_.beforeMessage([this] { progress_.clearLine(); });
  }
  ~MessagesAboveLine() {
    progress_.clearLine();
    program_.beforeMessage({});
  }
  MessagesAboveLine(const MessagesAboveLine&) = delete;
  MessagesAboveLine& operator=(const MessagesAboveLine&) = delete;

 private:
  Program& program_;
  Progress& progress_;
};

}  // namespace

int exitCodeOf(RunEnd end) {
  if (end != RunEnd::kInterrupted) return kDone;
  return Interruption::warned() && !Interruption::asked() ? kSavedForLater : int{kInterrupted};
}

RunEnd runShown(Program& program, Simulation& simulation,
                const std::vector<std::unique_ptr<Observer>>& observers, RunOptions options, bool quiet,
                const std::function<ProgressState(const Simulation&)>& state) {
  std::vector<Observer*> watching;
  for (const auto& observer : observers) watching.push_back(observer.get());
  Progress progress([](std::string_view text) { std::fwrite(text.data(), 1, text.size(), stderr); },
                    terminalWidth, monotonicSeconds);
  if (options.stop == nullptr) options.stop = &Interruption::asked();
  options.saveAndStop = &Interruption::warned();
  options.onProgress = [&, told = std::move(options.onProgress)](const Simulation& s) {
    if (told) told(s);
    if (!quiet) progress.update(state(s));
  };
  const MessagesAboveLine messages(program, progress);
  return runSimulation(simulation, watching, options);
}

}  // namespace weir::app
