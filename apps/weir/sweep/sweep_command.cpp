#include "apps/weir/sweep/sweep_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <numeric>
#include <utility>

#include "apps/weir/installed_scenes.h"
#include "apps/weir/program_file.h"
#include "apps/weir/standard_streams.h"
#include "apps/weir/sweep/samples.h"
#include "apps/weir/sweep/sweep_table.h"
#include "framework/base/error.h"
#include "framework/base/text.h"
#include "framework/compute/device.h"
#include "framework/run/guarded_checkpoint.h"

namespace weir::app {

namespace fs = std::filesystem;

namespace {

constexpr int kMaxThreads = 1024;
constexpr const char* kArrayTask = "SLURM_ARRAY_TASK_ID";

/// The GPUs where there are several, which runs take in turns; else the device as it was asked for.
std::vector<std::string> devicesOf(const std::string& asked) {
  std::vector<std::string> devices;
  if (asked == "auto" || asked == "cuda")
    for (const DeviceInfo& device : listDevices())
      if (device.name.starts_with("cuda:")) devices.push_back(device.name);
  return devices.size() > 1 ? devices : std::vector{asked};
}

/// The points first, first + stride, …, from 0.
std::vector<std::size_t> everyOf(std::size_t first, std::size_t stride, std::size_t count) {
  std::vector<std::size_t> chosen;
  for (std::size_t i = first; i < count; i += stride) chosen.push_back(i);
  return chosen;
}

std::vector<std::size_t> chosenByTask(const std::string& task, const std::string& what, std::size_t count) {
  const char* const end = task.data() + task.size();
  std::size_t first = 0, stride = count;
  auto [rest, error] = std::from_chars(task.data(), end, first);
  if (error == std::errc() && rest != end && *rest == '/') {
    const auto parsed = std::from_chars(rest + 1, end, stride);
    rest = parsed.ptr, error = parsed.ec;
  }
  if (error != std::errc() || rest != end || first == 0 || first > stride)
    throw usageError(
        fmt::format("{} {} is no part of the sweep", what, printable(task)),
        fmt::format("the number of a point, 1 to {}; or I/N, which is every N-th point from I on", count));
  return everyOf(first - 1, stride, count);
}

}  // namespace

SweepCommand::SweepCommand(CLI::App& app, Program& program)
    : program_(program),
      command_(app.add_subcommand(
          "sweep", "Run a scene for many values of its parameters, and make a table of the results")) {
  command_->add_option("scene", scene_, kSceneHelp)->required()->type_name("SCENE");
  command_
      ->add_option(
          "options", options_,
          "Behind '--': options of 'weir run' for each run, in which {} stands for the folder of the "
          "point, such as -- --export {}/run.vtkhdf")
      ->type_name("OPTION...");
  command_
      ->add_option("--out", out_, "The folder for tables and points; what is done there is not done again")
      ->type_name("DIR");
  command_
      ->add_option("--set", set_,
                   "A parameter and its values, as for 'weir run'; may be repeated for a grid, the last one "
                   "changes fastest")
      ->type_name("NAME=VALUE,...")
      ->take_all()
      ->allow_extra_args(false);
  command_
      ->add_option("--table", tables_,
                   "Points from a table: a line of names of parameters, then a line a point")
      ->type_name("FILE.csv")
      ->take_all()
      ->allow_extra_args(false);
  command_->add_option("--sample", sample_, "Points that fill the ranges: Sobol's, or a Latin hypercube")
      ->type_name("sobol:N|latin:N");
  command_
      ->add_option("--range", ranges_,
                   "A parameter to sample between two values; with :log in equal ratios; may be repeated")
      ->type_name("NAME=MIN:MAX[:log]")
      ->take_all()
      ->allow_extra_args(false);
  command_->add_option("--seed", seed_, "Of the Latin hypercube")->type_name("N")->capture_default_str();
  command_->add_option("--jobs", jobs_, "Runs at a time; they share the threads, and take GPUs in turns")
      ->type_name("N")
      ->check(CLI::Range(1, kMaxThreads))
      ->capture_default_str();
  command_->add_option("--threads", threads_, "Threads of all runs together; one a core if it is left out")
      ->type_name("N")
      ->check(CLI::Range(1, kMaxThreads));
  command_->add_option("--device", device_, "auto, cpu, cuda or cuda:N")
      ->type_name("D")
      ->capture_default_str();
  command_
      ->add_option("--task", task_,
                   "Run point I alone, or every N-th from I on; the task of a Slurm array if it is left out")
      ->type_name("I[/N]");
  CLI::Option* list =
      command_->add_flag("--list", list_, "Print the points with their numbers and folders, and run nothing");
  command_->add_flag("--collect", collect_, "Make the tables of what is done, and run nothing")
      ->excludes(list);
  command_->add_flag("--quiet", quiet_, "Show warnings and errors only");
}

PointList SweepCommand::points() const {
  std::vector<PointList> lists;
  for (const std::string& table : tables_) lists.push_back(tablePoints(table));
  if (sample_.empty() && !ranges_.empty())
    throw usageError("--range is given without --sample", "--sample sobol:N or --sample latin:N");
  if (!sample_.empty()) {
    std::vector<Range> ranges;
    for (const std::string& text : ranges_) ranges.push_back(Range::parse(text));
    lists.push_back(sampledPoints(Sampling::parse(sample_), ranges, seed_));
  }
  for (const std::string& text : set_) lists.push_back(listedPoints(text));
  if (lists.empty())
    throw usageError("the sweep changes nothing", "--set, --table, or --sample with --range");
  return productOf(lists);
}

std::vector<std::size_t> SweepCommand::chosenOf(const PointList& points) const {
  const char* array = std::getenv(kArrayTask);
  if (!task_.empty()) return chosenByTask(task_, "--task", points.size());
  if (array != nullptr) return chosenByTask(array, kArrayTask, points.size());
  return everyOf(0, 1, points.size());
}

void SweepCommand::checkOptions() const {
  if (!options_.empty() && !options_.front().starts_with('-'))
    throw usageError(inQuotes(options_.front()) + " is one argument too many",
                     "one SCENE, and behind '--' options of 'weir run'");
  for (const std::string& option : options_) {
    const std::string name = option.substr(0, option.find('='));
    for (const char* own :
         {"--set", "--stats", "--checkpoint", "--resume", "--threads", "--device", "--quiet"})
      if (name == own)
        throw usageError(name + " cannot be given behind '--': the sweep sets it",
                         "options of 'weir run' that 'weir sweep' has not",
                         "--set, --threads and --device stand before '--'");
  }
}

SweepPlan SweepCommand::plan(PointList points) const {
  SweepPlan plan{.program = programFile(),
                 .scene = scene_,
                 .folder = out_,
                 .points = std::move(points),
                 .chosen = {},
                 .options = options_,
                 .jobs = jobs_,
                 .threads = threads_ > 0 ? threads_ : CpuDevice().threads(),
                 .devices = devicesOf(device_),
                 .keepsCheckpoints = !guardedCheckpointStores(program_.registry()).empty()};
  plan.chosen = chosenOf(plan.points);
  return plan;
}

void SweepCommand::printTables() const {
  for (const char* name : {"table.csv", "times.csv"}) print((fs::path(out_) / name).string() + "\n");
}

int SweepCommand::run() {
  program_.setQuiet(quiet_);
  scene_ = sceneFile(scene_);
  checkOptions();
  const PointList points = this->points();
  if (list_) {
    print(pointTable(points));
    return kDone;
  }
  if (out_.empty()) throw usageError("--out is missing", "--out DIR, the folder for tables and points");
  Sweep sweep(plan(points), program_.log());
  std::error_code error;
  fs::create_directories(out_, error);
  if (error) throw ioError("cannot make the folder: " + error.message()).at({.file = out_});
  const int code = collect_ ? int{kDone} : sweep.run();
  writeTables(out_, points);
  printTables();
  return code;
}

}  // namespace weir::app
