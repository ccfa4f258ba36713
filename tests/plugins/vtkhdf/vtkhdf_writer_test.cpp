// The export: what goes in comes out again, and what third-party readers rely on is in the file.
#include "plugins/vtkhdf/vtkhdf_writer.h"

#include <hdf5.h>

#include <cstdlib>
#include <fstream>

#include "framework/base/check.h"
#include "framework/base/error.h"
#include "tests/plugins/vtkhdf/sample_run.h"

namespace weir::test {
namespace {

using VtkHdfWriterTest = InFolder;

const std::vector<int> kCounts{5, 5, 0, 0, 40000, 40000, 70000, 40000, 3, 0, 1};

void writeSample(const std::filesystem::path& file, const std::vector<int>& counts) {
  VtkHdfWriter writer(file, sampleLayout());
  writer.setText("scene", "{ \"weir\": 1, \"title\": \"Übung\" }");
  for (std::size_t s = 0; s < counts.size(); ++s)
    writer.append(SampleStep(static_cast<int>(s), counts[s]).frame());
  writer.setText("statistics", "");
  writer.close();
}

TEST_F(VtkHdfWriterTest, GivesBackGrowingShrinkingAndEmptyFrames) {
  const auto file = folder / "run.vtkhdf";
  writeSample(file, kCounts);
  const VtkHdfReader reader(file);
  ASSERT_EQ(reader.times().size(), kCounts.size());
  for (std::size_t s = 0; s < kCounts.size(); ++s)
    expectStep(reader.read(s), static_cast<int>(s), kCounts[s]);
  expectStep(reader.readLast(), static_cast<int>(kCounts.size()) - 1, kCounts.back());
  EXPECT_EQ(reader.text("scene"), "{ \"weir\": 1, \"title\": \"Übung\" }");
  EXPECT_EQ(reader.text("statistics"), "");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1) << "no drafts are left behind";
}

TEST_F(VtkHdfWriterTest, DoesNotSayWhenItWasWritten) {
  // So two files of the same data are the same.
  const auto file = folder / "run.vtkhdf";
  writeSample(file, {3, 2});
  const hid_t id = H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const auto look = [](hid_t, const char* name, const auto* info, void* seen) {
    EXPECT_EQ(info->ctime, 0) << name;
    EXPECT_EQ(info->mtime, 0) << name;
    ++*static_cast<int*>(seen);
    return herr_t{0};
  };
  int seen = 0;
  H5Ovisit2(id, H5_INDEX_NAME, H5_ITER_INC, look, &seen, H5O_INFO_TIME);
  EXPECT_GT(seen, 20);
  H5Fclose(id);
}

/// Reads integers with HDF5's own interface, not with ours.
class RawFile {
 public:
  explicit RawFile(const std::filesystem::path& file)
      : file_(H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT)) {}
  ~RawFile() { H5Fclose(file_); }

  std::vector<std::int64_t> integers(const char* path) const {
    const hid_t set = H5Dopen2(file_, path, H5P_DEFAULT);
    const hid_t space = H5Dget_space(set);
    std::vector<std::int64_t> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
    H5Dread(set, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    H5Sclose(space);
    H5Dclose(set);
    return values;
  }

  std::vector<hsize_t> shape(const char* path) const {
    const hid_t set = H5Dopen2(file_, path, H5P_DEFAULT);
    const hid_t space = H5Dget_space(set);
    std::vector<hsize_t> size(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space)));
    H5Sget_simple_extent_dims(space, size.data(), nullptr);
    H5Sclose(space);
    H5Dclose(set);
    return size;
  }

  int filters(const char* path) const {
    const hid_t set = H5Dopen2(file_, path, H5P_DEFAULT);
    const hid_t properties = H5Dget_create_plist(set);
    const int count = H5Pget_nfilters(properties);
    H5Pclose(properties);
    H5Dclose(set);
    return count;
  }

  hid_t id() const { return file_; }

 private:
  hid_t file_;
};

