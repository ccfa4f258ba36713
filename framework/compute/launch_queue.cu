#include "framework/compute/launch_queue.h"

#include <algorithm>
#include <cstdlib>
#include <string_view>
#include <utility>

namespace weir::detail {

struct LaunchQueue::Graph {
  Calls calls;
  cudaGraph_t graph = nullptr;
  cudaGraphExec_t executable = nullptr;
  std::vector<cudaGraphNode_t> nodes;  // of each call
  std::uint64_t lastLaunch = 0;

  ~Graph() {
    if (executable != nullptr) static_cast<void>(cudaGraphExecDestroy(executable));
    if (graph != nullptr) static_cast<void>(cudaGraphDestroy(graph));
  }
};

namespace {

/// `next` may be set up while `first` ends.
cudaError_t addOverlap(cudaGraph_t graph, cudaGraphNode_t first, cudaGraphNode_t next) {
  cudaGraphEdgeData edge{};
  edge.type = cudaGraphDependencyTypeProgrammatic;
  edge.from_port = cudaGraphKernelNodePortProgrammatic;
#if CUDART_VERSION >= 13000
  return cudaGraphAddDependencies(graph, &first, &next, &edge, 1);
#else
  return cudaGraphAddDependencies_v2(graph, &first, &next, &edge, 1);
#endif
}

/// Whether the current device knows of that.
bool canOverlap() {
  constexpr int kFirst = 9;  // compute capability
  int device = 0, major = 0;
  const bool known = cudaGetDevice(&device) == cudaSuccess &&
                     cudaDeviceGetAttribute(&major, cudaDevAttrComputeCapabilityMajor, device) == cudaSuccess;
  return known && major >= kFirst;
}

bool isSerial() {
  const char* value = std::getenv("WEIR_CUDA_SERIAL");
  return value != nullptr && std::string_view(value) == "1";
}

}  // namespace

LaunchQueue::LaunchQueue(cudaStream_t stream)
    : stream_(stream), overlaps_(canOverlap()), serial_(isSerial()) {}
LaunchQueue::~LaunchQueue() = default;

LaunchQueue::KernelFacts& LaunchQueue::facts(const void* kernel) {
  for (auto& [known, facts] : facts_)
    if (known == kernel) return facts;
  return facts_.emplace_back(kernel, KernelFacts{}).second;
}

void* LaunchQueue::note(const CallKind& kind, const void* what, Overlap overlap, std::size_t size) {
  const std::size_t begin = (now_.bytes.size() + kAlignment - 1) / kAlignment * kAlignment;
  now_.bytes.resize(begin + size);
  now_.list.push_back({&kind, what, overlap, begin, size});
  askers_.push_back(asker_);
  return now_.bytes.data() + begin;
}

cudaError_t LaunchQueue::issueNow(const CallKind& kind, const void* call) const {
  const cudaError_t error = kind.issue(call, stream_);
  return error == cudaSuccess && serial_ ? cudaStreamSynchronize(stream_) : error;
}

cudaError_t LaunchQueue::failed(std::size_t call, cudaError_t error) {
  if (error != cudaSuccess) failedAsker_ = askers_[call];
  return error;
}

cudaError_t LaunchQueue::issueAll() {
  cudaError_t error = cudaSuccess;
  for (std::size_t i = 0; i < now_.list.size() && error == cudaSuccess; ++i)
    error = failed(i, now_.list[i].kind->issue(now_.at(i), stream_));
  return error;
}

void LaunchQueue::drop() {
  gathering_ = false;
  now_.list.clear();
  now_.bytes.clear();
  askers_.clear();
}

cudaError_t LaunchQueue::flush() {
  if (!gathering_) return cudaSuccess;
  failedAsker_ = -1;
  const cudaError_t error = issueAll();
  drop();
  return error;
}

cudaError_t LaunchQueue::end() {
  if (!gathering_) return cudaSuccess;
  failedAsker_ = -1;
  const cudaError_t error = now_.list.empty() ? cudaSuccess : launch();
  drop();
  return error;
}

cudaError_t LaunchQueue::launch() {
  std::size_t differing = 0;
  Graph* graph = closest(differing);
  // Most calls differ where arrays have been swapped: that comes again, and wants a graph of its own.
  const bool another = graph == nullptr || 2 * differing > now_.list.size();
  cudaError_t error = cudaSuccess;
  if (another && graphs_.size() < kMaxGraphs) {
    // What no step did before may never come again.
    if (before_ != now_.list) {
      before_ = now_.list;
      return issueAll();
    }
    graphs_.push_back(std::make_unique<Graph>());
    graph = graphs_.back().get();
    error = build(*graph);
    if (error != cudaSuccess) {
      graphs_.pop_back();
      return error;
    }
  } else if (graph == nullptr) {
    const auto oldest = std::min_element(graphs_.begin(), graphs_.end(), [](const auto& a, const auto& b) {
      return a->lastLaunch < b->lastLaunch;
    });
    static_cast<void>(cudaStreamSynchronize(stream_));  // it may still be running
    graphs_.erase(oldest);
    before_ = now_.list;
    return issueAll();
  } else if (differing > 0) {
    error = update(*graph);
  }
  if (error == cudaSuccess) error = cudaGraphLaunch(graph->executable, stream_);
  graph->lastLaunch = ++launches_;
  return error;
}

/// The graph of the same calls with the fewest parameters that differ; null if there is none.
LaunchQueue::Graph* LaunchQueue::closest(std::size_t& differing) {
  Graph* best = nullptr;
  for (const auto& graph : graphs_) {
    if (graph->calls.list != now_.list) continue;
    std::size_t differs = 0;
    bool fixed = true;
    for (std::size_t i = 0; i < now_.list.size(); ++i) {
      if (std::memcmp(graph->calls.at(i), now_.at(i), now_.list[i].size) == 0) continue;
      ++differs;
      fixed = fixed && now_.list[i].kind->update != nullptr;
    }
    if (!fixed || (best != nullptr && differs >= differing)) continue;
    best = graph.get();
    differing = differs;
  }
  return best;
}

cudaError_t LaunchQueue::build(Graph& graph) {
  cudaError_t error = cudaGraphCreate(&graph.graph, 0);
  for (std::size_t i = 0; i < now_.list.size() && error == cudaSuccess; ++i)
    error = failed(i, addNode(graph, i));
  if (error == cudaSuccess) error = cudaGraphInstantiate(&graph.executable, graph.graph, 0);
  graph.calls = now_;
  return error;
}

/// Whether a call may be set up while the one before it ends.
bool LaunchQueue::overlapsBefore(std::size_t call) const {
  if (!overlaps_ || call == 0) return false;
  const Noted &first = now_.list[call - 1], &next = now_.list[call];
  return first.kind->isKernel && next.overlap.waits && next.overlap.readsAhead <= first.overlap.leaves;
}

/// One after the other: modules build upon each other.
cudaError_t LaunchQueue::addNode(Graph& graph, std::size_t call) {
  const CallKind& kind = *now_.list[call].kind;
  const cudaGraphNode_t* after = graph.nodes.empty() ? nullptr : &graph.nodes.back();
  const std::size_t afters = graph.nodes.empty() ? 0 : 1;
  cudaGraphNode_t node = nullptr;
  cudaError_t error = cudaSuccess;
  if (overlapsBefore(call)) {
    error = kind.add(now_.at(call), graph.graph, nullptr, 0, &node);
    if (error == cudaSuccess) error = addOverlap(graph.graph, *after, node);
  } else if (kind.add != nullptr) {
    error = kind.add(now_.at(call), graph.graph, after, afters, &node);
  } else {
    cudaGraph_t part = nullptr;
    error = cudaStreamBeginCapture(stream_, cudaStreamCaptureModeRelaxed);
    if (error == cudaSuccess) error = kind.issue(now_.at(call), stream_);
    const cudaError_t ended = cudaStreamEndCapture(stream_, &part);
    if (error == cudaSuccess) error = ended;
    if (error == cudaSuccess) error = cudaGraphAddChildGraphNode(&node, graph.graph, after, afters, part);
    if (part != nullptr) static_cast<void>(cudaGraphDestroy(part));
  }
  graph.nodes.push_back(node);
  return error;
}

cudaError_t LaunchQueue::update(Graph& graph) {
  cudaError_t error = cudaSuccess;
  for (std::size_t i = 0; i < now_.list.size() && error == cudaSuccess; ++i) {
    const std::size_t size = now_.list[i].size;
    if (std::memcmp(graph.calls.at(i), now_.at(i), size) == 0) continue;
    error = failed(i, now_.list[i].kind->update(now_.at(i), graph.executable, graph.nodes[i]));
  }
  std::swap(graph.calls, now_);
  return error;
}

}  // namespace weir::detail
