// A module with attributes of its own, which must travel with their particles.

#include <weir/fluid_module.h>
#include <weir/plugin.h>

namespace {

using namespace weir;

/// Gives each particle 3·id + 1, (id, 2·id, −id) and a matrix with that in its second row, in the first step
/// that it lives through.
class Tagger final : public FluidModule {
 public:
  static constexpr ModuleInfo kInfo{"Tagger", kFamily, "Tags particles by their ids."};
  const ModuleInfo& info() const override { return kInfo; }

  void reset(FluidStep& fluid) override {
    tag_ = fluid.particles.add<float>({"tag", AttributeType::kFloat, "", "3·id + 1."});
    vector_ = fluid.particles.add<Vec3f>({"tag_vector", AttributeType::kVec3, "", "(id, 2·id, -id)."});
    matrix_ = fluid.particles.add<Mat3f>({"tag_matrix", AttributeType::kMat3, "", "Of (id, 2·id, -id)."});
    number_ = fluid.particles.add<int>({"tag_number", AttributeType::kInt, "", "id + 7."});
  }

  void step(FluidStep& fluid) override {
    const std::int64_t n = fluid.particles.refreshCount();
    const std::vector<std::int64_t> ids = fluid.particles.ids().toHost(n);
    std::vector<float> tags = tag_.toHost(n);
    std::vector<Vec3f> vectors = vector_.toHost(n);
    std::vector<Mat3f> matrices = matrix_.toHost(n);
    std::vector<int> numbers = number_.toHost(n);
    for (std::size_t i = 0; i < tags.size(); ++i) {
      if (numbers[i] != 0) continue;
      const auto id = static_cast<float>(ids[i]);
      tags[i] = 3 * id + 1;
      vectors[i] = matrices[i][1] = {id, 2 * id, -id};
      numbers[i] = static_cast<int>(ids[i]) + 7;
    }
    tag_.assign(tags);
    vector_.assign(vectors);
    matrix_.assign(matrices);
    number_.assign(numbers);
  }

 private:
  Attribute<float> tag_;
  Attribute<Vec3f> vector_;
  Attribute<Mat3f> matrix_;
  Attribute<int> number_;
};

}  // namespace

WEIR_PLUGIN("tagger", "Tags particles.", registry) {
  registry.addModule<Tagger>();
}
