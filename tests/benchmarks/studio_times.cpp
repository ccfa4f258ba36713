// What the studio costs and how fast it is, over real connections on this machine:
//
//   weir_studio_times first [WEIR]      from the start of the program to the first picture's particles
//   weir_studio_times stream            frames a second and latency of the stream, without steps between them
//   weir_studio_times slowdown [THREADS [PAIRS]]  a run of 50 000 particles with and without somebody who
//                                       watches, in turns
//
// Each prints a line of a Markdown table per case. "stream" asks for the present frame again and again: it is
// copied, quantised, sent and received each time. Its latency is that of one request alone, its rate that
// with two on their way, as for a page.
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/wait.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <string>
#include <vector>

#include "framework/run/run.h"
#include "tests/apps/studio/web_client.h"

namespace weir::studio {
namespace {

using Clock = std::chrono::steady_clock;

double since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// A cube of about so many particles that falls apart in a tank.
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
    socket.sendText(R"({"do": "view.set", "attribute": "speed", "most": 200000})");
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
  for (int i = 0; i < kFrames; ++i) {
    receive();
    if (i + kUnderWay < kFrames) request();
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

constexpr double kWatched = 5e4, kDuration = 0.3;

double runAlone(const std::string& scene, int threads) {
  Registry registry;
  registerNodes(registry);
  Log log;
  const auto device = openDevice("cpu", threads);
  std::vector<std::string> warnings;
  Simulation simulation(loadScene(scene, registry, {}, warnings), *device, log, registry);
  Clock::time_point start;
  RunOptions options;
  options.onProgress = [&, begun = false](const Simulation&) mutable {
    if (!begun) start = Clock::now();  // frame 0 is there
    begun = true;
  };
  runSimulation(simulation, {}, options);
  return since(start);
}

double runWatched(const std::string& folder, int threads) {
  StudioOptions options;
  options.folder = folder;
  options.threads = threads;
  const RunningStudio studio(options, "scene.json");
  const Socket socket = studio.socket();
  socket.ask(R"({"id": 1, "do": "run.reset"})");
  socket.until(isFrame);
  socket.sendText(R"({"do": "frame.seen"})");
  const Clock::time_point start = Clock::now();
  socket.sendText(R"({"id": 2, "do": "run.play"})");
  socket.state("finished");
  return since(start);
}

void slowdown(int threads, int pairs) {
  const test::TemporaryFolder folder;
  const std::string scene = folder.write("scene.json", sceneOf(kWatched, kDuration));
  std::vector<double> alone, watched, slower;
  runAlone(scene, threads);  // the machine is warm for both
  for (int i = 0; i < pairs; ++i) {
    // Now the one first, now the other, so that what drifts favours neither.
    if (i % 2 == 0) alone.push_back(runAlone(scene, threads));
    watched.push_back(runWatched(folder.path(), threads));
    if (i % 2 != 0) alone.push_back(runAlone(scene, threads));
    slower.push_back(100 * (watched.back() / alone.back() - 1));
  }
  const auto at = [](std::vector<double>& values, double part) {
    std::sort(values.begin(), values.end());
    return values[static_cast<std::size_t>(part * static_cast<double>(values.size() - 1) + 0.5)];
  };
  constexpr double kQuarter = 0.25, kHalf = 0.5;
  fmt::print(
      "| threads | pairs | alone, s | watched, s | slower by, median | quartiles "
      "|\n|---|---|---|---|---|---|\n"
      "| {} | {} | {:.3f} | {:.3f} | {:.1f} % | {:.1f} to {:.1f} % |\n",
      threads, pairs, at(alone, kHalf), at(watched, kHalf), at(slower, kHalf), at(slower, kQuarter),
      at(slower, 1 - kQuarter));
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
    weir::studio::slowdown(argc > 2 ? std::atoi(argv[2]) : 0, argc > 3 ? std::max(1, std::atoi(argv[3])) : 3);
  else
    fmt::print("usage: weir_studio_times first [WEIR] | stream | slowdown [THREADS [PAIRS]]\n");
}
