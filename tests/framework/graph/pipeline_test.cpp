#include <gtest/gtest.h>

#include "framework/scene/scene_file.h"
#include "tests/support/expect_error.h"
#include "tests/support/test_nodes.h"

namespace weir {
namespace {

using test::errorOf;
using Names = std::vector<std::string>;

const Place kPlace{"s.json", "/modules", ""};

class PipelineTest : public testing::Test {
 protected:
  PipelineTest() { test::registerTestTypes(registry); }

  void assign(std::string_view json) {
    worker.pipeline()->assign(parseJson(json, "s.json"), registry, kPlace);
  }
  Names names() { return worker.pipeline()->names(); }
  Error error(std::string_view json) {
    return errorOf([&] { assign(json); });
  }
  /// What is written makes the same pipeline out of a new node.
  void expectRoundTrip() {
    test::Worker again;
    const Value written = worker.pipeline()->changedValues();
    again.pipeline()->assign(written, registry, kPlace);
    EXPECT_EQ(again.pipeline()->names(), names()) << writeJson(written);
    EXPECT_EQ(again.pipeline()->changedValues(), written) << writeJson(written);
    for (const double x : {-2.0, 0.5, 3.0})
      EXPECT_EQ(again.result(x), worker.result(x)) << writeJson(written);
  }

  Registry registry;
  test::Worker worker;
};

TEST_F(PipelineTest, RunsTheEnabledModulesInOrder) {
  EXPECT_EQ(names(), (Names{"add", "scale", "extra"}));
  EXPECT_EQ(worker.result(1), (1 + 1) * 5);
  EXPECT_EQ(worker.pipeline()->changedValues(), Value::object());
}

TEST_F(PipelineTest, Parameterises) {
  assign(R"({"add": {"params": {"amount": 3}}})");
  EXPECT_EQ(worker.result(1), 20);
  expectRoundTrip();
}

TEST_F(PipelineTest, EnablesAndDisables) {
  assign(R"({"add": {"enabled": false}, "extra": {"enabled": true}})");
  EXPECT_EQ(worker.result(1), 6);
  expectRoundTrip();
}

TEST_F(PipelineTest, Replaces) {
  assign(R"({"add": {"type": "ScaleRule", "params": {"factor": 3}}})");
  EXPECT_EQ(names(), (Names{"add", "scale", "extra"}));
  EXPECT_EQ(worker.result(1), 15);
  expectRoundTrip();
}

TEST_F(PipelineTest, NamingItsOwnTypeReplacesNothing) {
  assign(R"({"scale": {"type": "ScaleRule"}})");
  EXPECT_EQ(worker.result(1), 10);  // the factor that the node's constructor set is still there
  expectRoundTrip();
}

TEST_F(PipelineTest, InsertsAfterAndBefore) {
  assign(R"({"one": {"type": "AddRule", "after": "scale"}, "two": {"type": "ScaleRule", "before": "add"}})");
  EXPECT_EQ(names(), (Names{"two", "add", "scale", "one", "extra"}));
  EXPECT_EQ(worker.result(1), (1 * 2 + 1) * 5 + 1);
  expectRoundTrip();
}

TEST_F(PipelineTest, Moves) {
  assign(R"({"add": {"after": "scale"}})");
  EXPECT_EQ(names(), (Names{"scale", "add", "extra"}));
  EXPECT_EQ(worker.result(1), 6);
  expectRoundTrip();
  assign(R"({"extra": {"before": "scale", "enabled": true}})");
  EXPECT_EQ(names(), (Names{"extra", "scale", "add"}));
  expectRoundTrip();
}

TEST_F(PipelineTest, AParameterSetBackToItsTypesDefaultIsKept) {
  assign(R"({"scale": {"params": {"factor": 2}}})");  // 2 is the default of ScaleRule, 5 that of this node
  EXPECT_EQ(worker.result(1), 4);
  expectRoundTrip();
}

TEST_F(PipelineTest, TheFirstModuleOfAnEmptyPipelineNeedsNoPlace) {
  Pipeline<test::Rule> empty;
  empty.markDefault();
  const Value spec =
      parseJson(R"({"only": {"type": "AddRule"}, "next": {"type": "AddRule", "before": "only"}})", "");
  empty.assign(spec, registry, kPlace);
  EXPECT_EQ(empty.names(), (Names{"next", "only"}));
  Pipeline<test::Rule> again;
  again.markDefault();
  again.assign(empty.changedValues(), registry, kPlace);
  EXPECT_EQ(again.names(), empty.names());
}

TEST_F(PipelineTest, MistakesAreNamedAndLocated) {
  EXPECT_CONTAINS(error("[]").what(), "/modules: found []");
  EXPECT_CONTAINS(error(R"({"add": 1})").what(), "/modules/add: found 1");
  Error e = error(R"({"ad": {"enabled": false}})");
  EXPECT_CONTAINS(e.what(), "s.json:1:8: /modules/ad: there is no module 'ad'");
  EXPECT_CONTAINS(e.hint(), "'add'");
  EXPECT_CONTAINS(e.allowed(), "add, scale or extra");
  e = error(R"({"add": {"enable": false}})");
  EXPECT_CONTAINS(e.what(), "/modules/add/enable");
  EXPECT_CONTAINS(e.hint(), "'enabled'");
  EXPECT_CONTAINS(error(R"({"add": {"enabled": 1}})").what(), "/modules/add/enabled: found 1");
  EXPECT_CONTAINS(error(R"({"add": {"type": 1}})").what(), "/modules/add/type: found 1");
  EXPECT_CONTAINS(error(R"({"add": {"type": "AddRul"}})").hint(), "'AddRule'");
  EXPECT_CONTAINS(error(R"({"add": {"type": "Stranger"}})").what(),
                  "a Stranger is a Painting and does not fit here");
  EXPECT_CONTAINS(error(R"({"new": {"type": "Stranger", "after": "add"}})").what(), "does not fit here");
  EXPECT_CONTAINS(error(R"({"new": {"type": "AddRule"}})").allowed(), "\"after\" or \"before\"");
  EXPECT_CONTAINS(error(R"({"add": {"after": "scale", "before": "extra"}})").what(), "both");
  EXPECT_CONTAINS(error(R"({"add": {"after": "add"}})").what(), "next to itself");
  EXPECT_CONTAINS(error(R"({"add": {"after": "scal"}})").hint(), "'scale'");
  EXPECT_CONTAINS(error(R"({"add": {"params": {"amount": 11}}})").what(), "/modules/add/params/amount");
  EXPECT_EQ(names(), (Names{"add", "scale", "extra"}));
  EXPECT_EQ(worker.result(1), 10);
}

TEST_F(PipelineTest, ProgramsInsertAndReplaceToo) {
  PipelineBase& pipeline = *worker.pipeline();
  EXPECT_THROW(pipeline.insert(0, std::make_unique<test::Stranger>(), "x"), Error);
  EXPECT_THROW(pipeline.insert(0, std::make_unique<test::AddRule>(), "add"), Error);
  EXPECT_THROW(pipeline.replace("nothing", std::make_unique<test::AddRule>()), Error);
  pipeline.insert(1, std::make_unique<test::AddRule>(), "x");
  EXPECT_EQ(names(), (Names{"add", "x", "scale", "extra"}));
  pipeline.replace("x", std::make_unique<test::ScaleRule>());
  EXPECT_EQ(pipeline.find("x")->info().type, "ScaleRule");
  EXPECT_EQ(pipeline.indexOf("x"), 1u);
}

}  // namespace
}  // namespace weir
