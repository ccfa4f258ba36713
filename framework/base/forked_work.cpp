#include "framework/base/forked_work.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <new>
#include <system_error>
#include <vector>

#include "framework/base/check.h"
#include "framework/base/error.h"
#include "framework/base/interruption.h"
#include "framework/base/sanitizers.h"

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

/// Bytes of address space that this process has; 0 where nothing tells.
std::uint64_t addressSpace() {
  std::FILE* file = std::fopen("/proc/self/statm", "re");
  if (file == nullptr) return 0;
  unsigned long long pages = 0;
  const bool read = std::fscanf(file, "%llu", &pages) == 1;
  std::fclose(file);
  return read ? pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE)) : 0;
}

/// How the copy ends that asks for more memory than it may have.
constexpr int kOutOfMemory = 86;

void limitMemory(std::uint64_t more) {
#if defined(WEIR_ADDRESS_SANITIZER) || defined(WEIR_THREAD_SANITIZER)
  return;  // whose memory is none of the library's
#endif
  rlimit limit{};
  ::getrlimit(RLIMIT_AS, &limit);
  limit.rlim_cur = std::min(limit.rlim_max, static_cast<rlim_t>(addressSpace() + more));
  ::setrlimit(RLIMIT_AS, &limit);
  // Libraries catch std::bad_alloc and go on as if the file were damaged.
  std::set_new_handler([] { ::_exit(kOutOfMemory); });
}

void limitFiles() {
  const rlimit nothing{0, 0};
  ::setrlimit(RLIMIT_FSIZE, &nothing);
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
  sigset_t ending;
  ::sigemptyset(&ending);
  for (const int signal : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGXCPU, SIGALRM, SIGXFSZ}) {
    ::signal(signal, SIG_DFL);
    ::sigaddset(&ending, signal);
  }
  ::sigprocmask(SIG_UNBLOCK, &ending, nullptr);
  const rlimit noCore{0, 0};
  ::setrlimit(RLIMIT_CORE, &noCore);
  limitCpu(limits.cpuSeconds);
  if (limits.seconds > 0) ::alarm(static_cast<unsigned>(limits.seconds));
  if (limits.memoryBytes > 0) limitMemory(limits.memoryBytes);
  if (!limits.writesFiles) limitFiles();
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

/// All that the pipe gives, or the first `max` bytes of it and one more.
/// Throws Interrupted where that ends this work.
void waitForBytes(int pipe) {
  constexpr int kMilliseconds = 100;
  pollfd waiting{pipe, POLLIN, 0};
  do InterruptibleWork::endIfAsked();
  while (::poll(&waiting, 1, kMilliseconds) == 0);
}

std::string readToEnd(int pipe, std::uint64_t max) {
  std::string bytes;
  std::vector<char> block(std::size_t{1} << 16);
  while (true) {
    waitForBytes(pipe);
    const ssize_t more = ::read(pipe, block.data(), block.size());
    if (more < 0 && errno == EINTR) continue;
    if (more <= 0) return bytes;
    bytes.append(block.data(), static_cast<std::size_t>(more));
    if (max > 0 && bytes.size() > max) return bytes;
  }
}

}  // namespace

ForkedWork::ForkedWork(const std::function<std::string()>& work, const ForkedLimits& limits)
    : resultBytes_(limits.resultBytes) {
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
  try {
    end.bytes = readToEnd(pipe_, resultBytes_);
  } catch (...) {
    ::kill(child_, SIGKILL);  // the destructor waits for it
    throw;
  }
  const bool tooMuch = resultBytes_ > 0 && end.bytes.size() > resultBytes_;
  if (tooMuch) ::kill(child_, SIGKILL);
  end.done = !tooMuch && !end.bytes.empty() && end.bytes.back() == '\0';
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
  end.outOfMemory = tooMuch || (!end.done && end.exitCode == kOutOfMemory);
  return end;
}

ForkedWork::~ForkedWork() {
  if (child_ > 0) wait();
  ::close(pipe_);
}

}  // namespace weir
