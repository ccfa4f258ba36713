#include "framework/run/guarded_checkpoint.h"

#include <string>
#include <utility>

#include "framework/base/text.h"
#include "framework/graph/guard.h"

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

Checkpoint readCheckpoint(const CheckpointStore& store, const fs::path& file, const Simulation& simulation) {
  Checkpoint checkpoint = store.read(file);
  try {
    checkBelongs(checkpoint, simulation);
  } catch (Error& e) {
    throw e.at({.file = file.string()});
  }
  return checkpoint;
}

}  // namespace weir
