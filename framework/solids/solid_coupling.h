// How solids come to particles: the node that owns solids asks, the node that owns the particles accepts.
//
//   void configure(const SetupContext&) { fluid.request({static_cast<int>(solids.size())}); }
//   void reset(const SetupContext&) {
//     ... make parts_, a State<std::vector<std::unique_ptr<Solid>>> ...
//     for (std::size_t i = 0; i < fluid.size(); ++i) couplingOf(fluid, i).accept(parts_.get());
//   }
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "framework/base/api.h"
#include "framework/graph/port.h"
#include "framework/particles/particles.h"
#include "framework/solids/solid.h"

namespace WEIR_API weir {

/// Of a system of particles that meets solids.
class SolidCoupling {
 public:
  /// For reset(): leaves out the particles that have no room beside these solids, and meets the solids from
  /// then on, until the next reset. Returns how many were left out.
  virtual std::int64_t accept(std::span<const std::unique_ptr<Solid>> solids) = 0;

 protected:
  ~SolidCoupling() = default;
};

/// That of the particles on link i. Throws a scene Error if they meet no solids.
SolidCoupling& couplingOf(const Inputs<Particles>& particles, std::size_t i);

}  // namespace weir
