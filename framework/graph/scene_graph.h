// The nodes of a scene and the links between them.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "framework/base/api.h"
#include "framework/graph/memory_estimate.h"
#include "framework/graph/node.h"

namespace WEIR_API weir {

class Registry;

struct Link {
  std::string fromNode, output, toNode, input;
  /// "nozzle.particles -> water.emitters"
  std::string text() const { return fromNode + "." + output + " -> " + toNode + "." + input; }
};

class SceneGraph {
 public:
  /// Letters, digits, '_' and '-', starting with a letter; not "world", "render" or another section's name.
  static bool isValidName(std::string_view name);

  /// Throws a scene Error for a bad or taken name.
  Node& add(std::unique_ptr<Node> node, const std::string& name);
  Node* find(std::string_view name) const;
  const std::vector<std::unique_ptr<Node>>& nodes() const { return nodes_; }

  /// Throws a scene Error that names both ends: no such node or port (with a suggestion), wrong types, a
  /// taken input, a link that closes a cycle (the cycle is spelled out).
  void link(const Link& link);
  const std::vector<Link>& links() const { return links_; }

  /// Parses "node.output -> node.input"; throws a scene Error that says what the form is.
  static Link parseLink(std::string_view text);

  /// Checks what can only be checked when all is there: required inputs.
  void validate() const;

  /// Every node behind the nodes it reads from; in the order of the scene where links leave it free.
  std::vector<Node*> order() const;

  // The life of a simulation. Parameters that keyframes give take their values of the time first. An Error
  // that leaves these names the node.
  void reset(const SetupContext& context);  ///< configure from last to first, then reset from first to last
  /// What a reset and a run will need; configures from last to first, and asks from first to last.
  MemoryEstimate estimate(const SetupContext& context);
  /// At a frame.
  void save(const StateWriter& to) const;
  /// After a reset of the same graph.
  void restore(const StateReader& from);
  /// The least of all nodes' Node::longestStep; infinite if none asks for anything.
  double longestStep(const StepContext& next, double cfl);
  void step(const StepContext& context);
  /// A step and then a frame of these nodes alone, in the order of the graph.
  void follow(const std::vector<Node*>& nodes, const StepContext& context);
  void frame(const StepContext& context);

  /// What a node and its modules hold on the device, in bytes: what was allocated and not released again
  /// while they were reset and stepped.
  std::int64_t deviceMemoryOf(const Node& node) const;

 private:
  void animate(double time);
  void configure(const SetupContext& context);
  void stepNode(Node& node, const StepContext& context);
  template <class F>
  void call(Node& node, std::string_view hook, Device& device, F&& f);

  std::vector<std::unique_ptr<Node>> nodes_;
  std::vector<Link> links_;
  std::vector<Node*> order_;  // as of the last reset
  std::map<const Node*, std::int64_t> deviceMemory_;
};

}  // namespace weir
