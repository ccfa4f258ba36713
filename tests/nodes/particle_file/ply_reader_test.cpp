// The three encodings of PLY, written by the test itself, and messages about damaged files.
#include "nodes/particle_file/ply_reader.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/nodes/particle_file/ply_maker.h"
#include "tests/support/child_process.h"
#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

using Names = std::vector<std::string>;

class Ply : public testing::TestWithParam<const char*> {
 protected:
  ParticleData read(const std::string& text) const { return PlyReader().read(folder_.write("p.ply", text)); }
  Error refusal(const std::string& text) const {
    return errorOf([&] { read(text); });
  }

  TemporaryFolder folder_;
};

TEST_P(Ply, ReadsWhatItNeedsAndPassesOverTheRest) {
  const ParticleData data = read(samplePly(GetParam()));
  EXPECT_EQ(data.positions, (std::vector<Vec3f>{{1.5f, 0.1f, -2.25f}, {2.5f, 1.1f, -2.25f}}));
  EXPECT_EQ(data.velocities, (std::vector<Vec3f>{{4e-3f, 5, 6}, {4e-3f, 5, 5}}));
  EXPECT_EQ(data.unused, (Names{"red", "weights", "sign", "id"}));
}

constexpr const char* kPoints = "element vertex 2\nproperty float x\nproperty float y\nproperty float z\n";

TEST_P(Ply, VelocitiesMayBeMissing) {
  PlyMaker ply(GetParam(), kPoints);
  for (const float f : {1.0f, 2.0f, 3.0f, 4.0f, 5.0f, 6.0f}) ply.add(f);
  const ParticleData data = read(ply.text());
  EXPECT_EQ(data.positions, (std::vector<Vec3f>{{1, 2, 3}, {4, 5, 6}}));
  EXPECT_EQ(data.velocities, (std::vector<Vec3f>{{0, 0, 0}, {0, 0, 0}}));
}

TEST_P(Ply, OtherNumbersAreColumns) {
  PlyMaker ply(GetParam(), std::string(kPoints) +
                               "property double heat\nproperty int mark\nproperty float home_x\n"
                               "property float home_y\nproperty float home_z\nproperty uint big\n"
                               "property uchar red\nproperty float spin_x\nproperty float spin_z\n");
  for (const float row : {0.0f, 10.0f}) {
    for (const float f : {1.0f, 2.0f, 3.0f}) ply.add(row + f);
    ply.add(double(row) + 0.5).add(static_cast<int>(-row) - 7);
    for (const float f : {4.0f, 5.0f, 6.0f}) ply.add(row + f);
    ply.add(4000000000u).add(std::uint8_t{200}).add(row).add(-row).endRow();
  }
  const ParticleData data = read(ply.text());
  Names names;
  for (const ParticleColumn& column : data.columns) names.push_back(column.info.name);
  EXPECT_EQ(names, (Names{"heat", "mark", "home", "red", "spin_x", "spin_z"}));
  EXPECT_EQ(std::get<std::vector<float>>(data.columns[0].values), (std::vector<float>{0.5f, 10.5f}));
  EXPECT_EQ(std::get<std::vector<int>>(data.columns[1].values), (std::vector<int>{-7, -17}));
  EXPECT_EQ(std::get<std::vector<Vec3f>>(data.columns[2].values),
            (std::vector<Vec3f>{{4, 5, 6}, {14, 15, 16}}));
  EXPECT_EQ(data.columns[2].info.type, AttributeType::kVec3);
  EXPECT_EQ(std::get<std::vector<int>>(data.columns[3].values), (std::vector<int>{200, 200}));
  EXPECT_EQ(data.unused.size(), 9u);  // the names in the file
}

TEST_P(Ply, TakesAHeaderWithWindowsLines) {
  std::string text = samplePly(GetParam());
  const std::size_t end = text.find("end_header\n") + 11;
  std::string header;
  for (const char c : text.substr(0, end)) header += c == '\n' ? std::string("\r\n") : std::string(1, c);
  EXPECT_EQ(read(header + text.substr(end)).positions.size(), 2u);
}

TEST_P(Ply, RefusesAFileThatEndsTooEarlyOrTooLate) {
  const std::string text = samplePly(GetParam());
  const bool ascii = std::string_view(GetParam()) == "ascii";
  const std::size_t whole = text.size() - (ascii ? 1 : 0);  // the last line feed may be missing
  for (std::size_t size = 0; size < whole; ++size) {
    const Error error = refusal(text.substr(0, size));
    EXPECT_EQ(error.kind(), ErrorKind::kIo);
    ASSERT_NE(error.message(), "nothing was thrown") << size;
  }
  EXPECT_EQ(read(text + "\n").positions.size(), 2u);
  EXPECT_CONTAINS(refusal(text + "1").message(), "goes on behind what its header announces");
}

