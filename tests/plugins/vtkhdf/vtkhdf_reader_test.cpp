// Files of other programs, and files that are not such a thing. They are made with HDF5's own interface.
#include "plugins/vtkhdf/vtkhdf_reader.h"

#include <hdf5.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <limits>

#include "framework/base/error.h"
#include "tests/plugins/vtkhdf/sample_run.h"

namespace weir::test {
namespace {

using VtkHdfReaderTest = InFolder;

/// Writes what a test asks for, well-formed or not.
class Maker {
 public:
  explicit Maker(const std::filesystem::path& file)
      : file_(H5Fcreate(file.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT)) {}
  ~Maker() { H5Fclose(file_); }

  void group(const std::string& path) { H5Gclose(H5Gcreate2(file_, path.c_str(), 0, 0, 0)); }

  void type(const std::string& name) {
    const hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, H5T_VARIABLE);
    const char* text = name.c_str();
    attribute("Type", type, &text);
    H5Tclose(type);
  }

  void attribute(const char* name, hid_t type, const void* value, const char* at = "/VTKHDF") {
    const hid_t object = H5Oopen(file_, at, H5P_DEFAULT), space = H5Screate(H5S_SCALAR);
    const hid_t id = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(id, type, value);
    H5Aclose(id);
    H5Sclose(space);
    H5Oclose(object);
  }

