// A node of a scene: parameters, ports, and perhaps a pipeline of modules.
//
//   class Counter : public Node {
//    public:
//     static constexpr NodeInfo kInfo{"Counter", "Counts steps."};
//     const NodeInfo& info() const override { return kInfo; }
//     Param<int> start{*this, "start", 0, {.doc = "First number."}};
//     Output<Number> number{*this, "number", "The number of the step."};
//     void reset(const SetupContext&) override { count_ = start; }
//     void step(const StepContext&) override { number->value = ++count_; }
//
//    private:
//     State<int> count_{*this, "count"};  // checkpoints hold it
//   };
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "framework/base/api.h"
#include "framework/base/log.h"
#include "framework/compute/device.h"
#include "framework/graph/configurable.h"
#include "framework/graph/module.h"
#include "framework/graph/port.h"
#include "framework/graph/state.h"

namespace WEIR_API weir {

class Registry;
struct MemoryNeeds;

/// What a node class says of itself.
struct NodeInfo {
  std::string_view type;  ///< its name in scenes
  std::string_view doc;
  std::string_view also = {};  ///< other words for it, parted by commas, by which people look for it
};

/// What all nodes of a scene share while it is set up.
struct SetupContext {
  Device& device;
  Log& log;
  const Registry& registry;
  Vec3f gravity{};         ///< m/s²
  double dt = 0;           ///< longest step that the clock will make, s
  std::int64_t seed = 0;   ///< for random numbers
  bool stepsVary = false;  ///< whether nodes are asked for their longestStep()
  double end = 0;          ///< when the run will end, s
  /// If it is there, told of each node that is set up next, how many were before, and how many there are.
  std::function<void(std::string_view node, std::size_t done, std::size_t all)> progress = {};
};

/// One step from `time` to `time + dt`, in seconds.
struct StepContext {
  Device& device;
  Log& log;
  Vec3f gravity{};
  double time = 0;
  double dt = 0;
  std::int64_t index = 0;  ///< from 0
  double untilFrame = 0;   ///< from its end to the next frame, s; 0 if it ends there
};

/// Something tolerated that must stay rare, such as a truncated neighbour list.
struct RareEvent {
  std::string what;  ///< "particles left the domain"
  std::int64_t count = 0;
};

/// What a node says of itself at a frame or at the end of a run.
struct NodeReport {
  Value statistics = Value::object();  ///< numbers by name, for --stats
  std::vector<RareEvent> events;
};

/// Between steps it keeps in State members what reset() does not make again; see state.h.
class Node : public Configurable, public Stateful {
 public:
  virtual const NodeInfo& info() const = 0;

  const std::string& name() const { return name_; }
  void setName(std::string name) { name_ = std::move(name); }
  /// How many nodes of its type stand before it in the scene.
  int ordinal() const { return ordinal_; }
  /// Its place among all nodes of the scene, from 0.
  int place() const { return place_; }
  void setPlace(int place, int ordinal) {
    place_ = place;
    ordinal_ = ordinal;
  }
  /// The library that its type comes from, see Registry::setSource.
  const std::string& source() const { return source_; }
  void setSource(std::string source) { source_ = std::move(source); }

  const std::vector<InputPort*>& inputs() const { return inputs_; }
  const std::vector<OutputPort*>& outputs() const { return outputs_; }
  InputPort* findInput(std::string_view name) const;
  OutputPort* findOutput(std::string_view name) const;
  /// The node's modules, or null if it has no pipeline.
  virtual PipelineBase* pipeline() { return nullptr; }

  /// Sends requests up its inputs. Runs before reset, from the last node to the first.
  virtual void configure(const SetupContext&) {}
  /// Tells what the node will hold at most (see memory_estimate.h). Runs after configure, from the first node
  /// to the last, and before anything is made; what later nodes have to know for that is to be put out here,
  /// such as a mesh, and made again or kept for reset.
  virtual void estimate(const SetupContext&, MemoryNeeds&) {}
  /// Puts the node into its state at time 0 and fills its outputs.
  virtual void reset(const SetupContext& context) = 0;
  /// How long the step that begins at `next.time` may be so that nothing of this node moves farther in it
  /// than `cfl` times the distance that matters to it, in s, above 0; `next.dt` is the longest it will
  /// become. Asked before each step, and only where the scene asks for such steps; may wait for the device.
  /// The same state must give the same answer, bit for bit, as results depend on it.
  virtual double longestStep(const StepContext& /*next*/, double /*cfl*/) {
    return std::numeric_limits<double>::infinity();
  }
  virtual void step(const StepContext&) {}
  /// Whether the frames of a recording can take the place of its inputs: each is then a step of it, as long
  /// as they are apart. Throws a scene Error where that cannot be for reasons of the scene.
  virtual bool followsRecordings() const { return false; }
  /// Called at every frame time, before anyone looks: brings what is only looked at up to date, and checks
  /// what is too costly for every step. May wait for the device.
  virtual void frame(const StepContext&) {}
  /// May wait for the device: it is called between steps, once a run or when someone looks.
  virtual void report(NodeReport&) {}
  /// Particles it holds, as far as the host knows without asking the device.
  virtual std::int64_t particleCount() const { return 0; }

 private:
  friend class InputPort;
  friend class OutputPort;
  std::string name_;
  int place_ = 0, ordinal_ = 0;
  std::string source_{kOwnSource};
  std::vector<InputPort*> inputs_;
  std::vector<OutputPort*> outputs_;
};

/// The seed of a node's random numbers: its own if it has one; otherwise the scene's, with the node's type
/// and its ordinal, so that two nodes draw different numbers and a new name changes none.
std::uint64_t randomSeed(const Node& node, const SetupContext& context,
                         const std::optional<std::int64_t>& own);

/// What a node's parameter `seed` for randomSeed() says of itself.
inline constexpr ParamSpec kSeedSpec{
    .min = 0,
    .doc =
        "Of this node's random numbers. If it is left out, the scene's seed, the node's type and its place "
        "among nodes of that type decide."};

}  // namespace weir
