#include "framework/run/guarded_checkpoint.h"

#include <functional>
#include <string>
#include <utility>

#include "framework/base/text.h"
#include "framework/graph/guard.h"

namespace weir {

namespace fs = std::filesystem;

namespace {

/// What is called, and of which library: "checkpoints 'hdf5'".
struct Part {
  std::string what, source;

  void guarded(std::string_view hook, const std::function<void()>& f) const {
    constexpr bool kFilesSayEnough = true;
    callGuarded(
        source, [&] { return hookText(what, hook, source); }, f, kFilesSayEnough);
  }
};

class GuardedStore final : public CheckpointStore {
 public:
  GuardedStore(std::unique_ptr<CheckpointStore> store, Part part)
      : store_(std::move(store)), part_(std::move(part)) {
    part_.guarded("extension", [&] { extension_ = store_->extension(); });
  }

  std::string_view extension() const override { return extension_; }
  void write(const fs::path& file, const Checkpoint& checkpoint) const override {
    part_.guarded("write", [&] { store_->write(file, checkpoint); });
  }
  Checkpoint read(const fs::path& file) const override {
    Checkpoint checkpoint;
    part_.guarded("read", [&] { checkpoint = store_->read(file); });
    return checkpoint;
  }

 private:
  std::unique_ptr<CheckpointStore> store_;
  Part part_;
  std::string extension_;
};

}  // namespace

std::vector<std::unique_ptr<CheckpointStore>> guardedCheckpointStores(const Registry& registry) {
  std::vector<std::unique_ptr<CheckpointStore>> stores;
  for (auto& [name, store, source] : registry.createServices<CheckpointStore>())
    stores.push_back(
        std::make_unique<GuardedStore>(std::move(store), Part{"checkpoints " + inQuotes(name), source}));
  return stores;
}

}  // namespace weir
