#include "apps/weir/sweep/child_run.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <system_error>

#include "framework/base/error.h"

namespace weir::app {

namespace {

constexpr int kCannotRun = 127;  // as shells have it

Error cannotStart(const std::filesystem::path& program) {
  return ioError("the program cannot be started: " + std::generic_category().message(errno))
      .at({.file = program.string()});
}

int openLog(const std::filesystem::path& log) {
  constexpr mode_t kReadWriteForAll = 0666;
  const int file = ::open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, kReadWriteForAll);
  if (file >= 0) return file;
  throw ioError("cannot write the file: " + std::generic_category().message(errno))
      .at({.file = log.string()});
}

/// In the child, where only what is safe in signal handlers may be called.
[[noreturn]] void become(const char* program, char* const* arguments, int log, pid_t parent) {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (::getppid() != parent) ::_exit(kCannotRun);  // it has ended before it could be said
  const int nothing = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  ::dup2(nothing, STDIN_FILENO);
  ::dup2(nothing, STDOUT_FILENO);
  ::dup2(log, STDERR_FILENO);
  ::signal(SIGHUP, SIG_DFL);  // which nohup may have switched off, and a sweep ends its runs by
  ::execv(program, arguments);
  ::_exit(kCannotRun);
}

}  // namespace

ChildRun::ChildRun(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                   const std::filesystem::path& log) {
  std::vector<char*> words{const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  const int file = openLog(log);
  const pid_t parent = ::getpid();
  pid_ = ::fork();
  if (pid_ == 0) become(program.c_str(), words.data(), file, parent);
  ::close(file);
  if (pid_ < 0) throw cannotStart(program);
  runs_ = true;
}

ChildRun::~ChildRun() {
  if (!runs_) return;
  send(SIGTERM);
  while (::waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

std::optional<ChildEnd> ChildRun::ended() {
  int status = 0;
  if (!runs_ || ::waitpid(pid_, &status, WNOHANG) != pid_) return std::nullopt;
  if (!WIFEXITED(status) && !WIFSIGNALED(status)) return std::nullopt;
  runs_ = false;
  if (WIFSIGNALED(status)) return ChildEnd{.code = 0, .signal = WTERMSIG(status)};
  return ChildEnd{.code = WEXITSTATUS(status), .signal = 0};
}

void ChildRun::send(int signal) const {
  if (runs_) ::kill(pid_, signal);
}

}  // namespace weir::app