TEST_F(VtkHdfWriterTest, LaysTheFileOutAsReadersExpect) {
  using Integers = std::vector<std::int64_t>;
  using Shape = std::vector<hsize_t>;
  const auto file = folder / "run.vtkhdf";
  writeSample(file, {2, 0, 3, 3});  // the last two share a part
  const RawFile raw(file);

  const hid_t root = H5Gopen2(raw.id(), "/VTKHDF", H5P_DEFAULT);
  std::int64_t version[2] = {};
  const hid_t versionId = H5Aopen(root, "Version", H5P_DEFAULT);
  H5Aread(versionId, H5T_NATIVE_INT64, version);
  EXPECT_EQ(version[0], 2);
  EXPECT_EQ(version[1], 0);
  const hid_t typeId = H5Aopen(root, "Type", H5P_DEFAULT);
  const hid_t type = H5Aget_type(typeId);
  EXPECT_EQ(H5Tget_size(type), 8u);
  EXPECT_EQ(H5Tget_cset(type), H5T_CSET_ASCII);
  EXPECT_EQ(H5Tget_strpad(type), H5T_STR_NULLPAD);
  EXPECT_EQ(H5Tis_variable_str(type), 0);
  char name[8] = {};
  H5Aread(typeId, type, name);
  EXPECT_EQ(std::string(name, 8), "PolyData");
  for (const hid_t id : {typeId, versionId}) H5Aclose(id);
  H5Tclose(type);
  H5Gclose(root);

  EXPECT_EQ(raw.shape("/VTKHDF/Points"), (Shape{8, 3}));
  EXPECT_EQ(raw.integers("/VTKHDF/NumberOfPoints"), (Integers{2, 0, 3}));
  EXPECT_EQ(raw.shape("/VTKHDF/PointData/velocity"), (Shape{8, 3}));
  EXPECT_EQ(raw.shape("/VTKHDF/PointData/density"), (Shape{8}));
  EXPECT_EQ(raw.integers("/VTKHDF/FieldData/particles"), (Integers{2, 0, 3, 3}));

  EXPECT_EQ(raw.integers("/VTKHDF/Vertices/NumberOfCells"), (Integers{2, 0, 3}));
  EXPECT_EQ(raw.integers("/VTKHDF/Vertices/NumberOfConnectivityIds"), (Integers{2, 0, 3}));
  EXPECT_EQ(raw.integers("/VTKHDF/Vertices/Connectivity"), (Integers{0, 1, 2}));
  EXPECT_EQ(raw.integers("/VTKHDF/Vertices/Offsets"), (Integers{0, 1, 2, 0, 0, 1, 2, 3}));
  for (const std::string none : {"Lines", "Polygons", "Strips"}) {
    const std::string group = "/VTKHDF/" + none;
    EXPECT_EQ(raw.integers((group + "/NumberOfCells").c_str()), (Integers{0, 0, 0}));
    EXPECT_EQ(raw.integers((group + "/NumberOfConnectivityIds").c_str()), (Integers{0, 0, 0}));
    EXPECT_EQ(raw.integers((group + "/Connectivity").c_str()), (Integers{}));
    EXPECT_EQ(raw.integers((group + "/Offsets").c_str()), (Integers{0, 0, 0}));
  }

  EXPECT_EQ(raw.shape("/VTKHDF/Steps/CellOffsets"), (Shape{4, 4}));
  EXPECT_EQ(raw.integers("/VTKHDF/Steps/CellOffsets"),
            (Integers{0, 0, 0, 0, 2, 0, 0, 0, 2, 0, 0, 0, 2, 0, 0, 0}));
  EXPECT_EQ(raw.shape("/VTKHDF/Steps/ConnectivityIdOffsets"), (Shape{4, 4}));
  EXPECT_EQ(raw.integers("/VTKHDF/Steps/ConnectivityIdOffsets"), Integers(16, 0));
  EXPECT_EQ(raw.integers("/VTKHDF/Steps/PartOffsets"), (Integers{0, 1, 2, 2}));
  EXPECT_EQ(raw.integers("/VTKHDF/Steps/NumberOfParts"), (Integers{1, 1, 1, 1}));
  EXPECT_EQ(raw.integers("/VTKHDF/Steps/PointOffsets"), (Integers{0, 2, 2, 5}));
  EXPECT_EQ(raw.integers("/VTKHDF/Steps/PointDataOffsets/id"), (Integers{0, 2, 2, 5}));
  EXPECT_EQ(raw.integers("/VTKHDF/Steps/FieldDataOffsets/particles"), (Integers{0, 1, 2, 3}));
  EXPECT_EQ(raw.integers("/VTKHDF/Steps/FieldDataSizes/particles"), (Integers{1, 1, 1, 1, 1, 1, 1, 1}));

  EXPECT_EQ(raw.filters("/VTKHDF/Points"), 0);
  EXPECT_EQ(raw.filters("/VTKHDF/PointData/velocity"), 0);
  EXPECT_EQ(raw.filters("/VTKHDF/PointData/id"), 0);
  // A compressed chunk moves when it grows: after a kill, steps from before could not be read.
  EXPECT_EQ(raw.filters("/VTKHDF/Vertices/Offsets"), 0);
  EXPECT_EQ(raw.filters("/VTKHDF/Vertices/Connectivity"), 0);
}

