// What the studio does about pictures and videos.
#include <filesystem>
#include <utility>

#include "apps/studio/session/message.h"
#include "apps/studio/session/studio.h"
#include "framework/base/error.h"
#include "framework/base/text.h"
#include "framework/scene/scene_file.h"

namespace weir::studio {

namespace fs = std::filesystem;

void Studio::setStream(ClientId client, const Value& message, Value&) {
  Client& c = clients_[client];
  c.wantsFrames = switchMember(message, "particles");
  c.next.reset();
  if (!c.wantsFrames) return;
  if (const Packet last = recording_.nearest(std::numeric_limits<std::int64_t>::max()))
    sendFrame(client, c, last);
}

void Studio::askPicture(ClientId client, const Value& message, Value& result) {
  const LivePictureOptions options = pictureOptionsOf(message);
  const bool newer = message.find("newer") != nullptr && switchMember(message, "newer");
  const Value* id = message.find("id");
  const auto done = [this, client, options, id = id != nullptr ? *id : Value()](PictureAnswer answer) {
    sendPicture(client, id, options, std::move(answer));
  };
  result = {};
  if (const auto frame = frameMember(message)) return askPastPicture(client, *frame, options, done);
  desk_.ask(client, options, newer, done);
  if (!newer) host_.serve();
}

void Studio::askPastPicture(ClientId client, std::int64_t frame, const LivePictureOptions& options,
                            const PictureDone& done) {
  if (const auto problem = pastDesk_.problem()) throw *problem;
  askHost(client, [=, this](Simulation* simulation) {
    try {
      if (simulation == nullptr) throw usageError("there is nothing to draw yet", {}, "play the scene");
      Simulation& then = host_.runAt(frame);
      PictureDesk& desk = &then == simulation ? desk_ : pastDesk_;
      desk.ask(client, options, false, done);
      desk.serve(&then);
    } catch (const Error& e) {
      done({.problem = e});
    }
  });
}

void Studio::sendPicture(ClientId client, const Value& id, const LivePictureOptions& options,
                         PictureAnswer answer) {
  Value reply = Value::object();
  reply["id"] = id;
  if (answer.problem) {
    reply["error"] = problemOf(*answer.problem);
  } else {
    Value result = Value::object();
    result["drawn"] = !answer.jpeg.empty();
    result["frame"] = answer.frame;
    result["time"] = answer.time;
    reply["result"] = std::move(result);
  }
  if (!answer.jpeg.empty()) {
    PacketWriter writer;
    Value header = Value::object();
    header["kind"] = "picture";
    header["request"] = id;
    header["frame"] = answer.frame;
    header["time"] = answer.time;
    header["width"] = options.width;
    header["height"] = options.height;
    header["type"] = "image/jpeg";
    header["bytes"] = static_cast<std::int64_t>(answer.jpeg.size());
    header["data"] = writer.add(std::span<const char>(answer.jpeg));
    server_.sendBinary(client, writer.finish(header));
  }
  server_.sendText(client, writeJsonLine(reply));
}

Value Studio::videoValue(const VideoStatus& video) const {
  Value v = Value::object();
  v["state"] = nameOf(video.state);
  v["path"] = video_.path;
  v["frames"] = video.frames;
  if (video_.recorded) {
    v["of"] = video_.frames;
    v["whole"] = video_.whole;
  }
  if (video.problem) v["problem"] = problemOf(*video.problem);
  return v;
}

void Studio::tellVideo(const VideoStatus& video) {
  server_.post([this, video] { tell("video", videoValue(video)); });
}

fs::path Studio::videoPlace(const Value& message) const {
  const std::string path = textMember(message, "path");
  const fs::path file = folder_.resolve(path);
  const std::vector<std::string>& allowed = desk_.videoExtensions();
  if (std::find(allowed.begin(), allowed.end(), file.extension().string()) == allowed.end())
    throw usageError("there is no kind of video for the name " + inQuotes(path),
                     "a name that ends in " + joinNames(allowed));
  std::error_code error;
  if (!fs::is_directory(file.parent_path(), error))
    throw usageError("there is no folder for " + inQuotes(path), "a folder that exists");
  if (fs::is_directory(file, error)) throw usageError(inQuotes(path) + " is a folder", "the name of a file");
  requireNew(path);
  return file;
}

void Studio::requireRecordedFrames() const {
  if (!running_ || status_.find("frame") == nullptr || isState(HostState::kBuilding))
    throw usageError("there is no run whose frames could be written", {}, "play it first");
  if (isState(HostState::kPlaying))
    throw usageError("the frames of a run that plays are not written", "one that stands still",
                     "pause it first");
  if (status_.find("frame")->asInt() > 0 && status_.find("whole")->asInt() < 2)
    throw usageError("no frame of this run but the present one is kept whole", {},
                     "start the studio with a larger --frames-mb, or record the run as it plays");
}

void Studio::startVideo(ClientId client, const Value& message, Value& result) {
  requireWriter(client);
  const LivePictureOptions options = pictureOptionsOf(message);
  const bool recorded = message.find("recorded") != nullptr && switchMember(message, "recorded");
  if (coarser_ > 1)
    throw usageError("a preview is not written as a video", "a run in full", "end the preview, and play");
  if (const auto problem = desk_.problem()) throw *problem;
  const fs::path file = videoPlace(message);
  if (recorded) requireRecordedFrames();
  if (const VideoState last = videoDesk().video().state;
      last == VideoState::kRecording || last == VideoState::kFinishing)
    throw usageError("a video is being made already", "one at a time", "stop it first");
  video_ = {.path = textMember(message, "path"), .recorded = recorded};
  if (recorded) video_.frames = status_.find("frame")->asInt() + 1;
  videoDesk().startVideo(file, options, writeJsonLine(scene_),
                         recorded ? PictureDesk::Begin::kNextFrame : PictureDesk::Begin::kNow);
  if (recorded)
    host_.replay();
  else
    host_.serve();
  result = videoValue(videoDesk().video());
}

void Studio::moveVideo(ClientId client, const Value& message, Value&) {
  requireWriter(client);
  // Recorded frames are drawn as fast as that goes: what hands do meanwhile has nothing to do with them.
  if (!video_.recorded) desk_.moveCamera(cameraOf(message));
}

void Studio::stopVideo(ClientId client, const Value&, Value& result) {
  requireWriter(client);
  videoDesk().stopVideo();
  result = videoValue(videoDesk().video());
}

bool Studio::replayReached(Simulation& then, std::int64_t frames) {
  server_.post([this] { ++video_.whole; });
  pastDesk_.frame(then, frames);
  return pastDesk_.isRecording();
}

void Studio::replayEnded(const std::optional<Error>& problem) {
  if (problem)
    pastDesk_.fail(*problem);
  else
    pastDesk_.stopVideo();
}

}  // namespace weir::studio
