#include "nodes/particle_fluid/modules/xsph.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "framework/compute/dispatch.h"
#include "framework/graph/setting_warning.h"
#include "framework/neighbors/motion_code.h"

namespace weir {

namespace {

/// Of which none has a c above 1.
int sweepsFor(double share) {
  constexpr double kRounding = 1e-6;
  return std::max(1, static_cast<int>(std::ceil(share * (1 - kRounding))));
}

class StrengthOfXsph final : public MovedParameters {
 public:
  std::string_view from() const override { return Xsph::kInfo.type; }
  std::string_view to() const override { return from(); }
  std::vector<Parameter> parameters() const override {
    return {{"strength", "strength", 0.3}, {"form", "form", "explicit"}};
  }
  std::vector<Parameter> renamed() const override { return {}; }
  bool concerns(const Value& params) const override {
    return params.find("strength") != nullptr && params.find("form") == nullptr;
  }
  bool matter(const Value&) const override { return true; }
  std::string_view meaning() const override {
    return "a strength counts in each step, and is read so; a \"rate\", strength over the time step, is the "
           "same for any";
  }
};

}  // namespace

std::unique_ptr<MovedParameters> strengthOfXsph() {
  return std::make_unique<StrengthOfXsph>();
}

void Xsph::reset(FluidStep& fluid) {
  if (form != XsphForm::kImplicit) fluid.particles.byProducts().request(kMotionCodes);
}

void Xsph::warn(const FluidOutlook& outlook) const {
  constexpr int kMany = 8;
  const int sweeps = sweepsFor(double(rate) * outlook.dt);
  if (form == XsphForm::kPerTime && sweeps > kMany)
    outlook.warn(*this,
                 fmt::format("a rate of {:.3g} 1/s takes {} sweeps in a step of {:.3g} s", rate.get(), sweeps,
                             outlook.dt),
                 fmt::format("at most {:.2g} 1/s, or a ViscositySolver", kMany / outlook.dt));
}

void Xsph::smooth(FluidStep& fluid, double share, int sweeps) {
  if (!(share > 0)) return;
  for (int k = 0; k < sweeps; ++k)
    dispatch(fluid.device, [&](auto& device) { sweepOn(device, fluid, static_cast<float>(share / sweeps)); });
}

void Xsph::step(FluidStep& fluid) {
  if (form == XsphForm::kPerTime) {
    const double share = double(rate) * fluid.time.dt;
    smooth(fluid, share, sweepsFor(share));
  } else if (form == XsphForm::kExplicit) {
    smooth(fluid, strength, 1);
  } else if (viscosity > 0) {
    dispatch(fluid.device, [&](auto& device) { implicitOn(device, fluid); });
  }
}

double Xsph::memory(const FluidRoom& room) const {
  return form == XsphForm::kImplicit ? bytesOfArrays(room.particles, next_) : 0;
}

}  // namespace weir
