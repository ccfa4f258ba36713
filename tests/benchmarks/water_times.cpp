// How long pictures of the look "water" take: 1280 x 720 pixels of 2 x 2 samples, of a wave under the sky.
// Prints medians, after pictures that are not counted: the time that passes, and that of all processors.
//
//   weir_water_times [THREADS [PICTURES]]
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <vector>

#include "plugins/rendering/gl/context.h"
#include "plugins/rendering/gl/renderer.h"
#include "plugins/views/view.h"

namespace weir::rendering {
namespace {

/// Particles on a lattice below a wave.
std::vector<Vec3f> wave(int count, float& spacing) {
  spacing = std::cbrt(1.0f / static_cast<float>(count));  // of a volume of one cubic metre
  std::vector<Vec3f> positions;
  for (float z = 0; z < 1; z += spacing)
    for (float x = 0; x < 2; x += spacing) {
      const float surface = 0.5f + 0.3f * std::sin(3 * x) + 0.08f * std::sin(9 * z + 4 * x);
      for (float y = 0; y < surface; y += spacing) positions.push_back({x, y, z});
    }
  return positions;
}

struct Times {
  double wall, processors;  // ms
};

Times medians(gl::Renderer& renderer, const View& view, int pictures) {
  constexpr int kWarm = 3;
  std::vector<double> walls, processors;
  for (int i = 0; i < kWarm + pictures; ++i) {
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t worked = std::clock();
    renderer.draw(view);
    const std::chrono::duration<double, std::milli> taken = std::chrono::steady_clock::now() - start;
    if (i < kWarm) continue;
    walls.push_back(taken.count());
    processors.push_back(1e3 * static_cast<double>(std::clock() - worked) / CLOCKS_PER_SEC);
  }
  for (std::vector<double>* values : {&walls, &processors}) std::sort(values->begin(), values->end());
  return {walls[walls.size() / 2], processors[processors.size() / 2]};
}

void report(int threads, int particles, int pictures) {
  float spacing = 0;
  const std::vector<Vec3f> positions = wave(particles, spacing);
  View view;
  view.camera = poseSeeing({{0, 0, 0}, {2, 1, 1}}, {0.55f, 0.42f, 0.72f}, {0, 1, 0}, 40, 16.0f / 9.0f);
  view.ground.center = {1, 0, 0.5f};
  view.environment = EnvironmentLook::kSky;
  view.particles = {{.positions = positions, .radius = 0.5f * spacing}};
  gl::Renderer renderer(gl::makeContext(), openDevice("cpu", threads));
  const Times spheres = medians(renderer, view, pictures);
  view.waters = {{.smoothing = 2 * spacing}};
  view.particles = {{.positions = positions, .radius = 0.75f * spacing, .water = 0}};
  view.particles[0].volume = spacing * spacing * spacing;
  const Times water = medians(renderer, view, pictures);
  fmt::print("| {} | {:.0f} ms, {:.0f} ms of processors | {:.0f} ms, {:.0f} ms of processors |\n",
             positions.size(), spheres.wall, spheres.processors, water.wall, water.processors);
}

}  // namespace
}  // namespace weir::rendering

int main(int count, char** arguments) {
  const int threads = count > 1 ? std::atoi(arguments[1]) : 4;
  const int pictures = count > 2 ? std::atoi(arguments[2]) : 9;
  fmt::print("| Particles | spheres | water |\n|---|---|---|\n");
  for (const int particles : {100000, 500000, 2000000}) weir::rendering::report(threads, particles, pictures);
}
