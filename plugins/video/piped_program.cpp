#include "plugins/video/piped_program.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <system_error>
#include <utility>

#include "framework/base/interruption.h"

extern char** environ;

namespace weir::rendering {

namespace {

constexpr std::size_t kMaxMessages = 8192, kMaxOutput = 1 << 20;

void check(int error, const std::string& what) {
  if (error != 0) throw std::system_error(error, std::generic_category(), what);
}

/// An open file that is closed at the end of the scope.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() { ::close(number_); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int number() const { return number_; }

 private:
  int number_;
};

/// How the child is started: which files it gets, and how it takes signals.
class SpawnPlan {
 public:
  SpawnPlan() {
    check(posix_spawn_file_actions_init(&files_), "posix_spawn_file_actions_init");
    check(posix_spawnattr_init(&attributes_), "posix_spawnattr_init");
    // The child must not inherit what this program ignores or blocks.
    sigset_t all, none;
    sigfillset(&all);
    sigemptyset(&none);
    posix_spawnattr_setsigdefault(&attributes_, &all);
    posix_spawnattr_setsigmask(&attributes_, &none);
    posix_spawnattr_setpgroup(&attributes_, 0);
    posix_spawnattr_setflags(&attributes_,
                             POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
  }
  ~SpawnPlan() {
    posix_spawnattr_destroy(&attributes_);
    posix_spawn_file_actions_destroy(&files_);
  }
  SpawnPlan(const SpawnPlan&) = delete;
  SpawnPlan& operator=(const SpawnPlan&) = delete;

  pid_t spawn(const std::string& program, const std::vector<std::string>& arguments, int in, int err,
              const std::filesystem::path& output) {
    check(posix_spawn_file_actions_adddup2(&files_, in, STDIN_FILENO), "stdin");
    check(output.empty() ? posix_spawn_file_actions_adddup2(&files_, err, STDOUT_FILENO)
                         : posix_spawn_file_actions_addopen(&files_, STDOUT_FILENO, output.c_str(),
                                                            O_WRONLY | O_APPEND, 0),
          "stdout");
    check(posix_spawn_file_actions_adddup2(&files_, err, STDERR_FILENO), "stderr");
    std::vector<char*> argv{const_cast<char*>(program.c_str())};
    for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    pid_t pid = -1;
    check(posix_spawnp(&pid, program.c_str(), &files_, &attributes_, argv.data(), environ), program);
    return pid;
  }

 private:
  posix_spawn_file_actions_t files_;
  posix_spawnattr_t attributes_;
};

/// Above the three standard files, which the child's are copied onto.
int moveUp(int descriptor) {
  constexpr int kFirst = 3;
  if (descriptor < 0 || descriptor >= kFirst) return descriptor;
  const int moved = ::fcntl(descriptor, F_DUPFD_CLOEXEC, kFirst);
  const int error = moved < 0 ? errno : 0;
  ::close(descriptor);
  check(error, "fcntl");
  return moved;
}

struct Pair {
  int ours, theirs;
};

/// A socket, since a pipe that breaks raises SIGPIPE and a socket need not.
Pair makeInput() {
  std::array<int, 2> ends;
  check(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) == 0 ? 0 : errno, "socketpair");
  return {moveUp(ends[0]), moveUp(ends[1])};
}

Pair makeMessagePipe() {
  std::array<int, 2> ends;
  check(::pipe2(ends.data(), O_CLOEXEC) == 0 ? 0 : errno, "pipe2");
  ::fcntl(ends[0], F_SETFL, O_NONBLOCK);
  return {moveUp(ends[0]), moveUp(ends[1])};
}

/// That the process has used so far.
std::chrono::nanoseconds processorTime(pid_t pid) {
  clockid_t clock{};
  timespec used{};
  if (::clock_getcpuclockid(pid, &clock) != 0 || ::clock_gettime(clock, &used) != 0) return {};
  return std::chrono::seconds(used.tv_sec) + std::chrono::nanoseconds(used.tv_nsec);
}

void closeAndForget(int& descriptor) {
  const int open = std::exchange(descriptor, -1);
  if (open >= 0) ::close(open);
}

}  // namespace

std::chrono::nanoseconds Waiting::time() {
  constexpr std::chrono::nanoseconds kLongest = std::chrono::seconds(1);  // between two questions
  const auto now = std::chrono::steady_clock::now();
  waited_ += std::min<std::chrono::nanoseconds>(now - last_, kLongest);
  last_ = now;
  return waited_;
}

