// A made-up run of particles for tests of the export: every number follows from step and particle.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "plugins/vtkhdf/vtkhdf_reader.h"
#include "plugins/vtkhdf/vtkhdf_writer.h"

namespace weir::test {

/// velocity, density, id, and one attribute of each other integer type; the field "particles".
inline VtkHdfLayout sampleLayout() {
  return {.attributes = {{"velocity", 3, VtkHdfType::kFloat32, "m/s"},
                         {"density", 1, VtkHdfType::kFloat32, "kg/m^3"},
                         {"id", 1, VtkHdfType::kInt32, ""},
                         {"birth", 1, VtkHdfType::kInt64, ""},
                         {"flags", 2, VtkHdfType::kUint32, ""}},
          .fields = {"particles"}};
}

/// The numbers of one step. read_with_vtk.py knows the same formulas.
struct SampleStep {
  SampleStep(int step, int count) : time(step / 30.0) {
    for (int i = 0; i < count; ++i) {
      const auto p = static_cast<float>(i);
      const auto s = static_cast<float>(step);
      positions.push_back({p, s, 0.5f * p});
      velocities.push_back({s, -p, 1});
      densities.push_back(1000 + p - s);
      ids.push_back(i + 10 * step);
      births.push_back((std::int64_t{1} << 40) + i);
      flags.push_back(4000000000u + static_cast<unsigned>(i));
      flags.push_back(static_cast<unsigned>(step));
    }
  }

  VtkHdfFrame frame() const {
    return {.time = time,
            .positions = positions,
            .attributes = {flat(velocities), std::span(densities), std::span(ids), std::span(births),
                           std::span(flags)},
            .fields = {static_cast<double>(positions.size())}};
  }

  double time;
  std::vector<Vec3f> positions, velocities;
  std::vector<float> densities;
  std::vector<std::int32_t> ids;
  std::vector<std::int64_t> births;
  std::vector<std::uint32_t> flags;
};

template <class T>
const std::vector<T>& valuesOf(const VtkHdfStep& step, const char* name) {
  return std::get<std::vector<T>>(step.find(name)->values);
}

inline void expectStep(const VtkHdfStep& found, int step, int count) {
  SCOPED_TRACE("step " + std::to_string(step));
  const SampleStep wanted(step, count);
  EXPECT_EQ(found.time, wanted.time);
  ASSERT_EQ(found.positions.size(), static_cast<std::size_t>(count));
  EXPECT_TRUE(found.positions == wanted.positions);
  EXPECT_TRUE(found.velocities() == wanted.velocities);
  EXPECT_TRUE(valuesOf<float>(found, "density") == wanted.densities);
  const std::vector<std::int64_t> ids(wanted.ids.begin(), wanted.ids.end());
  const std::vector<std::int64_t> flags(wanted.flags.begin(), wanted.flags.end());
  EXPECT_TRUE(valuesOf<std::int64_t>(found, "id") == ids);
  EXPECT_TRUE(valuesOf<std::int64_t>(found, "birth") == wanted.births);
  EXPECT_TRUE(valuesOf<std::int64_t>(found, "flags") == flags);
}

/// An empty folder for each test, removed with all that is in it.
class InFolder : public testing::Test {
 protected:
  InFolder() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    std::string name = "weir_" + std::string(test->test_suite_name()) + "_" + test->name();
    std::replace(name.begin(), name.end(), '/', '_');  // of a test with a parameter
    folder = std::filesystem::temp_directory_path() / (name + "_" + std::to_string(::getpid()));
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
  }
  ~InFolder() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder, ignored);
  }

  std::filesystem::path folder;
};

}  // namespace weir::test
