#include "framework/base/forked_work.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <system_error>
#include <vector>

#include "framework/base/check.h"
#include "framework/base/error.h"

namespace weir {

namespace {

Error cannotStart(int error) {
  return ioError("cannot make a copy of this process: " + std::generic_category().message(error));
}

/// The soft limit ends the process by SIGXCPU, which tells the end from other ends.
void limitCpu(int seconds) {
  rlimit limit{};
  ::getrlimit(RLIMIT_CPU, &limit);
  limit.rlim_cur = std::min(limit.rlim_max, static_cast<rlim_t>(seconds));
  ::setrlimit(RLIMIT_CPU, &limit);
}

void sendAll(int pipe, const std::string& bytes) {
  for (std::size_t sent = 0; sent < bytes.size();) {
    const ssize_t more = ::write(pipe, bytes.data() + sent, bytes.size() - sent);
    if (more < 0 && errno != EINTR) ::_exit(1);
    if (more > 0) sent += static_cast<std::size_t>(more);
  }
}

// noexcept, so that nothing that is thrown leads back into what the parent does.
[[noreturn]] void runChild(const std::function<std::string()>& work, const ForkedLimits& limits,
                           int pipe) noexcept {
  for (const int signal : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGXCPU, SIGALRM})
    ::signal(signal, SIG_DFL);
  const rlimit noCore{0, 0};
  ::setrlimit(RLIMIT_CORE, &noCore);
  limitCpu(limits.cpuSeconds);
  if (limits.seconds > 0) ::alarm(static_cast<unsigned>(limits.seconds));
  // The C library prints there when it finds its heap destroyed; and what the work prints is not for the
  // user.
  const int nothing = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (nothing >= 0) ::dup2(nothing, STDOUT_FILENO);
  if (const int errors = limits.keepsStderr ? pipe : nothing; errors >= 0) ::dup2(errors, STDERR_FILENO);
  // The last byte says that it came to its end, as an exit within the work does not.
  sendAll(pipe, work() + '\0');
  // Without destructors and exit handlers, which belong to the parent.
  ::_exit(0);
}

std::string readToEnd(int pipe) {
  std::string bytes;
  std::vector<char> block(std::size_t{1} << 16);
  while (true) {
    const ssize_t more = ::read(pipe, block.data(), block.size());
    if (more < 0 && errno == EINTR) continue;
    if (more <= 0) return bytes;
    bytes.append(block.data(), static_cast<std::size_t>(more));
  }
}

}  // namespace

ForkedWork::ForkedWork(const std::function<std::string()>& work, const ForkedLimits& limits) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) throw cannotStart(errno);
  child_ = ::fork();
  if (child_ == 0) runChild(work, limits, ends[1]);
  const int error = errno;
  ::close(ends[1]);
  pipe_ = ends[0];
  if (child_ > 0) return;
  ::close(pipe_);
  throw cannotStart(error);
}

ForkedEnd ForkedWork::wait() {
  WEIR_CHECK(child_ > 0);
  ForkedEnd end;
  end.bytes = readToEnd(pipe_);
  end.done = !end.bytes.empty() && end.bytes.back() == '\0';
  if (end.done) end.bytes.pop_back();
  int status = 0;
  pid_t waited = 0;
  do waited = ::waitpid(child_, &status, 0);
  while (waited < 0 && errno == EINTR);
  child_ = -1;
  if (waited < 0) return end;  // the program ignores SIGCHLD: nobody knows, and the bytes must do
  end.signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  end.exitCode = WIFEXITED(status) ? WEXITSTATUS(status) : 0;
  end.outOfTime = end.signal == SIGXCPU || end.signal == SIGALRM;
  return end;
}

ForkedWork::~ForkedWork() {
  if (child_ > 0) wait();
  ::close(pipe_);
}

}  // namespace weir
