// How long pictures take: 1280 x 720 pixels of 2 x 2 samples, with shadows and ambient occlusion, of a wave
// in a tank. Prints a Markdown table of medians, all after pictures that are not counted.
//
//   weir_picture_times [DEVICE [THREADS [PICTURES]]] [sizes=20000,500000] [ways=OpenGL/device] [kernels]
//
// `sizes` and `ways` ask for a part of the table, `kernels` for the time in each kernel of the device, in all
// pictures.
//
// "OpenGL": OpenGL draws the particles, too. "OpenGL, device": the device finds which particles are seen.
// "device": it draws the whole picture. These are given finished colours in the host's memory. "frame": what
// a run does, from the positions and velocities in the memory of a simulation's device to the pixels on the
// host: a copy aside, speeds and their range, and the picture as by "device". A GPU's OpenGL is not measured
// with the CPU as the device. What OpenGL is, WEIR_GL may say.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <string>
#include <vector>

#include "framework/base/error.h"
#include "plugins/rendering/gl/context.h"
#include "plugins/rendering/gl/renderer.h"
#include "plugins/views/scene_view.h"
#include "plugins/views/view.h"

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

/// Of draw(), after prepare() each time.
template <class Prepare, class Draw>
Times medianTimes(int pictures, const Prepare& prepare, const Draw& draw) {
  using Clock = std::chrono::steady_clock;
  constexpr int kWarm = 5;
  std::vector<double> walls, processors;
  for (int i = 0; i < kWarm + pictures; ++i) {
    prepare(i);
    const Clock::time_point start = Clock::now();
    const std::clock_t worked = std::clock();
    draw();
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

const Aabb kTank{{0, 0, 0}, {2, 1, 1}};

Times timesFromHost(gl::Renderer& renderer, int particles, int pictures) {
  Wave wave(particles);
  const std::vector<Vec3f> edges = tankEdges();
  View view;
  view.lines = {{.points = edges}};
  view.camera = poseSeeing(kTank, {0.55f, 0.42f, 0.72f}, {0, 1, 0}, 40, 16.0f / 9.0f);
  view.ground.center = {1, 0, 0.5f};
  view.particles = {{.positions = wave.positions, .values = wave.values, .radius = 0.5f * wave.spacing}};
  return medianTimes(
      pictures, [&](int i) { wave.move(i % 2 == 0 ? 1e-3f : -1e-3f); }, [&] { renderer.draw(view); });
}

Times timesFromDevice(gl::Renderer& renderer, Device& simulation, int particles, int pictures) {
  Wave wave(particles);
  std::vector<Vec3f> speeds;
  for (const float value : wave.values) speeds.push_back({value, 0, 0});
  const auto count = static_cast<std::int64_t>(speeds.size());
  Array<Vec3f> positions(simulation, count);
  const Array<Vec3f> velocities(simulation, std::span<const Vec3f>(speeds));
  const RenderSettings settings;
  SceneView view(settings, *settings.camera, renderer);
  SceneSnapshot snapshot;
  const auto still = std::make_shared<StillScene>();
  still->bounds = kTank;
  still->lines = tankEdges();
  snapshot.still = still;
  FluidSnapshot& fluid = snapshot.fluids.emplace_back(simulation);
  fluid.spacing = wave.spacing;
  fluid.colorType = AttributeType::kVec3;
  return medianTimes(
      pictures,
      [&](int i) {
        wave.move(i % 2 == 0 ? 1e-3f : -1e-3f);
        positions.assign(wave.positions);
        simulation.synchronize();
      },
      [&] {
        fluid.positions.start(positions, count);
        fluid.numbers<Vec3f>().start(velocities, count);
        renderer.draw(view.of(snapshot));
        snapshot.still = nullptr;
      });
}

struct Options {
  std::string device = "auto";
  int threads = 0, pictures = 30;
  std::vector<int> sizes{20'000, 100'000, 500'000, 2'000'000};
  std::vector<std::string> ways;  ///< empty: all
  bool kernels = false;

  bool asksFor(const std::string& way) const {
    return ways.empty() || std::find(ways.begin(), ways.end(), way) != ways.end();
  }
};

std::vector<std::string> parts(const std::string& list, char between) {
  std::vector<std::string> found{""};
  for (const char c : list)
    if (c == between)
      found.emplace_back();
    else
      found.back() += c;
  return found;
}

int numberOf(const std::string& text) {
  char* end = nullptr;
  const long number = std::strtol(text.c_str(), &end, 10);
  if (text.empty() || *end != 0 || number < 0 || number > 1'000'000'000)
    throw usageError("'" + text + "' is not a number that can be used");
  return static_cast<int>(number);
}

Options optionsOf(int argc, char** argv) {
  Options options;
  int place = 0;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "kernels") {
      options.kernels = true;
    } else if (argument.starts_with("sizes=")) {
      options.sizes.clear();
      for (const std::string& size : parts(argument.substr(6), ',')) options.sizes.push_back(numberOf(size));
    } else if (argument.starts_with("ways=")) {
      options.ways = parts(argument.substr(5), '/');
    } else if (++place == 1) {
      options.device = argument;
    } else {
      (place == 2 ? options.threads : options.pictures) = numberOf(argument);
    }
  }
  options.pictures = std::max(1, options.pictures);
  return options;
}

struct Way {
  std::string name;
  Device* device;  ///< null: OpenGL alone
  std::unique_ptr<gl::Renderer> renderer;
  std::unique_ptr<Device> simulation = nullptr;  ///< whose memory particles come from; null: the host's

  Times times(int particles, int pictures) const {
    return simulation ? timesFromDevice(*renderer, *simulation, particles, pictures)
                      : timesFromHost(*renderer, particles, pictures);
  }
};

std::vector<Way> waysOf(const Options& options) {
  std::vector<Way> ways;
  const auto add = [&](const std::string& name, std::unique_ptr<Device> device, gl::ComputeShare share) {
    if (!options.asksFor(name)) return;
    Device* const used = device.get();
    if (used != nullptr) used->profiler().timeKernels(options.kernels);
    ways.push_back({name, used, std::make_unique<gl::Renderer>(gl::makeContext(), std::move(device), share)});
  };
  const auto open = [&] { return openDevice(options.device, options.threads); };
  // The CPU helps OpenGL only where that is software.
  if (open()->kind() == DeviceKind::kCuda || gl::makeContext()->isSoftware()) {
    add("OpenGL", nullptr, gl::ComputeShare::kParticles);
    add("OpenGL, device", open(), gl::ComputeShare::kParticles);
  }
  add("device", open(), gl::ComputeShare::kWhatCanBe);
  add("frame", open(), gl::ComputeShare::kWhatCanBe);
  if (!ways.empty() && ways.back().name == "frame") ways.back().simulation = open();
  if (ways.empty()) throw usageError("no pictures are drawn by these ways");
  return ways;
}

int run(const Options& options) {
  const std::vector<Way> ways = waysOf(options);
  fmt::print(
      "Milliseconds a picture, and in brackets processor time of all threads; median of {}. Device: {}. "
      "OpenGL: {}\n\n",
      options.pictures, openDevice(options.device, options.threads)->description(),
      ways.front().renderer->description());
  std::string rule = "|---|";
  fmt::print("| drawn by |");
  for (const int size : options.sizes) {
    const bool many = size >= 1'000'000;
    fmt::print(" {}{} |", size / (many ? 1'000'000 : 1000), many ? 'M' : 'k');
    rule += "---:|";
  }
  fmt::print("\n{}\n", rule);
  for (const Way& way : ways) {
    fmt::print("| {} |", way.name);
    for (const int size : options.sizes) {
      const Times times = way.times(size, options.pictures);
      fmt::print(" {:.1f} ({:.0f}) |", times.wall, times.processor);
      std::fflush(stdout);
    }
    fmt::print("\n");
  }
  if (!options.kernels) return 0;
  for (const Way& way : ways) {
    if (way.device == nullptr) continue;
    fmt::print("\n{}:\n", way.name);
    for (const ProfileEntry& entry : way.device->profiler().entries())
      fmt::print("  {:<20} {:8.2f} ms a call\n", entry.path,
                 entry.totalMs / static_cast<double>(entry.calls));
  }
  return 0;
}

}  // namespace
}  // namespace weir::rendering

int main(int argc, char** argv) {
  try {
    return weir::rendering::run(weir::rendering::optionsOf(argc, argv));
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}\n", e.what());
    return 1;
  }
}
