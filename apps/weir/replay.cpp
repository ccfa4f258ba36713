#include "apps/weir/replay.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <utility>

#include "framework/base/text.h"
#include "framework/graph/outputs_of.h"

namespace weir::app {

namespace {

/// Whether all numbers of the array are among those of the type.
template <class From>
bool holds(AttributeType type, const std::vector<From>& numbers) {
  return withAttributeType(type, [&]<class T>(std::type_identity<T>) {
    using Number = typename AttributeTraits<T>::Number;
    if constexpr (!std::is_integral_v<Number> || !std::is_integral_v<From>)
      return std::is_integral_v<Number> == std::is_integral_v<From>;
    else
      return std::all_of(numbers.begin(), numbers.end(), [](From n) { return std::in_range<Number>(n); });
  });
}

/// Adds an attribute of the first type that holds such numbers, and that many of them, if there is one; of
/// what the particles have already, it is theirs. So ids of 32 bits, of earlier exports, become longer.
template <class From>
void addNumbers(const RecordedArray& array, AttributeInfo info, const std::vector<From>& numbers,
                ParticleSet& particles, const StateWriter& to) {
  const AttributeInfo* present = particles.find(info.name);
  for (int type = 0; type < kAttributeTypes; ++type) {
    info.type = AttributeType(type);
    if (numbersIn(info.type) != array.components || !holds(info.type, numbers)) continue;
    if (present != nullptr && present->type != info.type) continue;
    return withAttributeType(info.type, [&]<class T>(std::type_identity<T>) {
      using Number = typename AttributeTraits<T>::Number;
      const std::vector<Number> narrow(numbers.begin(), numbers.end());
      particles.add<T>(info);
      to.put(array.name, std::span(reinterpret_cast<const T*>(narrow.data()), narrow.size() / kNumbersIn<T>));
    });
  }
}

/// Adds the attribute, with the unit that the scene's own particles have, and saves its values.
void addAttribute(const RecordedArray& array, const ParticleSet* own, ParticleSet& particles,
                  const StateWriter& to) {
  AttributeInfo info{.name = array.name, .unit = {}, .doc = {}};
  const AttributeInfo* known = own != nullptr ? own->find(array.name) : nullptr;
  if (known != nullptr) info.unit = known->unit;
  std::visit([&](const auto& numbers) { addNumbers(array, info, numbers, particles, to); }, array.values);
}

bool has(const RecordedFluid& fluid, std::string_view name) {
  return std::any_of(fluid.arrays.begin(), fluid.arrays.end(),
                     [&](const RecordedArray& array) { return array.name == name; });
}

const ParticleSet* ownOf(const Particles& particles) {
  return particles.exist() ? &particles.set() : nullptr;
}

}  // namespace

Replay::Replay(Simulation& simulation, const Recording& recording)
    : simulation_(simulation), recording_(recording), end_(recording.times().size()) {
  const auto fluids = outputsOf<Particles>(simulation.scene().graph);
  std::vector<std::string> names;
  for (const auto& [name, output] : fluids) names.push_back(name);
  std::vector<std::string> wanted = recording.fluids();
  if (wanted.empty() && names.size() == 1) wanted = names;
  if (wanted.empty())
    throw ioError("the file does not say of which fluid its particles are", "a scene with one fluid");
  for (const std::string& name : wanted) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end())
      throw ioError(
          "the file has particles of the fluid " + inQuotes(name) + ", which the scene does not have",
          names.empty() ? "a scene with such a fluid" : joinNames(names), didYouMean(name, names));
    targets_.push_back({fluids[static_cast<std::size_t>(found - names.begin())].second, nullptr});
  }
  names_ = std::move(wanted);
  simulation.replay();
  findFollowers();
}

void Replay::findFollowers() {
  for (const auto& node : simulation_.scene().graph.nodes()) {
    const bool recorded = std::ranges::any_of(
        targets_, [&](const Target& target) { return &target.output->node() == node.get(); });
    if (!recorded && node->followsRecordings()) followers_.push_back(node.get());
  }
  if (followers_.empty() || recording_.times().empty()) return;
  const std::vector<RecordedFluid> fluids = recording_.read(0);
  for (std::size_t i = 0; i < fluids.size(); ++i)
    for (const char* needed : {"velocity", "id"})
      if (!has(fluids[i], needed))
        throw ioError(fmt::format("the file has no attribute '{}' of the fluid {}, which {} needs", needed,
                                  inQuotes(names_[i]), inQuotes(followers_.front()->name())),
                      "an export with velocities and ids");
}

void Replay::showOnly(std::int64_t frame) {
  const std::size_t count = recording_.times().size();
  if (frame < 0 || static_cast<std::size_t>(frame) >= count)
    throw usageError(fmt::format("the file has no frame {}", frame), fmt::format("0 to {}", count - 1));
  first_ = frame_ = static_cast<std::size_t>(frame);
  end_ = first_ + 1;
  simulation_.showAt(frame, recording_.times()[first_]);  // so that outputs begin with its number
}

bool Replay::next() {
  if (frame_ == end_) return false;
  // What follows the recording has come here from its first frame.
  if (followers_.empty()) loaded_ = frame_;
  while (loaded_ <= frame_) load();
  ++frame_;
  return true;
}

void Replay::load() {
  const std::vector<RecordedFluid> fluids = recording_.read(loaded_);
  WEIR_CHECK(fluids.size() == targets_.size());
  particles_ = 0;
  for (std::size_t i = 0; i < targets_.size(); ++i) {
    fill(targets_[i], fluids[i]);
    particles_ += static_cast<std::int64_t>(fluids[i].positions.size());
  }
  const std::vector<double>& times = recording_.times();
  simulation_.showAt(static_cast<std::int64_t>(loaded_), times[loaded_]);
  simulation_.follow(followers_, times[loaded_ == 0 ? 0 : loaded_ - 1]);
  ++loaded_;
}

void Replay::fill(Target& target, const RecordedFluid& from) const {
  auto particles = std::make_unique<ParticleSet>(simulation_.device());
  const ParticleSet* own = target.particles ? target.particles.get() : ownOf(**target.output);
  const auto count = from.positions.size();
  StateArrays arrays;
  const StateWriter to(arrays);
  to.put("count", static_cast<std::int64_t>(count));
  to.put("next_id", static_cast<std::int64_t>(count));
  to.put("position", std::span<const Vec3f>(from.positions));
  if (!has(from, "velocity")) to.put("velocity", std::span<const Vec3f>(std::vector<Vec3f>(count)));
  if (!has(from, "id")) to.put("id", std::span<const std::int64_t>(std::vector<std::int64_t>(count)));
  for (const RecordedArray& array : from.arrays)
    if (array.name != "position") addAttribute(array, own, *particles, to);
  particles->restore(StateReader(arrays));
  (*target.output)->assign(*particles);
  target.particles = std::move(particles);
}

}  // namespace weir::app
