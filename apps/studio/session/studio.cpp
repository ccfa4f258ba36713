#include "apps/studio/session/studio.h"

#include <malloc.h>

#include <chrono>
#include <limits>
#include <utility>

#include "apps/studio/server/kept_token.h"
#include "apps/studio/session/draft.h"
#include "apps/studio/session/message.h"
#include "apps/studio/session/preview.h"
#include "apps/studio/session/versions.h"
#include "framework/base/build_info.h"
#include "framework/base/text.h"
#include "framework/compute/device.h"

namespace weir::studio {

namespace fs = std::filesystem;

namespace {

std::string_view nameOf(LogLevel level) {
  switch (level) {
    case LogLevel::kDebug:
      return "debug";
    case LogLevel::kInfo:
      return "info";
    case LogLevel::kWarning:
      return "warning";
    case LogLevel::kError:
      return "error";
  }
  return "error";
}

Value stringsValue(const std::vector<std::string>& texts) {
  Value list = Value::array();
  for (const std::string& text : texts) list.push(text);
  return list;
}

/// Somebody's file would be lost.
class FileExists : public Error {
 public:
  explicit FileExists(const std::string& path)
      : Error(
            usageError("there is a file " + inQuotes(path) + " already", "another name, or to replace it")) {}
};

ServerOptions serverOptions(const StudioOptions& options, Log& log) {
  const KeptToken kept =
      keptToken(options.tokens, {options.folder, options.host, options.port}, options.newToken);
  if (!kept.problem.empty()) log.warn("the studio has a new token: " + kept.problem);
  return {.host = options.host,
          .port = options.port,
          .token = kept.token,
          .largestUpload = options.largestUpload,
          .largestMessage = kLargestSceneFile,
          .maxWaitingBytes = options.maxWaitingBytes};
}

}  // namespace

Studio::Studio(StudioOptions options, const Registry& registry, Log& log)
    : options_(std::move(options)),
      registry_(registry),
      log_(log),
      folder_(options_.folder),
      sceneFiles_(folder_, options_.sceneFolders),
      device_(options_.device),
      recording_(options_.maxRecordedBytes),
      server_(serverOptions(options_, log), *this),
      desk_(registry, [this](const VideoStatus& video) { tellVideo(video); }),
      pastDesk_(registry, [this](const VideoStatus& video) { tellVideo(video); }),
      host_(registry, log, *this, options_.threads, options_.maxRecordedBytes / 2) {
  scene_["weir"] = kSceneVersion;
  scene_["nodes"] = Value::object();
  saved_ = scene_;
  findDraft();
}

Studio::~Studio() = default;

void Studio::open(const std::string& path) {
  readScene(folder_, path);
  takeScene(saved_, path, 0);
  findDraft();
}

void Studio::showLog(LogLevel level, std::string_view message) {
  Value line = Value::object();
  line["level"] = nameOf(level);
  line["text"] = message;
  server_.post([this, line = std::move(line)] { tell("log", line); });
}

void Studio::requireNew(const std::string& path) const {
  std::error_code ignored;
  if (fs::exists(fs::symlink_status(folder_.resolve(path), ignored))) throw FileExists(path);
}

// Clients

void Studio::opened(ClientId client) {
  clients_[client];
  if (!writer_) writer_ = client;
}

void Studio::closed(ClientId client) {
  clients_.erase(client);
  desk_.forget(client);
  pastDesk_.forget(client);
  host_.forget(client);
  giveBackMemory();
  if (writer_ != client) return;
  host_.release();
  writer_.reset();
  if (clients_.empty()) return;
  writer_ = clients_.begin()->first;
  tellRole(*writer_);
}

/// What waited for a client that was slow, up to tens of megabytes, malloc() keeps as free for good where
/// something small lies behind it.
void Studio::giveBackMemory() {
  constexpr std::chrono::seconds kPause{10};
  const auto now = std::chrono::steady_clock::now();
  if (now - memoryGivenBack_ < kPause) return;
  memoryGivenBack_ = now;
  ::malloc_trim(0);
}

const std::map<std::string, Studio::Command, std::less<>>& Studio::commands() {
  static const std::map<std::string, Command, std::less<>> kCommands{
      {"hello", &Studio::hello},
      {"scene.set", &Studio::setScene},
      {"scene.new", &Studio::newScene},
      {"draft.drop", &Studio::dropDraft},
      {"scene.open", &Studio::openScene},
      {"scene.save", &Studio::saveScene},
      {"scene.versions", &Studio::listVersions},
      {"scene.version", &Studio::showVersion},
      {"scene.cost", &Studio::askCost},
      {"run.play", &Studio::play},
      {"run.pause", &Studio::pause},
      {"run.cancel", &Studio::cancel},
      {"run.step", &Studio::step},
      {"run.reset", &Studio::reset},
      {"run.go_on", &Studio::goOn},
      {"body.pull", &Studio::pullBody},
      {"body.release", &Studio::releaseBody},
      {"run.seek", &Studio::seek},
      {"view.set", &Studio::setView},
      {"frame.seen", &Studio::confirm},
      {"role.claim", &Studio::claim},
      {"particle", &Studio::askParticle},
      {"particles", &Studio::askParticles},
      {"stream.set", &Studio::setStream},
      {"picture", &Studio::askPicture},
      {"video.start", &Studio::startVideo},
      {"video.camera", &Studio::moveVideo},
      {"video.stop", &Studio::stopVideo}};
  return kCommands;
}

void Studio::message(ClientId client, std::string_view text) {
  // Most of what others than the writer ask is short; the rest is refused before it takes any memory.
  constexpr std::size_t kMaxOfAViewer = 64 << 10;
  Value reply = Value::object();
  if (const auto id = idOf(text)) reply["id"] = *id;
  try {
    if (text.size() > kMaxOfAViewer) requireWriter(client);
    const Value message = readMessage(text);
    if (const Value* id = message.find("id")) reply["id"] = *id;
    const std::string name = textMember(message, "do");
    const auto command = commands().find(name);
    if (command == commands().end()) {
      std::vector<std::string> names;
      for (const auto& [known, unused] : commands()) names.push_back(known);
      throw usageError("there is no command " + inQuotes(name), joinNames(names), didYouMean(name, names));
    }
    Value result = Value::object();
    (this->*command->second)(client, message, result);
    if (result.isNull()) return;  // the answer comes later
    reply["result"] = std::move(result);
  } catch (const FileExists& e) {
    reply["error"] = problemOf(e);
    reply["error"]["exists"] = true;
  } catch (const Error& e) {
    reply["error"] = problemOf(e);
  }
  server_.sendText(client, writeJsonLine(reply));
}

double Studio::shareOf(ClientId client) const {
  constexpr double kWriter = 0.05, kViewer = 0.01;
  return writer_ == client ? kWriter : kViewer;
}

void Studio::tell(const std::string& event, Value data, std::optional<ClientId> except) {
  Value message = Value::object();
  message["event"] = event;
  message["data"] = std::move(data);
  const std::string text = writeJsonLine(message);
  for (const auto& [client, unused] : clients_)
    if (client != except) server_.sendText(client, text);
}

void Studio::tellRole(ClientId client) {
  Value message = Value::object();
  message["event"] = "role";
  message["data"] = writer_ == client ? "writer" : "viewer";
  server_.sendText(client, writeJsonLine(message));
}

void Studio::requireWriter(ClientId client) const {
  if (writer_ != client)
    throw usageError("another window has the pen", "watching", "take the pen to make changes here");
}

void Studio::hello(ClientId client, const Value&, Value& result) {
  static const std::string kServer = randomToken();
  result["version"] = version();
  result["server"] = kServer;
  result["role"] = writer_ == client ? "writer" : "viewer";
  Value devices = Value::array();
  for (const DeviceInfo& device : listDevices()) {
    Value v = Value::object();
    v["name"] = device.name;
    v["description"] = device.description;
    devices.push(std::move(v));
  }
  result["devices"] = std::move(devices);
  result["device"] = device_;
  result["scene"] = sceneValue();
  result["status"] = status_;
  Value pictures = Value::object();
  if (const auto problem = desk_.problem()) pictures["problem"] = problemOf(*problem);
  pictures["videos"] = stringsValue(desk_.videoExtensions());
  result["pictures"] = std::move(pictures);
  result["video"] = videoValue(videoDesk().video());
  result["history"] = history_.value();
  result["numbers"] = history_.last();
  if (geometry_) server_.sendBinary(client, geometry_);
  if (const Packet last = recording_.nearest(std::numeric_limits<std::int64_t>::max()))
    sendFrame(client, clients_[client], last);
}

void Studio::claim(ClientId client, const Value&, Value&) {
  if (writer_ == client) return;
  host_.release();
  const std::optional<ClientId> before = std::exchange(writer_, client);
  if (before) tellRole(*before);
  tellRole(client);
}

// The scene

Value Studio::sceneState() const {
  Value v = Value::object();
  v["path"] = path_;
  v["revision"] = revision_;
  v["changed"] = !(scene_ == saved_);
  if (problem_) v["problem"] = *problem_;
  v["warnings"] = stringsValue(warnings_);
  if (reset_) v["reset"] = *reset_;
  return v;
}

Value Studio::sceneValue() const {
  Value v = sceneState();
  v["scene"] = scene_;
  if (draft_) {
    v["draft"] = draft_->scene;
    v["draft_written"] = draft_->written;
  }
  if (const std::int64_t made = pictureTime(folder_, path_.empty() ? kUntitled : path_)) v["pictured"] = made;
  return v;
}

void Studio::readScene(const ServedFolder& folder, const std::string& path) {
  const fs::path parent = folder.root() / fs::path(path).parent_path();
  OpenedScene opened = readSceneFile(folder.read(path), path, parent.string(), registry_);
  saved_ = std::move(opened.scene);
  lossWarning_ = std::move(opened.warning);
}

CheckedScene Studio::check(const Value& scene) const {
  const fs::path folder = folder_.root() / fs::path(path_).parent_path();
  return checkScene(scene, path_, folder.string(), registry_,
                    [&](const Scene& built) { sceneFiles_.check(built, folder); });
}

CheckedScene Studio::checkRun(const Value& scene, int coarser) const {
  CheckedScene checked = check(scene);
  try {
    if (checked.scene) coarsen(*checked.scene, coarser);
  } catch (const Error& e) {
    checked.scene.reset();
    checked.problem = problemOf(e);
  }
  return checked;
}

void Studio::takeScene(Value scene, std::string path, ClientId from) {
  scene_ = std::move(scene);
  path_ = std::move(path);
  ++revision_;
  CheckedScene checked = checkRun(scene_, coarser_);
  problem_ = std::move(checked.problem);
  warnings_ = std::move(checked.warnings);
  if (!lossWarning_.empty()) warnings_.insert(warnings_.begin(), lossWarning_);
  if (checked.scene && running_) {
    SceneDifference difference = differenceOf(*running_, *checked.scene);
    reset_ = difference.reset;
    if (!reset_ && !difference.live.empty()) {
      host_.change(std::move(difference.live));
      running_ = std::move(checked.scene);
    }
  }
  tell("scene", sceneValue(), from);
}

void Studio::setScene(ClientId client, const Value& message, Value& result) {
  requireWriter(client);
  const Value& scene = member(message, "scene");
  if (!scene.isObject()) throw usageError("'scene' is " + scene.brief(), "an object");
  takeScene(scene, path_, client);
  // Nobody has decided about what an earlier run left: it is not written over.
  if (draft_ && !(draft_->scene == scene_)) keepOldDraft(folder_, path_);
  draft_.reset();
  keepDraft();
  result = sceneState();
}

void Studio::newScene(ClientId client, const Value&, Value& result) {
  requireWriter(client);
  path_.clear();
  beginUntitled();
  draft_.reset();
  // The world of before goes, too.
  coarser_ = 1;
  playsWhenBuilt_ = false;
  running_.reset();
  reset_.reset();
  forgetRun();
  host_.load(nullptr, nullptr, device_);
  result = sceneState();
}

/// What was made of another scene without a file, and not saved, is not written over.
void Studio::beginUntitled() {
  keepOldDraft(folder_, "");
  removePictureOfDraft(folder_, kUntitled);
  lossWarning_.clear();
}

void Studio::findDraft() {
  draft_ = readDraft(folder_, path_);
  if (draft_ && draft_->scene == scene_) draft_.reset();
}

void Studio::keepDraft() {
  try {
    writeDraft(folder_, path_, scene_);
    draftFailed_ = false;
  } catch (const Error& e) {
    if (!draftFailed_)
      log_.warn(std::string("changes are lost if the studio ends before they are saved: ") + e.what());
    draftFailed_ = true;
  }
}

void Studio::dropDraft(ClientId client, const Value&, Value&) {
  requireWriter(client);
  draft_.reset();
  removeDraft(folder_, path_);
}

void Studio::openScene(ClientId client, const Value& message, Value& result) {
  requireWriter(client);
  const bool isTemplate = message.find("template") != nullptr;
  const std::string path = textMember(message, isTemplate ? "template" : "path");
  readScene(isTemplate ? ServedFolder(options_.templates) : folder_, path);
  if (isTemplate) beginUntitled();
  running_.reset();
  coarser_ = 1;
  playsWhenBuilt_ = false;
  takeScene(saved_, isTemplate ? "" : path, client);
  draft_.reset();
  if (!isTemplate) findDraft();
  result = sceneValue();
}

void Studio::saveScene(ClientId client, const Value& message, Value& result) {
  requireWriter(client);
  const std::string path = textMember(message, "path");
  if (fs::path(path).extension() != ".json")
    throw usageError("a scene cannot be saved as " + inQuotes(path), "a name that ends in .json");
  const bool overwrite = message.find("overwrite") != nullptr && switchMember(message, "overwrite");
  const bool isOther = path != path_;
  if (isOther && !overwrite) requireNew(path);
  const std::string text = writeJson(scene_);
  try {
    keepVersion(folder_, path, text);
  } catch (const Error& e) {
    log_.warn(std::string("what the file held before is not kept as a version: ") + e.what());
  }
  folder_.write(path, text);
  saved_ = scene_;
  if (!lossWarning_.empty()) std::erase(warnings_, lossWarning_);
  lossWarning_.clear();
  // What somebody has made of the scene whose place this one takes, or left of this one, and nobody has
  // decided about.
  if (isOther) keepOldDraft(folder_, path);
  if (draft_)
    keepOldDraft(folder_, path_);
  else
    removeDraft(folder_, path_);
  draft_.reset();
  path_ = path;
  tell("scene", sceneValue(), client);
  result = sceneState();
}

void Studio::listVersions(ClientId, const Value&, Value& result) {
  Value list = Value::array();
  if (!path_.empty())
    for (const Version& version : versionsOf(folder_, path_)) {
      Value v = Value::object();
      v["number"] = version.number;
      v["written"] = version.written;
      v["picture"] = version.hasPicture;
      list.push(std::move(v));
    }
  result["versions"] = std::move(list);
}

void Studio::showVersion(ClientId, const Value& message, Value& result) {
  const std::int64_t number = wholeMember(message, "number", 1, std::numeric_limits<std::int64_t>::max());
  const fs::path parent = folder_.root() / fs::path(path_).parent_path();
  const std::string name = path_ + ", version " + std::to_string(number);
  result["scene"] =
      readSceneFile(readVersion(folder_, path_, number), name, parent.string(), registry_).scene;
}

}  // namespace weir::studio
