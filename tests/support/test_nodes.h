// Small node, module and section types with every kind of parameter and port, for tests of the framework.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "framework/graph/registry.h"

namespace weir {

enum class TestShape { kBox, kSphere, kPlane };
template <>
struct EnumNames<TestShape> {
  static constexpr std::array<EnumName, 3> kNames{
      {{"box", "A box."}, {"sphere", "A sphere."}, {"plane", "A plane."}}};
};

}  // namespace weir

namespace weir::test {

/// Travels along links, and takes requests.
struct Number {
  static constexpr std::string_view kPortType = "Number";
  struct Request {
    double spacing = 0;
    friend bool operator==(const Request&, const Request&) = default;
  };
  double value = 0;
};

/// Travels along links, and takes none.
struct Text {
  static constexpr std::string_view kPortType = "Text";
  std::string value;
};

struct Point : Configurable {
  Param<Vec3f> position{*this, "position", {}, {.unit = "m", .doc = "Where it is."}};
  Param<double> time{*this, "time", 0, {.unit = "s", .min = 0, .doc = "When it is there."}};
};

/// A source with a parameter of every kind.
class Source final : public Node {
 public:
  static constexpr NodeInfo kInfo{"Source", "Puts out a number."};
  const NodeInfo& info() const override { return kInfo; }

  Param<bool> flag{*this, "flag", false, {.doc = "A flag."}};
  Param<int> count{*this, "count", 3, {.min = 1, .max = 100, .doc = "A count."}};
  Param<std::int64_t> big{*this, "big", 1, {.doc = "A large integer."}};
  Param<float> speed{*this, "speed", 1.5f, {.unit = "m/s", .min = 0, .doc = "A speed."}};
  Param<double> spacing{*this, "spacing", 0.1, {.unit = "m", .min = 0, .aboveMin = true, .doc = "A length."}};
  Param<Vec2f> size{*this, "size", {1, 2}, {.unit = "m", .min = 0}};
  Param<Vec3f> position{*this, "position", {0, 1, 0}, {.unit = "m"}};
  Param<Color> color{*this, "color", {1, 0.5f, 0.25f, 1}};
  Param<Rotation> rotation{*this, "rotation", {}};
  Param<std::string> label{*this, "label", "source"};
  Param<FilePath> file{*this, "file", {}};
  Param<Curve> profile{*this, "profile", {}, {.minItems = 2}};
  Param<TestShape> shape{*this, "shape", TestShape::kBox};
  Param<std::optional<double>> limit{*this, "limit", std::nullopt, {.min = 0}};
  Param<std::vector<Vec3f>> points{*this, "points", {}};
  Param<std::vector<FilePath>> files{*this, "files", {}};
  Group<Point> start{*this, "start", "Where it starts."};
  GroupList<Point> path{*this, "path", "Where it goes."};
  Output<Number> number{*this, "number", "The number."};

  void validate() const override {
    if (*flag && count > 50) throw sceneError("flag is on and count is above 50", "one of them");
  }
  void reset(const SetupContext&) override { number->value = spacing; }
};

/// Fails to validate as long as its parameter is not given.
class NeedsFile final : public Node {
 public:
  static constexpr NodeInfo kInfo{"NeedsFile", "Reads a file."};
  const NodeInfo& info() const override { return kInfo; }
  Param<FilePath> file{*this, "file", {}, {.doc = "The file."}};
  Output<Text> text{*this, "text", "What stands in it."};
  void validate() const override {
    if (file->empty()) throw sceneError("no file is given", "a path in \"file\"");
  }
  void reset(const SetupContext&) override {}
};

/// Passes its input on; asks the node above for a spacing.
class Relay final : public Node {
 public:
  static constexpr NodeInfo kInfo{"Relay", "Passes a number on."};
  const NodeInfo& info() const override { return kInfo; }
  Param<double> wish{*this, "wish", 0.5};
  Input<Number> in{*this, "in", "The number."};
  Output<Number> out{*this, "out", "The same number."};
  void configure(const SetupContext&) override { in.request({wish}); }
  void reset(const SetupContext&) override { out->value = in->value; }
  void step(const StepContext&) override { out->value = in->value + 1; }
};

class Sum final : public Node {
 public:
  static constexpr NodeInfo kInfo{"Sum", "Adds numbers."};
  const NodeInfo& info() const override { return kInfo; }
  Inputs<Number> terms{*this, "terms", "What is added."};
  Input<Text> note{*this, "note", "A remark.", false};
  Output<Number> total{*this, "total", "The sum."};
  void reset(const SetupContext&) override {
    total->value = 0;
    for (std::size_t i = 0; i < terms.size(); ++i) total->value += terms[i].value;
  }
};

class Rule : public Module {
 public:
  static constexpr std::string_view kFamily = "Rule";
  virtual double apply(double x) const = 0;
};

class AddRule final : public Rule {
 public:
  static constexpr ModuleInfo kInfo{"AddRule", kFamily, "Adds an amount."};
  const ModuleInfo& info() const override { return kInfo; }
  Param<double> amount{*this, "amount", 1, {.min = -10, .max = 10, .doc = "What is added."}};
  double apply(double x) const override { return x + amount; }
};

class ScaleRule final : public Rule {
 public:
  static constexpr ModuleInfo kInfo{"ScaleRule", kFamily, "Multiplies by a factor."};
  const ModuleInfo& info() const override { return kInfo; }
  Param<double> factor{*this, "factor", 2, {.doc = "The factor."}};
  Param<FilePath> table{*this, "table", {}};
  void validate() const override {
    if (factor == 0) throw sceneError("the factor is 0", "another number");
  }
  double apply(double x) const override { return x * factor; }
};

class Stranger final : public Module {
 public:
  static constexpr ModuleInfo kInfo{"Stranger", "Painting", "Fits no pipeline here."};
  const ModuleInfo& info() const override { return kInfo; }
};

/// x -> (x + 1) * 5, with a third rule that is off by default.
class Worker final : public Node {
 public:
  static constexpr NodeInfo kInfo{"Worker", "Applies rules to a number."};
  const NodeInfo& info() const override { return kInfo; }
  Input<Number> in{*this, "in", "The number."};
  Output<Number> out{*this, "out", "What the rules make of it."};

