// Ports, links, order, requests, and the life of a graph.
#include "framework/graph/scene_graph.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "framework/base/check.h"
#include "tests/support/expect_error.h"
#include "tests/support/scene_mutator.h"
#include "tests/support/test_nodes.h"

namespace weir {
namespace {

using test::errorOf;

class SceneGraphTest : public testing::Test {
 protected:
  template <class N>
  N& add(const std::string& name) {
    return dynamic_cast<N&>(graph.add(std::make_unique<N>(), name));
  }
  void link(const char* text) { graph.link(SceneGraph::parseLink(text)); }
  Error linkError(const char* text) {
    const std::size_t before = graph.links().size();
    const Error e = errorOf([&] { link(text); });
    EXPECT_EQ(graph.links().size(), before);
    EXPECT_EQ(e.kind(), ErrorKind::kScene);
    return e;
  }
  std::vector<std::string> order() const {
    std::vector<std::string> names;
    for (const Node* node : graph.order()) names.push_back(node->name());
    return names;
  }

  SceneGraph graph;
  Registry registry;
  CpuDevice device{1};
  Log log;
  SetupContext setup{.device = device, .log = log, .registry = registry};
  StepContext stepContext{.device = device, .log = log};
};

TEST_F(SceneGraphTest, NamesAreCheckedAndUnique) {
  add<test::Source>("a");
  EXPECT_CONTAINS(errorOf([&] { add<test::Source>("a"); }).what(), "two nodes 'a'");
  for (const char* bad : {"", "1a", "a.b", "a b", "world", "render", "title"})
    EXPECT_THROW(add<test::Source>(bad), Error) << bad;
  EXPECT_EQ(graph.nodes().size(), 1u);
}

TEST_F(SceneGraphTest, PortsKnowTheirPath) {
  const auto& sum = add<test::Sum>("s");
  EXPECT_EQ(sum.terms.path(), "s.terms");
  EXPECT_EQ(sum.findInput("terms"), &sum.terms);
  EXPECT_EQ(sum.findInput("total"), nullptr);
  EXPECT_EQ(sum.findOutput("total"), &sum.total);
  EXPECT_TRUE(sum.terms.many());
  EXPECT_FALSE(sum.note.required());
}

TEST_F(SceneGraphTest, ParsesLinks) {
  const Link link = SceneGraph::parseLink(" a.x->b.y ");
  EXPECT_EQ(link.fromNode, "a");
  EXPECT_EQ(link.output, "x");
  EXPECT_EQ(link.toNode, "b");
  EXPECT_EQ(link.input, "y");
  EXPECT_EQ(link.text(), "a.x -> b.y");
  for (const char* bad : {"", "a.x", "a.x -> b", "a -> b.y", ".x -> b.y", "a. -> b.y", "a.x -> b.y -> c.z",
                          "a.x > b.y", "a.x.y -> b.z", "a.x -> b.y z"})
    EXPECT_CONTAINS(errorOf([&] { SceneGraph::parseLink(bad); }).allowed(), "node.output -> node.input");
}

TEST_F(SceneGraphTest, WrongLinksNameBothEnds) {
  add<test::Source>("a");
  add<test::NeedsFile>("t");
  add<test::Relay>("r");
  add<test::Sum>("s");
  EXPECT_CONTAINS(linkError("x.number -> r.in").what(), "no node 'x'");
  EXPECT_CONTAINS(linkError("a.numbr -> r.in").what(), "'a' (Source) has no output 'numbr'");
  EXPECT_CONTAINS(linkError("a.numbr -> r.in").hint(), "'number'");
  EXPECT_CONTAINS(linkError("r.in -> s.terms").what(), "no output 'in'");
  EXPECT_CONTAINS(linkError("a.number -> r.out").what(), "no input 'out'");
  EXPECT_CONTAINS(linkError("t.text -> r.in").what(), "'t.text' and 'r.in' do not fit: the output is a Text");
  link("a.number -> r.in");
  EXPECT_CONTAINS(linkError("a.number -> r.in").what(), "linked twice");
  link("a.number -> s.terms");
  EXPECT_CONTAINS(linkError("a.number -> s.terms").what(), "linked twice");
  EXPECT_CONTAINS(linkError("s.total -> r.in").what(),
                  "'r.in' is linked to 'a.number' already, and again to 's.total'");
}

TEST_F(SceneGraphTest, ACycleIsSpelledOut) {
  for (const char* name : {"a", "b", "c"}) add<test::Relay>(name);
  EXPECT_CONTAINS(linkError("a.out -> a.in").what(), "a -> a");
  link("a.out -> b.in");
  link("b.out -> c.in");
  EXPECT_CONTAINS(linkError("c.out -> a.in").what(), "closes a cycle: a -> b -> c -> a");
}

TEST_F(SceneGraphTest, RequiredInputsMustBeLinked) {
  add<test::Relay>("r");
  add<test::Sum>("s");  // needs nothing
  const Error e = errorOf([&] { graph.validate(); });
  EXPECT_CONTAINS(e.what(), "node 'r': the input 'r.in' is not linked");
  EXPECT_CONTAINS(e.allowed(), "Number");
  link("s.total -> r.in");
  EXPECT_NO_THROW(graph.validate());
}

TEST_F(SceneGraphTest, OrderFollowsLinksThenTheScene) {
  for (const char* name : {"d", "b"}) add<test::Source>(name);
  for (const char* name : {"a", "c"}) add<test::Relay>(name);
  add<test::Sum>("e");
  link("d.number -> a.in");
  link("b.number -> c.in");
  link("c.out -> e.terms");
  link("a.out -> e.terms");
  EXPECT_EQ(order(), (std::vector<std::string>{"d", "b", "a", "c", "e"}));
}

TEST_F(SceneGraphTest, OrderOfRandomGraphsPutsEveryNodeBehindItsSources) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    SceneGraph random;
    test::Random pick(seed);
    for (int i = 0; i < 20; ++i)
      random.add(std::make_unique<test::Sum>(), "n" + std::to_string(pick.below(1000) * 20 + i));
    for (int i = 0; i < 60; ++i) {
      const std::string from = pick.pick(random.nodes())->name(), to = pick.pick(random.nodes())->name();
      try {
        random.link({from, "total", to, "terms"});
      } catch (const Error&) {
        // A cycle or a link that is there already: the graph is as before.
      }
    }
    EXPECT_GT(random.links().size(), 15u);
    const auto order = random.order();
    ASSERT_EQ(order.size(), 20u);
    const auto position = [&](const std::string& name) {
      return std::find(order.begin(), order.end(), random.find(name));
    };
    for (const Link& l : random.links()) EXPECT_LT(position(l.fromNode), position(l.toNode)) << l.text();
  }
}

