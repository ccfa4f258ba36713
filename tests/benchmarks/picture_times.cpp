// How long pictures take: 1280 x 720 pixels of 2 x 2 samples, with shadows and ambient occlusion, of a wave
// in a tank. Prints a Markdown table of medians, all after pictures that are not counted.
//
//   weir_picture_times [DEVICE [THREADS [PICTURES]]]
//
// "OpenGL": OpenGL draws the particles, too. "OpenGL, device": the device finds which particles are seen.
// "device": it draws the whole picture. A GPU's OpenGL is not measured with the CPU as the device. What
// OpenGL is, WEIR_GL may say.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <string>
#include <vector>

#include "plugins/rendering/gl/context.h"
#include "plugins/rendering/gl/renderer.h"
#include "plugins/rendering/view.h"

namespace weir::rendering {
namespace {

/// Particles on a lattice below a wave, row by row as a sorted fluid has them.
struct Wave {
  std::vector<Vec3f> positions;
  std::vector<float> values;
  float spacing;

  explicit Wave(int count) : spacing(std::cbrt(1.0f / static_cast<float>(count))) {
    const auto steps = [&](float size) { return static_cast<int>(size / spacing); };
    for (int z = 0; z < steps(1); ++z)
      for (int y = 0; y < steps(1); ++y)
        for (int x = 0; x < steps(2); ++x) {
          const Vec3f p{spacing * static_cast<float>(x), spacing * static_cast<float>(y),
                        spacing * static_cast<float>(z)};
          const float surface = 0.5f + 0.3f * std::sin(3 * p.x) + 0.08f * std::sin(9 * p.z + 4 * p.x);
          if (p.y > surface) continue;
          positions.push_back(p);
          values.push_back(std::fabs(std::sin(3 * p.x)) * p.y / surface);
        }
  }

  /// A little farther, so that no picture is that of before.
  void move(float way) {
    for (Vec3f& p : positions) p.x += way;
  }
};

/// The edges of the tank.
std::vector<Vec3f> tankEdges() {
  std::vector<Vec3f> points;
  for (int i = 0; i < 8; ++i)
    for (const int axis : {1, 2, 4}) {
      if ((i & axis) != 0) continue;
      for (const int corner : {i, i | axis})
        points.push_back({corner & 1 ? 2.0f : 0, corner & 2 ? 1.0f : 0, corner & 4 ? 1.0f : 0});
    }
  return points;
}

struct Times {
  double wall, processor;  ///< ms; of the whole process
};

Times medianTimes(gl::Renderer& renderer, int particles, int pictures) {
  using Clock = std::chrono::steady_clock;
  Wave wave(particles);
  const std::vector<Vec3f> edges = tankEdges();
  View view;
  view.lines = {{.points = edges}};
  view.camera = poseSeeing({{0, 0, 0}, {2, 1, 1}}, {0.55f, 0.42f, 0.72f}, {0, 1, 0}, 40, 16.0f / 9.0f);
  view.ground.center = {1, 0, 0.5f};
  view.particles = {{.positions = wave.positions, .values = wave.values, .radius = 0.5f * wave.spacing}};
  constexpr int kWarm = 5;
  std::vector<double> walls, processors;
  for (int i = 0; i < kWarm + pictures; ++i) {
    wave.move(i % 2 == 0 ? 1e-3f : -1e-3f);
    const Clock::time_point start = Clock::now();
    const std::clock_t worked = std::clock();
    renderer.draw(view);
    const std::chrono::duration<double, std::milli> taken = Clock::now() - start;
    if (i < kWarm) continue;
    walls.push_back(taken.count());
    processors.push_back(1e3 * static_cast<double>(std::clock() - worked) / CLOCKS_PER_SEC);
  }
  const auto median = [](std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  };
  return {median(walls), median(processors)};
}

int run(const std::string& device, int threads, int pictures) {
  constexpr int kSizes[] = {20'000, 100'000, 500'000, 2'000'000};
  const auto open = [&] { return openDevice(device, threads); };
  std::vector<std::pair<std::string, std::unique_ptr<gl::Renderer>>> ways;
  // The CPU helps OpenGL only where that is software.
  if (open()->kind() == DeviceKind::kCuda || gl::makeContext()->isSoftware()) {
    ways.emplace_back("OpenGL", std::make_unique<gl::Renderer>(gl::makeContext()));
    ways.emplace_back("OpenGL, device", std::make_unique<gl::Renderer>(gl::makeContext(), open()));
  }
  ways.emplace_back("device",
                    std::make_unique<gl::Renderer>(gl::makeContext(), open(), gl::ComputeShare::kWhatCanBe));
  fmt::print(
      "Milliseconds a picture, and in brackets processor time of all threads; median of {}. Device: {}. "
      "OpenGL: {}\n\n",
      pictures, open()->description(), ways.front().second->description());
  fmt::print("| drawn by | 20k | 100k | 500k | 2M |\n|---|---:|---:|---:|---:|\n");
  for (const auto& [name, renderer] : ways) {
    fmt::print("| {} |", name);
    for (const int size : kSizes) {
      const Times times = medianTimes(*renderer, size, pictures);
      fmt::print(" {:.1f} ({:.0f}) |", times.wall, times.processor);
    }
    fmt::print("\n");
  }
  return 0;
}

}  // namespace
}  // namespace weir::rendering

int main(int argc, char** argv) {
  try {
    return weir::rendering::run(argc > 1 ? argv[1] : "auto", argc > 2 ? std::atoi(argv[2]) : 0,
                                argc > 3 ? std::max(1, std::atoi(argv[3])) : 30);
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}\n", e.what());
    return 1;
  }
}
