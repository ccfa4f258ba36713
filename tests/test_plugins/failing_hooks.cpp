// Types that fail where they are told to, as a plugin with mistakes would.
#include <fstream>
#include <stdexcept>

#include <weir/error.h>
#include <weir/fluid_module.h>
#include <weir/output.h>
#include <weir/particle_fluid.h>
#include <weir/plugin.h>
#include <weir/readers.h>

namespace {

using namespace weir;

struct NoException {};

void failIf(bool fails, const std::string& hook) {
  if (fails) throw std::runtime_error("mistake in " + hook);
}

class FailingNode final : public Node {
 public:
  static constexpr NodeInfo kInfo{"FailingNode", "Fails in one of its functions."};
  const NodeInfo& info() const override { return kInfo; }
  Param<std::string> hook{*this, "hook", "", {.doc = "The function that fails."}};

  void validate() const override { failIf(*hook == "validate", "validate"); }
  void configure(const SetupContext&) override { failIf(*hook == "configure", "configure"); }
  void estimate(const SetupContext&, MemoryNeeds&) override { failIf(*hook == "estimate", "estimate"); }
  double longestStep(const StepContext& next, double) override {
    failIf(*hook == "longestStep", "longestStep");
    return next.dt;
  }
  void save(const StateWriter&) const override { failIf(*hook == "save", "save"); }
  void restore(const StateReader&) override { failIf(*hook == "restore", "restore"); }
  void report(NodeReport&) override { failIf(*hook == "report", "report"); }
  void reset(const SetupContext&) override { failIf(*hook == "reset", "reset"); }
  void step(const StepContext&) override {
    failIf(*hook == "step", "step");
    if (*hook == "step_no_exception") throw NoException{};
    if (*hook == "step_check") WEIR_CHECK(1 == 2);
    if (*hook == "step_error") throw simulationError("mistake in step_error");
  }
  void frame(const StepContext&) override { failIf(*hook == "frame", "frame"); }
};

class FailingModule final : public FluidModule {
 public:
  static constexpr ModuleInfo kInfo{"FailingModule", kFamily, "Fails in one of its functions."};
  const ModuleInfo& info() const override { return kInfo; }
  Param<std::string> hook{*this, "hook", "", {.doc = "The function that fails."}};

  void validate() const override { failIf(*hook == "validate", "validate"); }
  double memory(const FluidRoom&) const override {
    failIf(*hook == "memory", "memory");
    return 0;
  }
  void save(const StateWriter&) const override { failIf(*hook == "save", "save"); }
  void restore(const StateReader&) override { failIf(*hook == "restore", "restore"); }
  void report(NodeReport&) override { failIf(*hook == "report", "report"); }
  void reset(FluidStep&) override { failIf(*hook == "reset", "reset"); }
  void warn(const FluidOutlook&) const override { failIf(*hook == "warn", "warn"); }
  void step(FluidStep&) override { failIf(*hook == "step", "step"); }
};

class FailsAtBirth final : public Node {
 public:
  static constexpr NodeInfo kInfo{"FailsAtBirth", "Cannot be made."};
  const NodeInfo& info() const override { return kInfo; }
  FailsAtBirth() { failIf(true, "the constructor"); }
  void reset(const SetupContext&) override {}
};

class FailingSection final : public Configurable {
 public:
  Param<bool> fails{*this, "fails", false, {.doc = "Whether it does."}};
  void validate() const override { failIf(fails, "validate"); }
};

/// Fails in the function that its folder is called after.
class FailingObserver final : public Observer {
 public:
  explicit FailingObserver(std::string hook) : hook_(std::move(hook)) {}
  std::string name() const override {
    failIf(hook_ == "name", "name");
    return "failing";
  }
  void begin(Simulation&) override { failIf(hook_ == "begin", "begin"); }
  std::string_view stateName() const override { return "failing"; }
  void save(const StateWriter& to) override {
    failIf(hook_ == "save", "save");
    to.put("number", 1);
  }
  void resume(Simulation&, const StateReader&) override { failIf(hook_ == "resume", "resume"); }
  std::unique_ptr<Snapshot> capture(Simulation&, std::unique_ptr<Snapshot>) override {
    failIf(hook_ == "capture", "capture");
    return std::make_unique<Snapshot>();
  }
  void write(Snapshot&) override { failIf(hook_ == "write", "write"); }
  void end(Simulation&, RunEnd) override { failIf(hook_ == "end", "end"); }

 private:
  std::string hook_;
};

class FailingOutput final : public OutputKind {
 public:
  std::vector<OutputOption> options() const override {
    return {{"failing", "DIR", {}, "A folder that is called after the function that fails."}};
  }
  std::unique_ptr<Observer> create(const OutputPaths& paths) const override {
    const std::string hook = paths.at("failing").filename();
    failIf(hook == "create", "create");
    return std::make_unique<FailingObserver>(hook);
  }
};

/// Fails in the function that the file is called after: "write.failing".
class FailingStore final : public CheckpointStore {
 public:
  std::string_view extension() const override { return ".failing"; }
  void write(const std::filesystem::path& file, const Checkpoint&) const override {
    failIf(file.filename().string().starts_with("write."), "write");
    std::ofstream(file) << "nothing";
  }
  Checkpoint read(const std::filesystem::path&) const override {
    failIf(true, "read");
    return {};
  }
};

/// The same.
class FailingRecording final : public Recording {
 public:
  explicit FailingRecording(std::string hook) : hook_(std::move(hook)) {}
  const std::vector<double>& times() const override {
    failIf(hook_ == "times", "times");
    return times_;
  }
  const std::vector<std::string>& fluids() const override {
    failIf(hook_ == "fluids", "fluids");
    return fluids_;
  }
  std::vector<RecordedFluid> read(std::size_t) const override {
    failIf(hook_ == "read", "read");
    return std::vector<RecordedFluid>(1);
  }

 private:
  std::string hook_;
  std::vector<double> times_ = {0, 0.1};
  std::vector<std::string> fluids_ = {"water"};
};

class FailingReader final : public RecordingReader {
 public:
  std::vector<std::string> extensions() const override { return {".failing"}; }
  std::unique_ptr<Recording> open(const std::filesystem::path& file) const override {
    const std::string hook = file.stem();
    failIf(hook == "open", "open");
    if (hook == "nothing") return nullptr;
    return std::make_unique<FailingRecording>(hook);
  }
};

}  // namespace

WEIR_PLUGIN("failing_hooks", "Fails where it is told to.", registry) {
  registry.addNode<FailingNode>();
  registry.addNode<FailsAtBirth>();
  registry.addModule<FailingModule>();
  registry.addSection<FailingSection>("failing", "Fails where it is told to.");
  registry.addService<OutputKind>("failing", [] { return std::make_unique<FailingOutput>(); });
  registry.addService<CheckpointStore>("failing", [] { return std::make_unique<FailingStore>(); });
  registry.addService<RecordingReader>("failing", [] { return std::make_unique<FailingReader>(); });
}