TEST_P(Ply, NamesTheRowThatIsWrong) {
  PlyMaker early(GetParam(), kPoints);
  early.add(1.0f).add(2.0f).add(3.0f).endRow().add(4.0f).add(5.0f);
  EXPECT_EQ(refusal(early.text()).message(),
            "the file ends too early, in row 1 of 2 of the element 'vertex'");

  PlyMaker infinite(GetParam(), kPoints);
  infinite.add(1.0f)
      .add(2.0f)
      .add(3.0f)
      .endRow()
      .add(4.0f)
      .add(std::numeric_limits<float>::infinity())
      .add(1.0f);
  const Error error = refusal(infinite.text());
  EXPECT_EQ(error.message(), "'y' is not finite, in row 1 of 2 of the element 'vertex'");
  EXPECT_EQ(error.location().line, std::string_view(GetParam()) == "ascii" ? 9 : 0);

  PlyMaker negative(GetParam(), std::string("element face 1\nproperty list char int i\n") + kPoints);
  negative.add(std::int8_t{-1});
  EXPECT_EQ(refusal(negative.text()).message(),
            "the list 'i' has no valid length, in row 0 of 1 of the element 'face'");
}

TEST_P(Ply, IsNotFooledByHugeClaims) {
  PlyMaker rows(
      GetParam(),
      "element vertex 18446744073709551615\nproperty float x\nproperty float y\nproperty float z\n");
  rows.add(1.0f).add(2.0f).add(3.0f);
  EXPECT_CONTAINS(refusal(rows.text()).message(), "the file ends too early, in row 1");
  PlyMaker list(GetParam(), std::string("element face 1\nproperty list uint double i\n") + kPoints);
  list.add(4294967295u).add(1.0);
  EXPECT_CONTAINS(refusal(list.text()).message(), "the list 'i' is longer than the file");
  PlyMaker nothing(GetParam(), std::string("element nothing 18446744073709551615\n") + kPoints);
  for (int i = 0; i < 6; ++i) nothing.add(1.0f);
  EXPECT_EQ(read(nothing.text()).positions.size(), 2u);
}

INSTANTIATE_TEST_SUITE_P(Encodings, Ply, testing::ValuesIn(kPlyFormats),
                         [](const auto& tested) { return std::string(tested.param); });

TEST(PlyErrors, SayWhereAndWhatIsWrong) {
  const TemporaryFolder folder;
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
  const std::string start = "ply\nformat ascii 1.0\n";
  struct Case {
    std::string text;
    int line;
    const char* message;
  };
  for (const auto& [text, line, message] : {
           Case{"", 1, "does not begin with 'ply'"},
           Case{"solid cube\n", 1, "does not begin with 'ply'"},
           Case{start + "comment\n", 4, "the file ends within its header"},
           Case{"ply\nformat ascii 2.0\n", 2, "the format is not known"},
           Case{"ply\nformat binary_middle_endian 1.0\n", 2, "the format is not known"},
           Case{start + "format ascii 1.0\n", 3, "a second line 'format'"},
           Case{"ply\nelement vertex 1\n" + xyz + "end_header\n1 2 3\n", 6, "no line 'format'"},
           Case{start + "elephant vertex 1\n", 3, "found 'elephant vertex 1'"},
           Case{start + "element vertex -1\n", 3, "no name and count"},
           Case{start + "element vertex 1.5\n", 3, "no name and count"},
           Case{start + "element vertex 99999999999999999999\n", 3, "no name and count"},
           Case{start + "element vertex\n", 3, "no name and count"},
           Case{start + "element vertex 1\nelement vertex 1\n", 4, "two elements 'vertex'"},
           Case{start + xyz, 3, "before the first element"},
           Case{start + "element vertex 1\nproperty half x\n", 4, "found the type 'half'"},
           Case{start + "element vertex 1\nproperty float\n", 4, "cannot be understood"},
           Case{start + "element f 1\nproperty list float int i\n", 4,
                "the length of the list 'i' is not an integer"},
           Case{start + "element point 1\n" + xyz + "end_header\n1 2 3\n", 0, "no element 'vertex'"},
           Case{start + "element vertex 0\n" + xyz + "end_header\n", 0, "'vertex' has no rows"},
           Case{start + "element vertex 1\nend_header\n", 0, "no column 'x'"},
           Case{start + "element vertex 1\nproperty float x\nproperty float y\nend_header\n1 2\n", 0,
                "no column 'z'"},
           Case{start + "element vertex 1\n" + xyz + "property float x\nend_header\n1 2 3 4\n", 0,
                "two columns 'x'"},
           Case{start + "element vertex 1\nproperty int x\nproperty float y\nproperty float z\nend_header\n1 "
                        "2 3\n",
                4, "'x' is of an integer type"},
           Case{start + "element vertex 1\nproperty list char float x\nproperty float y\nproperty float "
                        "z\nend_header\n",
                4, "'x' is a list"},
           Case{start + "element vertex 2\n" + xyz + "end_header\n1 2 3\n4 five 6\n", 9, "found 'five'"},
           Case{start + "element vertex 1\n" + xyz + "end_header\n1 2 1e999\n", 8, "'1e999' is too large"},
           Case{start + "element vertex 1\n" + xyz + "end_header\n1 2 1e39\n", 8, "'z' is not finite"},
           Case{start + "element vertex 1\n" + xyz + "end_header\n1 2 3 4\n", 8, "goes on behind"},
       }) {
    SCOPED_TRACE(text);
    const std::string file = folder.write("p.ply", text);
    const Error error = errorOf([&] { PlyReader().read(file); });
    EXPECT_EQ(error.kind(), ErrorKind::kIo);
    EXPECT_CONTAINS(error.message(), message);
    EXPECT_EQ(error.location().line, line);
    EXPECT_EQ(error.location().file, file);
  }
}

}  // namespace
}  // namespace weir::test
