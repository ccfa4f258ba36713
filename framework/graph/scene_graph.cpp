#include "framework/graph/scene_graph.h"

#include <algorithm>
#include <limits>
#include <map>
#include <unordered_map>

#include "framework/base/interruption.h"
#include "framework/base/text.h"
#include "framework/compute/profiler.h"

namespace weir {

namespace {

// What a node may not be called, because options like --set world.dt=… would be ambiguous.
constexpr std::string_view kReservedNames[] = {"world", "render", "title"};

// Where the states of a node's modules stand, beside its own.
constexpr std::string_view kModuleStates = "modules";

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

template <class P>
Error noSuchPort(const Node& node, const std::string& name, const std::vector<P*>& ports, const char* kind) {
  std::vector<std::string> names;
  for (const P* port : ports) names.push_back(port->name());
  return sceneError(inQuotes(node.name()) + " (" + std::string(node.info().type) + ") has no " + kind + " " +
                        inQuotes(name),
                    names.empty() ? "nothing: it has none" : joinNames(names), didYouMean(name, names));
}

/// The names on a path of links from `from` to `to`; empty if there is none.
std::vector<std::string> pathBetween(Node& from, const Node& to) {
  std::unordered_map<const Node*, const Node*> cameFrom{{&from, nullptr}};
  std::vector<const Node*> open{&from};
  while (!open.empty() && !cameFrom.contains(&to)) {
    const Node* node = open.back();
    open.pop_back();
    for (const OutputPort* output : node->outputs())
      for (const InputPort* input : output->links())
        if (cameFrom.emplace(&input->node(), node).second) open.push_back(&input->node());
  }
  std::vector<std::string> path;
  if (cameFrom.contains(&to))
    for (const Node* node = &to; node != nullptr; node = cameFrom[node])
      path.insert(path.begin(), node->name());
  return path;
}

}  // namespace

bool SceneGraph::isValidName(std::string_view name) {
  return isName(name) &&
         std::find(std::begin(kReservedNames), std::end(kReservedNames), name) == std::end(kReservedNames);
}

Node& SceneGraph::add(std::unique_ptr<Node> node, const std::string& name) {
  if (!isValidName(name))
    throw sceneError(inQuotes(name) + " is not a valid name for a node",
                     "letters, digits, '_' and '-', starting with a letter; not world, render or title");
  if (find(name) != nullptr)
    throw sceneError("there are two nodes '" + name + "'", "a name of its own for each");
  node->setName(name);
  const auto isAlike = [&](const auto& other) { return other->info().type == node->info().type; };
  node->setPlace(static_cast<int>(nodes_.size()),
                 static_cast<int>(std::count_if(nodes_.begin(), nodes_.end(), isAlike)));
  nodes_.push_back(std::move(node));
  return *nodes_.back();
}

Node* SceneGraph::find(std::string_view name) const {
  for (const auto& node : nodes_)
    if (node->name() == name) return node.get();
  return nullptr;
}

Link SceneGraph::parseLink(std::string_view text) {
  const auto fail = [&] {
    return sceneError("found " + Value(text).brief(), "a link of the form \"node.output -> node.input\"");
  };
  const auto arrow = text.find("->");
  if (arrow == std::string_view::npos) throw fail();
  const auto split = [&](std::string_view end) {
    end = trimmed(end);
    const auto dot = end.find('.');
    if (dot == std::string_view::npos || dot == 0 || dot + 1 == end.size() ||
        end.find_first_of(" \t.>", dot + 1) != std::string_view::npos)
      throw fail();
    return std::pair(std::string(end.substr(0, dot)), std::string(end.substr(dot + 1)));
  };
  const auto [fromNode, output] = split(text.substr(0, arrow));
  const auto [toNode, input] = split(text.substr(arrow + 2));
  return {fromNode, output, toNode, input};
}

void SceneGraph::link(const Link& link) {
  const auto node = [&](const std::string& name) -> Node& {
    if (Node* found = find(name)) return *found;
    std::vector<std::string> names;
    for (const auto& n : nodes_) names.push_back(n->name());
    throw sceneError("there is no node " + inQuotes(name), joinNames(names), didYouMean(name, names));
  };
  Node& from = node(link.fromNode);
  Node& to = node(link.toNode);
  OutputPort* output = from.findOutput(link.output);
  if (output == nullptr) throw noSuchPort(from, link.output, from.outputs(), "output");
  InputPort* input = to.findInput(link.input);
  if (input == nullptr) throw noSuchPort(to, link.input, to.inputs(), "input");

  if (const auto back = pathBetween(to, from); !back.empty()) {
    std::string cycle;
    for (const std::string& name : back) cycle += name + " -> ";
    throw sceneError("the link \"" + link.text() + "\" closes a cycle: " + cycle + back.front(),
                     "links without a cycle");
  }
  input->link(*output);
  links_.push_back(link);
}

void SceneGraph::validate() const {
  for (const auto& node : nodes_)
    for (const InputPort* input : node->inputs())
      if (input->required() && input->links().empty())
        throw sceneError("the input '" + input->path() + "' is not linked",
                         "a link from an output of type " + input->typeName())
            .inNode(node->name());
}

std::vector<Node*> SceneGraph::order() const {
  // By their places in the scene, where the links leave the order free: names must not change a run.
  std::map<const Node*, std::size_t> waitingFor;
  std::map<int, Node*> ready;
  for (const auto& node : nodes_) {
    std::size_t links = 0;
    for (const InputPort* input : node->inputs()) links += input->links().size();
    waitingFor[node.get()] = links;
    if (links == 0) ready[node->place()] = node.get();
  }
  std::vector<Node*> order;
  while (!ready.empty()) {
    Node* node = ready.begin()->second;
    ready.erase(ready.begin());
    order.push_back(node);
    for (const OutputPort* output : node->outputs())
      for (const InputPort* input : output->links())
        if (--waitingFor[&input->node()] == 0) ready[input->node().place()] = &input->node();
  }
  WEIR_CHECK(order.size() == nodes_.size());  // link() refuses cycles
  return order;
}

namespace {

/// Calls f, which is `hook` of the node; its Errors say so.
template <class F>
void callHook(const Node& node, std::string_view hook, F&& f) {
  try {
    callGuarded(
        node.source(), [&] { return hookText("", hook, node.source()); }, std::forward<F>(f));
  } catch (Error& e) {
    throw node.locate(e).inNode(node.name());
  }
}

}  // namespace

template <class F>
void SceneGraph::call(Node& node, std::string_view hook, Device& device, F&& f) {
  const std::size_t before = device.memoryUse().inUse;
  callHook(node, hook, std::forward<F>(f));
  deviceMemory_[&node] += static_cast<std::int64_t>(device.memoryUse().inUse - before);
}

std::int64_t SceneGraph::deviceMemoryOf(const Node& node) const {
  const auto entry = deviceMemory_.find(&node);
  return entry != deviceMemory_.end() ? entry->second : 0;
}

void SceneGraph::animate(double time) {
  for (const auto& node : nodes_) {
    node->animate(time);
    if (node->pipeline() == nullptr) continue;
    for (const auto& module : node->pipeline()->modules()) module->animate(time);
  }
}

void SceneGraph::configure(const SetupContext& context) {
  validate();
  animate(0);
  order_ = order();
  for (const auto& node : nodes_)
    for (OutputPort* output : node->outputs()) output->forgetRequests();
  for (auto node = order_.rbegin(); node != order_.rend(); ++node)
    call(**node, "configure", context.device, [&] { (*node)->configure(context); });
}

MemoryEstimate SceneGraph::estimate(const SetupContext& context) {
  configure(context);
  MemoryEstimate estimate;
  for (Node* node : order_) {
    MemoryNeeds needs;
    call(*node, "estimate", context.device, [&] { node->estimate(context, needs); });
    if (needs.device > 0) estimate.add(node->name(), std::move(needs));
  }
  return estimate;
}

void SceneGraph::save(const StateWriter& to) const {
  // A node with its modules is no more than the sum of these: no hook can leave out what is declared.
  for (Node* node : order_) {
    const StateWriter own = to.in(node->name());
    callHook(*node, "save", [&] { node->saveState(own); });
    if (const PipelineBase* pipeline = node->pipeline())
      callHook(*node, "save", [&] { pipeline->saveState(own.in(kModuleStates)); });
  }
}

void SceneGraph::restore(const StateReader& from) {
  for (Node* node : order_) {
    const StateReader own = from.in(node->name());
    callHook(*node, "restore", [&] { node->restoreState(own); });
    if (PipelineBase* pipeline = node->pipeline())
      callHook(*node, "restore", [&] { pipeline->restoreState(own.in(kModuleStates)); });
  }
}

void SceneGraph::reset(const SetupContext& context) {
  configure(context);
  for (std::size_t i = 0; i < order_.size(); ++i) {
    Node* node = order_[i];
    InterruptibleWork::endIfAsked();
    if (context.progress) context.progress(node->name(), i, order_.size());
    const ProfileScope scope(context.device.profiler(), node->name());
    call(*node, "reset", context.device, [&] { node->reset(context); });
  }
}

double SceneGraph::longestStep(const StepContext& next, double cfl) {
  animate(next.time);
  double longest = std::numeric_limits<double>::infinity();
  for (Node* node : order_)
    call(*node, "longestStep", next.device,
         [&] { longest = std::min(longest, node->longestStep(next, cfl)); });
  return longest;
}

void SceneGraph::stepNode(Node& node, const StepContext& context) {
  const ProfileScope scope(context.device.profiler(), node.name());
  call(node, "step", context.device, [&] { node.step(context); });
}

void SceneGraph::step(const StepContext& context) {
  animate(context.time);
  for (Node* node : order_) stepNode(*node, context);
}

void SceneGraph::follow(const std::vector<Node*>& nodes, const StepContext& context) {
  StepContext after = context;
  after.time += context.dt;
  animate(after.time);
  for (Node* node : order_) {
    if (std::find(nodes.begin(), nodes.end(), node) == nodes.end()) continue;
    if (context.dt > 0) stepNode(*node, context);
    call(*node, "frame", context.device, [&] { node->frame(after); });
  }
}

void SceneGraph::frame(const StepContext& context) {
  animate(context.time);
  for (Node* node : order_) call(*node, "frame", context.device, [&] { node->frame(context); });
}

}  // namespace weir
