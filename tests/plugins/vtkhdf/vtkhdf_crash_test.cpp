// What is left of an export when the program is killed or the disk is full.
#include <fcntl.h>
#include <signal.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <functional>

#include "framework/base/error.h"
#include "tests/plugins/vtkhdf/sample_run.h"

namespace weir::test {
namespace {

using VtkHdfCrashTest = InFolder;

constexpr int kKills = 8;
constexpr rlim_t kLimitStep = 700'000;

/// Grows, shrinks and has empty frames.
int countOf(int step) {
  return step % 7 == 6 ? 0 : (step % 13) * 700;
}

/// Runs `body` in a process of its own, which gets the writing end of a pipe.
class Child {
 public:
  explicit Child(const std::function<int(int pipe)>& body) {
    int ends[2];
    EXPECT_EQ(::pipe(ends), 0);
    pid_ = ::fork();
    if (pid_ == 0) {
      ::close(ends[0]);
      ::_exit(body(ends[1]));
    }
    ::close(ends[1]);
    pipe_ = ends[0];
  }
  ~Child() { ::close(pipe_); }

  /// The next number from the child, or -1 if it has ended.
  std::int64_t next() {
    std::int64_t number = -1;
    return ::read(pipe_, &number, sizeof number) == sizeof number ? number : -1;
  }
  void kill() { ::kill(pid_, SIGKILL); }
  int wait() {
    int status = 0;
    ::waitpid(pid_, &status, 0);
    return status;
  }

 private:
  pid_t pid_ = 0;
  int pipe_ = -1;
};

void say(int pipe, std::int64_t number) {
  if (::write(pipe, &number, sizeof number) != sizeof number) ::_exit(9);
}

void expectAllSteps(const std::filesystem::path& file, std::int64_t atLeast) {
  const VtkHdfReader reader(file);
  EXPECT_GE(static_cast<std::int64_t>(reader.times().size()), atLeast);
  for (std::size_t s = 0; s < reader.times().size(); ++s)
    expectStep(reader.read(s), static_cast<int>(s), countOf(static_cast<int>(s)));
}

TEST_F(VtkHdfCrashTest, KeepsTheFramesWrittenBeforeAKill) {
  for (int round = 0; round < kKills; ++round) {
    SCOPED_TRACE("round " + std::to_string(round));
    const auto file = folder / "run.vtkhdf";
    Child child([&](int pipe) {
      VtkHdfWriter writer(file, sampleLayout());
      for (int s = 0;; ++s) {
        writer.append(SampleStep(s, countOf(s)).frame());
        say(pipe, writer.framesWritten());
      }
      return 0;
    });
    std::int64_t written = 0;
    while (written >= 0 && written < 20 + 9 * round) written = child.next();
    child.kill();
    ASSERT_TRUE(WIFSIGNALED(child.wait()));
    while (const std::int64_t more = child.next()) {
      if (more < 0) break;
      written = more;
    }
    expectAllSteps(file, written);
    if (HasFailure()) return;
  }
}

/// Appends until an error comes. Says how many frames were written, and ends with 0 if all is as it should
/// be.
int writeUntilFull(const std::filesystem::path& file, int pipe) {
  VtkHdfWriter writer(file, sampleLayout());
  try {
    constexpr int kMoreThanFit = 100000;
    for (int s = 0; s < kMoreThanFit; ++s) writer.append(SampleStep(s, countOf(s)).frame());
    return 1;
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::kIo || error.location().file != file.string()) return 2;
    const std::string& what = error.message();
    if (what.find("No space left") == std::string::npos && what.find("File too large") == std::string::npos) {
      fprintf(stderr, "%s\n", error.what());
      return 3;
    }
  }
  const std::int64_t written = writer.framesWritten();
  try {
    writer.append(SampleStep(1 << 20, 1).frame());
    return 4;
  } catch (const Error&) {
    // The same error again.
  }
  writer.close();
  say(pipe, written);
  return 0;
}

TEST_F(VtkHdfCrashTest, KeepsTheFramesWrittenBeforeAFileGetsTooLarge) {
  const auto file = folder / "run.vtkhdf";
  for (rlim_t limit = 3'000'000; limit < 6'000'000; limit += kLimitStep) {
    SCOPED_TRACE("limit " + std::to_string(limit));
    Child child([&](int pipe) {
      ::signal(SIGXFSZ, SIG_IGN);
      const rlimit max{limit, limit};
      ::setrlimit(RLIMIT_FSIZE, &max);
      return writeUntilFull(file, pipe);
    });
    const std::int64_t written = child.next();
    ASSERT_EQ(child.wait(), 0);
    ASSERT_GT(written, 0);
    expectAllSteps(file, written);
    if (HasFailure()) return;
  }
}

TEST_F(VtkHdfCrashTest, SaysSoWhereNotEvenTheFirstPartFits) {
  Child child([&](int) {
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit max{1000, 1000};
    ::setrlimit(RLIMIT_FSIZE, &max);
    try {
      VtkHdfWriter writer(folder / "run.vtkhdf", sampleLayout());
    } catch (const Error& error) {
      return error.message() == "cannot write the file: File too large" ? 0 : 2;
    }
    return 1;
  });
  EXPECT_EQ(child.wait(), 0);
  EXPECT_TRUE(std::filesystem::is_empty(folder));
}

TEST_F(VtkHdfCrashTest, KeepsTheFramesWrittenBeforeTheDiskIsFull) {
  if (::mount("tmpfs", folder.c_str(), "tmpfs", 0, "size=4m") != 0)
    GTEST_SKIP() << "this user cannot mount a small disk";
  const auto file = folder / "run.vtkhdf";
  {
    Child child([&](int pipe) { return writeUntilFull(file, pipe); });
    const std::int64_t written = child.next();
    EXPECT_EQ(child.wait(), 0);
    EXPECT_GT(written, 0);
    expectAllSteps(file, written);
  }
  ::umount(folder.c_str());
}

}  // namespace
}  // namespace weir::test
