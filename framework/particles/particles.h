// What systems of particles put out, and what all that shows, exports, couples or measures particles takes:
//
//   Output<Particles> particles{*this, "particles", "The tracers."};
//   ...
//   void estimate(...) { particles->material.spacing = spacing, particles->maxCount = count; }
//   void reset(...) { particles->assign(set_); }
//
// Nothing in it is a fluid's: a node whose particles are not a fluid is drawn, exported and measured like
// one.
#pragma once

#include <string>
#include <string_view>

#include "framework/base/api.h"
#include "framework/particles/particle_set.h"
#include "framework/particles/period.h"

namespace WEIR_API weir {

class SolidCoupling;

/// A quantity of the matter: one value for all particles, or an attribute that has each particle's own.
struct MaterialField {
  float value = 0;        ///< of all particles; a typical one where each has its own
  std::string attribute;  ///< of floats; empty where all particles have `value`

  bool byParticle() const { return !attribute.empty(); }
};

/// What the particles are made of.
struct Material {
  float spacing = 0;      ///< m, distance of particles at rest: the size of what they resolve, and their look
  MaterialField density;  ///< kg/m³, of the matter at rest; 0 for points without mass
  MaterialField volume;   ///< m³, of the matter that a particle stands for
};

class Particles {
 public:
  static constexpr std::string_view kPortType = "Particles";
  /// Of a coupling: how many solids it will bring.
  struct Request {
    int solids = 0;
    friend bool operator==(const Request&, const Request&) = default;
  };

  Material material;    ///< its spacing is told in estimate() already
  double maxCount = 0;  ///< particles that there will be at any time; told in estimate(), 0 if nobody asked
  Period period;        ///< of the space in which they live, if it repeats itself; told in configure()

  /// Whether there are particles to look at: from the reset of their node on.
  bool exist() const { return set_ != nullptr; }
  /// What exists (a WEIR_CHECK otherwise).
  ParticleSet& set() const {
    WEIR_CHECK(set_ != nullptr);
    return *set_;
  }
  /// For the node that holds the set, which must outlive this.
  void assign(ParticleSet& set) { set_ = &set; }

  /// Each particle's own value; of nothing where all share one. Throws a scene Error if the material names an
  /// attribute of floats that the particles do not have.
  Attribute<const float> ownValues(const MaterialField& field) const;

  /// For a node whose particles meet solids, in its constructor; see framework/solids/solid_coupling.h.
  void offer(SolidCoupling& coupling) { coupling_ = &coupling; }
  SolidCoupling* coupling() const { return coupling_; }

 private:
  ParticleSet* set_ = nullptr;
  SolidCoupling* coupling_ = nullptr;
};

}  // namespace weir