TEST_F(SceneGraphTest, ManyLinksArriveInTheOrderOfTheNodesWhateverTheirNames) {
  add<test::Source>("b").spacing.set(1);
  add<test::Source>("a").spacing.set(2);
  auto& sum = add<test::Sum>("s");
  link("a.number -> s.terms");
  link("b.number -> s.terms");
  graph.reset(setup);
  EXPECT_EQ(sum.terms[0].value, 1);
  EXPECT_EQ(sum.terms[1].value, 2);
  EXPECT_EQ(sum.total->value, 3);
}

TEST_F(SceneGraphTest, DataFlowsDownInOneStep) {
  add<test::Source>("z").spacing.set(5);
  add<test::Relay>("y");
  auto& last = add<test::Relay>("x");
  link("z.number -> y.in");
  link("y.out -> x.in");
  graph.reset(setup);
  EXPECT_EQ(last.out->value, 5);
  graph.step(stepContext);
  EXPECT_EQ(last.out->value, 7);
}

TEST_F(SceneGraphTest, RequestsFlowUp) {
  auto& a = add<test::Source>("a");
  add<test::Relay>("r").wish.set(0.25);
  link("a.number -> r.in");
  EXPECT_FALSE(a.number.requested().has_value());
  graph.reset(setup);
  EXPECT_EQ(a.number.requested()->spacing, 0.25);
  graph.reset(setup);  // the old request is forgotten
  EXPECT_EQ(a.number.requested()->spacing, 0.25);
}

TEST_F(SceneGraphTest, RequestsThatDifferNameBoth) {
  auto& a = add<test::Source>("a");
  add<test::Relay>("r").wish.set(0.25);
  auto& other = add<test::Relay>("q");
  link("a.number -> r.in");
  link("a.number -> q.in");
  graph.reset(setup);
  const Error e = errorOf([&] { a.number.requested(); });
  EXPECT_CONTAINS(e.what(), "'r.in'");
  EXPECT_CONTAINS(e.what(), "'q.in'");
  other.wish.set(0.25);
  graph.reset(setup);
  EXPECT_EQ(a.number.requested()->spacing, 0.25);
}

class Failing final : public Node {
 public:
  static constexpr NodeInfo kInfo{"Failing", "Fails in its step."};
  const NodeInfo& info() const override { return kInfo; }
  void reset(const SetupContext&) override {}
  void step(const StepContext&) override { throw simulationError("it diverged"); }
};

TEST_F(SceneGraphTest, AnErrorInAStepNamesTheNode) {
  add<Failing>("f");
  graph.reset(setup);
  const Error e = errorOf([&] { graph.step(stepContext); });
  EXPECT_EQ(e.kind(), ErrorKind::kSimulation);
  EXPECT_EQ(e.location().node, "f");
}

TEST_F(SceneGraphTest, ResetRefusesAnIncompleteGraph) {
  add<test::Relay>("r");
  EXPECT_THROW(graph.reset(setup), Error);
}

class TwoPortsOfOneName : public Node {
 public:
  static constexpr NodeInfo kInfo{"TwoPortsOfOneName", ""};
  const NodeInfo& info() const override { return kInfo; }
  void reset(const SetupContext&) override {}
  Output<test::Number> a{*this, "a", ""};
  Output<test::Number> b{*this, "a", ""};
};

TEST(Port, NamesAreUniqueInANode) {
  EXPECT_THROW(TwoPortsOfOneName(), InternalError);
}

TEST(Port, UnlinkedInputsAreEmpty) {
  test::Sum sum;
  EXPECT_EQ(sum.note.get(), nullptr);
  EXPECT_FALSE(sum.note.linked());
  EXPECT_THROW(*sum.note, InternalError);
  EXPECT_TRUE(sum.terms.empty());
}

TEST(Port, UnlinkTakesBothEndsApart) {
  test::Source source;
  test::Sum sum;
  sum.terms.link(source.number);
  EXPECT_EQ(source.number.links().size(), 1u);
  sum.terms.unlink(source.number);
  EXPECT_TRUE(sum.terms.empty());
  EXPECT_TRUE(source.number.links().empty());
}

}  // namespace
}  // namespace weir