  template <class T>
  void set(const std::string& path, const std::vector<T>& values, std::vector<hsize_t> shape = {}) {
    if (shape.empty()) shape = {values.size()};
    const hid_t type = std::is_same_v<T, float>    ? H5T_NATIVE_FLOAT
                       : std::is_same_v<T, double> ? H5T_NATIVE_DOUBLE
                                                   : H5T_NATIVE_INT64;
    const hid_t space = H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr);
    const hid_t id = H5Dcreate2(file_, path.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    H5Dwrite(id, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    H5Dclose(id);
    H5Sclose(space);
  }

  /// Points that are claimed but not stored.
  void claimPoints(hsize_t count) { claim("/VTKHDF/Points", H5T_NATIVE_FLOAT, {count, 3}); }

  /// Numbers that are claimed but not stored.
  void claim(const std::string& path, hid_t type, const std::vector<hsize_t>& shape) {
    const std::vector<hsize_t> chunk{1024, 3};
    const int rank = static_cast<int>(shape.size());
    const hid_t properties = H5Pcreate(H5P_DATASET_CREATE),
                space = H5Screate_simple(rank, shape.data(), nullptr);
    H5Pset_chunk(properties, rank, chunk.data());
    H5Dclose(H5Dcreate2(file_, path.c_str(), type, space, H5P_DEFAULT, properties, H5P_DEFAULT));
    H5Sclose(space);
    H5Pclose(properties);
  }

 private:
  hid_t file_;
};

using Integers = std::vector<std::int64_t>;

TEST_F(VtkHdfReaderTest, ReadsAnUnstructuredGridOfDoublesInTwoParts) {
  const auto file = folder / "grid.hdf";
  {
    Maker maker(file);
    maker.group("/VTKHDF");
    maker.type("UnstructuredGrid");
    maker.set<double>("/VTKHDF/Points", {1, 2, 3, 4, 5, 6, 7, 8, 9.5}, {3, 3});
    maker.set<std::int64_t>("/VTKHDF/NumberOfPoints", {1, 2});
    maker.group("/VTKHDF/PointData");
    maker.set<double>("/VTKHDF/PointData/Velocity", {0, 0, 1, 0, 2, 0, 3, 0, 0}, {3, 3});
    maker.set<std::int64_t>("/VTKHDF/PointData/GlobalIds", {std::int64_t{1} << 60, 5, -6});
  }
  const VtkHdfReader reader(file);
  EXPECT_EQ(reader.times(), std::vector<double>{0});
  const VtkHdfStep step = reader.readLast();
  EXPECT_EQ(step.positions, (std::vector<Vec3f>{{1, 2, 3}, {4, 5, 6}, {7, 8, 9.5}}));
  EXPECT_EQ(step.velocities(), (std::vector<Vec3f>{{0, 0, 1}, {0, 2, 0}, {3, 0, 0}}));
  EXPECT_EQ(valuesOf<std::int64_t>(step, "GLOBALIDS"), (Integers{std::int64_t{1} << 60, 5, -6}));
  EXPECT_EQ(step.find("density"), nullptr);
}

void temporal(Maker& maker, std::int64_t steps = 4) {
  maker.group("/VTKHDF");
  maker.type("PolyData");
  maker.set<float>("/VTKHDF/Points", {0, 0, 0, 1, 1, 1, 2, 2, 2}, {3, 3});
  maker.set<std::int64_t>("/VTKHDF/NumberOfPoints", {1, 2});
  maker.group("/VTKHDF/PointData");
  maker.set<float>("/VTKHDF/PointData/mass", {1, 2, 3});
  maker.group("/VTKHDF/Steps");
  maker.set<double>("/VTKHDF/Steps/Values", {0.5, 1, 2, 4});
  maker.attribute("NSteps", H5T_NATIVE_INT64, &steps, "/VTKHDF/Steps");
  maker.set<std::int64_t>("/VTKHDF/Steps/PartOffsets", {0, 0, 1, 0});
  maker.set<std::int64_t>("/VTKHDF/Steps/NumberOfParts", {1, 1, 1, 2});
  maker.set<std::int64_t>("/VTKHDF/Steps/PointOffsets", {0, 0, 1, 0});
}

TEST_F(VtkHdfReaderTest, LeavesOutAStepThatAKilledRunGaveNoTime) {
  const auto file = folder / "killed.vtkhdf";
  {
    Maker maker(file);
    temporal(maker, 5);
  }
  EXPECT_EQ(VtkHdfReader(file).times(), (std::vector<double>{0.5, 1, 2, 4}));
}

TEST_F(VtkHdfReaderTest, ReadsStepsThatShareData) {
  const auto file = folder / "steps.vtkhdf";
  {
    Maker maker(file);
    temporal(maker);
  }
  const VtkHdfReader reader(file);
  EXPECT_EQ(reader.times(), (std::vector<double>{0.5, 1, 2, 4}));
  EXPECT_EQ(reader.read(1).positions, (std::vector<Vec3f>{{0, 0, 0}}));
  EXPECT_EQ(reader.read(2).positions, (std::vector<Vec3f>{{1, 1, 1}, {2, 2, 2}}));
  EXPECT_EQ(valuesOf<float>(reader.read(2), "mass"), (std::vector<float>{2, 3}));
  EXPECT_EQ(reader.readLast().positions.size(), 3u);
  EXPECT_EQ(reader.nearestStep(-7), 0u);
  EXPECT_EQ(reader.nearestStep(1.4), 1u);
  EXPECT_EQ(reader.nearestStep(1.5), 1u);
  EXPECT_EQ(reader.nearestStep(1.6), 2u);
  EXPECT_EQ(reader.nearestStep(1e9), 3u);
}

/// Two parts of one and of two polygons, without time steps.
void polygons(Maker& maker, const Integers& idCounts, const Integers& corners, const Integers& offsets,
              const Integers& counts = {1, 2}) {
  maker.group("/VTKHDF");
  maker.type("PolyData");
  maker.set<float>("/VTKHDF/Points", std::vector<float>(21, 0.5f), {7, 3});
  maker.set<std::int64_t>("/VTKHDF/NumberOfPoints", {3, 4});
  maker.group("/VTKHDF/Polygons");
  maker.set<std::int64_t>("/VTKHDF/Polygons/NumberOfCells", counts);
  maker.set<std::int64_t>("/VTKHDF/Polygons/NumberOfConnectivityIds", idCounts);
  maker.set<std::int64_t>("/VTKHDF/Polygons/Connectivity", corners);
  maker.set<std::int64_t>("/VTKHDF/Polygons/Offsets", offsets);
}

TEST_F(VtkHdfReaderTest, TrianglesOfSeveralPartsNameThePointsOfAll) {
  {
    Maker maker(folder / "parts.vtkhdf");
    polygons(maker, {3, 6}, {0, 1, 2, 0, 1, 2, 0, 2, 3}, {0, 3, 0, 3, 6});
  }
  EXPECT_EQ(VtkHdfReader(folder / "parts.vtkhdf").triangles(0),
            (std::vector<Vec3i>{{0, 1, 2}, {3, 4, 5}, {3, 5, 6}}));
}

TEST_F(VtkHdfReaderTest, PolygonsThatAreNoTrianglesOrNameNoPointAreRefused) {
  {
    Maker maker(folder / "mixed.vtkhdf");  // as many corners as two triangles have
    polygons(maker, {3, 6}, {0, 1, 2, 0, 1, 2, 3, 0, 1}, {0, 3, 0, 4, 6});
  }
  EXPECT_THROW(VtkHdfReader(folder / "mixed.vtkhdf").triangles(0), Error);
  {
    Maker maker(folder / "beyond.vtkhdf");  // the first part has points 0 to 2
    polygons(maker, {3, 6}, {0, 1, 3, 0, 1, 2, 0, 2, 3}, {0, 3, 0, 3, 6});
  }
  EXPECT_THROW(VtkHdfReader(folder / "beyond.vtkhdf").triangles(0), Error);
}

TEST_F(VtkHdfReaderTest, NumbersOfPolygonsThatCannotBeAreRefused) {
  constexpr std::int64_t kLargest = std::numeric_limits<std::int64_t>::max();
  for (const Integers& counts : {Integers{1, kLargest}, Integers{kLargest, 2}, Integers{-1, 2},
                                 Integers{std::numeric_limits<std::int32_t>::max(), 2}}) {
    {
      Maker maker(folder / "counts.vtkhdf");
      polygons(maker, {3, 6}, {0, 1, 2, 0, 1, 2, 0, 2, 3}, {0, 3, 0, 3, 6}, counts);
    }
    const VtkHdfReader reader(folder / "counts.vtkhdf");
    EXPECT_THROW(static_cast<void>(reader.polygonCount(0)), Error);
    EXPECT_THROW(reader.triangles(0), Error);
  }
}

/// The message that reading the last step of a file ends with.
std::string refusal(const std::filesystem::path& file) {
  try {
    VtkHdfReader(file).readLast().velocities();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kIo);
    return error.message();
  }
  return "(no error)";
}

TEST_F(VtkHdfReaderTest, RefusesWhatIsNoVtkHdf) {
  testing::internal::CaptureStderr();
  EXPECT_EQ(refusal(folder / "missing.vtkhdf"), "there is no such file");
  EXPECT_EQ(refusal(folder), "this is a folder or a device, not a file");
  const auto text = folder / "text.vtkhdf";
  std::ofstream(text) << "x,y,z\n1,2,3\n";
  EXPECT_EQ(refusal(text), "this is not an HDF5 file, or one without its beginning");
  std::ofstream(text, std::ios::trunc);
  EXPECT_NE(refusal(text), "(no error)");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST_F(VtkHdfReaderTest, SaysWhatIsWrongWithAFile) {
  struct Case {
    std::function<void(Maker&)> make;
    std::string message;
  };
  const auto points = [](Maker& m) { m.set<float>("/VTKHDF/Points", {1, 2, 3, 4, 5, 6}, {2, 3}); };
  const auto start = [](Maker& m) {
    m.group("/VTKHDF");
    m.type("PolyData");
  };
  const std::vector<Case> cases{
      {[](Maker& m) { m.group("/data"); }, "this HDF5 file holds no VTKHDF"},
      {[](Maker& m) { m.group("/VTKHDF"); }, "/VTKHDF has no attribute Type"},
      {[](Maker& m) {
         m.group("/VTKHDF");
         m.type("ImageData");
       },
       "/VTKHDF is of type 'ImageData'"},
      {[&](Maker& m) {
         start(m);
         const std::int64_t version = 3;
         m.attribute("Version", H5T_NATIVE_INT64, &version);
       },
       "/VTKHDF has version 3"},
      {start, "/VTKHDF holds no data set 'NumberOfPoints'"},
      {[&](Maker& m) {
         start(m);
         m.set<std::int64_t>("/VTKHDF/NumberOfPoints", {2});
       },
       "/VTKHDF holds no data set 'Points'"},
      {[&](Maker& m) {
         start(m);
         points(m);
         m.set<float>("/VTKHDF/NumberOfPoints", {2});
       },
       "/VTKHDF/NumberOfPoints holds no integers"},
      {[&](Maker& m) {
         start(m);
         points(m);
         m.set<std::int64_t>("/VTKHDF/NumberOfPoints", {-2});
       },
       "/VTKHDF claims -2 points in part 0"},
      {[&](Maker& m) {
         start(m);
         points(m);
         m.set<std::int64_t>("/VTKHDF/NumberOfPoints", {3});
       },
       "/VTKHDF/Points has 2 rows, but the file asks for 3 from row 0 on"},
      {[&](Maker& m) {
         start(m);
         m.claimPoints(1'000'000'000);
         m.set<std::int64_t>("/VTKHDF/NumberOfPoints", {1'000'000'000});
       },
       "/VTKHDF/Points claims 1000000000 points, more than fit into the file"},
      {[&](Maker& m) {
         start(m);
         points(m);
         m.claim("/VTKHDF/NumberOfPoints", H5T_NATIVE_INT64, {1'000'000'000});
       },
       "/VTKHDF/NumberOfPoints claims 1000000000 numbers, more than fit into the file"},
      {[&](Maker& m) {
         start(m);
         m.set<std::int64_t>("/VTKHDF/NumberOfPoints", {Integers::value_type{1} << 62});
       },
       "/VTKHDF claims 4611686018427387904 points in part 0"},
      {[&](Maker& m) {
         start(m);
         m.set<float>("/VTKHDF/Points", {1, 2, 3, 4}, {2, 2});
         m.set<std::int64_t>("/VTKHDF/NumberOfPoints", {2});
       },
       "/VTKHDF/Points has 2 columns"},
      {[&](Maker& m) {
         start(m);
         m.set<float>("/VTKHDF/Points", {1, 2, 3}, {1, 3, 1});
         m.set<std::int64_t>("/VTKHDF/NumberOfPoints", {1});
       },
       "/VTKHDF/Points has 3 dimensions"},
      {[&](Maker& m) {
         start(m);
         m.set<float>("/VTKHDF/Points", {1, 2, 3, 4, NAN, 6}, {2, 3});
         m.set<std::int64_t>("/VTKHDF/NumberOfPoints", {2});
       },
       "/VTKHDF/Points holds a position that is not finite, point 1 of step 0"},
      {[&](Maker& m) {
         start(m);
         m.set<double>("/VTKHDF/Points", {1, 2, 1e300}, {1, 3});
         m.set<std::int64_t>("/VTKHDF/NumberOfPoints", {1});
       },
       "/VTKHDF/Points holds a position that is not finite, point 0 of step 0"},
      {[&](Maker& m) {
         start(m);
         points(m);
         m.set<std::int64_t>("/VTKHDF/NumberOfPoints", {2});
         m.group("/VTKHDF/PointData");
         m.set<float>("/VTKHDF/PointData/velocity", {1, 2});
       },
       "the array 'velocity' has 1 floating-point numbers a point"},
      {[&](Maker& m) {
         start(m);
         points(m);
         m.set<std::int64_t>("/VTKHDF/NumberOfPoints", {2});
         m.group("/VTKHDF/PointData");
         m.set<float>("/VTKHDF/PointData/density", {1});
       },
       "/VTKHDF/PointData/density has 1 rows, but the file asks for 2 from row 0 on"},
      {[&](Maker& m) {
         start(m);
         m.group("/VTKHDF/Steps");
         const std::int64_t steps = 9;
         m.attribute("NSteps", H5T_NATIVE_INT64, &steps, "/VTKHDF/Steps");
         m.set<double>("/VTKHDF/Steps/Values", {0, 1});
       },
       "/VTKHDF/Steps has 9 steps, but times for 2"},
      {[&](Maker& m) {
         start(m);
         m.group("/VTKHDF/Steps");
         m.set<double>("/VTKHDF/Steps/Values", {0, NAN});
       },
       "/VTKHDF/Steps/Values has no finite time for step 1"},
      {[&](Maker& m) {
         start(m);
         m.group("/VTKHDF/Steps");
         m.set<double>("/VTKHDF/Steps/Values", {0, 1});
         m.set<std::int64_t>("/VTKHDF/Steps/PartOffsets", {0, 7});
         points(m);
         m.set<std::int64_t>("/VTKHDF/NumberOfPoints", {2});
       },
       "/VTKHDF lists 1 parts, but step 1 asks for 1 from part 7 on"},
      {[&](Maker& m) {
         start(m);
         m.group("/VTKHDF/Steps");
         m.set<double>("/VTKHDF/Steps/Values", {0, 1});
         m.set<std::int64_t>("/VTKHDF/Steps/NumberOfParts", {}, {2, 0});
         points(m);
         m.set<std::int64_t>("/VTKHDF/NumberOfPoints", {2});
       },
       "/VTKHDF/Steps/NumberOfParts holds no column of integers"},
  };
  for (const Case& bad : cases) {
    const auto file = folder / "bad.vtkhdf";
    {
      Maker maker(file);
      bad.make(maker);
    }
    EXPECT_EQ(refusal(file), bad.message);
  }
}

TEST_F(VtkHdfReaderTest, RefusesATruncatedFileWhereverItEnds) {
  const auto file = folder / "run.vtkhdf", cut = folder / "cut.vtkhdf";
  {
    VtkHdfWriter writer(file, sampleLayout());
    for (int s = 0; s < 3; ++s) writer.append(SampleStep(s, 20).frame());
  }
  const auto size = std::filesystem::file_size(file);
  constexpr int kCuts = 50;
  for (int i = 0; i < kCuts; ++i) {
    std::filesystem::copy_file(file, cut, std::filesystem::copy_options::overwrite_existing);
    std::filesystem::resize_file(cut, size * static_cast<std::uintmax_t>(i) / kCuts);
    EXPECT_NE(refusal(cut), "(no error)") << "cut after " << i << "/" << kCuts;
  }
}

}  // namespace
}  // namespace weir::test
