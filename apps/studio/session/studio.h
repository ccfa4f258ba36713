// The studio: one scene that is edited, one simulation of it, and everybody who watches. Speaks what
// PROTOCOL.md says. All but the simulation runs on the server's thread.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/studio/server/http_server.h"
#include "apps/studio/server/served_folder.h"
#include "apps/studio/session/draft.h"
#include "apps/studio/session/number_history.h"
#include "apps/studio/session/picture_desk.h"
#include "apps/studio/session/recording.h"
#include "apps/studio/session/scene_files.h"
#include "apps/studio/session/simulation_host.h"

namespace weir::studio {

struct StudioOptions {
  std::string host = "127.0.0.1";
  int port = 0;
  std::string device = "auto";
  int threads = 0;
  std::filesystem::path folder;                     ///< whose files may be read and written
  std::vector<std::filesystem::path> sceneFolders;  ///< that scenes may read files of, too
  std::filesystem::path page;                       ///< the built web page
  std::filesystem::path templates;                  ///< scenes to start from
  std::string types;                                ///< what `weir nodes --json` prints
  std::filesystem::path tokens;  ///< where tokens are kept, see keptToken(); empty: nowhere
  bool newToken = false;         ///< the one that was kept is not valid any more
  std::int64_t maxRecordedBytes = std::int64_t{1}
                                  << 30;  ///< bytes of frames that are kept; half as much of states
  std::int64_t largestUpload = ServedFolder::kLargestUpload;  ///< bytes
  std::int64_t maxWaitingBytes = std::int64_t{64} << 20;      ///< bytes for a client before it is closed
};

class Studio final : private ServerEvents, private HostListener {
 public:
  Studio(StudioOptions options, const Registry& registry, Log& log);
  ~Studio() override;

  /// Begins with a scene of the served folder. One that is broken is opened as well, with its problem.
  void open(const std::string& path);
  std::string address() const { return server_.access().address(); }
  /// By which other machines reach it, if it listens at all addresses of this one.
  std::vector<std::string> furtherAddresses() const { return server_.access().furtherAddresses(); }
  void run() { server_.run(); }
  void stop() { server_.stop(); }  ///< from any thread
  /// Shows a line of the log to everybody; from any thread.
  void showLog(LogLevel level, std::string_view message);

 private:
  struct Client {
    int unseen = 0;                           // frames that it was sent and has not confirmed
    std::shared_ptr<const std::string> next;  // the newest frame, which waits until it has
    bool wantsFrames = true;
  };
  using Command = void (Studio::*)(ClientId, const Value&, Value&);

  // ServerEvents
  HttpReply request(const HttpRequest& request) override;
  std::filesystem::path uploadPlace(const HttpRequest& request) override;
  void opened(ClientId client) override;
  void message(ClientId client, std::string_view text) override;
  void closed(ClientId client) override;
  double shareOf(ClientId client) const override;
  // HostListener, on the simulation's thread
  void status(const Value& status) override;
  void numbers(const Value& numbers) override;
  void frame(std::int64_t frame, const Packet& packet) override;
  void geometry(const Packet& packet) override;
  void reached(Simulation& simulation) override;
  void wentBack(std::int64_t frame) override;
  void serve(Simulation* simulation) override;
  void leaving() override;
  void pastChanging() override;
  void pastLeaving() override;
  bool replayReached(Simulation& then, std::int64_t frames) override;
  void replayEnded(const std::optional<Error>& problem) override;

  HttpReply page(const std::string& path) const;
  HttpReply files(const HttpRequest& request);
  /// Throws an Error if there is something at the path.
  void requireNew(const std::string& path) const;
  HttpReply picture(const HttpRequest& request);
  HttpReply thumbnail(const std::string& name) const;
  HttpReply listing(const std::vector<ServedFile>& files) const;

  void hello(ClientId client, const Value& message, Value& result);
  void setScene(ClientId client, const Value& message, Value& result);
  void openScene(ClientId client, const Value& message, Value& result);
  void saveScene(ClientId client, const Value& message, Value& result);
  void listVersions(ClientId client, const Value& message, Value& result);
  void showVersion(ClientId client, const Value& message, Value& result);
  void askCost(ClientId client, const Value& message, Value& result);
  void play(ClientId client, const Value& message, Value& result);
  void pause(ClientId client, const Value& message, Value& result);
  void cancel(ClientId client, const Value& message, Value& result);
  void step(ClientId client, const Value& message, Value& result);
  void reset(ClientId client, const Value& message, Value& result);
  void pullBody(ClientId client, const Value& message, Value& result);
  void releaseBody(ClientId client, const Value& message, Value& result);
  void goOn(ClientId client, const Value& message, Value& result);
  void seek(ClientId client, const Value& message, Value& result);
  void setView(ClientId client, const Value& message, Value& result);
  void confirm(ClientId client, const Value& message, Value& result);
  void claim(ClientId client, const Value& message, Value& result);
  void newScene(ClientId client, const Value& message, Value& result);
  void dropDraft(ClientId client, const Value& message, Value& result);
  void askParticle(ClientId client, const Value& message, Value& result);
  void askParticles(ClientId client, const Value& message, Value& result);
  void setStream(ClientId client, const Value& message, Value& result);
  void askPicture(ClientId client, const Value& message, Value& result);
  /// Of the run as it was at a frame.
  void askPastPicture(ClientId client, std::int64_t frame, const LivePictureOptions& options,
                      const PictureDone& done);
  void startVideo(ClientId client, const Value& message, Value& result);
  void moveVideo(ClientId client, const Value& message, Value& result);
  void stopVideo(ClientId client, const Value& message, Value& result);
  static const std::map<std::string, Command, std::less<>>& commands();