/// A fan of `count` triangles about point 0, moved by the step.
struct SampleFan {
  SampleFan(int step, int count) : time(step) {
    for (int i = 0; i < count + (count > 0 ? 2 : 0); ++i)
      vertices.push_back({static_cast<float>(i), static_cast<float>(step), 0});
    for (int i = 0; i < count; ++i) triangles.push_back({0, i + 1, i + 2});
  }
  VtkHdfFrame frame() const {
    return {.time = time,
            .positions = vertices,
            .attributes = {flat(vertices)},
            .fields = {static_cast<double>(triangles.size())},
            .triangles = triangles};
  }

  double time;
  std::vector<Vec3f> vertices;
  std::vector<Vec3i> triangles;
};

const VtkHdfLayout kFanLayout{
    .attributes = {{"Normals", 3, VtkHdfType::kFloat32, ""}}, .fields = {"triangles"}, .triangles = true};

TEST_F(VtkHdfWriterTest, TrianglesArePolygonsAndCanBeGoneOnWith) {
  using Integers = std::vector<std::int64_t>;
  const auto whole = folder / "whole.vtkhdf", resumed = folder / "resumed.vtkhdf";
  {
    VtkHdfWriter writer(whole, kFanLayout);
    for (const auto& [step, count] : {std::pair{0, 2}, {1, 0}, {2, 3}, {3, 1}})
      writer.append(SampleFan(step, count).frame());
  }
  {
    VtkHdfWriter writer(resumed, kFanLayout);
    for (const auto& [step, count] : {std::pair{0, 2}, {1, 0}, {2, 40}, {3, 20}})
      writer.append(SampleFan(step, count).frame());
  }
  {
    VtkHdfWriter writer(resumed, kFanLayout, 2);
    for (const auto& [step, count] : {std::pair{2, 3}, {3, 1}}) writer.append(SampleFan(step, count).frame());
  }
  for (const auto& file : {whole, resumed}) {
    const RawFile raw(file);
    EXPECT_EQ(raw.integers("/VTKHDF/NumberOfPoints"), (Integers{4, 0, 5, 3}));
    EXPECT_EQ(raw.integers("/VTKHDF/Polygons/NumberOfCells"), (Integers{2, 0, 3, 1}));
    EXPECT_EQ(raw.integers("/VTKHDF/Polygons/NumberOfConnectivityIds"), (Integers{6, 0, 9, 3}));
    EXPECT_EQ(raw.integers("/VTKHDF/Polygons/Connectivity"),
              (Integers{0, 1, 2, 0, 2, 3, 0, 1, 2, 0, 2, 3, 0, 3, 4, 0, 1, 2}));
    EXPECT_EQ(raw.integers("/VTKHDF/Polygons/Offsets"), (Integers{0, 3, 6, 0, 0, 3, 6, 9, 0, 3}));
    EXPECT_EQ(raw.integers("/VTKHDF/Vertices/NumberOfCells"), (Integers{0, 0, 0, 0}));
    EXPECT_EQ(raw.integers("/VTKHDF/Vertices/Offsets"), (Integers{0, 0, 0, 0}));
    EXPECT_EQ(raw.integers("/VTKHDF/Steps/PointOffsets"), (Integers{0, 4, 4, 9}));
    EXPECT_EQ(raw.integers("/VTKHDF/Steps/CellOffsets"),
              (Integers{0, 0, 0, 0, 0, 0, 2, 0, 0, 0, 2, 0, 0, 0, 5, 0}));
    EXPECT_EQ(raw.integers("/VTKHDF/Steps/ConnectivityIdOffsets"),
              (Integers{0, 0, 0, 0, 0, 0, 6, 0, 0, 0, 6, 0, 0, 0, 15, 0}));
  }
}

