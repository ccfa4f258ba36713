// weir sweep through the command line: which points there are, what is run, and what stands in the tables.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <set>

#include "framework/base/table_text.h"
#include "framework/scene/scene_file.h"
#include "tests/support/child_process.h"
#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDam = R"({
  "weir": 1,
  "world": { "dt": 0.004, "duration": 0.1, "frame_rate": 50 },
  "nodes": {
    "block": { "type": "BoxSampler", "params": { "max": [0.2, 0.2, 0.2] } },
    "tank": { "type": "StaticBoundary",
              "params": { "shape": "box", "min": [0, 0, 0], "max": [0.5, 0.5, 0.2], "inverted": true } },
    "water": { "type": "ParticleFluid", "params": { "spacing": 0.05, "rest_steps": 0 } }
  },
  "links": [ "block.particles -> water.initial", "tank.boundary -> water.boundaries" ]
})";

using Row = std::map<std::string, std::string>;

std::vector<Row> rowsOf(const std::string& text) {
  TableLines lines(text);
  std::vector<std::string> names;
  std::vector<Row> rows;
  while (lines.next()) {
    std::vector<std::string> fields;
    for (TableFields field(lines.line(), lines.number()); field.next();) fields.push_back(field.text());
    if (names.empty()) {
      names = fields;
      continue;
    }
    EXPECT_EQ(fields.size(), names.size()) << text;
    for (std::size_t i = 0; i < std::min(fields.size(), names.size()); ++i)
      (i == 0 ? rows.emplace_back() : rows.back())[names[i]] = fields[i];
  }
  return rows;
}

class SweepTest : public testing::Test {
 protected:
  SweepTest() : scene(folder.write("dam.json", kDam)) {}

  ChildResult sweep(const std::vector<std::string>& arguments, const ChildOptions& options = {}) const {
    std::vector<std::string> all{"sweep", scene};
    all.insert(all.end(), arguments.begin(), arguments.end());
    return runWeir(all, options);
  }
  std::vector<Row> list(std::vector<std::string> arguments) const {
    arguments.push_back("--list");
    const ChildResult result = sweep(arguments);
    EXPECT_EQ(result.code, 0) << result.err;
    return rowsOf(result.out);
  }
  /// Of a list: one parameter of all points.
  std::vector<double> listed(const std::vector<std::string>& arguments, const std::string& name) const {
    std::vector<double> values;
    for (const Row& row : list(arguments)) values.push_back(std::stod(row.at(name)));
    return values;
  }
  void expectRefused(const std::vector<std::string>& arguments, int code,
                     std::initializer_list<const char*> parts) const {
    std::vector<std::string> all = arguments;
    all.insert(all.end(), {"--out", folder / "refused"});
    const ChildResult result = sweep(all);
    EXPECT_EQ(result.code, code) << result.err;
    EXPECT_EQ(result.out, "");
    for (const char* part : parts) EXPECT_CONTAINS(result.err, part);
    EXPECT_FALSE(fs::exists(folder / "refused"));
  }

  TemporaryFolder folder;
  std::string scene;
};

TEST_F(SweepTest, AGridHasEveryCombinationAndTheLastParameterChangesFastest) {
  const std::vector<Row> rows =
      list({"--set", "water.spacing=0.05,0.04", "--set", "world.gravity=[0,-9,0],[0,-1,0]", "--set",
            "title=\"one, two\",three"});
  ASSERT_EQ(rows.size(), 8u);
  const char* const spacings[] = {"0.05", "0.04"};
  const char* const gravities[] = {"[0,-9,0]", "[0,-1,0]"};
  const char* const titles[] = {"\"one, two\"", "three"};
  std::set<std::string> folders;
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_EQ(rows[i].at("point"), std::to_string(i + 1));
    EXPECT_EQ(rows[i].at("water.spacing"), spacings[i / 4]);
    EXPECT_EQ(rows[i].at("world.gravity"), gravities[i / 2 % 2]);
    EXPECT_EQ(rows[i].at("title"), titles[i % 2]);
    folders.insert(rows[i].at("folder"));
  }
  EXPECT_EQ(folders.size(), 8u);
  EXPECT_EQ(list({"--set", "water.spacing=0.05,1e-2"})[1].at("folder"), "water.spacing=1e-2");
}

