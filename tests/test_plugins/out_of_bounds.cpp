// Writes behind the end of an array of its own: for builds with the address sanitizer, which must say so.

#include <weir/fluid_module.h>
#include <weir/plugin.h>

namespace {

using namespace weir;

class OutOfBounds final : public FluidModule {
 public:
  static constexpr ModuleInfo kInfo{"OutOfBounds", kFamily, "Writes behind the end of its array."};
  const ModuleInfo& info() const override { return kInfo; }

  void step(FluidStep& fluid) override {
    constexpr std::int64_t kSize = 64;  // a size that is not rounded up
    Array<float> values(fluid.device, kSize);
    writeTo(values.view(), fluid.particles.bound() > 0 ? kSize : 0);
  }

 private:
  static void writeTo(ArrayView<float> values, std::int64_t place) {
    volatile float* const element = &values[place];
    *element = 1;
  }
};

}  // namespace

WEIR_PLUGIN("out_of_bounds", "Writes where it must not.", registry) {
  registry.addModule<OutOfBounds>();
}
