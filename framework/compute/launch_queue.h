// What a CUDA device is asked to do, issued at once or gathered over a step and handed over as one graph.
//
// A step of a simulation asks for nearly the same kernels every time. Launching them one by one costs the
// host some microseconds each, more than a small scene's kernels take. So the calls of a step are noted with
// all their parameters, and compared with those of earlier steps: where all are equal, the graph of that step
// is launched again; where only parameters differ, they are changed in it. Whatever a step does differently
// (another count, swapped arrays, a new module) is seen, because everything that kernels get is compared.
#pragma once

#include <cuda_runtime.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <new>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "framework/base/api.h"
#include "framework/compute/standing.h"

namespace weir::detail {

/// How far a kernel of a graph overlaps with those beside it (kernel_overlap.h).
struct Overlap {
  bool waits = false;  ///< it begins by waiting for the one before it, but for what it reads ahead
  Standing leaves = Standing::kNothing, readsAhead = Standing::kNothing;
  bool operator==(const Overlap&) const = default;
};

/// How one kind of call is made.
struct CallKind {
  cudaError_t (*issue)(const void* call, cudaStream_t stream);
  /// Adds a node to a graph; null if it has to be captured from the stream.
  cudaError_t (*add)(const void* call, cudaGraph_t graph, const cudaGraphNode_t* after, std::size_t afters,
                     cudaGraphNode_t* node);
  /// Gives a node of an instantiated graph new parameters; null if that cannot be.
  cudaError_t (*update)(const void* call, cudaGraphExec_t graph, cudaGraphNode_t node);
  bool isKernel = false;
};

class WEIR_API LaunchQueue {
 public:
  /// Of the current device. With the environment variable WEIR_CUDA_SERIAL=1 nothing is gathered, and each
  /// call ends before the next begins: errors then name the kernel that made them, and a run must have the
  /// same bits as one in which kernels overlap.
  explicit LaunchQueue(cudaStream_t stream);
  ~LaunchQueue();
  LaunchQueue(const LaunchQueue&) = delete;
  LaunchQueue& operator=(const LaunchQueue&) = delete;

  /// Issues the call, or notes it while calls are gathered. `what` tells kernels of one kind apart. Call is
  /// trivially destructible, and its bytes say all that it does.
  template <class Call>
  cudaError_t submit(const CallKind& kind, const void* what, const Call& call, Overlap overlap = {}) {
    static_assert(std::is_trivially_destructible_v<Call> && alignof(Call) <= kAlignment);
    if (!gathering_) return issueNow(kind, &call);
    std::memcpy(note(kind, what, overlap, sizeof(Call)), &call, sizeof(Call));
    return cudaSuccess;
  }

  void begin() { gathering_ = !serial_; }
  /// Launches what was gathered, as a graph if a step asked for the like before.
  cudaError_t end();
  /// Issues what was gathered one by one; calls are issued at once from now on until the next begin().
  cudaError_t flush();
  /// Forgets what was gathered.
  void drop();
  bool gathering() const { return gathering_; }

  /// Who asks for the calls that are noted from now on: a number of the caller's choice.
  void setAsker(int asker) { asker_ = asker; }
  /// Who asked for the noted call that failed; -1 if nobody knows.
  int failedAsker() const { return failedAsker_; }

  static constexpr unsigned kUnknown = ~0u;
  /// What is known of a kernel (kernel_facts.h).
  struct KernelFacts {
    unsigned sharedBytes = kUnknown;  ///< the most that a launch may ask for
  };
  KernelFacts& facts(const void* kernel);

 private:
  static constexpr std::size_t kAlignment = 16;
  static constexpr std::size_t kMaxGraphs = 8;  // a step may alternate between arrays, and emit or not

  struct Noted {
    const CallKind* kind;
    const void* what;
    Overlap overlap;
    std::size_t begin, size;  // bytes of the call in Calls::bytes
    bool operator==(const Noted&) const = default;
  };
  struct Calls {
    std::vector<Noted> list;
    std::vector<unsigned char> bytes;  // memory from operator new is aligned to kAlignment
    const void* at(std::size_t i) const { return bytes.data() + list[i].begin; }
  };
  struct Graph;

