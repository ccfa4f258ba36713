#include "apps/weir/sweep/sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstring>
#include <optional>
#include <thread>
#include <utility>

#include "apps/weir/shown_run.h"
#include "framework/base/error.h"
#include "framework/base/interruption.h"
#include "framework/base/text.h"
#include "framework/run/progress.h"
#include "framework/scene/scene_file.h"

namespace weir::app {

namespace {

constexpr std::chrono::milliseconds kPause(20);

std::string replaced(std::string text, std::string_view part, const std::string& other) {
  for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; at += other.size())
    text.replace(at, part.size(), other);
  return text;
}

/// What the run said last: its error.
std::string errorIn(const std::filesystem::path& log) {
  constexpr std::size_t kLargestLog = std::size_t{64} << 20, kLongest = 2000;
  constexpr std::string_view kMark = "error: ";
  std::string text;
  try {
    text = "\n" + readTextFile(log, kLargestLog);
  } catch (const Error& e) {
    return e.what();
  }
  const std::size_t at = text.rfind("\n" + std::string(kMark));
  if (at == std::string::npos) return {};
  text.erase(0, at + 1 + kMark.size());
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text.substr(0, kLongest);
}

/// How a run ended that failed.
PointError errorOf(const ChildEnd& end, const std::filesystem::path& log) {
  PointError error{end.signal == 0 ? end.code : int{kSimulationFailed}, errorIn(log)};
  if (end.signal != 0)
    error.text = fmt::format("signal {} ({}) ended the run{}", end.signal, ::strsignal(end.signal),
                             end.signal == SIGKILL ? "; the likely cause is that memory ran out" : "");
  if (error.text.empty()) error.text = fmt::format("exit code {}; see log.txt", end.code);
  return error;
}

/// The exit code of a run that somebody asked to end, or 0.
int askedToEnd(const ChildEnd& end) {
  if (end.signal == SIGUSR1 || (end.signal == 0 && end.code == kSavedForLater)) return kSavedForLater;
  constexpr std::array kPolite{SIGINT, SIGTERM, SIGHUP};
  const bool politely = std::find(kPolite.begin(), kPolite.end(), end.signal) != kPolite.end();
  return politely || (end.signal == 0 && end.code == kInterrupted) ? int{kInterrupted} : 0;
}

bool isEnding() {
  return Interruption::asked() || Interruption::warned();
}

}  // namespace

Sweep::Sweep(SweepPlan plan, Log& log) : plan_(std::move(plan)), log_(log) {
  const SweepIdentity identity(plan_.scene, plan_.options);
  for (std::size_t i = 0; i < plan_.points.size(); ++i) {
    identities_.push_back(identity.of(plan_.points[i]));
    folderOf(i).checkIdentity(identities_.back());
  }
  waiting_.assign(plan_.chosen.begin(), plan_.chosen.end());
  plan_.jobs = std::clamp(plan_.jobs, 1, std::max(1, static_cast<int>(waiting_.size())));
}

PointFolder Sweep::folderOf(std::size_t point) const {
  return PointFolder(plan_.folder / folderNameOf(plan_.points[point]));
}

std::vector<std::string> Sweep::argumentsOf(std::size_t point, std::size_t slot) const {
  const PointFolder folder = folderOf(point);
  std::vector<std::string> arguments{"run", plan_.scene.string()};
  const auto add = [&](std::initializer_list<std::string> more) {
    arguments.insert(arguments.end(), more.begin(), more.end());
  };
  for (const Setting& setting : plan_.points[point]) add({"--set", setting.name + "=" + setting.value});
  add({"--stats", folder.stats(), "--quiet", "--device", plan_.devices[slot % plan_.devices.size()]});
  add({"--threads", std::to_string(std::max(1, plan_.threads / plan_.jobs))});
  if (plan_.keepsCheckpoints) add({"--checkpoint", folder.checkpoint(), "--resume", "auto"});
  for (const std::string& option : plan_.options) add({replaced(option, "{}", folder.path())});
  return arguments;
}

std::size_t Sweep::freeSlot() const {
  std::size_t slot = 0;
  const auto isTaken = [&](const auto& running) { return running->slot == slot; };
  while (std::any_of(running_.begin(), running_.end(), isTaken)) ++slot;
  return slot;
}

