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

}  // namespace weir::test
