#include "nodes/fluid_surface/surface_level.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace weir {

namespace {

double fieldAt(const std::vector<ParticleKernel>& kernels, const Vec3d& p) {
  double sum = 0;
  for (const ParticleKernel& k : kernels) {
    const double x = p.x - k.center.x, y = p.y - k.center.y, z = p.z - k.center.z;
    const double square =
        k.xx * x * x + k.yy * y * y + k.zz * z * z + 2 * (k.xy * x * y + k.xz * x * z + k.yz * y * z);
    if (square < 1) sum += k.weight * std::pow(1 - square, 3);
  }
  return sum;
}

}  // namespace

float flatLevel(Device& device, const KernelSettings& settings) {
  const float d = settings.spacing;
  // Kernels that reach the middle of the face must not know of the block's other faces.
  const int half = static_cast<int>(std::ceil(3 * settings.radius / d)) + 1;
  std::vector<Vec3f> block;
  for (int k = 0; k < half; ++k)
    for (int j = -half; j < half; ++j)
      for (int i = -half; i < half; ++i)
        block.push_back(d * Vec3f{float(i) + 0.5f, -float(k) - 0.5f, float(j) + 0.5f});
  ParticleKernels kernels(device);
  const Array<Vec3f> positions(device, std::span<const Vec3f>(block));
  KernelSettings whole = settings;
  whole.leavesSpray = false;  // the block's own rim
  kernels.make(device, positions.view(), positions.size(), whole, std::numeric_limits<float>::max());
  std::vector<ParticleKernel> near;
  for (const ParticleKernel& k : kernels.array().toHost(kernels.size()))
    if (std::abs(k.center.x) < 2 * settings.radius + d && std::abs(k.center.z) < 2 * settings.radius + d)
      near.push_back(k);
  constexpr int kSamples = 4;  // along each side of the lattice's unit square
  double sum = 0;
  for (int i = 0; i < kSamples; ++i)
    for (int j = 0; j < kSamples; ++j)
      sum += fieldAt(near, {(i + 0.5) / kSamples * double(d), 0, (j + 0.5) / kSamples * double(d)});
  return static_cast<float>(sum / (kSamples * kSamples));
}

float loneAxis(float level, const KernelSettings& settings) {
  const double h = double(settings.radius) / double(settings.spacing);
  const double k = h * std::cbrt(double(level) * 64 * std::numbers::pi / 315);
  const double wanted = std::cbrt(3 / (4 * std::numbers::pi)) / h;
  // The radius grows with the axis up to 2/(3k).
  double low = 0, high = std::min(1.0, 2 / (3 * k));
  for (int i = 0; i < 60; ++i) {
    const double axis = (low + high) / 2;
    (axis * std::sqrt(1 - k * axis) < wanted ? low : high) = axis;
  }
  return static_cast<float>(high);
}

}  // namespace weir
