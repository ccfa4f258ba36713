// Checkpoints with a flipped bit are refused, or give back what was written: never anything else.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <map>

#include "framework/base/error.h"
#include "plugins/vtkhdf/checkpoint_file.h"
#include "plugins/vtkhdf/hdf5.h"
#include "tests/support/child_process.h"
#include "tests/support/expect_error.h"
#include "tests/support/scene_mutator.h"

namespace weir::test {
namespace {

Checkpoint sample() {
  Checkpoint checkpoint{.version = "1.2.3",
                        .scene = "{\"world\": {\"dt\": 0.001}}",
                        .device = "cpu",
                        .inputs = "{\"mesh.file\": {\"file\": \"a.obj\", \"bytes\": 12, \"digest\": 7}}",
                        .state = {}};
  Random random(5);
  std::vector<Vec3f> positions(500);
  for (Vec3f& p : positions)
    for (int k = 0; k < 3; ++k) p[k] = float(random.below(1'000'000)) * 1e-6f;
  std::vector<double> times(40, 0.25);
  const StateWriter water = StateWriter(checkpoint.state).in("water");
  water.in("particles").put("position", std::span<const Vec3f>(positions));
  water.in("particles").put("velocity", std::span<const Vec3f>(positions));
  water.put("times", std::span<const double>(times));
  water.put("count", 500);
  StateWriter(checkpoint.state).in("clock").put("frame", std::int64_t{7});
  return checkpoint;
}

void expectEqual(const Checkpoint& read, const Checkpoint& written) {
  EXPECT_EQ(read.version, written.version);
  EXPECT_EQ(read.scene, written.scene);
  EXPECT_EQ(read.device, written.device);
  EXPECT_EQ(read.inputs, written.inputs);
  ASSERT_EQ(read.state.size(), written.state.size());
  for (const auto& [path, array] : written.state) {
    const auto found = read.state.find(path);
    ASSERT_NE(found, read.state.end()) << path;
    EXPECT_EQ(found->second.kind, array.kind) << path;
    EXPECT_EQ(found->second.rows, array.rows) << path;
    EXPECT_EQ(found->second.columns, array.columns) << path;
    EXPECT_EQ(found->second.data, array.data) << path;
  }
}

class DamagedCheckpoint : public testing::Test {
 protected:
  DamagedCheckpoint() {
    store.write(folder / "good.h5", written);
    bytes = readFile(folder / "good.h5");
  }
  /// What is said of the file with one bit flipped; "" if it was read as it was written.
  std::string refusalOf(std::size_t byte, int bit) {
    std::string flipped = bytes;
    flipped[byte] = static_cast<char>(flipped[byte] ^ (1 << bit));
    const std::string file = folder.write("flipped.h5", flipped);
    try {
      expectEqual(store.read(file), written);
      return {};
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kIo);
      EXPECT_EQ(error.location().file, file);
      return error.what();
    }
  }

  TemporaryFolder folder;
  Hdf5CheckpointStore store;
  Checkpoint written = sample();
  std::string bytes;
};

// WEIR_TEST_FLIPS is how many bits are tried, one after another.
TEST_F(DamagedCheckpoint, NoFlippedBitIsSilent) {
  const char* asked = std::getenv("WEIR_TEST_FLIPS");
  const std::uint64_t flips = asked != nullptr ? std::strtoull(asked, nullptr, 10) : 1000;
  Random random(11);
  std::uint64_t refused = 0;
  for (std::uint64_t k = 0; k < flips && !HasFailure(); ++k) {
    const std::size_t byte = random.below(bytes.size());
    const int bit = static_cast<int>(random.below(8));
    SCOPED_TRACE("byte " + std::to_string(byte) + ", bit " + std::to_string(bit));
    if (!refusalOf(byte, bit).empty()) ++refused;
  }
  EXPECT_GT(refused, flips / 3);  // the rest is space of the format that nothing stands in
  if (asked != nullptr)
    std::printf("%llu flips, %llu refused, the others read as written\n",
                static_cast<unsigned long long>(flips), static_cast<unsigned long long>(refused));
}

TEST_F(DamagedCheckpoint, TheRefusalNamesTheArray) {
  const auto& data = written.state.at("water/times").data;
  const std::size_t place = bytes.find(std::string(reinterpret_cast<const char*>(data.data()), data.size()));
  ASSERT_NE(place, std::string::npos);
  const std::string refusal = refusalOf(place + 100, 3);
  EXPECT_CONTAINS(refusal, "its array 'water/times' is not what was written");
  EXPECT_CONTAINS(refusal, ".previous.h5");
  const std::size_t text = bytes.find("1.2.3");
  ASSERT_NE(text, std::string::npos);
  EXPECT_CONTAINS(refusalOf(text, 0), "the checkpoint is damaged");
}

TEST_F(DamagedCheckpoint, OneWithoutDigestsSaysHowToGoOn) {
  {
    const hdf5::Session session;
    hdf5::File file = hdf5::File::create(folder / "old.h5", folder / "old.h5");
    hdf5::Group root = file.root().createGroup("checkpoint");
    root.setAttribute("format", std::int64_t{1});
    for (const char* text : {"program", "scene", "device"}) root.writeText(text, "1");
    root.createGroup("state");
    file.close();
  }
  const Error e = errorOf([&] { store.read(folder / "old.h5"); });
  EXPECT_CONTAINS(e.what(), "the checkpoint is of format 1");
  EXPECT_CONTAINS(e.hint(), "resume it with the program that wrote it");
}

}  // namespace
}  // namespace weir::test
