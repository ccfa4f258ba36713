// Work in a process of its own: what comes back from it, and what becomes of its crashes.
#include "plugins/vtkhdf/isolated.h"

#include <atomic>
#include <csignal>
#include <stdexcept>
#include <thread>

#include "framework/base/packed.h"
#include "plugins/vtkhdf/vtkhdf_particle_reader.h"
#include "tests/plugins/vtkhdf/sample_run.h"
#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

constexpr int kManySeconds = 60;

std::string isolated(const std::function<std::string()>& work, int cpuSeconds = kManySeconds) {
  return hdf5::runIsolated(work, cpuSeconds);
}

TEST(Isolated, GivesBackBytes) {
  EXPECT_EQ(isolated([] { return std::string("a\0b", 3); }), std::string("a\0b", 3));
  EXPECT_EQ(isolated([] { return std::string(); }), "");
  const std::string much(10'000'000, 'x');  // more than a pipe holds
  EXPECT_TRUE(isolated([&] { return much; }) == much);
}

TEST(Isolated, ChangesNothingHere) {
  int number = 1;
  EXPECT_EQ(isolated([&] { return std::to_string(++number); }), "2");
  EXPECT_EQ(number, 1);
}

TEST(Isolated, PassesErrorsOn) {
  const Error error = errorOf([] {
    isolated([]() -> std::string { throw ioError("what", "allowed", "hint").at({.file = "here"}); });
  });
  EXPECT_EQ(error.kind(), ErrorKind::kIo);
  EXPECT_STREQ(error.what(), "here: what\n  allowed: allowed\n  hint: hint");
  EXPECT_EQ(errorOf([] { isolated([]() -> std::string { throw std::runtime_error("odd"); }); }).message(),
            "the file cannot be read: odd");
}

TEST(Isolated, ACrashIsAnError) {
  for (const int signal : {SIGSEGV, SIGABRT, SIGKILL}) {
    const Error error = errorOf([&] {
      isolated([&] {
        ::raise(signal);
        return std::string();
      });
    });
    EXPECT_EQ(error.kind(), ErrorKind::kIo);
    EXPECT_CONTAINS(error.message(), "crashes when it reads it");
  }
}

TEST(Isolated, WorkWithoutEndIsAnError) {
  const Error error = errorOf([] {
    isolated(
        [] {
          const volatile bool busy = true;
          while (busy) {
          }
          return std::string();
        },
        1);
  });
  EXPECT_CONTAINS(error.message(), "does not come to an end");
}

TEST(Packed, GivesBackWhatWasAddedAndRefusesTheRest) {
  Packer packer;
  packer.addAll(std::vector<int>{1, 2, 3});
  packer.addText("text");
  packer.addAll(std::vector<double>{});
  const std::string bytes = packer.take();
  Unpacker unpacker(bytes);
  EXPECT_EQ(unpacker.all<int>(), (std::vector<int>{1, 2, 3}));
  EXPECT_EQ(unpacker.text(), "text");
  EXPECT_EQ(unpacker.all<double>(), std::vector<double>{});
  EXPECT_TRUE(unpacker.atEnd());
  EXPECT_CONTAINS(errorOf([&] { unpacker.text(); }).message(), "contents are inconsistent");
  Unpacker cut(std::string_view(bytes).substr(0, 10));
  EXPECT_CONTAINS(errorOf([&] { cut.all<int>(); }).message(), "contents are inconsistent");
}

using VtkHdfParticleReaderTest = InFolder;

TEST_F(VtkHdfParticleReaderTest, ReadsTheLastStepWhileAnotherFileIsWritten) {
  const auto done = folder / "done.vtkhdf";
  {
    VtkHdfWriter writer(done, sampleLayout());
    for (int s = 0; s < 3; ++s) writer.append(SampleStep(s, 5 + s).frame());
  }
  std::atomic<bool> writing = false;
  int written = 0;
  std::jthread busy([&](const std::stop_token& enough) {
    VtkHdfWriter writer(folder / "busy.vtkhdf", sampleLayout());
    for (; !enough.stop_requested(); ++written) {
      writer.append(SampleStep(written, 20000).frame());
      writing = true;
    }
    writer.close();
  });
  while (!writing) std::this_thread::yield();
  for (int s = 0; s < 20; ++s) {
    const ParticleData data = VtkHdfParticleReader().read(done);
    const SampleStep wanted(2, 7);
    EXPECT_EQ(data.positions, wanted.positions);
    EXPECT_EQ(data.velocities, wanted.velocities);
    EXPECT_EQ(data.unused, (std::vector<std::string>{"birth", "density", "flags", "id"}));
  }
  busy.request_stop();
  busy.join();
  EXPECT_EQ(VtkHdfReader(folder / "busy.vtkhdf").times().size(), static_cast<std::size_t>(written));
}

TEST_F(VtkHdfParticleReaderTest, RefusesAFileWithoutParticles) {
  const auto file = folder / "empty.vtkhdf";
  {
    VtkHdfWriter writer(file, sampleLayout());
    writer.append(SampleStep(0, 0).frame());
  }
  const Error error = errorOf([&] { VtkHdfParticleReader().read(file); });
  EXPECT_EQ(error.message(), "the last step holds no particles");
  EXPECT_EQ(error.location().file, file.string());
  EXPECT_CONTAINS(errorOf([&] { VtkHdfParticleReader().read(folder / "no.vtkhdf"); }).what(),
                  "there is no such file");
}

}  // namespace
}  // namespace weir::test
