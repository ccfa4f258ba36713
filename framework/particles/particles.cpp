#include "framework/particles/particles.h"

#include "framework/base/error.h"
#include "framework/base/text.h"

namespace weir {

Attribute<const float> Particles::ownValues(const MaterialField& field) const {
  if (!field.byParticle()) return {};
  const AttributeInfo* info = set().find(field.attribute);
  if (info != nullptr && info->type == AttributeType::kFloat) return set().get<float>(field.attribute);
  std::vector<std::string> names;
  for (const AttributeInfo& attribute : set().attributes())
    if (attribute.type == AttributeType::kFloat) names.push_back(attribute.name);
  throw sceneError(
      "the particles' material is said to be in " + inQuotes(field.attribute) + ", no attribute of theirs",
      joinNames(names), didYouMean(field.attribute, names));
}

}  // namespace weir
