#include "framework/run/guarded_output.h"

#include <utility>

#include "framework/base/check.h"
#include "framework/base/text.h"
#include "framework/graph/guard.h"

namespace weir {

namespace {

/// Calls f, which is `hook` of the output `name` of the library `source`.
void callOutput(const std::string& name, const std::string& source, std::string_view hook,
                const std::function<void()>& f) {
  constexpr bool kFilesSayEnough = true;
  callGuarded(
      source, [&] { return hookText("output " + inQuotes(name), hook, source); }, f, kFilesSayEnough);
}

class GuardedObserver final : public Observer {
 public:
  GuardedObserver(std::unique_ptr<Observer> observer, std::string name, std::string source)
      : observer_(std::move(observer)), output_(std::move(name)), source_(std::move(source)) {
    // Asked once, as a worker asks for the name where nothing may be thrown.
    guarded("name", [&] { name_ = observer_->name(); });
    guarded("stateName", [&] { stateName_ = observer_->stateName(); });
  }

  std::string name() const override { return name_; }
  std::string_view stateName() const override { return stateName_; }
  void begin(Simulation& simulation) override {
    guarded("begin", [&] { observer_->begin(simulation); });
  }
  void save(const StateWriter& to) override {
    guarded("save", [&] { observer_->save(to); });
  }
  void resume(Simulation& simulation, const StateReader& from) override {
    guarded("resume", [&] { observer_->resume(simulation, from); });
  }
  std::unique_ptr<Snapshot> capture(Simulation& simulation, std::unique_ptr<Snapshot> used) override {
    std::unique_ptr<Snapshot> snapshot;
    guarded("capture", [&] { snapshot = observer_->capture(simulation, std::move(used)); });
    return snapshot;
  }
  void write(Snapshot& snapshot) override {
    guarded("write", [&] { observer_->write(snapshot); });
  }
  std::vector<OutputPart> writeParts() const override {
    std::vector<OutputPart> parts;
    guarded("writeParts", [&] { parts = observer_->writeParts(); });
    return parts;
  }
  void end(Simulation& simulation, RunEnd how) override {
    guarded("end", [&] { observer_->end(simulation, how); });
  }

 private:
  void guarded(std::string_view hook, const std::function<void()>& f) const {
    callOutput(output_, source_, hook, f);
  }

  std::unique_ptr<Observer> observer_;
  std::string output_, source_, name_, stateName_;
};

}  // namespace

std::vector<OutputOption> optionsOf(const OutputKind& kind, const std::string& name,
                                    const std::string& source) {
  std::vector<OutputOption> options;
  callOutput(name, source, "options", [&] { options = kind.options(); });
  return options;
}

bool showsReplays(const OutputKind& kind, const std::string& name, const std::string& source) {
  bool shows = false;
  callOutput(name, source, "showsReplays", [&] { shows = kind.showsReplays(); });
  return shows;
}

std::unique_ptr<Observer> makeGuardedObserver(const OutputKind& kind, const std::string& name,
                                              const std::string& source, const OutputPaths& paths) {
  std::unique_ptr<Observer> observer;
  callOutput(name, source, "create", [&] {
    observer = kind.create(paths);
    WEIR_CHECK(observer != nullptr);
  });
  return std::make_unique<GuardedObserver>(std::move(observer), name, source);
}

}  // namespace weir
