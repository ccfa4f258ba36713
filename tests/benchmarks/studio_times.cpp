// What the studio costs and how fast it is, over real connections on this machine:
//
//   weir_studio_times first [WEIR]      from the start of the program to the first picture's particles
//   weir_studio_times stream            frames a second and latency of the stream, without steps between them
//   weir_studio_times slowdown [THREADS [BLOCKS [DEVICE]]]  what a viewer of 50 000 particles costs: two
//                                       simulations of one scene in this process, with and without somebody
//                                       who watches, come to the same frames, three at a time, in turns
//
// Each prints a line of a Markdown table per case. "stream" asks for the present frame again and again: it is
// copied, quantised, sent and received each time. Its latency is that of one request alone, its rate that
// with two on their way, as for a page.
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/wait.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "framework/run/simulation.h"
#include "tests/apps/studio/web_client.h"

namespace weir::studio {
namespace {

using Clock = std::chrono::steady_clock;

double since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// A cube of about that many particles that falls apart in a tank.
std::string sceneOf(double particles, double duration) {
  constexpr double kSpacing = 0.01;
  const double side = kSpacing * std::round(std::cbrt(particles));
  return fmt::format(
      R"({{"weir": 1, "world": {{"duration": {}, "frame_rate": 30, "dt": 0.001}},
           "nodes": {{"block": {{"type": "BoxSampler",
                                 "params": {{"min": [0, 0, 0], "max": [{}, {}, {}], "arrangement": "lattice"}}}},
                      "tank": {{"type": "StaticBoundary",
                                "params": {{"shape": "box", "min": [0, 0, 0], "max": [3, 3, 3], "inverted": true}}}},
                      "water": {{"type": "ParticleFluid",
                                 "params": {{"spacing": {}, "support_ratio": 1.2, "rest_steps": 0}},
                                 "modules": {{"solver": {{"params": {{"iterations": 3}}}}}}}}}},
           "links": ["block.particles -> water.initial", "tank.boundary -> water.boundaries"]}})",
      duration, side, side, side, kSpacing);
}

bool isFrame(const Socket::Message& message) {
  return !message.text && Socket::headerOf(message).find("kind")->asString() == "frame";
}

const Value& fluidOf(const Value& header) {
  return header.find("fluids")->asArray().at(0);
}

void streamOf(double particles) {
  constexpr int kFrames = 60, kAlone = 20, kUnderWay = 2;
  const test::TemporaryFolder folder;
  folder.write("scene.json", sceneOf(particles, 1));
  StudioOptions options;
  options.folder = folder.path();
  const RunningStudio studio(options, "scene.json");
  const Socket socket = studio.socket();
  socket.ask(R"({"id": 1, "do": "run.reset"})");
  const Value header = Socket::headerOf(*socket.until(isFrame));
  socket.sendText(R"({"do": "frame.seen"})");
  const auto request = [&] {
    socket.sendText(R"({"id": 3, "do": "view.set", "attribute": "speed", "most": 200000})");
  };
  const auto receive = [&] {
    std::size_t bytes = 0;
    while (const auto message = socket.next()) {
      if (message->text || message->data.size() < sizeof(std::uint32_t)) continue;
      bytes = message->data.size();
      socket.sendText(R"({"do": "frame.seen"})");
      break;
    }
    return bytes;
  };
  std::vector<double> alone;
  std::size_t bytes = 0;
  for (int i = 0; i < kAlone; ++i) {
    const Clock::time_point start = Clock::now();
    request();
    bytes = receive();
    alone.push_back(since(start));
  }
  std::sort(alone.begin(), alone.end());
  const Clock::time_point start = Clock::now();
  for (int i = 0; i < kUnderWay; ++i) request();
  // Each request is answered, but a frame may stand for two that came together.
  for (int frames = 0; frames < kFrames;) {
    const auto message = socket.next();
    if (!message) throw std::runtime_error("the studio closed the connection");
    if (!message->text) {
      ++frames;
      socket.sendText(R"({"do": "frame.seen"})");
    } else if (parseJson(message->data, "answer").find("id") != nullptr) {
      request();
    }
  }
  const double rate = kFrames / since(start);
  const Value& fluid = fluidOf(header);
  fmt::print("| {} | {} | {:.1f} | {:.0f} | {:.1f} |\n", fluid.find("total")->asInt(),
             fluid.find("count")->asInt(), 1e-6 * static_cast<double>(bytes), rate, 1e3 * alone[kAlone / 2]);
}

void stream() {
  fmt::print("| particles | sent | MB a frame | frames/s | latency, ms |\n|---|---|---|---|---|\n");
  for (const double particles : {2e4, 2e5, 1e6}) streamOf(particles);
}

