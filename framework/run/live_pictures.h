// Pictures of a running simulation for somebody who watches it: from any camera, whenever they are asked for,
// and videos of what is seen. A plugin brings them:
//
//   registry.addService<LivePictures>("pictures", [] { return std::make_unique<MyPictures>(); });
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "framework/base/vec.h"
#include "framework/run/observer.h"

namespace weir {

/// Where a watcher's camera is. Metres.
struct LiveCamera {
  Vec3f eye{2, 1.5f, 2};
  Vec3f target{};
  Vec3f up{0, 1, 0};
  float fovDegrees = 40;  ///< vertical field of view, in (0, 180)
};

struct LivePictureOptions {
  std::optional<LiveCamera> camera;  ///< nothing: that of the scene
  int width = 1280, height = 720;    ///< pixels
  int samplesPerAxis = 2;            ///< 1 (jagged, fast) to 4
};

/// Red, green and blue (sRGB) of each pixel, rows from the top: 3·width·height bytes.
struct LivePixels {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
};

/// Draws one simulation, as the scene's sections say but for the camera.
class LiveRenderer {
 public:
  virtual ~LiveRenderer() = default;

  /// Copies what pictures need, at a frame or between two steps, on the simulation's thread. `used` is a
  /// snapshot of this renderer's that nobody needs any more, or null. Throws a scene Error if the sections
  /// name what the scene does not have; then this renderer is of no more use.
  virtual std::unique_ptr<Snapshot> capture(Simulation& simulation, std::unique_ptr<Snapshot> used) = 0;

  // The rest is called from one other thread, and uses neither the simulation nor its device.

  /// A JPEG file. The same snapshot may be drawn several times. Throws an io Error if this machine cannot
  /// draw, or no picture as large, and a scene Error for a camera that looks nowhere; others can be drawn
  /// after it.
  virtual std::string draw(Snapshot& snapshot, const LivePictureOptions& options) = 0;
  /// The same as pixels. Throws as draw() does.
  virtual LivePixels pixels(Snapshot& snapshot, const LivePictureOptions& options) = 0;

  // Videos, one at a time. Each throws an io Error with the encoder's reason; the video is then lost.

  /// The name ends in one of LivePictures::videoExtensions(). Its place is taken when it is complete.
  virtual void startVideo(const std::filesystem::path& file, int width, int height) = 0;
  /// The next frame of it. Waits where frames come faster than they are encoded. Throws as draw(), too.
  virtual void addToVideo(Snapshot& snapshot, const LiveCamera& camera) = 0;
  /// Completes it. Without a frame there is no file.
  virtual void finishVideo() = 0;
};

class LivePictures {
 public:
  static constexpr std::string_view kInterface = "LivePictures";
  virtual ~LivePictures() = default;

  /// What the names of videos may end in, ".mp4", the usual one first.
  virtual std::vector<std::string> videoExtensions() const = 0;
  /// On the simulation's thread, which does not wait for much; the simulation must outlive what is returned.
  virtual std::unique_ptr<LiveRenderer> open(Simulation& simulation) const = 0;
};

}  // namespace weir
