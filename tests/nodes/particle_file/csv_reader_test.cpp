// Tables as people and programs write them, and messages that lead to a mistake.
#include "nodes/particle_file/csv_reader.h"

#include <gtest/gtest.h>

#include "tests/support/child_process.h"
#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

using Names = std::vector<std::string>;

class Csv : public testing::Test {
 protected:
  ParticleData read(const std::string& text) const { return CsvReader().read(folder_.write("p.csv", text)); }
  Error refusal(const std::string& text) const {
    return errorOf([&] { read(text); });
  }

  TemporaryFolder folder_;
};

TEST_F(Csv, ReadsPositionsAndVelocitiesInAnyOrder) {
  const ParticleData data = read("vz,y,x,vx,z,vy\n6,2,1,4,3,5\n-6e-1,+2.5,1E2,.4,-0,5.\n");
  EXPECT_EQ(data.positions, (std::vector<Vec3f>{{1, 2, 3}, {100, 2.5f, 0}}));
  EXPECT_EQ(data.velocities, (std::vector<Vec3f>{{4, 5, 6}, {0.4f, 5, -0.6f}}));
  EXPECT_EQ(data.unused, Names{});
}

TEST_F(Csv, VelocitiesMayBeMissing) {
  const ParticleData data = read("x,y,z\n1,2,3\n");
  EXPECT_EQ(data.positions, (std::vector<Vec3f>{{1, 2, 3}}));
  EXPECT_EQ(data.velocities, (std::vector<Vec3f>{{0, 0, 0}}));
}

TEST_F(Csv, NumbersAreRoundedOnceToSinglePrecision) {
  // 16777217 lies between two floats; the third number is too small for a float.
  const ParticleData data = read("x,y,z\n0.1,16777217,1e-60\n");
  EXPECT_EQ(data.positions, (std::vector<Vec3f>{{0.1f, 16777216, 0}}));
}

TEST_F(Csv, TakesWindowsLinesBlanksCommentsQuotesAndAByteOrderMark) {
  const ParticleData data = read(
      "\xEF\xBB\xBF# made by hand\r\n\r\n  X , \"Y\",z\t\r\n# between\r\n 1 ,\"2\", 3\r\n\r\n   "
      "\r\n4,5,6\r\n  # end");
  EXPECT_EQ(data.positions, (std::vector<Vec3f>{{1, 2, 3}, {4, 5, 6}}));
}

TEST_F(Csv, NamesTheColumnsThatItDoesNotUse) {
  const ParticleData data = read("id,x,y,z,\"name, or \"\"label\"\"\"\nseven,1,2,3,\"a,b\"\n8,4,5,6,\n");
  EXPECT_EQ(data.positions, (std::vector<Vec3f>{{1, 2, 3}, {4, 5, 6}}));
  EXPECT_EQ(data.unused, (Names{"id", "name, or \"\"label\"\""}));
}

TEST_F(Csv, TheLastLineNeedsNoLineFeed) {
  EXPECT_EQ(read("x,y,z\n1,2,3\n4,5,6").positions.size(), 2u);
}

TEST_F(Csv, SaysWhereAndWhatIsWrong) {
  struct Case {
    const char* text;
    int line, column;
    const char* message;
  };
  for (const auto& [text, line, column, message] : {
           Case{"", 0, 0, "the file is empty"},
           Case{"\n# only a comment\n", 0, 0, "the file is empty"},
           Case{"x,y,z\n", 0, 0, "no particles"},
           Case{"x,y\n1,2\n", 1, 1, "no column 'z'"},
           Case{"\nx;y;z\n1;2;3\n", 2, 1, "no column 'x'; there are 'x;y;z'"},
           Case{"1,2,3\n", 1, 1, "no column 'x'"},
           Case{"x,y,z,vx,vy\n1,2,3,4,5\n", 1, 1, "no column 'vz'"},
           Case{"x,y,z,Y\n1,2,3,4\n", 1, 1, "two columns 'y'"},
           Case{"x,y,z\n1,2,3\n1,2\n", 3, 3, "the line ends after 2 fields"},
           Case{"x,y,z\r\n1,2,3,4\r\n", 2, 7, "more fields than the header has columns"},
           Case{"x,y,z\n1,2,3\n\n# two\n1, two,3\n", 5, 4, "y is 'two'"},
           Case{"x,y,z\n1,,3\n", 2, 3, "y is ''"},
           Case{"x,y,z\n1,2,3.0.0\n", 2, 5, "z is '3.0.0'"},
           Case{"x,y,z\n1,2 2,3\n", 2, 3, "y is '2 2'"},
           Case{"x,y,z\n1,2,0x10\n", 2, 5, "z is '0x10'"},
           Case{"x,y,z\n+-1,2,3\n", 2, 1, "x is '+-1'"},
           Case{"x,y,z\n1,nan,3\n", 2, 3, "y is 'nan'"},
           Case{"x,y,z\n1,2,-inf\n", 2, 5, "z is '-inf'"},
           Case{"x,y,z\n1,2,1e39\n", 2, 5, "z is '1e39'"},
           Case{"x,y,z\n1,2,1e999\n", 2, 5, "z is '1e999'"},
           Case{"x,y,z,vx,vy,vz\n1,2,3,4,5,oops\n", 2, 11, "vz is 'oops'"},
           Case{"x,y,z\n1,\"2,3\n", 2, 3, "a quoted field does not end"},
           Case{"x,y,z\n1,\"2\"2,3\n", 2, 3, "behind the quoted field"},
       }) {
    SCOPED_TRACE(text);
    const Error error = refusal(text);
    EXPECT_EQ(error.kind(), ErrorKind::kIo);
    EXPECT_CONTAINS(error.message(), message);
    EXPECT_EQ(error.location().line, line);
    EXPECT_EQ(error.location().column, column);
    EXPECT_EQ(error.location().file, folder_ / "p.csv");
  }
}

TEST_F(Csv, SaysWhyAFileCannotBeRead) {
  EXPECT_CONTAINS(errorOf([&] { CsvReader().read(folder_ / "none.csv"); }).what(), "No such file");
  EXPECT_CONTAINS(errorOf([&] { CsvReader().read(folder_.path()); }).what(), "it is a folder");
  EXPECT_CONTAINS(errorOf([&] { CsvReader().read("/dev/zero"); }).what(), "it is not a regular file");
}

}  // namespace
}  // namespace weir::test