void first(const std::string& weir) {
  fmt::print("| particles | address, ms | connected, ms | first frame, ms |\n|---|---|---|---|\n");
  for (const double particles : {2e4, 2e5}) {
    const test::TemporaryFolder folder;
    const std::string scene = folder.write("scene.json", sceneOf(particles, 1));
    const Clock::time_point start = Clock::now();
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
    const pid_t child = fork();
    if (child == 0) {
      dup2(ends[1], STDOUT_FILENO);
      execlp(weir.c_str(), weir.c_str(), "studio", scene.c_str(), "--device", "cpu", "--no-browser", nullptr);
      _exit(127);
    }
    close(ends[1]);
    std::string address;
    for (char c = 0; read(ends[0], &c, 1) == 1 && c != '\n';) address += c;
    const double addressed = since(start);
    const std::size_t colon = address.rfind(':'), token = address.find('=');
    if (token == std::string::npos) throw std::runtime_error("no address from " + weir);
    const int port = std::stoi(address.substr(colon + 1));
    const Socket socket(port, "GET / HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port) +
                                  "\r\nAuthorization: Bearer " + address.substr(token + 1) + "\r\n");
    socket.ask(R"({"id": 1, "do": "hello"})");
    const double connected = since(start);
    socket.sendText(R"({"id": 2, "do": "run.play"})");
    const Value header = Socket::headerOf(*socket.until(isFrame));
    fmt::print("| {} | {:.0f} | {:.0f} | {:.0f} |\n", fluidOf(header).find("total")->asInt(), 1e3 * addressed,
               1e3 * connected, 1e3 * since(start));
    kill(child, SIGTERM);
    waitpid(child, nullptr, 0);
    close(ends[0]);
  }
}

constexpr double kWatched = 5e4, kMs = 1e3;

/// A number of each block, and what they say together.
class Numbers {
 public:
  void add(double number) {
    sorted_.insert(std::upper_bound(sorted_.begin(), sorted_.end(), number), number);
  }
  double median() const { return at(kHalf * last()); }
  /// The median of all blocks that there could be lies between these in 95 of 100 measurements: as many of n
  /// numbers are below it as a coin thrown n times shows heads.
  std::pair<double, double> sure() const {
    constexpr double kDeviations = 1.96;
    const double away = kHalf * kDeviations * std::sqrt(last() + 1);
    return {at(std::floor(kHalf * last() - away)), at(std::ceil(kHalf * last() + away))};
  }

 private:
  static constexpr double kHalf = 0.5;

  double last() const { return static_cast<double>(sorted_.size()) - 1; }
  double at(double rank) const { return sorted_[static_cast<std::size_t>(std::clamp(rank, 0.0, last()))]; }

  std::vector<double> sorted_;
};

/// What some frames took: in all, and in the steps alone.
struct Took {
  double seconds = 0, stepping = 0;
};

/// The simulation without a studio.
class Alone {
 public:
  Alone(const std::string& scene, const std::string& device, int threads)
      : device_(openDevice(device, threads)) {
    registerNodes(registry_);
    std::vector<std::string> warnings;
    simulation_ =
        std::make_unique<Simulation>(loadScene(scene, registry_, {}, warnings), *device_, log_, registry_);
    simulation_->reset();
  }
  Took advance(int frames) {
    const std::atomic<bool> never = false;
    const double before = simulation_->stepSeconds();
    const Clock::time_point start = Clock::now();
    for (int i = 0; i < frames; ++i) simulation_->advanceFrame(never, {});
    return {since(start), simulation_->stepSeconds() - before};
  }

 private:
  Registry registry_;
  Log log_;
  std::unique_ptr<Device> device_;
  std::unique_ptr<Simulation> simulation_;
};

