// What `weir bench` can run: scenes that come with the program, and the sizes of the dam break.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/weir/bench/byte_model.h"
#include "framework/base/vec.h"

namespace weir::app {

/// A block of that many particles along each edge.
struct BlockSize {
  Vec3<std::int64_t> sides;

  std::int64_t particles() const { return sides.x * sides.y * sides.z; }
  std::string name() const { return std::to_string(particles()); }
};

struct BenchCase {
  std::string name;
  std::string about;                      ///< for --help and the documents
  std::string scene;                      ///< a file of resources/scenes
  std::vector<std::string> set;           ///< changes to it, as for --set
  bool hasSizes = false;                  ///< a block of any BlockSize; otherwise the scene as it is
  bool isClosed = false;                  ///< as many particles at the end as at the start
  bool early = true;                      ///< whether the beginning is timed, too
  double lateAfter = 1;                   ///< simulated time before the flow counts as developed, s
  std::optional<StepPasses> passes = {};  ///< where a model of the bytes of a step is known
};

std::vector<BenchCase> benchCases();

/// Those that are compared with other programs, and two beyond them.
std::vector<BlockSize> blockSizes();

/// One of blockSizes() if it has exactly that many particles; otherwise the block of about as many that is
/// nearest to a cube: its base is a square, and its height takes up the rest.
BlockSize blockOf(std::int64_t particles);

/// What makes the cube of a dam break, 0.81 m wide, of that many particles.
std::vector<std::string> settingsOf(const BlockSize& size);

/// The text of a file of resources/scenes that a case names; it is part of the program.
std::string_view benchSceneText(std::string_view file);

}  // namespace weir::app
