#include "plugins/vtkhdf/isolated.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <system_error>

#include "plugins/vtkhdf/hdf5.h"
#include "plugins/vtkhdf/packed.h"

namespace weir::hdf5 {

namespace {

/// The first byte of what the child says; without one of these it has said nothing.
enum Outcome : char { kDone = 'd', kError = 'e', kOther = 'o' };

/// An end of a pipe.
class Descriptor {
 public:
  explicit Descriptor(int id) : id_(id) {}
  ~Descriptor() { close(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return id_; }
  void close() {
    if (id_ >= 0) ::close(id_);
    id_ = -1;
  }

 private:
  int id_;
};

std::string outcomeOf(const std::function<std::string()>& work) {
  try {
    return char{kDone} + work();
  } catch (const Error& error) {
    Packer packer;
    for (const std::string& text : {error.message(), error.allowed(), error.hint(), error.location().file})
      packer.addText(text);
    return char{kError} + packer.take();
  } catch (const std::exception& error) {
    return char{kOther} + std::string(error.what());
  }
}

/// The soft limit ends the process by SIGXCPU, which tells the end from other ends.
void limitCpu(int seconds) {
  rlimit limit{};
  ::getrlimit(RLIMIT_CPU, &limit);
  limit.rlim_cur = std::min(limit.rlim_max, static_cast<rlim_t>(seconds));
  ::setrlimit(RLIMIT_CPU, &limit);
}

[[noreturn]] void runChild(const std::function<std::string()>& work, int cpuSeconds, int pipe) {
  for (const int signal : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGXCPU}) ::signal(signal, SIG_DFL);
  const rlimit noCore{0, 0};
  ::setrlimit(RLIMIT_CORE, &noCore);
  limitCpu(cpuSeconds);
  // The C library prints there when it finds its heap destroyed.
  const int nothing = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (nothing >= 0) ::dup2(nothing, STDERR_FILENO);

  const std::string outcome = outcomeOf(work);
  for (std::size_t sent = 0; sent < outcome.size();) {
    const ssize_t more = ::write(pipe, outcome.data() + sent, outcome.size() - sent);
    if (more < 0 && errno != EINTR) ::_exit(1);
    if (more > 0) sent += static_cast<std::size_t>(more);
  }
  // Without destructors and exit handlers, which belong to the parent.
  ::_exit(0);
}

std::string readToEnd(int pipe) {
  std::string bytes;
  std::vector<char> block(std::size_t{1} << 20);
  while (true) {
    const ssize_t more = ::read(pipe, block.data(), block.size());
    if (more < 0 && errno == EINTR) continue;
    if (more <= 0) return bytes;
    bytes.append(block.data(), static_cast<std::size_t>(more));
  }
}

int waitFor(pid_t child) {
  int status = 0;
  while (::waitpid(child, &status, 0) < 0)
    if (errno != EINTR) return 0;  // the program ignores SIGCHLD: nobody knows, and the bytes must do
  return status;
}

[[noreturn]] void rethrow(std::string_view packed) {
  Unpacker unpacker(packed);
  std::string message(unpacker.text()), allowed(unpacker.text()), hint(unpacker.text());
  throw ioError(std::move(message), std::move(allowed), std::move(hint))
      .at({.file = std::string(unpacker.text())});
}

Error cannotStart(int error) {
  return ioError("cannot start a process that reads the file: " + std::generic_category().message(error));
}

}  // namespace

std::string runIsolated(const std::function<std::string()>& work, int cpuSeconds) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) throw cannotStart(errno);
  const Descriptor from(ends[0]);
  Descriptor to(ends[1]);
  pid_t child = 0;
  {
    const Session session;  // so that no other thread is within HDF5 while the copy is made
    child = ::fork();
    if (child < 0) throw cannotStart(errno);
    if (child == 0) {
      Session::renewLock();
      runChild(work, cpuSeconds, to.get());
    }
  }
  to.close();
  const std::string outcome = readToEnd(from.get());
  const int status = waitFor(child);
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU)
    throw ioError("the file is damaged: the HDF5 library does not come to an end with it");
  if (WIFSIGNALED(status) || status != 0 || outcome.empty())
    throw ioError("the file is damaged: the HDF5 library crashes when it reads it");
  switch (outcome[0]) {
    case kDone:
      return outcome.substr(1);
    case kError:
      rethrow(std::string_view(outcome).substr(1));
    default:
      throw ioError("the file cannot be read: " + outcome.substr(1));
  }
}

}  // namespace weir::hdf5
