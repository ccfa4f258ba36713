// Tables of particles, asked for as the page asks.
#include "apps/studio/session/particle_values.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/apps/studio/web_client.h"

namespace weir::studio {
namespace {

class ParticleTable : public testing::Test {
 protected:
  ParticleTable() {
    folder.write("scene.json", kBriefScene);
    StudioOptions options;
    options.folder = folder.path();
    options.threads = 1;
    studio = std::make_unique<RunningStudio>(options, "scene.json");
    socket = std::make_unique<Socket>(studio->port(), studio->head("GET /api/live", studio->bearer()));
    socket->ask(R"({"id": 1, "do": "run.reset"})");
    socket->sendText(R"({"id": 2, "do": "run.play"})");
    socket->state("finished");
  }
  Value page(const std::string& more) const {
    return socket->ask(R"({"id": 3, "do": "particles", "node": "water")" + more + "}");
  }
  static std::vector<std::string> columns(const Value& table) {
    std::vector<std::string> names;
    for (const Value& column : table.find("columns")->asArray())
      names.push_back(column.find("name")->asString());
    return names;
  }
  static std::size_t at(const Value& table, const std::string& name) {
    const std::vector<std::string> names = columns(table);
    const auto found = std::find(names.begin(), names.end(), name);
    EXPECT_NE(found, names.end()) << name;
    return static_cast<std::size_t>(found - names.begin());
  }
  static std::vector<double> numbers(const Value& table, std::size_t column) {
    std::vector<double> all;
    for (const Value& row : table.find("rows")->asArray()) all.push_back(row.asArray().at(column).asDouble());
    return all;
  }

  test::TemporaryFolder folder;
  std::unique_ptr<RunningStudio> studio;
  std::unique_ptr<Socket> socket;
};

TEST_F(ParticleTable, HasAllAttributesOfAllParticles) {
  const Value table = *page(R"(, "count": 1000)").find("result");
  EXPECT_EQ(table.find("total")->asInt(), 125);
  std::vector<double> expected(125);
  for (std::size_t i = 0; i < expected.size(); ++i) expected[i] = static_cast<double>(i);
  EXPECT_EQ(numbers(table, 0), expected);
  // The same particle, asked for alone.
  const Value one = *socket->ask(R"({"id": 4, "do": "particle", "node": "water", "particle": 31})")
                         .find("result")
                         ->find("attributes");
  const Value::Array& row = table.find("rows")->asArray().at(31).asArray();
  const Value::Array& velocity = one.find("velocity")->asArray();
  EXPECT_EQ(row.at(at(table, "velocity.y")), velocity.at(1));
  EXPECT_EQ(row.at(at(table, "position.x")), one.find("position")->asArray().at(0));
  EXPECT_EQ(row.at(at(table, "density")), *one.find("density"));
  const double speed =
      std::hypot(velocity.at(0).asDouble(), velocity.at(1).asDouble(), velocity.at(2).asDouble());
  EXPECT_GT(speed, 0.1);
  EXPECT_NEAR(row.at(at(table, "speed")).asDouble(), speed, 1e-6 * speed);
  for (const auto& [name, unused] : one.asObject()) {
    const bool isVector = unused.isArray();
    EXPECT_LT(at(table, isVector ? name + ".z" : name), row.size());
  }
}

TEST_F(ParticleTable, IsSortedByAnyColumnPageByPage) {
  const Value all = *page(R"(, "count": 1000)").find("result");
  for (const std::string& column : columns(all))
    for (const bool descending : {false, true}) {
      // Equal ones keep the order of their ids.
      std::vector<std::pair<double, double>> expected;
      const std::vector<double> keys = numbers(all, at(all, column)), ids = numbers(all, 0);
      for (std::size_t i = 0; i < keys.size(); ++i) expected.emplace_back(keys[i], ids[i]);
      std::stable_sort(expected.begin(), expected.end(), [&](const auto& a, const auto& b) {
        return descending ? a.first > b.first : a.first < b.first;
      });
      const Value some = *page(R"(, "sort": ")" + column + R"(", "descending": )" +
                               (descending ? "true" : "false") + R"(, "from": 40, "count": 20)")
                              .find("result");
      const std::vector<double> found = numbers(some, 0);
      ASSERT_EQ(found.size(), 20u);
      for (std::size_t i = 0; i < found.size(); ++i)
        EXPECT_EQ(found[i], expected[40 + i].second) << column << descending << i;
    }
}

TEST_F(ParticleTable, BehindTheEndIsTheLastPage) {
  const Value table = *page(R"(, "from": 2000, "count": 50)").find("result");
  EXPECT_EQ(table.find("from")->asInt(), 100);
  EXPECT_EQ(table.find("rows")->asArray().size(), 25u);
}

TEST_F(ParticleTable, WhatCannotBeIsSaid) {
  const Value wrong = page(R"(, "sort": "velocity.w")");
  ASSERT_NE(wrong.find("error"), nullptr);
  EXPECT_NE(wrong.find("error")->find("allowed")->asString().find("velocity.x"), std::string::npos);
  EXPECT_NE(page(R"(, "count": 0)").find("error"), nullptr);
  EXPECT_NE(page(R"(, "from": -1)").find("error"), nullptr);
  EXPECT_NE(page(R"(, "descending": 1)").find("error"), nullptr);
  EXPECT_TRUE(socket->ask(R"({"id": 3, "do": "particles", "node": "block"})").find("result")->isNull());
  EXPECT_EQ(page("").find("result")->find("total")->asInt(), 125);  // the run did not suffer
}

}  // namespace
}  // namespace weir::studio