bool Sweep::tryStart(std::size_t point) {
  const PointFolder folder = folderOf(point);
  std::optional<OutputLock> lock;
  try {
    lock.emplace(folder.path());
    // Held by a run whose sweep was killed, until it has seen that.
    const OutputLock ofRun(folder.stats());
  } catch (const Error&) {
    return false;
  }
  if (folder.state() == PointState::kDone) {
    ++finished_;
    return true;
  }
  folder.begin(identities_[point]);
  const std::size_t slot = freeSlot();
  auto child = std::make_unique<ChildRun>(plan_.program, argumentsOf(point, slot), folder.log());
  running_.push_back(
      std::make_unique<Running>(Running{point, slot, std::move(*lock), WallClock::now(), std::move(child)}));
  return true;
}

void Sweep::startMore() {
  constexpr std::chrono::milliseconds kPauseForOthers(500);
  if (isEnding() || WallClock::now() < nextTry_) return;
  std::size_t taken = 0;
  while (taken < waiting_.size() && running_.size() < static_cast<std::size_t>(plan_.jobs)) {
    const std::size_t point = waiting_.front();
    waiting_.pop_front();
    if (tryStart(point)) continue;
    waiting_.push_back(point);
    ++taken;
  }
  if (taken > 0 && taken == waiting_.size()) nextTry_ = WallClock::now() + kPauseForOthers;
}

std::string Sweep::countedText(std::size_t point, const std::string& what) {
  return fmt::format("{} of {}: {} {}", ++finished_, plan_.chosen.size(), describe(plan_.points[point]),
                     what);
}

void Sweep::keepFailure(std::size_t point, const PointError& error) {
  folderOf(point).keepError(error);
  failed_[point] = error.code;
  log_.warn(countedText(point, "failed: " + error.text));
}

void Sweep::handle(const Running& running, const ChildEnd& end) {
  const PointFolder folder = folderOf(running.point);
  if (const int code = askedToEnd(end); code != 0) {
    stopped_ = std::max(stopped_, code);
  } else if (end.signal != 0 || end.code != kDone) {
    keepFailure(running.point, errorOf(end, folder.log()));
  } else if (folder.state() != PointState::kDone) {
    keepFailure(running.point, {kIoFailed, "the run has written no statistics"});
  } else {
    folder.finish();
    const std::chrono::duration<double> took = WallClock::now() - running.start;
    log_.info(countedText(running.point, "done in " + durationText(took.count())));
  }
}

void Sweep::reap() {
  std::erase_if(running_, [this](const std::unique_ptr<Running>& running) {
    const std::optional<ChildEnd> end = running->child->ended();
    if (end) handle(*running, *end);
    return end.has_value();
  });
}

void Sweep::passOnSignals() {
  // A second SIGHUP, which a queue may send to all processes, harms nothing; a second SIGTERM would.
  if (Interruption::asked() && !std::exchange(passedInterruption_, true))
    for (const auto& running : running_) running->child->send(SIGHUP);
  if (Interruption::warned() && !std::exchange(passedWarning_, true))
    for (const auto& running : running_) running->child->send(SIGUSR1);
}

int Sweep::exitCode() const {
  const bool isOpen = !waiting_.empty() || stopped_ != 0;
  if (isOpen && (Interruption::asked() || stopped_ == kInterrupted)) return kInterrupted;
  if (isOpen) return kSavedForLater;
  return failed_.empty() ? int{kDone} : failed_.begin()->second;
}

int Sweep::run() {
  const Interruption interruption(OnWarning::kSave);
  log_.info(fmt::format("{} of {} points, {} at a time with {} threads in all: {}", plan_.chosen.size(),
                        plan_.points.size(), plan_.jobs, plan_.threads, plan_.folder.string()));
  while (!running_.empty() || (!waiting_.empty() && !isEnding())) {
    startMore();
    passOnSignals();
    std::this_thread::sleep_for(kPause);
    reap();
  }
  log_.info(fmt::format("{} of {} points are done, {} failed", finished_ - failed_.size(),
                        plan_.chosen.size(), failed_.size()));
  return exitCode();
}

}  // namespace weir::app
