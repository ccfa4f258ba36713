// A fluid in a test that meets rigid meshes.
#pragma once

#include "nodes/semi_analytical_sfi/semi_analytical_sfi.h"
#include "tests/support/fluid_scene.h"
#include "tests/support/given_mesh.h"

namespace weir::test {

class SolidScene : public FluidScene {
 public:
  using FluidScene::FluidScene;

  /// One more coupling of the fluid, with these solids, named solid0, solid1, …
  SemiAnalyticalSFI& couple(const std::vector<TriangleMesh>& meshes,
                            const Value& parameters = Value::object()) {
    const std::string name = "contact" + std::to_string(couplings_++);
    auto& node = static_cast<SemiAnalyticalSFI&>(graph().add(std::make_unique<SemiAnalyticalSFI>(), name));
    node.assignAll(parameters, {"test", "", ""});
    graph().link(SceneGraph::parseLink("water.fluid -> " + name + ".fluid"));
    for (const TriangleMesh& mesh : meshes) {
      const std::string solid = "solid" + std::to_string(solids_++);
      graph().add(std::make_unique<GivenMesh>(mesh), solid);
      graph().link(SceneGraph::parseLink(solid + ".surface -> " + name + ".solids"));
    }
    return node;
  }

 private:
  int couplings_ = 0, solids_ = 0;
};

inline constexpr double kGravity = 9.8, kWater = 1000;

/// A lattice that fills the box.
inline std::vector<Vec3f> block(float spacing, const Vec3f& lo, const Vec3f& hi) {
  std::vector<Vec3f> positions;
  for (float x = lo.x + 0.5f * spacing; x < hi.x; x += spacing)
    for (float y = lo.y + 0.5f * spacing; y < hi.y; y += spacing)
      for (float z = lo.z + 0.5f * spacing; z < hi.z; z += spacing) positions.push_back({x, y, z});
  return positions;
}

/// Water that settles in a tank, in steps of kSettlingDt. Forces are those of the pressure where the
/// iterations have converged, so the relative stiffness (c·dt/d)² is small, 2.8, and the iterations are many.
constexpr double kSettlingDt = 1.5e-3;
inline SolidScene settling(Device& device, float spacing, const std::vector<Vec3f>& positions) {
  return {device,
          positions,
          {},
          object({{"spacing", spacing}, {"bulk_modulus", 5e5}}),
          object({{"solver", object({{"params", object({{"iterations", 60}})}})},
                  {"viscosity", object({{"params", object({{"form", "explicit"}, {"strength", 0.5}})}})}})};
}

}  // namespace weir::test
