#include "framework/particles/pack_layout.h"

#include "framework/base/error.h"
#include "framework/base/text.h"
#include "framework/particles/particle_set.h"

namespace weir {

PackLayout::PackLayout(const ParticleSet& particles) {
  for (const AttributeInfo& info : particles.allAttributes())
    if (!info.derived) add(info);
}

PackLayout::PackLayout(const ParticleSet& particles, std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names) {
    const AttributeInfo* info = particles.find(name);
    if (info != nullptr) {
      add(*info);
      continue;
    }
    std::vector<std::string> known;
    for (const AttributeInfo& attribute : particles.allAttributes()) known.push_back(attribute.name);
    throw simulationError(
        "the particles have no attribute " + inQuotes(std::string(name)) + " that others could be told of",
        joinNames(known), didYouMean(std::string(name), known));
  }
}

void PackLayout::add(const AttributeInfo& info) {
  attributes_.push_back(info);
  bytesOfOne_ += withAttributeType(
      info.type, []<class T>(std::type_identity<T>) { return static_cast<std::int64_t>(sizeof(T)); });
}

std::int64_t PackLayout::particlesIn(std::int64_t bytes) const {
  if (bytesOfOne_ == 0 || bytes % bytesOfOne_ != 0)
    throw simulationError("found " + std::to_string(bytes) + " bytes of packed particles",
                          "a multiple of " + std::to_string(bytesOfOne_) + ", for " + describe());
  return bytes / bytesOfOne_;
}

std::string PackLayout::describe() const {
  std::string text;
  for (const AttributeInfo& info : attributes_)
    text += (text.empty() ? "" : ", ") + info.name + " " + std::string(nameOf(info.type));
  return text;
}

void PackLayout::checkSame(std::string_view described, const std::string& sender) const {
  if (described != describe())
    throw simulationError("the particles of " + sender + " have the attributes " + std::string(described),
                          describe(), "run the same scene with the same plugins everywhere");
}

}  // namespace weir
