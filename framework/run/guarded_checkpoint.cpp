#include "framework/run/guarded_checkpoint.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <span>
#include <string>
#include <system_error>
#include <utility>

#include "framework/base/text.h"
#include "framework/graph/guard.h"
#include "framework/run/checkpoint_parts.h"

namespace weir {

namespace fs = std::filesystem;

namespace {

class GuardedStore final : public CheckpointStore {
 public:
  GuardedStore(std::unique_ptr<CheckpointStore> store, GuardedPart part)
      : store_(std::move(store)), part_(std::move(part)) {
    part_.call("extension", [&] { extension_ = store_->extension(); });
  }

  std::string_view extension() const override { return extension_; }
  void write(const fs::path& file, const Checkpoint& checkpoint) const override {
    part_.call("write", [&] { store_->write(file, checkpoint); });
  }
  Checkpoint read(const fs::path& file) const override {
    Checkpoint checkpoint;
    part_.call("read", [&] { checkpoint = store_->read(file); });
    return checkpoint;
  }

 private:
  std::unique_ptr<CheckpointStore> store_;
  GuardedPart part_;
  std::string extension_;
};

void throwIfForbidden(const fs::path& file) {
  if (::access(file.c_str(), R_OK) == 0 || errno == ENOENT) return;
  throw ioError("cannot read the checkpoint: " + std::generic_category().message(errno))
      .at({.file = file.string()});
}

RankShare shareOf(const Communicator* ranks) {
  return ranks != nullptr ? RankShare{ranks->rank(), ranks->size()} : RankShare{};
}

/// Without its parts, which are no checkpoints.
Checkpoint readNamed(const CheckpointStore& store, const fs::path& file) {
  Checkpoint checkpoint = store.read(file);
  if (const std::optional<int> rank = rankOfPart(checkpoint))
    throw ioError(fmt::format("this is the part of a checkpoint that rank {} has written", *rank),
                  "the file that names it, beside the folder in which it stands")
        .at({.file = file.string()});
  return checkpoint;
}

/// The first that is not empty.
std::string firstOfRanks(const std::string& own, Communicator* ranks) {
  if (ranks == nullptr) return own;
  const auto bytes = std::as_bytes(std::span(own));
  for (const Message& text : ranks->allGather(Message(bytes.begin(), bytes.end())))
    if (!text.empty()) return {reinterpret_cast<const char*>(text.data()), text.size()};
  return {};
}

/// None if it is not whole for one of the ranks.
std::optional<Checkpoint> readWhole(const CheckpointStore& store, const fs::path& file, Log& log,
                                    Communicator* ranks) {
  std::optional<Checkpoint> checkpoint;
  std::string problem;
  try {
    checkpoint = readNamed(store, file);
    readParts(store, file, *checkpoint, shareOf(ranks));
  } catch (const Error& e) {
    problem = e.what();
  }
  problem = firstOfRanks(problem, ranks);
  if (problem.empty()) return checkpoint;
  log.warn("going on without a checkpoint: " + problem);
  return std::nullopt;
}

bool isThere(const fs::path& file, Communicator* ranks) {
  std::error_code ignored;
  const bool seen = fs::exists(file, ignored);
  return ranks != nullptr ? ranks->any(seen) : seen;
}

void throwUnlessBelongs(const Checkpoint& checkpoint, const fs::path& file, const Simulation& simulation) {
  try {
    checkBelongs(checkpoint, simulation);
  } catch (Error& e) {
    throw e.at({.file = file.string()});
  }
}

}  // namespace

std::vector<std::unique_ptr<CheckpointStore>> guardedCheckpointStores(const Registry& registry) {
  std::vector<std::unique_ptr<CheckpointStore>> stores;
  for (auto& [name, store, source] : registry.createServices<CheckpointStore>())
    stores.push_back(std::make_unique<GuardedStore>(std::move(store),
                                                    GuardedPart{"checkpoints " + inQuotes(name), source}));
  return stores;
}

std::unique_ptr<CheckpointStore> checkpointStoreOf(const Registry& registry, const std::string& option,
                                                   const fs::path& file) {
  std::vector<std::string> endings;
  for (auto& store : guardedCheckpointStores(registry)) {
    endings.emplace_back(store->extension());
    if (file.extension() == store->extension()) return std::move(store);
  }
  throw usageError(option + " is of no known kind",
                   endings.empty() ? "nothing: no plugin that keeps checkpoints is loaded"
                                   : "a file that ends in " + joinNames(endings));
}

Checkpoint readCheckpoint(const CheckpointStore& store, const fs::path& file, const Simulation& simulation,
                          const Communicator* ranks) {
  Checkpoint checkpoint = readNamed(store, file);
  throwUnlessBelongs(checkpoint, file, simulation);
  readParts(store, file, checkpoint, shareOf(ranks));
  return checkpoint;
}

std::optional<Checkpoint> readNewestCheckpoint(const CheckpointStore& store, const fs::path& file,
                                               const Simulation& simulation, Communicator* ranks) {
  for (const fs::path& candidate : {file, Checkpoints::previousOf(file)}) {
    throwIfForbidden(candidate);
    if (!isThere(candidate, ranks)) continue;
    std::optional<Checkpoint> found = readWhole(store, candidate, simulation.log(), ranks);
    if (!found) continue;
    throwUnlessBelongs(*found, candidate, simulation);
    simulation.log().info("going on from " + printable(candidate.string(), 200));
    return found;
  }
  simulation.log().info("there is no whole checkpoint yet: from the start");
  return std::nullopt;
}

}  // namespace weir
