// What plots show outlives the window that showed it.
#include "apps/studio/session/number_history.h"

#include <gtest/gtest.h>

#include "tests/apps/studio/web_client.h"

namespace weir::studio {
namespace {

Value numbersAt(double time) {
  Value numbers = parseJson(R"({"particles": 8, "step_ms": {"median": 2.5}, "nodes": {"water": {
      "type": "ParticleFluid", "compression": {"mean": 0.25, "max": 0.5}, "momentum": [3, 0, 4],
      "bounds": [[0, 0, 0], [1, 1, 1]]}}})",
                            "numbers");
  numbers["simulated_seconds"] = time;
  return numbers;
}

TEST(NumberHistoryTest, NumbersHaveTheNamesOfTheirReports) {
  NumberHistory history;
  EXPECT_TRUE(history.last().isNull());
  history.add(numbersAt(0.5));
  EXPECT_EQ(writeJsonLine(history.value()),
            writeJsonLine(parseJson(R"json({"times": [0.5], "values": {"particles": [8.0],
                "step (ms)": [2.5], "water.compression.max": [0.5], "water.compression.mean": [0.25],
                "water.momentum": [5.0]}})json",
                                    "expected")));
  Value later = numbersAt(1);
  later["nodes"]["gauge"]["flux"] = 7;
  history.add(later);
  const Value value = history.value();
  EXPECT_EQ(*value.find("values")->find("gauge.flux"), parseJson("[null, 7.0]", "row"));
  EXPECT_EQ(history.last(), later);
}

TEST(NumberHistoryTest, WhatARunHasTakenBackIsForgotten) {
  NumberHistory history;
  for (const double time : {0.0, 1.0, 2.0, 3.0, 1.0}) history.add(numbersAt(time));
  EXPECT_EQ(*history.value().find("times"), parseJson("[0.0, 1.0]", "times"));
}

TEST(NumberHistoryTest, OfTooManyEverySecondOneIsForgotten) {
  NumberHistory history(4);
  for (int i = 0; i < 5; ++i) history.add(numbersAt(i));
  EXPECT_EQ(*history.value().find("times"), parseJson("[0.0, 2.0, 4.0]", "times"));
}

TEST(NumberHistoryTest, AWindowThatComesLaterHasThePlotsOfTheWholeRun) {
  const test::TemporaryFolder folder;
  folder.write("scene.json", kBriefScene);
  StudioOptions options;
  options.folder = folder.path();
  options.threads = 1;
  const RunningStudio studio(options, "scene.json");
  const Socket first = studio.socket();
  const Value before = *first.ask(R"({"id": 1, "do": "hello"})").find("result");
  EXPECT_TRUE(before.find("numbers")->isNull());
  EXPECT_TRUE(before.find("history")->find("times")->asArray().empty());
  first.ask(R"({"id": 2, "do": "run.play"})");
  const double end = 0.04;
  const Value told = first.event(
      "numbers", [&](const Value& numbers) { return numbers.find("simulated_seconds")->asDouble() == end; });
  const Socket second = studio.socket();
  const Value hello = *second.ask(R"({"id": 1, "do": "hello"})").find("result");
  const Value::Array& times = hello.find("history")->find("times")->asArray();
  ASSERT_GE(times.size(), 2u);
  EXPECT_EQ(times.front().asDouble(), 0);
  EXPECT_EQ(times.back().asDouble(), end);
  EXPECT_EQ(hello.find("history")->find("values")->find("water.kinetic_energy")->asArray().back(),
            *told.find("nodes")->find("water")->find("kinetic_energy"));
  first.ask(R"({"id": 3, "do": "scene.new"})");
  const Value after = *second.ask(R"({"id": 4, "do": "hello"})").find("result");
  EXPECT_TRUE(after.find("history")->find("times")->asArray().empty());
}

}  // namespace
}  // namespace weir::studio