TEST_F(SweepTest, TheTableHasWhatSingleRunsSay) {
  const std::string out = folder / "out";
  const std::vector<std::string> arguments{"--set",    "water.spacing=0.05,0.04,0.1",
                                           "--out",    out,
                                           "--jobs",   "2",
                                           "--device", "cpu",
                                           "--",       "--frames",
                                           "2"};
  const ChildResult result = sweep(arguments);
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(result.out, out + "/table.csv\n" + out + "/times.csv\n");
  const std::string table = readFile(out + "/table.csv");
  const std::vector<Row> rows = rowsOf(table), times = rowsOf(readFile(out + "/times.csv"));
  ASSERT_EQ(rows.size(), 3u);
  ASSERT_EQ(times.size(), 3u);
  for (const Row& row : rows) {
    const std::string stats = folder / "single.json";
    ASSERT_EQ(runWeir({"run", scene, "--set", "water.spacing=" + row.at("water.spacing"), "--frames", "2",
                       "--device", "cpu", "--stats", stats})
                  .code,
              0);
    const Value single = parseJson(readFile(stats), stats);
    EXPECT_EQ(row.at("state"), "done");
    EXPECT_EQ(row.at("error"), "");
    EXPECT_EQ(row.at("frames"), "2");
    EXPECT_EQ(row.at("particles"), std::to_string(single.find("particles")->asInt()));
    EXPECT_EQ(std::stod(row.at("water.kinetic_energy")),
              single.find("nodes")->find("water")->find("kinetic_energy")->asDouble());
    EXPECT_GT(std::stod(times[0].at("wall_seconds")), 0);
    EXPECT_FALSE(row.contains("wall_seconds"));
  }
  // What is done stays as it is, and the table is the same.
  const auto written = fs::last_write_time(out + "/water.spacing=0.05/stats.json");
  ASSERT_EQ(sweep(arguments).code, 0);
  EXPECT_EQ(fs::last_write_time(out + "/water.spacing=0.05/stats.json"), written);
  EXPECT_EQ(readFile(out + "/table.csv"), table);
}

TEST_F(SweepTest, APointThatFailsIsKeptAndTheOthersGoOn) {
  const std::string out = folder / "out";
  const std::vector<std::string> arguments{
      "--set", "water.spacing=0.05,-1,0.04", "--out", out, "--", "--frames", "1"};
  const ChildResult result = sweep(arguments);
  EXPECT_EQ(result.code, 3) << result.err;
  EXPECT_CONTAINS(result.err, "water.spacing = -1 failed: ");
  const std::string table = readFile(out + "/table.csv");
  const std::vector<Row> rows = rowsOf(table);
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0].at("state"), "done");
  EXPECT_EQ(rows[1].at("state"), "failed");
  EXPECT_EQ(rows[2].at("state"), "done");
  EXPECT_CONTAINS(rows[1].at("error"), "--set water.spacing=-1");
  EXPECT_EQ(rows[1].at("particles"), "");
  EXPECT_NE(rows[2].at("particles"), "");
  // It is tried again, with the same end.
  EXPECT_EQ(sweep(arguments).code, 3);
  EXPECT_EQ(readFile(out + "/table.csv"), table);
}

TEST_F(SweepTest, ATableGivesAPointALine) {
  const std::string points = folder.write("points.csv",
                                          "\xEF\xBB\xBF# a study\r\nwater.spacing, world.gravity\r\n\r\n"
                                          "0.05,\"[0, -9, 0]\"\r\n0.04,\"[0, -1, 0]\"");
  const std::vector<Row> rows = list({"--table", points, "--set", "world.dt=0.001,0.002"});
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_EQ(rows[1].at("water.spacing"), "0.05");
  EXPECT_EQ(rows[1].at("world.dt"), "0.002");
  EXPECT_EQ(rows[2].at("world.gravity"), "[0, -1, 0]");
}

