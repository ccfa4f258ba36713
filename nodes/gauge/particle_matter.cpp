#include "nodes/gauge/particle_matter.h"

namespace weir {

namespace {

ScalarField fieldOf(const Particles& particles, const MaterialField& field) {
  const Attribute<const float> own = particles.ownValues(field);
  return {own ? own.read().view() : ArrayView<const float>{}, field.value};
}

ScalarField attributeOf(const Particles& particles, std::string_view name) {
  if (!hasScalar(particles, name)) return {};
  return {particles.set().get<float>(name).read().view(), 0};
}

}  // namespace

bool hasScalar(const Particles& particles, std::string_view attribute) {
  const AttributeInfo* info = particles.set().find(attribute);
  return info != nullptr && info->type == AttributeType::kFloat;
}

MatterView matterOf(const Particles& particles) {
  const ParticleSet& set = particles.set();
  return {.positions = set.positions().read().view(),
          .velocities = set.velocities().read().view(),
          .volumes = fieldOf(particles, particles.material.volume),
          .restDensities = fieldOf(particles, particles.material.density),
          .densities = attributeOf(particles, "density"),
          .pressures = attributeOf(particles, "pressure")};
}

}  // namespace weir
