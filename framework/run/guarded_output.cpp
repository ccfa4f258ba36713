#include "framework/run/guarded_output.h"

#include <utility>

#include "framework/base/check.h"
#include "framework/base/text.h"
#include "framework/graph/guard.h"
#include "framework/run/output_by_ranks.h"

namespace weir {

namespace {

/// The output `name` of the library `source`.
GuardedPart outputPart(const std::string& name, const std::string& source) {
  return {"output " + inQuotes(name), source};
}

class GuardedObserver final : public Observer {
 public:
  GuardedObserver(std::unique_ptr<Observer> observer, GuardedPart part)
      : observer_(std::move(observer)), part_(std::move(part)) {
    // Asked once, as a worker asks for the name where nothing may be thrown.
    part_.call("name", [&] { name_ = observer_->name(); });
    part_.call("stateName", [&] { stateName_ = observer_->stateName(); });
  }

  std::string name() const override { return name_; }
  std::string_view stateName() const override { return stateName_; }
  void begin(Simulation& simulation) override {
    part_.call("begin", [&] { observer_->begin(simulation); });
  }
  void save(const StateWriter& to) override {
    part_.call("save", [&] { observer_->save(to); });
  }
  void resume(Simulation& simulation, const StateReader& from) override {
    part_.call("resume", [&] { observer_->resume(simulation, from); });
  }
  std::unique_ptr<Snapshot> capture(Simulation& simulation, std::unique_ptr<Snapshot> used) override {
    std::unique_ptr<Snapshot> snapshot;
    part_.call("capture", [&] { snapshot = observer_->capture(simulation, std::move(used)); });
    return snapshot;
  }
  void write(Snapshot& snapshot) override {
    part_.call("write", [&] { observer_->write(snapshot); });
  }
  std::vector<OutputPart> writeParts() const override {
    std::vector<OutputPart> parts;
    part_.call("writeParts", [&] { parts = observer_->writeParts(); });
    return parts;
  }
  void end(Simulation& simulation, RunEnd how) override {
    part_.call("end", [&] { observer_->end(simulation, how); });
  }

 private:
  std::unique_ptr<Observer> observer_;
  GuardedPart part_;
  std::string name_, stateName_;
};

}  // namespace

std::vector<OutputOption> optionsOf(const OutputKind& kind, const std::string& name,
                                    const std::string& source) {
  std::vector<OutputOption> options;
  outputPart(name, source).call("options", [&] { options = kind.options(); });
  return options;
}

bool showsReplays(const OutputKind& kind, const std::string& name, const std::string& source) {
  bool shows = false;
  outputPart(name, source).call("showsReplays", [&] { shows = kind.showsReplays(); });
  return shows;
}

bool isByRanks(const OutputKind& kind, const std::string& name, const std::string& source,
               const Scene& scene) {
  const auto* const byRanks = dynamic_cast<const OutputByRanks*>(&kind);
  bool asked = false;
  if (byRanks != nullptr) outputPart(name, source).call("isAsked", [&] { asked = byRanks->isAsked(scene); });
  return asked;
}

std::unique_ptr<Observer> makeGuardedObserver(const OutputKind& kind, const std::string& name,
                                              const std::string& source, const OutputPaths& paths,
                                              Communicator* ranks) {
  std::unique_ptr<Observer> observer;
  outputPart(name, source).call("create", [&] {
    observer = ranks != nullptr ? dynamic_cast<const OutputByRanks&>(kind).create(paths, *ranks)
                                : kind.create(paths);
    WEIR_CHECK(observer != nullptr);
  });
  return std::make_unique<GuardedObserver>(std::move(observer), outputPart(name, source));
}

}  // namespace weir
