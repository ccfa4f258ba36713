#include "nodes/sink/sink.h"

#include <fmt/format.h>

#include <algorithm>

#include "framework/graph/memory_estimate.h"

namespace weir {

void Sink::validate() const {
  if (min.get().has_value() != max.get().has_value()) {
    const auto& missing = min.get() ? max : min;
    throw sceneError("the box has " + (min.get() ? min : max).name() + " but no " + missing.name(),
                     "both corners, or neither for a sink of meshes alone");
  }
  if (!min.get()) return;
  const Vec3f extent = *max.get() - *min.get();
  if (!(extent.x > 0 && extent.y > 0 && extent.z > 0))
    throw sceneError("the box has no volume, as min is not below max along every axis", "min below max");
}

float Sink::finestSpacing() const {
  float spacing = 0;
  for (const SinkRegion::Request& request : sink.requests())
    spacing = spacing == 0 ? request.spacing : std::min(spacing, request.spacing);
  return spacing;
}

void Sink::estimate(const SetupContext&, MemoryNeeds& needs) {
  const float spacing = finestSpacing();
  for (std::size_t i = 0; i < meshes.size() && spacing > 0; ++i)
    needs.add(MeshSdf::maxMemory(meshes[i], cellFor(spacing), cellFor(spacing)));
}

void Sink::reset(const SetupContext& context) {
  if (!min.get() && meshes.empty())
    throw sceneError("the sink is empty: it has no box, and no mesh is linked to it",
                     "min and max, or a link to '" + meshes.path() + "'");
  *sink = {};
  removed_ = Array<int>(context.device, 1);
  removed_->fillZero();
  removedBefore_ = 0;
  if (min.get()) sink->pieces.push_back({.box = {*min.get(), *max.get()}, .removed = removed_->data()});
  const float spacing = finestSpacing();
  for (std::size_t i = 0; i < meshes.size() && spacing > 0; ++i) addMesh(context, i, spacing);
}

void Sink::addMesh(const SetupContext& context, std::size_t link, float spacing) {
  const std::string from = "the mesh from '" + meshes.links()[link]->path() + "'";
  const float cell = cellFor(spacing);
  std::vector<std::string> warnings;
  auto sdf = std::make_shared<const MeshSdf>(context.device, meshes[link], cell, cell, warnings);
  for (const std::string& warning : warnings)
    context.log.warn(fmt::format("node '{}': {}: {}", name(), from, warning));
  sink->pieces.push_back(
      {.box = meshes[link].bounds(), .isMesh = true, .mesh = sdf->view(false), .removed = removed_->data()});
  sink->meshes.push_back(std::move(sdf));
}

void Sink::report(NodeReport& report) {
  if (!removed_->empty())
    report.statistics["particles_removed"] = removedBefore_ + removed_->toHost().front();
}

}  // namespace weir
