// Which attributes particles take along from one set to another, and where each stands in a buffer: one
// attribute behind the other, and in each one particle behind the other.
//
//   const PackLayout all(particles);                         // what migrates, and what a halo starts with
//   const PackLayout moving(particles, {"position", "velocity"});  // what is refreshed in between
//   particles.pack(all, leaving, buffer);
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "framework/base/api.h"
#include "framework/particles/attribute_types.h"

namespace WEIR_API weir {

class ParticleSet;

class PackLayout {
 public:
  /// All attributes that the set has at the time but those that are derived, which are made anew wherever the
  /// particle is.
  explicit PackLayout(const ParticleSet& particles);
  /// These, in this order. Throws a simulation Error for a name that the set does not have.
  PackLayout(const ParticleSet& particles, std::initializer_list<std::string_view> names);

  const std::vector<AttributeInfo>& attributes() const { return attributes_; }
  std::int64_t bytesOfOne() const { return bytesOfOne_; }
  std::int64_t bytesOf(std::int64_t particles) const { return particles * bytesOfOne_; }
  /// How many particles these bytes are. Throws a simulation Error if they are no whole number of them.
  std::int64_t particlesIn(std::int64_t bytes) const;

  /// "position vec3, velocity vec3, id int64": what two sides compare before they exchange anything.
  std::string describe() const;
  /// Throws a simulation Error unless the other side's description is the same. `sender` says who that is.
  void checkSame(std::string_view described, const std::string& sender) const;

 private:
  void add(const AttributeInfo& info);

  std::vector<AttributeInfo> attributes_;
  std::int64_t bytesOfOne_ = 0;
};

}  // namespace weir