TEST(VtkHdfSampleTest, WritesTheFileThatVtkReads) {
  const char* file = std::getenv("WEIR_VTKHDF_SAMPLE");
  if (!file) GTEST_SKIP() << "read_with_vtk.py says where to";
  writeSample(file, kCounts);
  EXPECT_TRUE(std::filesystem::exists(file));
}

// Cut behind any step and gone on with, also in the middle of steps that share a part.
TEST_F(VtkHdfWriterTest, GoesOnBehindAnyStep) {
  const std::vector<int> counts{5, 5, 0, 7, 7, 7, 2};
  for (std::size_t kept = 0; kept <= counts.size(); ++kept) {
    SCOPED_TRACE("kept " + std::to_string(kept));
    const auto file = folder / "run.vtkhdf";
    writeSample(file, counts);
    {
      VtkHdfWriter writer(file, sampleLayout(), static_cast<std::int64_t>(kept));
      for (std::size_t s = kept; s < counts.size(); ++s)
        writer.append(SampleStep(static_cast<int>(s), counts[s]).frame());
      writer.close();
    }
    {
      const VtkHdfReader reader(file);
      ASSERT_EQ(reader.times().size(), counts.size());
      for (std::size_t s = 0; s < counts.size(); ++s)
        expectStep(reader.read(s), static_cast<int>(s), counts[s]);
    }
    const RawFile raw(file);
    EXPECT_EQ(raw.integers("/VTKHDF/NumberOfPoints"), (std::vector<std::int64_t>{5, 0, 7, 2}));
    EXPECT_EQ(raw.integers("/VTKHDF/Steps/PartOffsets"), (std::vector<std::int64_t>{0, 0, 1, 2, 2, 2, 3}));
    EXPECT_EQ(raw.integers("/VTKHDF/Vertices/Connectivity").size(), 7u);
  }
}

TEST_F(VtkHdfWriterTest, CanBeReadWhileItGrows) {
  const auto file = folder / "run.vtkhdf";
  VtkHdfWriter writer(file, sampleLayout());
  EXPECT_TRUE(VtkHdfReader(file).times().empty());
  EXPECT_THROW(VtkHdfReader(file).readLast(), Error);
  for (int s = 0; s < 3; ++s) {
    writer.append(SampleStep(s, 10 + s).frame());
    EXPECT_EQ(writer.framesWritten(), s + 1);
    expectStep(VtkHdfReader(file).readLast(), s, 10 + s);
  }
}

TEST_F(VtkHdfWriterTest, ClosesTwiceAndInTheDestructor) {
  {
    VtkHdfWriter writer(folder / "a.vtkhdf", sampleLayout());
    writer.append(SampleStep(0, 3).frame());
    writer.close();
    writer.close();
    VtkHdfWriter other(folder / "b.vtkhdf", sampleLayout());
    other.append(SampleStep(0, 4).frame());
  }
  expectStep(VtkHdfReader(folder / "a.vtkhdf").readLast(), 0, 3);
  expectStep(VtkHdfReader(folder / "b.vtkhdf").readLast(), 0, 4);
}

