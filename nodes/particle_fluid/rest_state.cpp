#include "nodes/particle_fluid/rest_state.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "framework/base/interruption.h"
#include "framework/compute/dispatch.h"
#include "framework/particles/divided_particles.h"

namespace weir {

RestState::RestState(FluidStep& fluid, const std::vector<SharedBatch>& batches)
    : fluid_(fluid), sum_(fluid.device, 1) {
  for (const SharedBatch& of : batches) {
    batches_.push_back({.batch = of.batch,
                        .count = of.countOfAll(),
                        .weightless = of.batch->pressure == StartPressure::kNone});
    holdsParts_ |= of.part != nullptr && of.batch->container == nullptr;
  }
}

bool RestState::wanted() const {
  return std::any_of(batches_.begin(), batches_.end(),
                     [](const Resting& b) { return b.batch->container != nullptr; });
}

double RestState::sumOfAll() {
  ExactSum sum = sum_.toHost().front();
  if (fluid_.divided != nullptr) {
    std::array<std::int64_t, 3> parts{sum.ones, sum.fine, sum.finest};
    fluid_.divided->ranks().sum(parts);
    sum.ones = parts[0], sum.fine = parts[1], sum.finest = parts[2];
  }
  return sum.value();
}

bool RestState::unloadUnheld(int steps) {
  constexpr double kMaxCarried = 0.1;
  bool any = false;
  for (Resting& of : batches_)
    if (of.undecided() && of.carried > kMaxCarried * steps) any = of.weightless = true;
  return any;
}

namespace {

/// What damping still achieves. `peaks` has mean squares of the speed (m²/s²), one a stop.
class Progress {
 public:
  Progress(const std::vector<double>& peaks, double atRest) {
    if (peaks.size() < 2 * kStops) return;
    const auto early = peaks.end() - 2 * kStops, late = peaks.end() - kStops;
    const double before = std::accumulate(early, late, 0.0), now = std::accumulate(late, peaks.end(), 0.0);
    none_ = now >= kLeast * before;
    little_ = now <= kMaxLeft * kStops * atRest;
  }

  /// At its last stops the fluid was on average as fast as at those before.
  bool stagnates() const { return none_; }
  /// What is left is what the solver leaves: more than a little motion never is.
  bool isOver() const { return none_ && little_; }

 private:
  static constexpr int kStops = 10;
  static constexpr double kLeast = 0.95, kMaxLeft = 20;
  bool none_ = false, little_ = false;
};

}  // namespace

void RestState::keepPlaces() {
  ParticleSet& particles = fluid_.particles;
  places_ = particles.add<Vec3f>({.name = "place_at_rest",
                                  .type = AttributeType::kVec3,
                                  .unit = "m",
                                  .doc = "Where it is held until the start.",
                                  .internal = true});
  const std::size_t bytes = static_cast<std::size_t>(particles.refreshCount()) * sizeof(Vec3f);
  if (bytes > 0)
    fluid_.device.copy(places_.write().data(), std::as_const(particles).positions().read().data(), bytes);
}

int RestState::reach(int max, const std::function<void()>& step) {
  if (holdsParts_) keepPlaces();
  // At rest: a particle that falls freely has this speed after half a thousandth of a spacing.
  double atRest = 1e-3 * length(fluid_.time.gravity) * fluid_.constants.spacing;
  if (atRest == 0 && fluid_.images != nullptr) {
    // Fluid that fills a period is under pressure without weight: no particle has far to go then.
    constexpr double kWay = 3e-4;  // spacings in a step
    const double speed = kWay * fluid_.constants.spacing / fluid_.time.dt;
    atRest = speed * speed;
  }
  // Between two stops; sooner, an implicit step that has just begun to carry pressure looks like the peak.
  constexpr int kMinMotion = 8;
  double last = 0;
  int taken = 0, stopped = 0;
  bool moving = true;
  std::vector<double> peaks;  // at stops
  while (taken < max && moving) {
    InterruptibleWork::endIfAsked();
    step();
    dispatch(fluid_.device, [&](auto& device) {
      findCarriedOn(device);
      containOn(device);
    });
    ++taken;
    double square = 0;
    dispatch(fluid_.device, [&](auto& device) { square = meanSquareSpeedOn(device); });
    // Motion is stopped where it is fastest, which is where the forces vanish.
    const bool fastest = square <= last && taken - stopped >= kMinMotion;
    if (fastest) peaks.push_back(last);
    const Progress progress(peaks, atRest);
    const bool calm = fastest && (square <= atRest || progress.isOver());
    // Before, pushes are those of particles on their way to where they will rest. What its container carries
    // may never come to rest in it.
    const bool settled = calm || (fastest && (progress.stagnates() || 2 * taken > max));
    const bool unloaded = settled && unloadUnheld(taken - stopped);
    moving = unloaded || !calm;
    if (unloaded) peaks.clear();
    dispatch(fluid_.device, [&](auto& device) { dampOn(device, fastest ? 0.0f : 1.0f); });
    last = fastest ? 0 : square;
    if (fastest) {
      stopped = taken;
      for (Resting& of : batches_) of.carried = 0;
    }
  }
  dispatch(fluid_.device, [&](auto& device) {
    releaseOn(device);
    giveBackOn(device);
  });
  return taken;
}

}  // namespace weir
