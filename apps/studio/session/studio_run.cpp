// What the studio does about the run: what clients order and ask, and what the simulation tells them.
#include <algorithm>
#include <limits>
#include <utility>

#include "apps/studio/session/cost.h"
#include "apps/studio/session/message.h"
#include "apps/studio/session/particle_values.h"
#include "apps/studio/session/studio.h"
#include "framework/base/text.h"
#include "framework/compute/device.h"

namespace weir::studio {

namespace {

/// Frames that may be under way to a viewer; more would be shown late.
constexpr int kMaxUnseen = 2;

}  // namespace

void Studio::reset(ClientId client, const Value& message, Value& result) {
  requireWriter(client);
  if (message.find("device") != nullptr) {
    const std::string device = textMember(message, "device");
    // Kept only if it can be used: who names none gets the last one.
    if (device != device_) (void)openDevice(device, options_.threads);
    device_ = device;
  }
  const std::optional<std::string> before = reset_;
  const Value* other = message.find("scene");
  if (other != nullptr && !other->isObject()) throw usageError("'scene' is " + other->brief(), "an object");
  constexpr std::int64_t kCoarsest = 8;
  const bool changes = message.find("coarser") != nullptr;
  run(other != nullptr ? *other : scene_,
      changes ? static_cast<int>(wholeMember(message, "coarser", 1, kCoarsest)) : coarser_);
  if (reset_ != before) tell("scene", sceneValue(), client);
  result = sceneState();
  result["device"] = device_;
}

void Studio::run(const Value& scene, int coarser) {
  CheckedScene checked = checkRun(scene, coarser);
  if (!checked.scene) throw sceneError(checked.problem->find("message")->asString());
  coarser_ = coarser;
  running_ = checkRun(scene, coarser).scene;
  reset_.reset();
  // Where it is another one than is edited.
  if (!(scene == scene_))
    if (const CheckedScene edited = checkRun(scene_, coarser); edited.scene)
      reset_ = differenceOf(*running_, *edited.scene).reset;
  forgetRun();
  host_.load(std::move(checked.scene), checkRun(scene, coarser).scene, device_);
  // Who wants to see it run wants that of what takes its place, too.
  playsWhenBuilt_ = playsWhenBuilt_ && isState(HostState::kBuilding);
  if (playsWhenBuilt_) host_.play();
  // Before the simulation tells so: it is not as it was any more.
  status_["state"] = nameOf(HostState::kBuilding);
}

void Studio::forgetRun() {
  recording_.clear();
  history_.clear();
  geometry_.reset();
}

bool Studio::isState(HostState state) const {
  const Value* name = status_.find("state");
  return name != nullptr && name->asString() == nameOf(state);
}

bool Studio::needsReset() const {
  return !running_ || isState(HostState::kFailed) || isState(HostState::kFinished);
}

void Studio::play(ClientId client, const Value& message, Value& result) {
  requireWriter(client);
  if (needsReset()) reset(client, message, result);
  host_.play();
  setPlaysWhenBuilt(isState(HostState::kBuilding));
}

void Studio::pause(ClientId client, const Value&, Value&) {
  requireWriter(client);
  host_.pause();
  setPlaysWhenBuilt(false);
}

void Studio::setPlaysWhenBuilt(bool plays) {
  if (std::exchange(playsWhenBuilt_, plays) == plays) return;
  status_["plays"] = plays;
  tell("status", status_);
}

void Studio::cancel(ClientId client, const Value&, Value&) {
  requireWriter(client);
  if (!isState(HostState::kBuilding)) return;
  playsWhenBuilt_ = false;
  running_.reset();
  reset_.reset();
  forgetRun();
  host_.load(nullptr, nullptr, device_);
}

void Studio::step(ClientId client, const Value& message, Value& result) {
  constexpr std::int64_t kMaxFrames = 1'000'000;
  const std::int64_t frames =
      message.find("frames") != nullptr ? wholeMember(message, "frames", 1, kMaxFrames) : 1;
  requireWriter(client);
  if (needsReset()) reset(client, message, result);
  host_.advance(frames);
}

void Studio::goOn(ClientId client, const Value& message, Value& result) {
  requireWriter(client);
  const std::int64_t frame = wholeMember(message, "frame", 0, std::numeric_limits<std::int64_t>::max());
  if (!running_ || recording_.size() == 0)
    throw usageError("there is no run to go on from", {}, "play it first");
  CheckedScene checked = checkRun(scene_, coarser_);
  if (!checked.scene) throw sceneError(checked.problem->find("message")->asString());
  if (const auto reset = differenceOf(*running_, *checked.scene).reset)
    throw usageError(
        inQuotes(*reset) + " has changed since the run began, so it cannot go on from a frame of it",
        "changes of what may change during a run", "reset to see the others");
  running_ = checkRun(scene_, coarser_).scene;
  playsWhenBuilt_ = false;
  host_.goOn(std::move(checked.scene), checkRun(scene_, coarser_).scene, device_, frame);
  status_["state"] = nameOf(HostState::kBuilding);
  result = sceneState();
}

void Studio::pullBody(ClientId client, const Value& message, Value&) {
  requireWriter(client);
  if (!running_) throw usageError("there is no run with a body to pull", {}, "play it first");
  BodyWish wish{textMember(message, "node"), pointMember(message, "to")};
  requirePullable(*running_, wish.node);
  host_.pull(std::move(wish));
}

void Studio::releaseBody(ClientId client, const Value&, Value&) {
  requireWriter(client);
  host_.release();
}

void Studio::seek(ClientId client, const Value& message, Value& result) {
  const std::int64_t frame = wholeMember(message, "frame", 0, std::numeric_limits<std::int64_t>::max());
  const Packet packet = recording_.nearest(frame);
  result["found"] = packet != nullptr;
  if (packet) sendFrame(client, clients_[client], packet);
}

void Studio::setView(ClientId client, const Value& message, Value&) {
  requireWriter(client);
  constexpr std::int64_t kMaxParticles = 20'000'000;
  FrameView view;
  view.attribute = textMember(message, "attribute");
  view.max = wholeMember(message, "most", 1, kMaxParticles);
  host_.show(std::move(view));
}

void Studio::confirm(ClientId client, const Value&, Value& result) {
  Client& c = clients_[client];
  c.unseen = std::max(0, c.unseen - 1);
  if (const Packet next = std::exchange(c.next, nullptr)) sendFrame(client, c, next);
  result = {};
}

void Studio::answerLater(ClientId client, const Value& message, Value& result,
                         std::function<Value(const Simulation&)> f) {
  const Value* id = message.find("id");
  const auto answer = [this, client, f = std::move(f), frame = frameMember(message),
                       id = id != nullptr ? *id : Value()](Simulation* simulation) {
    Value reply = Value::object();
    reply["id"] = id;
    try {
      reply["result"] = simulation != nullptr ? f(frame ? host_.runAt(*frame) : *simulation) : Value();
    } catch (const Error& e) {
      if (e.kind() != ErrorKind::kUsage) throw;  // the simulation failed
      reply["error"] = problemOf(e);
    }
    server_.sendText(client, writeJsonLine(reply));
  };
  askHost(client, answer);
  result = {};
}

void Studio::askHost(ClientId client, QuestionQueue::Question question) {
  if (!host_.ask(client, std::move(question)))
    throw usageError("this window asks faster than the simulation answers",
                     "at most " + std::to_string(QuestionQueue::kMaxOfAClient) + " questions that wait");
}

void Studio::askParticle(ClientId client, const Value& message, Value& result) {
  const std::string node = textMember(message, "node");
  // As far as JavaScript knows whole numbers.
  constexpr std::int64_t kMaxId = (std::int64_t{1} << 53) - 1;
  const std::int64_t particle = wholeMember(message, "particle", 0, kMaxId);
  answerLater(client, message, result, [node, particle](const Simulation& simulation) {
    return particleValue(simulation, node, particle);
  });
}

void Studio::askParticles(ClientId client, const Value& message, Value& result) {
  constexpr std::int64_t kMaxRows = 1000;
  ParticlePage page;
  page.node = textMember(message, "node");
  if (message.find("sort") != nullptr) page.sort = textMember(message, "sort");
  if (message.find("descending") != nullptr) page.descending = switchMember(message, "descending");
  if (message.find("from") != nullptr)
    page.from = wholeMember(message, "from", 0, std::numeric_limits<std::int32_t>::max());
  if (message.find("count") != nullptr) page.count = wholeMember(message, "count", 1, kMaxRows);
  answerLater(client, message, result,
              [page](const Simulation& simulation) { return particlePageValue(simulation, page); });
}

void Studio::askCost(ClientId client, const Value& message, Value& result) {
  CheckedScene checked = checkRun(scene_, coarser_);
  if (!checked.scene) throw sceneError(checked.problem->find("message")->asString());
  const Value* id = message.find("id");
  const auto answer =
      [this, client, id = id != nullptr ? *id : Value(), device = device_,
       scene = std::make_shared<std::unique_ptr<Scene>>(std::move(checked.scene))](Simulation* running) {
        Value reply = Value::object();
        reply["id"] = id;
        try {
          const std::unique_ptr<Device> own = running ? nullptr : openDevice(device, options_.threads);
          reply["result"] = costOf(std::move(*scene), own ? *own : running->device(), registry_);
        } catch (const Error& e) {
          reply["error"] = problemOf(e);
        } catch (const std::exception& e) {  // it is none of the run's
          reply["error"] = problemOf(sceneError(e.what()));
        }
        server_.sendText(client, writeJsonLine(reply));
      };
  askHost(client, answer);
  result = {};
}

// What the simulation tells

void Studio::status(const Value& status) {
  const std::string& state = status.find("state")->asString();
  if (state == nameOf(HostState::kFinished) || state == nameOf(HostState::kFailed)) desk_.stopVideo();
  // Those who wait for a picture of a run that could not begin are told so.
  if (state == nameOf(HostState::kFailed)) host_.serve();
  server_.post([this, status] {
    status_ = status;
    status_["recorded_every"] = recording_.every();
    status_["coarser"] = coarser_;
    if (!isState(HostState::kBuilding)) playsWhenBuilt_ = false;
    status_["plays"] = playsWhenBuilt_;
    tell("status", status_);
  });
}

void Studio::numbers(const Value& numbers) {
  server_.post([this, numbers] {
    history_.add(numbers);
    tell("numbers", numbers);
  });
}

void Studio::geometry(const Packet& packet) {
  server_.post([this, packet] {
    geometry_ = packet;
    for (const auto& [client, unused] : clients_) server_.sendBinary(client, packet);
  });
}

void Studio::frame(std::int64_t frame, const Packet& packet) {
  server_.post([this, frame, packet] {
    recording_.add(frame, packet);
    for (auto& [id, client] : clients_) sendFrame(id, client, packet);
  });
}

void Studio::reached(Simulation& simulation) {
  desk_.frame(simulation);
}

void Studio::wentBack(std::int64_t frame) {
  server_.post([this, frame] { recording_.forgetAfter(frame); });
}

void Studio::serve(Simulation* simulation) {
  desk_.serve(simulation);
}

void Studio::leaving() {
  desk_.leave();
}

void Studio::pastChanging() {
  pastDesk_.change();
}

void Studio::pastLeaving() {
  pastDesk_.change();
  pastDesk_.leave();
}

void Studio::sendFrame(ClientId id, Client& client, const Packet& packet) {
  if (!client.wantsFrames) return;
  if (client.unseen >= kMaxUnseen) {
    client.next = packet;
    return;
  }
  ++client.unseen;
  server_.sendBinary(id, packet);
}

}  // namespace weir::studio