TEST_F(VtkHdfWriterTest, ReplacesAnExistingFileAndFollowsLinks) {
  const auto file = folder / "run.vtkhdf", link = folder / "link.vtkhdf";
  writeSample(file, {1, 2});
  std::filesystem::create_symlink(file, link);
  writeSample(link, {7});
  EXPECT_TRUE(std::filesystem::is_symlink(link));
  EXPECT_EQ(VtkHdfReader(file).times().size(), 1u);
  expectStep(VtkHdfReader(file).readLast(), 0, 7);
}

TEST_F(VtkHdfWriterTest, ChecksWhatTheCallerHands) {
  VtkHdfWriter writer(folder / "run.vtkhdf", sampleLayout());
  const SampleStep step(3, 4);
  VtkHdfFrame frame = step.frame();
  frame.attributes.pop_back();
  EXPECT_THROW(writer.append(frame), InternalError);
  frame = step.frame();
  frame.attributes[1] = std::span(step.ids);
  EXPECT_THROW(writer.append(frame), InternalError);
  frame = step.frame();
  frame.positions = frame.positions.subspan(1);
  EXPECT_THROW(writer.append(frame), InternalError);
  writer.append(step.frame());
  EXPECT_THROW(writer.append(step.frame()), InternalError) << "time does not rise";
  writer.close();
  EXPECT_THROW(writer.append(SampleStep(4, 1).frame()), InternalError);
}

/// The message of the io Error that creating this file ends with.
std::string refusal(const std::filesystem::path& file) {
  try {
    VtkHdfWriter writer(file, sampleLayout());
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kIo);
    EXPECT_EQ(error.location().file, file.string());
    return error.message();
  }
  return "(no error)";
}

TEST_F(VtkHdfWriterTest, TakesARelativeNameAndAnEndingInCapitals) {
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(folder);
  writeSample("run.VTKHDF", {3});
  std::filesystem::current_path(before);
  expectStep(VtkHdfReader(folder / "run.VTKHDF").readLast(), 0, 3);
}

TEST_F(VtkHdfWriterTest, RefusesPathsThatCannotBeAFile) {
  using testing::internal::GetCapturedStderr;
  testing::internal::CaptureStderr();
  EXPECT_EQ(refusal(folder / "run.mp4"), "the export would be a file of type '.mp4'");
  std::filesystem::create_directory(folder / "dir.vtkhdf");
  EXPECT_EQ(refusal(folder / "dir.vtkhdf"), "the export would replace a folder");
  EXPECT_NE(refusal(folder / "missing" / "run.vtkhdf").find("there is no folder"), std::string::npos);
  std::ofstream(folder / "plain") << "x";
  EXPECT_NE(refusal(folder / "plain" / "run.vtkhdf").find("folder"), std::string::npos);
  std::filesystem::create_symlink("/dev/full", folder / "full.vtkhdf");
  EXPECT_EQ(refusal(folder / "full.vtkhdf"), "the export would replace something that is not a file");
  EXPECT_EQ(refusal("/proc/run.vtkhdf"), "cannot create the file: No such file or directory");
  EXPECT_EQ(GetCapturedStderr(), "") << "HDF5 prints nothing itself";
}

TEST_F(VtkHdfWriterTest, LeavesAnExistingFileWhereTheNewOneCannotBeMade) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  const auto file = folder / "run.vtkhdf";
  writeSample(file, {3});
  std::filesystem::permissions(folder,
                               std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  EXPECT_EQ(refusal(file), "cannot create the file: Permission denied");
  std::filesystem::permissions(folder, std::filesystem::perms::owner_all);
  expectStep(VtkHdfReader(file).readLast(), 0, 3);
  std::filesystem::permissions(file, std::filesystem::perms::owner_read);
  EXPECT_EQ(refusal(file), "the file exists and may not be written");
}

}  // namespace
}  // namespace weir::test