  Worker() {
    rules_.add<AddRule>("add");
    rules_.add<ScaleRule>("scale").factor.set(5);
    rules_.add<AddRule>("extra").enable(false);
    rules_.markDefault();
  }
  PipelineBase* pipeline() override { return &rules_; }
  double result(double x) const {
    rules_.forEachEnabled([&](Rule& rule) { x = rule.apply(x); });
    return x;
  }
  void reset(const SetupContext&) override { out->value = result(in->value); }

 private:
  Pipeline<Rule> rules_;
};

/// A section of the scene file.
class Stage final : public Configurable {
 public:
  Param<int> width{*this, "width", 1280, {.min = 16, .max = 8192, .doc = "Width of the picture."}};
  Group<Point> camera{*this, "camera", "The camera."};
  GroupList<Point> keyframes{*this, "keyframes", "Where the camera goes."};
  Param<FilePath> backdrop{*this, "backdrop", {}};
};

void registerTestTypes(Registry& registry);

/// A scene that uses all of them.
inline constexpr std::string_view kTestScene = R"({
  "weir": 1,
  "title": "Zahlen – 数",
  "world": { "gravity": [0, -1, 0], "dt": 0.01, "duration": 2 },
  "nodes": {
    "a": { "type": "Source",
           "params": { "flag": true, "count": 7, "big": 9007199254740993, "speed": 0.1, "spacing": 1e-3, "size": [3, 4],
                       "position": [1, 2, 3], "color": "#ff8000", "rotation": [0, 90, 0], "label": "Tür \"1\"",
                       "file": "data/a.txt", "profile": [[0, 0], [1, 2], [0.5, 3]], "shape": "sphere", "limit": 4.5,
                       "points": [[1, 2, 3], [4, 5, 6]], "files": ["x.obj", "/y.obj"],
                       "start": { "time": 2 }, "path": [{ "position": [1, 0, 0] }, { "time": 1 }] } },
    "b": { "type": "Source" },
    "words": { "type": "NeedsFile", "params": { "file": "words.txt" } },
    "relay": { "type": "Relay" },
    "sum": { "type": "Sum" },
    "worker": { "type": "Worker",
                "modules": { "scale": { "params": { "factor": 2 } }, "add": { "after": "scale" },
                             "extra": { "enabled": true },
                             "more": { "type": "ScaleRule", "before": "scale", "params": { "factor": 0.5 } } } }
  },
  "links": ["a.number -> sum.terms", "b.number -> sum.terms", "words.text -> sum.note", "sum.total -> relay.in",
            "relay.out -> worker.in"],
  "stage": { "width": 640, "camera": { "position": [1, 2, 3] }, "keyframes": [{ "time": 1 }, { "time": 2 }] },
  "render": { "camera": { "eye": [1, 2, 3] } },
  "layout": { "a": [10, 20] },
  "plugins": ["libmine.so"],
  "$schema": "weir.schema.json"
}
)";

}  // namespace weir::test
