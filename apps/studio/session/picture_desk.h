// Pictures and videos of the simulation, drawn on a thread of its own by what a plugin brings
// (framework/run/live_pictures.h). The simulation goes first, and waits for no more than a copy of the frame,
// and for a video that is behind.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "apps/studio/server/http_server.h"
#include "framework/base/error.h"
#include "framework/run/live_pictures.h"

namespace weir::studio {

/// What became of a request for a picture.
struct PictureAnswer {
  std::string jpeg;              ///< empty: it was not drawn, as a newer request of the client came
  std::int64_t frame = 0;        ///< that it shows, or the last one before
  double time = 0;               ///< s
  std::optional<Error> problem;  ///< why there is none
};
using PictureDone = std::function<void(PictureAnswer)>;

enum class VideoState { kNone, kRecording, kFinishing, kDone, kFailed };

/// "none", "recording", "finishing", "done" or "failed".
std::string_view nameOf(VideoState state);

struct VideoStatus {
  VideoState state = VideoState::kNone;
  std::int64_t frames = 0;  ///< handed to the encoder
  std::optional<Error> problem;
};

class PictureDesk {
 public:
  /// `told` gets the video's status when it has changed, and else four times a second; like what is given to
  /// ask(), it is called on any thread, and must do no more than to pass on what it gets. The registry must
  /// outlive this.
  PictureDesk(const Registry& registry, std::function<void(VideoStatus)> told);
  /// leave() must have been called after the last frame.
  ~PictureDesk();
  PictureDesk(const PictureDesk&) = delete;
  PictureDesk& operator=(const PictureDesk&) = delete;

  // From any thread; each returns at once.

  /// Why there are no pictures here, as far as can be said without drawing one.
  std::optional<Error> problem() const;
  /// What the names of videos may end in.
  const std::vector<std::string>& videoExtensions() const { return extensions_; }
  /// One request of a client waits at a time; an older one is answered without a picture. With `newer` it
  /// waits for a frame that the client has no picture of; else serve() must follow. Throws problem().
  void ask(ClientId client, const LivePictureOptions& options, bool newer, PictureDone done);
  /// The client is gone.
  void forget(ClientId client);
  /// Where a video begins: with the frame that is there, for which serve() must follow, or with the next one
  /// that frame() gets.
  enum class Begin { kNow, kNextFrame };
  /// A video has a picture of each frame from then on. Throws problem(), or a usage Error if there is a video
  /// that is not complete.
  /// `scene`, as JSON text, is put into the file where that can carry one, see carryScene.
  void startVideo(std::filesystem::path file, const LivePictureOptions& options, std::string scene,
                  Begin begin);
  void moveCamera(const LiveCamera& camera);
  void stopVideo();
  VideoStatus video() const;
  /// Whether more frames come into a video.
  bool isRecording() const { return video().state == VideoState::kRecording; }

  // On the simulation's thread.

  /// Lets what waits be drawn from the simulation as it is. Null: there is none.
  void serve(Simulation* simulation);
  /// A new frame, which a video shows that many times.
  void frame(Simulation& simulation, std::int64_t times = 1);
  /// There will be no more frames, for this reason: those who wait are told, and the video is lost.
  void fail(const Error& problem);
  /// The simulation will be gone: completes the video, and waits until nothing of it is used. Requests are
  /// drawn from the next one.
  void leave();
  /// The simulation will be at another time: waits until what may be drawn is drawn.
  void change();

 private:
  struct Held {
    std::unique_ptr<Snapshot> snapshot;
    std::int64_t number = 0, frame = 0, steps = 0;
    double time = 0;
  };
  using HeldPointer = std::shared_ptr<const Held>;
  struct Request {
    std::int64_t order = 0;
    LivePictureOptions options;
    bool newer = false;
    bool ready = false;  // may be drawn from latest_
    PictureDone done;
  };
  struct Video {
    std::filesystem::path file;
    LivePictureOptions options;
    std::string scene;
    Begin begin;
    bool hasFrames = false, started = false, ending = false;
    std::deque<HeldPointer> frames;
  };
  using Lock = std::unique_lock<std::mutex>;

  /// Calls the plugin without the lock; what it throws names it.
  std::optional<Error> outside(Lock& lock, std::string_view hook, const std::function<void()>& f) const;
  bool capture(Simulation& simulation, Lock& lock);
  void addToVideo(std::int64_t times = 1);
  /// Answers all requests with the problem, ends the video, and waits until nothing of the simulation is
  /// used.
  void fail(const Error& problem, Lock& lock);
  void finishVideo();
  void tell(bool always);

  // The painter's thread.
  void paint();
  bool videoHasWork() const;
  std::map<ClientId, Request>::iterator nextRequest();
  void paintRequest(std::map<ClientId, Request>::iterator which, Lock& lock);
  void paintVideo(Lock& lock);
  void endVideo(VideoState state, std::optional<Error> problem);

  std::unique_ptr<LivePictures> pictures_;  // null without a plugin
  std::string source_;                      // the plugin
  std::vector<std::string> extensions_;
  std::function<void(VideoStatus)> told_;

  mutable std::mutex mutex_;  // of all that follows
  std::condition_variable wake_, idle_;
  std::unique_ptr<LiveRenderer> renderer_;  // made and dropped on the simulation's thread
  bool busy_ = false;                       // the painter uses it
  HeldPointer latest_;
  std::int64_t captured_ = 0, asked_ = 0;
  std::map<ClientId, Request> requests_;
  std::map<ClientId, std::int64_t> seen_;  // the number of what a client has a picture of
  std::optional<Video> video_;
  VideoStatus status_;
  std::chrono::steady_clock::time_point toldAt_{};
  bool videoWasLast_ = false, quit_ = false;
  std::thread painter_;  // last: it uses all of the above
};

}  // namespace weir::studio