  cudaError_t issueNow(const CallKind& kind, const void* call) const;
  cudaError_t failed(std::size_t call, cudaError_t error);
  void* note(const CallKind& kind, const void* what, Overlap overlap, std::size_t size);
  cudaError_t issueAll();
  cudaError_t launch();
  Graph* closest(std::size_t& differing);
  cudaError_t build(Graph& graph);
  bool overlapsBefore(std::size_t call) const;
  cudaError_t addNode(Graph& graph, std::size_t call);
  cudaError_t update(Graph& graph);

  cudaStream_t stream_;
  bool overlaps_;  // kernels in graphs
  bool serial_;    // each call ends before the next begins, see the constructor
  bool gathering_ = false;
  Calls now_;
  std::vector<int> askers_;  // of each call in now_
  int asker_ = -1, failedAsker_ = -1;
  std::vector<Noted> before_;  // of the last step
  std::vector<std::unique_ptr<Graph>> graphs_;
  std::uint64_t launches_ = 0;
  std::vector<std::pair<const void*, KernelFacts>> facts_;
};

// What hands kernels to the CUDA runtime is hidden or static, so that no library calls another's copy of it.

/// A kernel with its launch and its arguments.
template <class... P>
struct KernelCall {
  void (*kernel)(P...);
  unsigned blocks, threads;
  unsigned sharedBytes;
  std::tuple<P...> arguments;
};

template <class... P>
struct [[gnu::visibility("hidden")]] KernelCalls {
  using Call = KernelCall<P...>;

  /// f(parameters for the runtime), where arguments are given by their addresses.
  template <class F>
  static cudaError_t withParameters(const void* pointer, const F& f) {
    auto& call = *static_cast<Call*>(const_cast<void*>(pointer));
    return std::apply(
        [&](auto&... arguments) {
          void* addresses[] = {const_cast<void*>(static_cast<const void*>(&arguments))...};
          cudaKernelNodeParams parameters{};
          parameters.func = reinterpret_cast<void*>(call.kernel);
          parameters.gridDim = dim3(call.blocks);
          parameters.blockDim = dim3(call.threads);
          parameters.sharedMemBytes = call.sharedBytes;
          parameters.kernelParams = addresses;
          return f(parameters);
        },
        call.arguments);
  }

  static cudaError_t issue(const void* call, cudaStream_t stream) {
    return withParameters(call, [&](const cudaKernelNodeParams& p) {
      return cudaLaunchKernel(p.func, p.gridDim, p.blockDim, p.kernelParams, p.sharedMemBytes, stream);
    });
  }
  static cudaError_t add(const void* call, cudaGraph_t graph, const cudaGraphNode_t* after,
                         std::size_t afters, cudaGraphNode_t* node) {
    return withParameters(call, [&](const cudaKernelNodeParams& p) {
      return cudaGraphAddKernelNode(node, graph, after, afters, &p);
    });
  }
  static cudaError_t update(const void* call, cudaGraphExec_t graph, cudaGraphNode_t node) {
    return withParameters(call, [&](const cudaKernelNodeParams& p) {
      return cudaGraphExecKernelNodeSetParams(graph, node, &p);
    });
  }

  static constexpr CallKind kKind{issue, add, update, true};
};

/// How a kernel is launched.
struct LaunchShape {
  unsigned blocks, threads;
  unsigned sharedBytes = 0;
  Overlap overlap{};
};

template <class... P>
static cudaError_t submitKernel(LaunchQueue& queue, void (*kernel)(P...), const LaunchShape& shape,
                                const std::type_identity_t<P>&... arguments) {
  // Calls are compared byte by byte; padding inside of arguments that happens to differ costs an update.
  alignas(KernelCall<P...>) unsigned char zeros[sizeof(KernelCall<P...>)] = {};
  auto& call =
      *new (zeros) KernelCall<P...>{kernel, shape.blocks, shape.threads, shape.sharedBytes, {arguments...}};
  return queue.submit(KernelCalls<P...>::kKind, reinterpret_cast<const void*>(kernel), call, shape.overlap);
}

}  // namespace weir::detail
