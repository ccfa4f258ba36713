// An emitter above a fluid whose modules are switched off but for the prediction, so that what is emitted
// stays as it left.
#pragma once

#include <memory>
#include <vector>

#include "nodes/emitters/emitter.h"
#include "tests/support/devices.h"
#include "tests/support/fluid_scene.h"
#include "tests/support/given_mesh.h"

namespace weir::test {

template <class E>
class Jet {
 public:
  Jet(Device& device, float spacing, const Value& parameters, const char* calibration = "lattice")
      : scene_(
            device, {}, {}, object({{"spacing", spacing}, {"calibration", calibration}}),
            object({{"solver", object({{"enabled", false}})}, {"viscosity", object({{"enabled", false}})}})) {
    emitter_ = static_cast<E*>(&scene_.graph().add(std::make_unique<E>(), "nozzle"));
    emitter_->assignAll(parameters, {"test", "", ""});
    scene_.graph().link(SceneGraph::parseLink("nozzle.particles -> water.emitters"));
    scene_.gravity = {};
  }
  /// Of a MeshEmitter.
  void emitFrom(TriangleMesh mesh) {
    scene_.graph().add(std::make_unique<GivenMesh>(std::move(mesh)), "mesh");
    scene_.graph().link(SceneGraph::parseLink("mesh.surface -> nozzle.surface"));
  }
  std::vector<Vec3f> after(double dt, int steps) {
    scene_.reset(dt);
    scene_.step(steps);
    return scene_.positions();
  }
  FluidScene& scene() { return scene_; }
  NodeReport report() {
    NodeReport report;
    emitter_->report(report);
    return report;
  }

 private:
  FluidScene scene_;
  E* emitter_;
};

/// The smallest distance of any two, by comparing all.
inline double minDistance(const std::vector<Vec3f>& points) {
  double min = 1e30;
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) min = std::min(min, double(length(points[i] - points[j])));
  return min;
}

}  // namespace weir::test