TEST_F(SweepTest, ADamagedTableIsRefusedWithItsPlace) {
  struct Case {
    const char* text;
    int code;
    std::initializer_list<const char*> parts;
  };
  const Case cases[] = {
      {"", 5, {"points.csv", "the table is empty"}},
      {"water.spacing\n", 5, {"there are no points"}},
      {"water.spacing,world.dt\n0.05\n", 5, {"points.csv:2", "ends after 1 fields"}},
      {"water.spacing\n0.05\n0.04,1\n", 5, {"points.csv:3:6", "more fields"}},
      {"water.spacing,world.dt\n0.05,\n", 5, {"points.csv:2:6", "'world.dt' is empty"}},
      {"water.spacing\n\"0.05\n", 5, {"points.csv:2:1", "does not end"}},
      {"water.spacing,water.spacing\n1,2\n", 5, {"points.csv:1:15", "two columns"}},
      {"spacing\n1\n", 5, {"points.csv:1:1", "'spacing' is no parameter"}},
      {"world.gravity\n\"[0,1\"\n", 5, {"points.csv:2:1"}},
      {"water.spacing\n0.05\n0.04\n0.05\n", 2, {"points 1 and 3 are the same"}},
      {"water.spacing\n\xFF\xFE\n", 5, {"points.csv:2:1", "UTF-8"}},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.text);
    expectRefused({"--table", folder.write("points.csv", c.text)}, c.code, c.parts);
  }
  expectRefused({"--table", folder / "missing.csv"}, 5, {"missing.csv"});
}

TEST_F(SweepTest, WrongUsageIsRefused) {
  expectRefused({}, 2, {"changes nothing"});
  expectRefused({"--set", "water.spacing"}, 2, {"no '='"});
  expectRefused({"--set", "water.spacing=0.1,,0.2"}, 2, {"a value is empty"});
  expectRefused({"--set", "water.spacing=0.1", "--set", "water.spacing=0.2"}, 2, {"set by two options"});
  expectRefused({"--sample", "sobol:8"}, 2, {"no range"});
  expectRefused({"--range", "water.spacing=1:2"}, 2, {"without --sample"});
  for (const char* sample : {"sobol", "sobol:0", "sobol:-1", "sobol:1e3", "halton:8", "sobol:99999999"})
    expectRefused({"--sample", sample, "--range", "water.spacing=1:2"}, 2,
                  {"--sample", "sobol:N or latin:N"});
  for (const char* range : {"water.spacing", "water.spacing=1", "water.spacing=2:1", "water.spacing=1:nan",
                            "water.spacing=0:1:log", "water.spacing=1:2:linear"})
    expectRefused({"--sample", "sobol:8", "--range", range}, 2, {"--range"});
  expectRefused({"--set", "water.spacing=0.1", "--", "--stats", "x.json"}, 2,
                {"--stats cannot be given behind"});
  expectRefused({"more", "--set", "water.spacing=0.1"}, 2, {"'more' is one argument too many"});
  for (const char* task : {"0", "3", "x", "2/1", "1/0"})
    expectRefused({"--set", "water.spacing=0.1,0.2", "--task", task}, 2, {"is no part of the sweep"});
}

/// Each elementary interval of area 1/64, 2^-k by 2^(k-6), has one of 64 points: Sobol's first two
/// dimensions are a (0, 2)-sequence in base 2.
TEST_F(SweepTest, SobolPointsFillEveryElementaryInterval) {
  const std::vector<std::string> arguments{"--sample",          "sobol:64", "--range",
                                           "water.spacing=0:1", "--range",  "world.dt=-16:16"};
  const std::vector<double> x = listed(arguments, "water.spacing");
  std::vector<double> y = listed(arguments, "world.dt");
  ASSERT_EQ(x.size(), 64u);
  for (double& value : y) value = (value + 16) / 32;
  for (int k = 0; k <= 6; ++k) {
    std::set<std::pair<int, int>> boxes;
    for (std::size_t i = 0; i < 64; ++i)
      boxes.insert({static_cast<int>(std::ldexp(x[i], k)), static_cast<int>(std::ldexp(y[i], 6 - k))});
    EXPECT_EQ(boxes.size(), 64u) << k;
  }
  // More points begin with the same.
  const std::vector<double> more =
      listed({"--sample", "sobol:128", "--range", "water.spacing=0:1", "--range", "world.dt=-16:16"},
             "water.spacing");
  EXPECT_TRUE(std::equal(x.begin(), x.end(), more.begin()));
}