PipedProgram::PipedProgram(const std::string& program, const std::vector<std::string>& arguments,
                           const ProgramLimits& limits, const std::filesystem::path& output)
    : maxMessages_(output.empty() ? kMaxOutput : kMaxMessages), limits_(limits) {
  const Pair input = makeInput();
  const Descriptor theirInput(input.theirs);
  input_ = input.ours;
  try {
    const Pair messages = makeMessagePipe();
    const Descriptor theirMessages(messages.theirs);
    messagePipe_ = messages.ours;
    pid_ = SpawnPlan().spawn(program, arguments, input.theirs, messages.theirs, output);
  } catch (...) {
    closeAndForget(input_);
    closeAndForget(messagePipe_);
    throw;
  }
}

PipedProgram::~PipedProgram() {
  cancel();
  finish();
  closeAndForget(messagePipe_);
}

bool PipedProgram::write(std::span<const std::uint8_t> bytes) {
  constexpr int kPatience = 100;  // milliseconds until cancel() is noticed
  Waiting taken;
  while (!bytes.empty()) {
    if (cancelled_ || isOverdue(taken, limits_.idle, "took no frame")) return false;
    // A descriptor of -1 is passed over.
    std::array<pollfd, 2> waiting{pollfd{input_, POLLOUT, 0}, pollfd{messagePipe_, POLLIN, 0}};
    if (::poll(waiting.data(), waiting.size(), kPatience) <= 0) continue;
    if (waiting[1].revents != 0) readMessages();
    if (waiting[0].revents == 0) continue;
    const ssize_t sent = ::send(input_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent < 0 && errno != EAGAIN && errno != EINTR) return false;
    if (sent <= 0) continue;
    bytes = bytes.subspan(static_cast<std::size_t>(sent));
    taken.restart();
    lifeless_.restart();
  }
  return true;
}

bool PipedProgram::isRunning() {
  readMessages();
  return !hasEnded();
}

bool PipedProgram::finish() {
  constexpr int kPatience = 20;
  closeAndForget(input_);
  Waiting start;
  while (!hasEnded()) {
    if (cancelled_ || isOverdue(start, limits_.end, "did not end")) kill();
    pollfd waiting{messagePipe_, POLLIN, 0};
    if (::poll(&waiting, 1, kPatience) > 0) readMessages();
  }
  readMessages();
  reap();
  return ending_ == "ended with exit code 0";
}

bool PipedProgram::isOverdue(Waiting& since, std::chrono::milliseconds limit, const char* what) {
  using Seconds = std::chrono::duration<double>;
  if (!overdue_.empty()) return true;
  if (since.time() >= limit)
    overdue_ = fmt::format("{} for {:g} s", what, Seconds(limit).count());
  else if (isLifelessAfterInterruption())
    overdue_ = fmt::format("{} for {} s after the run was interrupted", what,
                           ProgramLimits::kAfterInterruption.count());
  return !overdue_.empty();
}

bool PipedProgram::isLifelessAfterInterruption() {
  if (!Interruption::asked()) return false;
  const std::chrono::nanoseconds used = processorTime(pid_);
  if (used > used_) lifeless_.restart();
  used_ = used;
  return lifeless_.time() >= ProgramLimits::kAfterInterruption;
}

/// The process is not reaped, so that its number, which is also its group's, is not given to another.
bool PipedProgram::hasEnded() const {
  if (pid_ < 0) return true;
  siginfo_t info{};
  const int result = ::waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT);
  return result != 0 ? errno != EINTR : info.si_pid == pid_;
}

void PipedProgram::kill() const {
  ::kill(-pid_, SIGKILL);
}

void PipedProgram::reap() {
  if (pid_ < 0) return;
  kill();  // what it has started and left behind
  int status = 0;
  const bool reaped = ::waitpid(pid_, &status, 0) == pid_;
  if (!overdue_.empty())
    ending_ = overdue_;
  else if (!reaped)
    ending_ = "ended in an unknown way";  // where this program ignores SIGCHLD
  else if (WIFSIGNALED(status))
    ending_ = "was ended by signal " + std::to_string(WTERMSIG(status));
  else
    ending_ = "ended with exit code " + std::to_string(WEXITSTATUS(status));
  pid_ = -1;
}

void PipedProgram::readMessages() {
  std::array<char, 4096> buffer;
  while (messagePipe_ >= 0) {
    const ssize_t got = ::read(messagePipe_, buffer.data(), buffer.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0 && errno == EAGAIN) return;
    if (got <= 0) return closeAndForget(messagePipe_);
    messages_.append(buffer.data(), static_cast<std::size_t>(got));
    if (messages_.size() > maxMessages_) messages_.erase(0, messages_.size() - maxMessages_);
  }
}

}  // namespace weir::rendering
