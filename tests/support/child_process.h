// Runs a program as a user does: arguments in, exit code and both outputs out.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace weir::test {

struct ChildResult {
  int code = -1;   ///< exit code; -1 if a signal or the time limit ended it
  int signal = 0;  ///< the signal that ended it
  bool timedOut = false;
  std::string out, err;
};

struct ChildOptions {
  std::map<std::string, std::string> environment;  ///< set in addition to the present one
  std::string folder;                              ///< to run in; "" for the present one
  std::chrono::seconds limit{120};                 ///< then it is killed
  /// Called with the process id and what has come on stderr so far, whenever more of it comes.
  std::function<void(int pid, const std::string& err)> onStderr;
};

ChildResult runChild(const std::string& program, const std::vector<std::string>& arguments,
                     const ChildOptions& options = {});

/// The folder of this build, with bin/, lib/ and share/; the test program stands in its bin/.
std::string buildFolder();
/// The program `weir` of this build.
std::string weirProgram();
ChildResult runWeir(const std::vector<std::string>& arguments, const ChildOptions& options = {});

/// The folder resources/ of the sources, or what the environment variable WEIR_TEST_RESOURCES names.
std::string resourcesFolder();

/// An empty folder that is removed at the end.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::string& path() const { return path_; }
  std::string operator/(const std::string& name) const { return path_ + "/" + name; }
  /// Writes a file into it and returns its path.
  std::string write(const std::string& name, const std::string& text) const;

 private:
  std::string path_;
};

std::string readFile(const std::string& path);

}  // namespace weir::test
