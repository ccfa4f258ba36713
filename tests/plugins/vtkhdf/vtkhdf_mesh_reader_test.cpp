// Surfaces that --export-surface wrote are read back, and files that hold something else are refused.
#include "plugins/vtkhdf/vtkhdf_mesh_reader.h"

#include <functional>

#include "framework/base/error.h"
#include "plugins/vtkhdf/vtkhdf_particle_reader.h"
#include "tests/plugins/vtkhdf/sample_run.h"

namespace weir::test {
namespace {

using VtkHdfMeshReaderTest = InFolder;

const VtkHdfLayout kSurface{.attributes = {}, .fields = {}, .triangles = true};

struct Surface {
  std::vector<Vec3f> vertices;
  std::vector<Vec3i> triangles;

  VtkHdfFrame frame(double time) const {
    return {.time = time, .positions = vertices, .attributes = {}, .fields = {}, .triangles = triangles};
  }
};

const Surface kTetrahedron{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                           {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
const Surface kTriangle{{{5, 0, 0}, {6, 0, 0.25f}, {5, 1, 0}}, {{0, 1, 2}}};

void write(const std::filesystem::path& file, const std::vector<Surface>& steps) {
  VtkHdfWriter writer(file, kSurface);
  double time = 0;
  for (const Surface& step : steps) writer.append(step.frame(time++));
  writer.close();
}

std::string refusal(const std::function<void()>& read) {
  try {
    read();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

TEST_F(VtkHdfMeshReaderTest, ReadsTheLastStepWhateverWasBefore) {
  for (const auto& steps :
       {std::vector{kTetrahedron}, std::vector{kTriangle, kTriangle, kTetrahedron, kTetrahedron},
        std::vector{kTriangle, Surface{}, kTetrahedron}}) {
    write(folder / "a.vtkhdf", steps);
    const TriangleMesh mesh = VtkHdfMeshReader().read(folder / "a.vtkhdf");
    EXPECT_EQ(mesh.vertices, kTetrahedron.vertices);
    EXPECT_EQ(mesh.triangles, kTetrahedron.triangles);
  }
}

TEST_F(VtkHdfMeshReaderTest, EveryStepHasItsOwnTriangles) {
  write(folder / "a.vtkhdf", {kTetrahedron, kTriangle, kTetrahedron});
  const VtkHdfReader reader(folder / "a.vtkhdf");
  EXPECT_EQ(reader.triangles(0), kTetrahedron.triangles);
  EXPECT_EQ(reader.triangles(1), kTriangle.triangles);
  EXPECT_EQ(reader.triangles(2), kTetrahedron.triangles);
  EXPECT_EQ(reader.polygonCount(1), 1);
}

TEST_F(VtkHdfMeshReaderTest, ParticlesAreNoSurfaceAndSurfacesAreNoParticles) {
  write(folder / "surface.vtkhdf", {kTetrahedron});
  const std::string particles = refusal([&] { VtkHdfParticleReader().read(folder / "surface.vtkhdf"); });
  EXPECT_NE(particles.find("surface of 4 polygons"), std::string::npos) << particles;
  EXPECT_NE(particles.find("MeshSampler"), std::string::npos) << particles;
  {
    VtkHdfWriter writer(folder / "particles.vtkhdf", sampleLayout());
    writer.append(SampleStep(0, 5).frame());
    writer.close();
  }
  const std::string surface = refusal([&] { VtkHdfMeshReader().read(folder / "particles.vtkhdf"); });
  EXPECT_NE(surface.find("no triangles"), std::string::npos) << surface;
  EXPECT_NE(surface.find("particles.vtkhdf"), std::string::npos) << surface;
}

}  // namespace
}  // namespace weir::test
