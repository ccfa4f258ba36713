#include "python/src/python_simulation.h"

#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <atomic>
#include <cmath>

#include "framework/base/text.h"
#include "framework/run/guarded_checkpoint.h"
#include "framework/run/guarded_output.h"
#include "framework/run/output_paths.h"
#include "framework/run/run.h"
#include "framework/run/series.h"
#include "framework/run/statistics.h"
#include "python/src/errors.h"
#include "python/src/numpy_arrays.h"
#include "python/src/stream_order.h"
#include "python/src/values.h"

namespace weir::python {

namespace {

constexpr const char* kSeries = "series";

std::string quotedOption(const std::string& name, const std::string& path) {
  return name + "=" + inQuotes(path);
}

/// One observer for each kind of output that was asked for.
std::vector<std::unique_ptr<Observer>> makeObservers(const Registry& registry,
                                                     std::map<std::string, std::string> asked) {
  std::vector<std::unique_ptr<Observer>> observers;
  std::vector<std::string> known{kSeries};
  for (const auto& [service, kind, source] : registry.createServices<OutputKind>()) {
    OutputPaths paths;
    for (const OutputOption& option : optionsOf(*kind, service, source)) {
      known.push_back(option.name);
      const auto path = asked.find(option.name);
      if (path == asked.end()) continue;
      checkOutputPath(option, path->second, quotedOption(option.name, path->second));
      paths[option.name] = path->second;
      asked.erase(path);
    }
    if (!paths.empty()) observers.push_back(makeGuardedObserver(*kind, service, source, paths));
  }
  if (const auto path = asked.find(kSeries); path != asked.end()) {
    const OutputOption option{.name = kSeries, .argument = "FILE.jsonl", .extensions = {".jsonl"}, .doc = ""};
    checkOutputPath(option, path->second, quotedOption(kSeries, path->second));
    observers.push_back(std::make_unique<SeriesOutput>(path->second));
    asked.erase(path);
  }
  if (!asked.empty())
    throw usageError("there is no output " + inQuotes(asked.begin()->first), joinNames(known),
                     didYouMean(asked.begin()->first, known));
  return observers;
}

using Numbers = std::vector<float>;

/// With `eye`, `target` and `up` of three numbers each, and `fov` of one, in degrees; all of them checked.
std::optional<LiveCamera> cameraOf(const std::optional<std::map<std::string, Numbers>>& given) {
  if (!given) return std::nullopt;
  const auto vector = [&](const char* name) {
    const Numbers& v = given->at(name);
    return Vec3f{v.at(0), v.at(1), v.at(2)};
  };
  return LiveCamera{.eye = vector("eye"),
                    .target = vector("target"),
                    .up = vector("up"),
                    .fovDegrees = given->at("fov").at(0)};
}

}  // namespace

PythonSimulation::PythonSimulation(std::shared_ptr<PythonScene> scene, const std::string& device, int threads,
                                   bool deterministic)
    : scene_(std::move(scene)) {
  constexpr int kMaxThreads = 1024;
  if (threads < 0 || threads > kMaxThreads)
    throw usageError("found threads=" + std::to_string(threads),
                     "1 to " + std::to_string(kMaxThreads) + ", or 0 for one a core");
  number_ = scene_->simulate(device, threads);
  scene_->device()->setDeterministic(deterministic);
  reset();
}

bool PythonSimulation::isOpen() const {
  return scene_->simulation() != nullptr && scene_->simulationNumber() == number_;
}

Simulation& PythonSimulation::simulation() const {
  if (!isOpen())
    throw usageError("the simulation is closed", "a new weir.Simulation of the scene",
                     "a scene has one simulation at a time; a newer one closes the one before");
  static_cast<void>(scene_->scene());  // refused while another thread is stepping
  return *scene_->simulation();
}

Simulation& PythonSimulation::ready() const {
  Simulation& present = simulation();
  if (failed_)
    throw usageError("the simulation has failed within a step", "reset(), which goes back to time 0");
  if (!scene_->staleBecause.empty())
    throw usageError("the simulation cannot go on after " + scene_->staleBecause,
                     "reset(), which goes back to time 0",
                     "parameters that may change during a run say so in their help");
  return present;
}

void PythonSimulation::stepping(const std::function<void()>& f) {
  const PythonScene::Stepping guard(*scene_);
  waitForStream(simulation().device(), kLegacyStream);
  inCallback_ = false;
  try {
    const nb::gil_scoped_release released;
    f();
  } catch (...) {
    failed_ = failed_ || !inCallback_;
    throw;
  }
}

void PythonSimulation::reset() {
  Simulation& present = simulation();
  pictures_.reset();  // meshes may become others
  // What it throws leaves nodes half set up.
  failed_ = true;
  scene_->staleBecause.clear();
  stepping([&] { present.reset(); });
  failed_ = false;
}

bool PythonSimulation::callBack(const nb::object& callback, const nb::object& self) {
  const nb::gil_scoped_acquire gil;
  inCallback_ = true;
  if (PyErr_CheckSignals() != 0) throw nb::python_error();
  const bool ends = !callback.is_none() && callback(self).ptr() == Py_True;
  waitForStream(simulation().device(), kLegacyStream);
  inCallback_ = false;
  return ends;
}

bool PythonSimulation::atEnd() const {
  const Simulation& present = simulation();
  const Clock& clock = present.clock();
  constexpr double kRounding = 1e-9;  // of a frame
  return present.frame() >= clock.frameCount() &&
         present.time() >= clock.endAfterFrame(present.frame()) - kRounding / present.scene().world.frameRate;
}

void PythonSimulation::step() {
  Simulation& present = ready();
  if (atEnd())
    throw usageError("the simulation is at its end, at " + Value(present.time()).brief() + " s",
                     "steps before the end of its duration", "a longer duration: simulation.duration = …");
  std::atomic<bool> stop = false;
  const auto once = [&] { stop = true; };
  stepping([&] {
    if (present.frame() < present.clock().frameCount())
      present.advanceFrame(stop, once);
    else
      present.finishRest(stop, once);
  });
  checkSignals();
}

bool PythonSimulation::advance(std::int64_t frames, const nb::object& callback, const nb::object& self) {
  Simulation& present = ready();
  const std::int64_t left = present.clock().frameCount() - present.frame();
  if (frames < 0 || frames > left)
    throw usageError("found frames=" + std::to_string(frames),
                     "0 to " + std::to_string(left) + ", the frames that are left of the duration",
                     "a longer duration: simulation.duration = …");
  std::atomic<bool> stop = false;
  stepping([&] {
    for (std::int64_t i = 0; i < frames && !stop; ++i)
      present.advanceFrame(stop, [&] { stop = callBack(callback, self); });
  });
  return !stop;
}

void PythonSimulation::setDuration(double seconds) {
  Value value = Value::object();
  value["duration"] = seconds;
  static_cast<void>(simulation());
  scene_->assign({}, value);
}

std::int64_t PythonSimulation::lastFrameFor(double seconds) {
  const Simulation& present = simulation();
  if (!(seconds >= 0)) throw usageError("found a duration of " + Value(seconds).brief() + " s", "at least 0");
  constexpr double kRounding = 1e-6;  // of a frame
  const double rate = present.scene().world.frameRate;
  const std::int64_t last = std::llround(std::ceil((present.time() + seconds) * rate - kRounding));
  const double end = double(last) / rate;
  if (end > duration()) setDuration(end);
  return last;
}

Checkpoint PythonSimulation::resumedBy(const RunRequest& request) {
  if (request.duration)
    throw usageError("both resume and duration are given",
                     "resume alone, which goes on to the scene's duration");
  pictures_.reset();
  Checkpoint from = checkpointIn("resume", request.resume);
  scene_->staleBecause.clear();
  failed_ = false;  // until it throws
  return from;
}

std::optional<Checkpoints> PythonSimulation::checkpointsOf(const RunRequest& request) const {
  if (request.checkpoint.empty()) return std::nullopt;
  return std::make_optional<Checkpoints>(
      request.checkpoint, CheckpointInterval::parse(request.checkpointEvery),
      checkpointStoreOf(simulation().registry(), quotedOption("checkpoint", request.checkpoint),
                        request.checkpoint));
}

bool PythonSimulation::run(const RunRequest& request) {
  const bool resumes = !request.resume.empty();
  Simulation& present = resumes ? simulation() : ready();
  const auto observers = makeObservers(present.registry(), request.outputs);
  std::vector<Observer*> watching;
  for (const auto& observer : observers) watching.push_back(observer.get());
  RunOptions options;
  std::optional<Checkpoint> from;
  if (resumes) options.resume = &from.emplace(resumedBy(request)).state;
  std::optional<Checkpoints> checkpoints = checkpointsOf(request);
  if (checkpoints) options.checkpoints = &*checkpoints;
  options.proceed = true;
  if (request.duration) options.lastFrame = lastFrameFor(*request.duration);
  std::atomic<bool> stop = false;
  options.stop = &stop;
  std::exception_ptr interrupted;
  std::int64_t seen = present.stepsDone();
  bool resumed = !resumes;  // whether it is where the steps begin
  const auto afterStep = [&] {
    try {
      if (callBack(request.callback, request.self)) stop = true;
    } catch (const nb::python_error&) {
      // The outputs end as after any interruption, with all that there was, before it travels on.
      interrupted = std::current_exception();
      stop = true;
    }
  };
  options.onProgress = [&](const Simulation& s) {
    const bool stepped = resumed && s.stepsDone() != seen;
    resumed = true;
    seen = s.stepsDone();
    if (stepped) afterStep();
  };
  stepping([&] {
    if (!resumes && !present.atFrame()) present.advanceFrame(stop, afterStep);
    seen = present.stepsDone();
    if (!stop) runSimulation(present, watching, options);
  });
  if (interrupted) std::rethrow_exception(interrupted);
  return !stop;
}

void PythonSimulation::refresh() {
  Simulation& present = ready();
  stepping([&] { present.refresh(); });
}

Checkpoint PythonSimulation::checkpointIn(const std::string& option, const std::string& file) const {
  const Simulation& present = simulation();
  return readCheckpoint(*checkpointStoreOf(present.registry(), quotedOption(option, file), file), file,
                        present);
}

void PythonSimulation::save(const std::string& file) {
  Simulation& present = ready();
  if (!present.atFrame())
    throw usageError("the simulation is between two frames, and checkpoints are of frames",
                     "save() after advance() or run(), which end at a frame");
  Checkpoints checkpoints(file, {}, checkpointStoreOf(present.registry(), quotedOption("save", file), file));
  stepping([&] { present.refresh(); });
  const PythonScene::Stepping guard(*scene_);
  const nb::gil_scoped_release released;
  checkpoints.begin(present);
  checkpoints.write(present, {});
}

void PythonSimulation::resume(const std::string& file) {
  Simulation& present = simulation();
  const Checkpoint from = checkpointIn("resume", file);
  pictures_.reset();
  failed_ = true;  // until it is whole
  stepping([&] { present.resume(StateReader(from.state)); });
  scene_->staleBecause.clear();
  failed_ = false;
}

nb::object PythonSimulation::render(const LivePictureOptions& options) {
  Simulation& present = ready();
  stepping([&] { present.refresh(); });
  if (!pictures_) pictures_ = std::make_unique<Pictures>(present);
  LivePixels pixels;
  try {
    const PythonScene::Stepping guard(*scene_);
    const nb::gil_scoped_release released;
    pixels = pictures_->draw(present, options);
  } catch (...) {
    pictures_.reset();  // it may be of no more use
    throw;
  }
  return toNumpy(std::move(pixels.rgb), {std::size_t(pixels.height), std::size_t(pixels.width), 3});
}

void PythonSimulation::close() {
  pictures_.reset();
  if (isOpen()) scene_->endSimulation();
}

std::uintptr_t PythonSimulation::stream() const {
  return streamOf(simulation().device());
}

nb::object PythonSimulation::statistics() {
  Simulation& present = simulation();
  const RunEnd end = failed_ ? RunEnd::kFailed : atEnd() ? RunEnd::kFinished : RunEnd::kInterrupted;
  return toPython(runStatistics(present, end), false);
}

void bindSimulation(nb::module_& m) {
  using S = PythonSimulation;
  nb::class_<S>(m, "Simulation", "What weir.Simulation is made of.")
      .def(nb::init<std::shared_ptr<PythonScene>, const std::string&, int, bool>(), nb::arg("scene"),
           nb::arg("device"), nb::arg("threads"), nb::arg("deterministic"))
      .def("reset", &S::reset)
      .def("step", &S::step)
      .def("advance", &S::advance, nb::arg("frames"), nb::arg("callback").none(), nb::arg("self"))
      .def(
          "run",
          [](S& s, std::optional<double> duration, std::map<std::string, std::string> outputs,
             std::string checkpoint, std::string checkpointEvery, std::string resume, nb::object callback,
             nb::object self) {
            return s.run({duration, std::move(outputs), std::move(checkpoint), std::move(checkpointEvery),
                          std::move(resume), std::move(callback), std::move(self)});
          },
          nb::arg("duration").none(), nb::arg("outputs"), nb::arg("checkpoint"), nb::arg("checkpoint_every"),
          nb::arg("resume"), nb::arg("callback").none(), nb::arg("self"))
      .def("refresh", &S::refresh)
      .def("save", &S::save, nb::arg("file"))
      .def("resume", &S::resume, nb::arg("file"))
      .def(
          "render",
          [](S& s, int width, int height, int samples, std::optional<std::map<std::string, Numbers>> camera) {
            return s.render(
                {.camera = cameraOf(camera), .width = width, .height = height, .samplesPerAxis = samples});
          },
          nb::arg("width"), nb::arg("height"), nb::arg("samples"), nb::arg("camera").none(),
          nb::sig("def render(self, width: int, height: int, samples: int, camera: dict | None) -> "
                  "numpy.ndarray"))
      .def("close", &S::close)
      .def("statistics", &S::statistics, nb::sig("def statistics(self) -> dict"))
      .def_prop_ro("is_open", &S::isOpen)
      .def_prop_ro("at_end", &S::atEnd)
      .def_prop_ro("time", &S::time)
      .def_prop_rw("duration", &S::duration, &S::setDuration)
      .def_prop_ro("frame", &S::frame)
      .def_prop_ro("steps", &S::steps)
      .def_prop_ro("device", &S::deviceName)
      .def_prop_ro("stream", &S::stream);
}

}  // namespace weir::python
