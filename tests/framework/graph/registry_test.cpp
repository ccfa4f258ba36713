#include "framework/graph/registry.h"

#include <gtest/gtest.h>

#include "tests/support/expect_error.h"
#include "tests/support/test_nodes.h"

namespace weir {
namespace {

using test::errorOf;

TEST(Registry, CreatesByType) {
  Registry registry;
  test::registerTestTypes(registry);
  EXPECT_EQ(registry.createNode("Sum")->info().type, "Sum");
  EXPECT_EQ(registry.createModule("AddRule")->info().family, "Rule");
  EXPECT_EQ(registry.nodes().at("Sum").source, "tests");
  EXPECT_NE(registry.sections().at("stage").create(), nullptr);
}

TEST(Registry, UnknownTypesAreErrorsWithASuggestion) {
  Registry registry;
  test::registerTestTypes(registry);
  const Error node = errorOf([&] { registry.createNode("Souce"); });
  EXPECT_EQ(node.kind(), ErrorKind::kScene);
  EXPECT_CONTAINS(node.hint(), "'Source'");
  EXPECT_CONTAINS(node.allowed(), "Relay");
  EXPECT_CONTAINS(errorOf([&] { registry.createNode("AddRule"); }).hint(), "plugin");
  EXPECT_CONTAINS(errorOf([&] { registry.createModule("AddRul"); }).hint(), "'AddRule'");
}

TEST(Registry, ATakenNameNamesBothLibraries) {
  Registry registry;
  test::registerTestTypes(registry);
  registry.setSource("other");
  for (const Error& e : {errorOf([&] { registry.addNode<test::Sum>(); }),
                         errorOf([&] { registry.addModule<test::AddRule>(); }),
                         errorOf([&] { registry.addSection<test::Stage>("stage", ""); })}) {
    EXPECT_CONTAINS(e.what(), "tests and other");
  }
  EXPECT_EQ(registry.nodes().at("Sum").source, "tests");
}

struct Greeter {
  static constexpr std::string_view kInterface = "Greeter";
  virtual ~Greeter() = default;
  virtual std::string greet() const = 0;
};
struct Polite final : Greeter {
  std::string greet() const override { return "good day"; }
};

TEST(Registry, ServicesAreFoundByInterface) {
  Registry registry;
  EXPECT_TRUE(registry.createServices<Greeter>().empty());
  registry.addService<Greeter>("polite", [] { return std::make_unique<Polite>(); });
  const auto services = registry.createServices<Greeter>();
  ASSERT_EQ(services.size(), 1u);
  EXPECT_EQ(services[0].name, "polite");
  EXPECT_EQ(services[0].implementation->greet(), "good day");
  EXPECT_THROW(registry.addService<Greeter>("polite", [] { return std::make_unique<Polite>(); }), Error);
}

TEST(Registry, TwoOfThemDoNotKnowOfEachOther) {
  Registry a, b;
  test::registerTestTypes(a);
  EXPECT_TRUE(b.nodes().empty());
}

}  // namespace
}  // namespace weir
