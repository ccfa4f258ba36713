#include "nodes/particle_fluid/inflow.h"

#include <algorithm>
#include <string>

#include "framework/compute/dispatch.h"
#include "framework/compute/parallel.h"

namespace weir {

namespace {

constexpr int kKept = 2;  // batches of a node; each has a layer at least

}  // namespace

void Inflow::add(const ParticleBatch& born, int source, const FlowsIn::Flow& flow, double time,
                 const ParticleSet& particles) {
  WEIR_CHECK(born.velocities.size() >= born.count);
  const auto isOfSource = [source](const Batch& batch) { return batch.source == source; };
  if (std::count_if(batches_.begin(), batches_.end(), isOfSource) >= kKept)
    batches_.erase(std::find_if(batches_.begin(), batches_.end(), isOfSource));
  Batch& batch = batches_.emplace_back(Batch{.positions = Array<Vec3f>(*device_, born.count),
                                             .velocities = Array<Vec3f>(*device_, born.count),
                                             .firstId = particles.nextId(),
                                             .born = time,
                                             .flow = flow,
                                             .source = source});
  const std::size_t bytes = static_cast<std::size_t>(born.count) * sizeof(Vec3f);
  device_->copy(batch.positions.data(), born.positions.data(), bytes);
  device_->copy(batch.velocities.data(), born.velocities.data(), bytes);
}

void Inflow::carry(ParticleSet& particles, const StepContext& context, float spacing) {
  std::erase_if(batches_, [&](const Batch& batch) {
    const std::int64_t last = (batch.positions.size() - 1) / batch.flow.together;
    const double travelled = batch.flow.speed * (context.time - batch.born - batch.flow.leaving);
    return travelled >= (kCarried + static_cast<double>(last)) * spacing;
  });
  if (particles.bound() == 0) return;
  for (const Batch& batch : batches_)
    dispatch(*device_, [&](auto& device) { carryOn(device, batch, particles, context, spacing); });
}

void Inflow::save(const StateWriter& to) const {
  to.put("count", static_cast<std::int64_t>(batches_.size()));
  for (std::size_t i = 0; i < batches_.size(); ++i) {
    const Batch& batch = batches_[i];
    const StateWriter one = to.in(std::to_string(i));
    one.put("positions", batch.positions, batch.positions.size());
    one.put("velocities", batch.velocities, batch.velocities.size());
    one.put("first_id", batch.firstId);
    one.put("born", batch.born);
    one.put("speed", batch.flow.speed);
    one.put("leaving", batch.flow.leaving);
    one.put("together", batch.flow.together);
    one.put("source", batch.source);
  }
}

void Inflow::restore(const StateReader& from) {
  batches_.clear();
  if (!from.has("count")) return;  // of a version that carried nothing
  std::int64_t count = 0;
  from.get("count", count);
  for (std::int64_t i = 0; i < count; ++i) {
    const StateReader one = from.in(std::to_string(i));
    Batch batch{.positions = Array<Vec3f>(*device_, one.getAll<Vec3f>("positions")),
                .velocities = Array<Vec3f>(*device_, one.getAll<Vec3f>("velocities"))};
    one.get("first_id", batch.firstId);
    one.get("born", batch.born);
    one.get("speed", batch.flow.speed);
    batch.flow.together = batch.positions.size();  // of a version that let all of a step go at once
    if (one.has("together")) {
      one.get("leaving", batch.flow.leaving);
      one.get("together", batch.flow.together);
    }
    one.get("source", batch.source);
    if (batch.positions.size() == batch.velocities.size() && batch.flow.together > 0)
      batches_.push_back(std::move(batch));
  }
}

}  // namespace weir
