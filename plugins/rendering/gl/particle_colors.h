// The colours of particles as a row of texels: the colour map, then the fixed colour and that of "not a
// number".
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "plugins/rendering/view.h"

namespace weir::rendering::gl {

class ParticleColors {
 public:
  static constexpr int kCount = 258;

  explicit ParticleColors(const ParticleView& particles);

  /// Where the colour of a value lies among the texels, in [0, kCount - 1]; between two of them it is a
  /// mixture.
  float entryOf(float value) const;
  static float fixedEntry() { return 256; }

  /// Red, green, blue and 255 of each texel.
  const std::vector<std::uint8_t>& texels() const { return texels_; }
  /// Red, green and blue at a place among the texels.
  std::array<std::uint8_t, 3> at(float entry) const;

 private:
  float lowest_, highest_;
  std::vector<std::uint8_t> texels_;
};

}  // namespace weir::rendering::gl