  CheckedScene check(const Value& scene) const;
  /// As it is run: `coarser` times as coarse.
  CheckedScene checkRun(const Value& scene, int coarser) const;
  /// The question waits for its turn at the simulation. Throws a usage Error if too many of the client wait.
  void askHost(ClientId client, QuestionQueue::Question question);
  /// Gives a scene to the simulation, which then is that one's, or a preview of it.
  void run(const Value& scene, int coarser);
  /// Into saved_, with a warning of what saving would lose.
  void readScene(const ServedFolder& folder, const std::string& path);
  /// What is kept of the run for those who look is gone with it.
  void forgetRun();
  /// Whether the simulation has last told that it is in a state.
  bool isState(HostState state) const;
  /// Tells everybody.
  void setPlaysWhenBuilt(bool plays);
  /// Whether there is no run that could go on.
  bool needsReset() const;
  void takeScene(Value scene, std::string path, ClientId from);
  /// Offers what an earlier run was left with, if it is something else.
  void beginUntitled();
  void giveBackMemory();
  void findDraft();
  void keepDraft();
  void requireWriter(ClientId client) const;
  /// Answers with what f makes of the simulation, between two of its steps, or of how it was at the frame
  /// that the message names.
  void answerLater(ClientId client, const Value& message, Value& result,
                   std::function<Value(const Simulation&)> f);
  void sendPicture(ClientId client, const Value& id, const LivePictureOptions& options, PictureAnswer answer);
  PictureDesk& videoDesk() { return video_.recorded ? pastDesk_ : desk_; }
  /// Throws a usage Error if the message asks for a video that cannot be made.
  std::filesystem::path videoPlace(const Value& message) const;
  /// The same if the run has no frames that stand still.
  void requireRecordedFrames() const;
  Value videoValue(const VideoStatus& video) const;
  void tellVideo(const VideoStatus& video);  // from any thread
  Value sceneState() const;                  ///< all but the scene itself
  Value sceneValue() const;
  void tell(const std::string& event, Value data, std::optional<ClientId> except = {});
  void tellRole(ClientId client);
  void sendFrame(ClientId id, Client& client, const Packet& packet);

  StudioOptions options_;
  const Registry& registry_;
  Log& log_;
  ServedFolder folder_;
  SceneFiles sceneFiles_;

  std::map<ClientId, Client> clients_;
  std::chrono::steady_clock::time_point memoryGivenBack_{};
  std::optional<ClientId> writer_;
  Value scene_;                   // as it is edited, right or wrong
  std::string path_;              // below the served folder; "" if it has no file yet
  Value saved_;                   // scene_ as its file has it
  std::optional<Draft> draft_;    // what an earlier run made of it and nobody saved
  bool draftFailed_ = false;      // that was told
  std::int64_t revision_ = 0;     // of scene_
  std::optional<Value> problem_;  // of scene_
  std::vector<std::string> warnings_;
  std::string lossWarning_;           // what saving over the file would lose
  std::unique_ptr<Scene> running_;    // what the simulation was last given, to compare with
  std::optional<std::string> reset_;  // why the simulation must be reset to be as scene_ is
  std::string device_;
  int coarser_ = 1;  // times as coarse as its scene is what runs, or is to run: more than 1 is a preview
  Value status_ = Value::object();
  Packet geometry_;
  Recording recording_;
  NumberHistory history_;
  bool playsWhenBuilt_ = false;  // somebody has asked for that while the scene is being built

  /// The last video that was begun.
  struct LastVideo {
    std::string path;                    // below the served folder
    bool recorded = false;               // of recorded frames, drawn by pastDesk_
    std::int64_t frames = 0, whole = 0;  // of those: how many the run has, and how many pictures were kept
  };
  LastVideo video_;

  HttpServer server_;
  PictureDesk desk_;
  PictureDesk pastDesk_;  // of runs as they were
  SimulationHost host_;   // last: it calls the rest
};

}  // namespace weir::studio
