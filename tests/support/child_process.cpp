#include "tests/support/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <system_error>

namespace weir::test {

namespace {

using Clock = std::chrono::steady_clock;

/// In the child: becomes the program, or ends with the code that shells use for what cannot be run.
[[noreturn]] void become(const std::string& program, const std::vector<std::string>& arguments,
                         const ChildOptions& options, int out, int err) {
  dup2(open("/dev/null", O_RDONLY), STDIN_FILENO);
  dup2(out, STDOUT_FILENO);
  dup2(err, STDERR_FILENO);
  setpgid(0, 0);
  for (const auto& [name, value] : options.environment) setenv(name.c_str(), value.c_str(), 1);
  constexpr int kCannotRun = 127;
  if (!options.folder.empty() && chdir(options.folder.c_str()) != 0) _exit(kCannotRun);
  std::vector<char*> argv{const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  execv(program.c_str(), argv.data());
  _exit(kCannotRun);
}

/// Appends what can be read now; false at the end of the stream.
bool drain(int descriptor, std::string& text) {
  std::array<char, 4096> buffer;
  const ssize_t got = read(descriptor, buffer.data(), buffer.size());
  if (got > 0) text.append(buffer.data(), static_cast<std::size_t>(got));
  return got > 0 || (got < 0 && errno == EINTR);
}

void readBoth(int pid, int out, int err, const ChildOptions& options, ChildResult& result) {
  const Clock::time_point deadline = Clock::now() + options.limit;
  bool outOpen = true, errOpen = true;
  while (outOpen || errOpen) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
    if (left <= 0) {
      result.timedOut = true;
      kill(-pid, SIGKILL);
      return;
    }
    std::array<pollfd, 2> waiting{pollfd{outOpen ? out : -1, POLLIN, 0},
                                  pollfd{errOpen ? err : -1, POLLIN, 0}};
    if (poll(waiting.data(), waiting.size(), static_cast<int>(left)) <= 0) continue;
    if (waiting[0].revents != 0) outOpen = drain(out, result.out);
    if (waiting[1].revents != 0) {
      errOpen = drain(err, result.err);
      if (options.onStderr) options.onStderr(pid, result.err);
    }
  }
}

}  // namespace

ChildResult runChild(const std::string& program, const std::vector<std::string>& arguments,
                     const ChildOptions& options) {
  int out[2], err[2];
  if (pipe2(out, O_CLOEXEC) != 0 || pipe2(err, O_CLOEXEC) != 0)
    throw std::system_error(errno, std::generic_category(), "pipe");
  const pid_t pid = fork();
  if (pid < 0) throw std::system_error(errno, std::generic_category(), "fork");
  if (pid == 0) become(program, arguments, options, out[1], err[1]);
  close(out[1]);
  close(err[1]);
  ChildResult result;
  readBoth(pid, out[0], err[0], options, result);
  close(out[0]);
  close(err[0]);
  int status = 0;
  while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFEXITED(status)) result.code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) result.signal = WTERMSIG(status);
  return result;
}

std::string buildFolder() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path().parent_path();
}

std::string weirProgram() {
  return buildFolder() + "/bin/weir";
}

ChildResult runWeir(const std::vector<std::string>& arguments, const ChildOptions& options) {
  return runChild(weirProgram(), arguments, options);
}

std::string resourcesFolder() {
  const char* variable = std::getenv("WEIR_TEST_RESOURCES");
  return variable != nullptr ? variable : WEIR_RESOURCES;
}

TemporaryFolder::TemporaryFolder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "weir_test_XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) throw std::system_error(errno, std::generic_category(), pattern);
  path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::string TemporaryFolder::write(const std::string& name, const std::string& text) const {
  const std::string path = *this / name;
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file) throw std::runtime_error("cannot write " + path);
  return path;
}

std::string readFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

}  // namespace weir::test