/// The same in a studio, with somebody who gets each frame.
class Watched {
 public:
  Watched(const std::string& folder, const std::string& device, int threads)
      : studio_(optionsOf(folder, device, threads), "scene.json"), socket_(studio_.socket()) {
    socket_.ask(R"({"id": 1, "do": "run.reset"})");
    socket_.until(isFrame);
    socket_.sendText(R"({"do": "frame.seen"})");
  }
  /// Until the viewer has the last of them and the simulation stands.
  Took advance(int frames) {
    shown_ += frames;
    const Clock::time_point start = Clock::now();
    socket_.sendText(fmt::format(R"({{"do": "run.step", "frames": {}}})", frames));
    bool seen = false, stands = false, counted = false;
    Took took;
    const auto answered = socket_.until([&](const Socket::Message& message) {
      if (isFrame(message)) {
        seen = seen || Socket::headerOf(message).find("frame")->asInt() == shown_;
        socket_.sendText(R"({"do": "frame.seen"})");
      } else if (message.text) {
        const Value value = parseJson(message.data, "message");
        const Value* event = value.find("event");
        if (event == nullptr) return false;
        const Value& data = *value.find("data");
        // Where it stands the numbers are told once more. Nothing is asked of it before, but that is not
        // counted.
        counted = counted || (stands && event->asString() == "numbers");
        if (event->asString() == "status" && data.find("state")->asString() == "paused" &&
            data.find("frame")->asInt() == shown_) {
          stands = true;
          const double stepping = data.find("stepping_seconds")->asDouble();
          took.stepping = stepping - std::exchange(stepping_, stepping);
        }
      }
      if (seen && stands && took.seconds == 0) took.seconds = since(start);
      return took.seconds > 0 && counted;
    });
    if (!answered) throw std::runtime_error("the studio says nothing any more");
    return took;
  }
  /// Seconds of a core that the server's and the viewer's threads have used so far.
  double serving() { return studio_.servingSeconds(); }
  static double viewing() { return secondsOf(CLOCK_THREAD_CPUTIME_ID); }

 private:
  static StudioOptions optionsOf(const std::string& folder, const std::string& device, int threads) {
    StudioOptions options;
    options.device = device;
    options.folder = folder;
    options.threads = threads;
    return options;
  }

  RunningStudio studio_;
  Socket socket_;
  std::int64_t shown_ = 0;
  double stepping_ = 0;
};

void slowdown(int threads, int blocks, const std::string& device) {
  constexpr int kFrames = 3;  // a block
  constexpr double kPercent = 100;
  const test::TemporaryFolder folder;
  const std::string scene = folder.write("scene.json", sceneOf(kWatched, (blocks + 2) * kFrames / 30.0));
  Alone alone(scene, device, threads);
  Watched watched(folder.path(), device, threads);
  alone.advance(kFrames);
  watched.advance(kFrames);  // the machine is warm for both
  Numbers aloneMs, watchedMs, slower, steps, waits, served, viewed, counted;
  for (int i = 0; i < blocks; ++i) {
    // Both come to the same frames, now the one first, now the other, so that what drifts favours neither.
    Took without, with;
    if (i % 2 == 0) without = alone.advance(kFrames);
    const double servedBefore = watched.serving(), viewedBefore = watched.viewing();
    with = watched.advance(kFrames);
    const double serving = watched.serving() - servedBefore, viewing = watched.viewing() - viewedBefore;
    if (i % 2 != 0) without = alone.advance(kFrames);
    aloneMs.add(kMs * without.seconds / kFrames);
    watchedMs.add(kMs * with.seconds / kFrames);
    slower.add(kPercent * (with.seconds / without.seconds - 1));
    steps.add(kPercent * (with.stepping / without.stepping - 1));
    waits.add(kMs * (with.seconds - with.stepping) / kFrames);
    served.add(kMs * serving / kFrames);
    viewed.add(kMs * viewing / kFrames);
    // As if all threads of the simulation waited for each of these.
    counted.add(kPercent * (with.seconds - with.stepping + serving + viewing) / without.seconds);
  }
  const auto [min, max] = slower.sure();
  fmt::print(
      "| threads | blocks | a frame alone, ms | watched, ms | slower by | 95 % sure | its steps slower by |\n"
      "|---|---|---|---|---|---|---|\n"
      "| {} | {} | {:.1f} | {:.1f} | {:.1f} % | {:.1f} to {:.1f} % | {:.1f} % |\n\n",
      threads, blocks, aloneMs.median(), watchedMs.median(), slower.median(), min, max, steps.median());
  fmt::print(
      "| besides steps, ms a frame | server's thread, ms of a core | viewer's | all of it, if nothing else "
      "ran meanwhile |\n"
      "|---|---|---|---|\n"
      "| {:.2f} | {:.2f} | {:.2f} | {:.1f} % |\n",
      waits.median(), served.median(), viewed.median(), counted.median());
}

}  // namespace
}  // namespace weir::studio

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  const std::string beside = weir::test::weirProgram();
  if (what == "first")
    weir::studio::first(argc > 2 ? argv[2] : beside);
  else if (what == "stream")
    weir::studio::stream();
  else if (what == "slowdown")
    weir::studio::slowdown(argc > 2 ? std::atoi(argv[2]) : 0, argc > 3 ? std::max(1, std::atoi(argv[3])) : 20,
                           argc > 4 ? argv[4] : "cpu");
  else
    fmt::print("usage: weir_studio_times first [WEIR] | stream | slowdown [THREADS [BLOCKS [DEVICE]]]\n");
}