TEST_F(SweepTest, ALatinHypercubeHasOnePointInEachPartOfEachRange) {
  const auto arguments = [](const char* seed) {
    return std::vector<std::string>{"--sample", "latin:50",     "--range", "water.spacing=1:1000:log",
                                    "--range",  "world.dt=0:1", "--seed",  seed};
  };
  const std::vector<double> x = listed(arguments("1"), "water.spacing"),
                            y = listed(arguments("1"), "world.dt");
  std::set<int> partsOfX, partsOfY;
  for (const double value : x) partsOfX.insert(static_cast<int>(50 * std::log10(value) / 3));
  for (const double value : y) partsOfY.insert(static_cast<int>(50 * value));
  EXPECT_EQ(partsOfX.size(), 50u);
  EXPECT_EQ(partsOfY.size(), 50u);
  EXPECT_EQ(listed(arguments("1"), "world.dt"), y);
  EXPECT_NE(listed(arguments("2"), "world.dt"), y);
}

TEST_F(SweepTest, TasksOfAnArrayMakeTheTableOfTheWhole) {
  const auto arguments = [&](const std::string& out) {
    return std::vector<std::string>{"--set", "water.spacing=0.05,0.04,0.1", "--out", folder / out};
  };
  const auto with = [](std::vector<std::string> all, const std::vector<std::string>& more) {
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  const std::vector<std::string> frames{"--", "--frames", "1"};
  ASSERT_EQ(sweep(with(arguments("whole"), frames)).code, 0);
  ASSERT_EQ(sweep(with(with(arguments("tasks"), {"--task", "1/2"}), frames)).code, 0);
  std::vector<Row> rows = rowsOf(readFile(folder / "tasks/table.csv"));
  EXPECT_EQ(rows[0].at("state") + rows[1].at("state") + rows[2].at("state"), "doneopendone");
  ChildOptions second;
  second.environment["SLURM_ARRAY_TASK_ID"] = "2";
  ASSERT_EQ(sweep(with(arguments("tasks"), frames), second).code, 0);
  EXPECT_EQ(readFile(folder / "tasks/table.csv"), readFile(folder / "whole/table.csv"));
  ChildOptions fourth;
  fourth.environment["SLURM_ARRAY_TASK_ID"] = "4";
  const ChildResult result = sweep(with(arguments("tasks"), frames), fourth);
  EXPECT_EQ(result.code, 2);
  EXPECT_CONTAINS(result.err, "SLURM_ARRAY_TASK_ID 4 is no part of the sweep");
  // The tables alone, of what is there.
  fs::remove(folder / "tasks/table.csv");
  fs::remove(folder / "tasks/water.spacing=0.04/stats.json");
  ASSERT_EQ(sweep(with(with(arguments("tasks"), {"--collect"}), frames)).code, 0);
  rows = rowsOf(readFile(folder / "tasks/table.csv"));
  EXPECT_EQ(rows[0].at("state") + rows[1].at("state") + rows[2].at("state"), "doneopendone");
}

TEST_F(SweepTest, ResultsOfAnotherSceneOrOtherOptionsAreNotTakenOver) {
  const std::vector<std::string> arguments{"--set", "water.spacing=0.1", "--out", folder / "out", "--"};
  const auto with = [&](const char* frames) {
    std::vector<std::string> all = arguments;
    all.insert(all.end(), {"--frames", frames});
    return all;
  };
  ASSERT_EQ(sweep(with("1")).code, 0);
  const ChildResult other = sweep(with("2"));
  EXPECT_EQ(other.code, 5);
  EXPECT_CONTAINS(other.err, "the options behind '--' changed since");
  std::string text = kDam;
  text.replace(text.find("0.004"), 5, "0.002");
  folder.write("dam.json", text);
  const ChildResult changed = sweep(with("1"));
  EXPECT_EQ(changed.code, 5);
  EXPECT_CONTAINS(changed.err, "water.spacing=0.1");
  EXPECT_CONTAINS(changed.err, "the scene changed since");
}

TEST_F(SweepTest, OutputsOfEachRunStandInThePointsFolder) {
  const ChildResult result = sweep({"--set", "water.spacing=0.1,0.05", "--out", folder / "out", "--",
                                    "--frames", "1", "--series", "{}/series.csv"});
  ASSERT_EQ(result.code, 0) << result.err;
  for (const char* point : {"water.spacing=0.1", "water.spacing=0.05"})
    EXPECT_EQ(rowsOf(readFile(folder / "out" + "/" + point + "/series.csv")).size(), 2u);
}

}  // namespace
}  // namespace weir::test
