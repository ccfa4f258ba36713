#include "framework/run/checkpoint.h"

#include <fmt/format.h>
#include <unistd.h>

#include <charconv>
#include <cmath>
#include <set>

#include "framework/base/build_info.h"
#include "framework/base/digest.h"
#include "framework/base/file_output.h"
#include "framework/base/text.h"
#include "framework/graph/given_data.h"
#include "framework/run/checkpoint_parts.h"
#include "framework/run/saved_outputs.h"
#include "framework/scene/scene_file.h"

namespace weir {

namespace fs = std::filesystem;

namespace {

/// Enough to see what is wrong.
constexpr std::size_t kMaxDifferences = 8;

std::string shown(const Value* value) {
  return value != nullptr ? value->brief() : "nothing";
}

/// The paths at which two values differ, with both sides.
void compare(const std::string& path, const Value* saved, const Value* present,
             std::vector<std::string>& differences) {
  if (saved != nullptr && present != nullptr && saved->isObject() && present->isObject()) {
    std::set<std::string> names;
    for (const Value* value : {saved, present})
      for (const auto& [name, member] : value->asObject()) names.insert(name);
    for (const std::string& name : names)
      compare(path.empty() ? name : path + "." + name, saved->find(name), present->find(name), differences);
    return;
  }
  const bool equal = saved != nullptr && present != nullptr && *saved == *present;
  if (!equal) differences.push_back(fmt::format("{}: {} then, {} now", path, shown(saved), shown(present)));
}

/// The files that parameters of `owner` name.
void addInputs(const Configurable& owner, const std::string& prefix, Value& inputs) {
  for (const Property* property : owner.properties()) {
    const std::string name = prefix + "." + std::string(property->name());
    const auto* path = dynamic_cast<const Param<FilePath>*>(property);
    std::error_code ignored;
    // What is not a file is refused by whoever reads it, and says so better.
    if (path == nullptr || !fs::is_regular_file(path->get().resolved, ignored)) continue;
    const FileDigest digest = digestOfFile(path->get().resolved);
    inputs[name]["file"] = path->get().text;
    inputs[name]["bytes"] = static_cast<std::int64_t>(digest.bytes);
    inputs[name]["digest"] = static_cast<std::int64_t>(digest.digest);
  }
}

void addGiven(const Node& node, Value& inputs) {
  const auto* given = dynamic_cast<const GivenData*>(&node);
  const std::optional<std::uint32_t> digest = given != nullptr ? given->givenDigest() : std::nullopt;
  if (!digest) return;
  inputs[node.name()]["arrays"] = true;
  inputs[node.name()]["digest"] = static_cast<std::int64_t>(*digest);
}

void compareInputs(const std::string& savedText, const std::string& presentText,
                   std::vector<std::string>& differences) {
  const Value saved = parseJson(savedText, "the checkpoint's list of files");
  const Value present = parseJson(presentText, "the list of files");
  for (const auto& [name, file] : present.asObject()) {
    const Value* before = saved.find(name);
    if (before != nullptr && *before == file) continue;
    differences.push_back(file.find("arrays") != nullptr ? name + ": the arrays are others now"
                                                         : fmt::format("{}: the file {} is another now", name,
                                                                       shown(file.find("file"))));
  }
}

std::string backEndOf(const Device& device) {
  return device.kind() == DeviceKind::kCpu ? "cpu" : "cuda";
}

/// States are the same on all back ends, but what they compute is not, bit by bit.
void tellOfOtherBackEnd(const Checkpoint& checkpoint, const Simulation& simulation) {
  const std::string present = backEndOf(simulation.device());
  if (checkpoint.device == present) return;
  simulation.log().warn(
      fmt::format("the checkpoint was made on {} and goes on on {}, with other bits than there from here on",
                  checkpoint.device, present));
}

}  // namespace

std::string checkpointScene(const Scene& scene) {
  Value all = sceneToValue(scene);
  Value chosen = Value::object();
  for (const char* part : {"world", "nodes", "links"})
    if (const Value* found = std::as_const(all).find(part)) chosen[part] = *found;
  if (Value* world = chosen.find("world"))
    std::erase_if(world->asObject(), [](const auto& member) { return member.first == "duration"; });
  return writeJson(chosen);
}

std::string checkpointInputs(const Scene& scene) {
  Value inputs = Value::object();
  for (const auto& node : scene.graph.nodes()) {
    addInputs(*node, node->name(), inputs);
    addGiven(*node, inputs);
    if (PipelineBase* pipeline = node->pipeline())
      for (const auto& module : pipeline->modules())
        addInputs(*module, node->name() + "." + module->name(), inputs);
  }
  return writeJson(inputs);
}

void checkBelongs(const Checkpoint& checkpoint, const Simulation& simulation) {
  std::vector<std::string> differences;
  const auto compareTexts = [&](const char* what, std::string_view saved, std::string_view present) {
    if (saved != present) differences.push_back(fmt::format("{}: {} then, {} now", what, saved, present));
  };
  compareTexts("version of the program", checkpoint.version, version());
  const Value saved = parseJson(checkpoint.scene, "the checkpoint's scene");
  const Value present = parseJson(checkpointScene(simulation.scene()), "the scene");
  compare("", &saved, &present, differences);
  // Where another file is named, that is what to say.
  if (differences.empty())
    compareInputs(checkpoint.inputs, checkpointInputs(simulation.scene()), differences);
  if (differences.empty()) return tellOfOtherBackEnd(checkpoint, simulation);
  const std::size_t more = differences.size() - std::min(differences.size(), kMaxDifferences);
  differences.resize(differences.size() - more);
  throw ioError("the checkpoint is of another run: " + joinNames(differences, "; ") +
                    (more > 0 ? fmt::format("; and {} more", more) : ""),
                "the same scene, the same files and the same version",
                "the duration, outputs and section render may change");
}

CheckpointInterval CheckpointInterval::parse(const std::string& text) {
  double number = 0;
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  const std::string_view unit(rest, static_cast<std::size_t>(end - rest));
  CheckpointInterval interval;
  if (error == std::errc() && std::isfinite(number) && number > 0) {
    if (unit == "s") interval.seconds = number;
    if (unit.empty() && number >= 1 && number == std::floor(number) && number < 1e15)
      interval.frames = static_cast<std::int64_t>(number);
  }
  if (!interval.seconds && !interval.frames)
    throw usageError("--checkpoint-every " + printable(text) + " is not a valid interval",
                     "a number of frames such as 20, or of seconds such as 90s");
  return interval;
}

Checkpoints::Checkpoints(fs::path file, CheckpointInterval interval, std::unique_ptr<CheckpointStore> store)
    : file_(std::move(file)), interval_(interval), store_(std::move(store)) {}

fs::path Checkpoints::previousOf(const fs::path& file) {
  return fs::path(file).replace_extension(".previous" + file.extension().string());
}

void Checkpoints::begin(const Simulation& simulation) {
  checkWritable(file_);
  inputs_ = checkpointInputs(simulation.scene());
  writtenAt_ = std::chrono::steady_clock::now();
}

bool Checkpoints::isDue(const Simulation& simulation) const {
  if (interval_.frames) return simulation.frame() > 0 && simulation.frame() % *interval_.frames == 0;
  const std::chrono::duration<double> since = std::chrono::steady_clock::now() - writtenAt_;
  return since.count() >= *interval_.seconds;
}

Checkpoint Checkpoints::about(const Simulation& simulation) const {
  return {.version = std::string(version()),
          .scene = checkpointScene(simulation.scene()),
          .device = backEndOf(simulation.device()),
          .inputs = inputs_,
          .state = {}};
}

void Checkpoints::write(Simulation& simulation, std::span<Observer* const> observers) {
  Checkpoint checkpoint = about(simulation);
  const StateWriter state(checkpoint.state);
  // First, as they wait until all is on the disk.
  saveOutputs(observers, state.in(kOutputStates));
  simulation.save(state);
  put(checkpoint);
  removeUnnamedParts(*store_, file_);  // of a run on several ranks before
  syncFolderOf(file_);
}

bool Checkpoints::put(const Checkpoint& checkpoint) {
  // All names are made first: where memory ends in one, no draft is left.
  const fs::path draft = file_.string() + fmt::format(".{}.part", ::getpid());
  const fs::path previous = previousOf(file_), link = previous.string() + ".part";
  std::error_code ignored;
  fs::remove(draft, ignored);
  store_->write(draft, checkpoint);
  // At every moment there is a whole checkpoint at the path.
  fs::remove(link, ignored);
  fs::create_hard_link(file_, link, ignored);
  if (!ignored) fs::rename(link, previous, ignored);
  const bool keepsLast = !ignored;
  if (!keepsLast) fs::remove(link, ignored);
  std::error_code error;
  fs::rename(draft, file_, error);
  if (error) {
    fs::remove(draft, ignored);
    throw ioError("cannot write the checkpoint: " + error.message()).at({.file = file_.string()});
  }
  writtenAt_ = std::chrono::steady_clock::now();
  return keepsLast;
}

}  // namespace weir
