// Whatever stands in a scene file, it builds or is refused with an Error that says where: never another
// exception, a crash or a hang. A scene that builds can be written and read back.
#include <gtest/gtest.h>

#include "framework/base/text.h"
#include "framework/scene/scene_file.h"
#include "tests/support/scene_mutator.h"
#include "tests/support/test_nodes.h"

namespace weir {
namespace {

constexpr std::uint64_t kMutations = 10000;

constexpr std::string_view kSmallScene =
    R"({"weir": 1, "nodes": {"n": {"type": "Source"}, "r": {"type": "Relay"}}, "links": ["n.number -> r.in"]})";

void expectGoodError(const Error& e) {
  EXPECT_TRUE(e.kind() == ErrorKind::kScene || e.kind() == ErrorKind::kIo) << e.what();
  EXPECT_EQ(e.location().file, "s.json") << e.what();
  EXPECT_TRUE(e.location().line > 0) << e.what();
  EXPECT_TRUE(std::string_view(e.what()).starts_with("s.json:" + std::to_string(e.location().line)))
      << e.what();
  EXPECT_FALSE(e.message().empty());
  EXPECT_FALSE(e.allowed().empty()) << e.what();
  EXPECT_LT(std::string_view(e.what()).size(), 4000u);
  EXPECT_TRUE(isUtf8(e.what())) << printable(e.what(), 4000);
  for (const char c : std::string_view(e.what()))
    EXPECT_TRUE(c == '\n' || static_cast<unsigned char>(c) >= 0x20);
}

TEST(SceneMutation, EveryMutantBuildsOrIsRefusedWithAPlace) {
  Registry registry;
  test::registerTestTypes(registry);
  const test::SceneMutator mutator({std::string(test::kTestScene), std::string(kSmallScene)});
  int built = 0, refusedByParser = 0, refusedByBuilder = 0;
  for (std::uint64_t seed = 0; seed < kMutations && !HasFailure(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const std::string text = mutator.mutate(seed);
    std::vector<std::string> warnings;
    bool parsed = false;
    try {
      const Value root = parseJson(text, "s.json");
      parsed = true;
      const Place place{"s.json", "", "/scenes"};
      const auto scene = buildScene(root, place, registry, {}, warnings);
      ++built;
      const Value written = sceneToValue(*scene);
      const auto again = buildScene(parseJson(writeJson(written), "written"), place, registry, {}, warnings);
      EXPECT_EQ(sceneToValue(*again), written);
    } catch (const Error& e) {
      expectGoodError(e);
      ++(parsed ? refusedByBuilder : refusedByParser);
    }
  }
  // The generator must reach all three outcomes, or the test would say little.
  EXPECT_GT(built, 500);
  EXPECT_GT(refusedByParser, 1500);
  EXPECT_GT(refusedByBuilder, 3000);
  RecordProperty("built", built);
  RecordProperty("refused_by_parser", refusedByParser);
  RecordProperty("refused_by_builder", refusedByBuilder);
}

TEST(SceneMutation, TheSameSeedMakesTheSameText) {
  const test::SceneMutator mutator({std::string(kSmallScene)});
  EXPECT_EQ(mutator.mutate(7), mutator.mutate(7));
  EXPECT_NE(mutator.mutate(7), mutator.mutate(8));
}

}  // namespace
}  // namespace weir
