#include "plugins/vtkhdf/files_elsewhere.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <system_error>

#include "framework/base/text.h"
#include "framework/base/value.h"
#include "plugins/vtkhdf/rank_files.h"

namespace weir {

namespace {

namespace fs = std::filesystem;
using hdf5::Dataset;
using hdf5::Group;

/// Behind the last row that is taken, by data set, by file.
using RowsNeeded = std::map<std::string, std::map<std::string, std::int64_t>>;

void addNeeded(const Dataset& set, RowsNeeded& needed) {
  for (const hdf5::RowsElsewhere& rows : set.elsewhere()) {
    std::int64_t& end = needed[rows.file][rows.dataset];
    end = std::max(end, rows.first + rows.count);
  }
}

void addNeeded(const Group& group, RowsNeeded& needed, int depth = 0) {
  constexpr int kDeepest = 4;
  for (const std::string& name : group.members()) {
    // What holds no numbers is nobody's concern.
    if (group.isGroup(name) && depth < kDeepest) addNeeded(group.group(name), needed, depth + 1);
    if (group.isVirtual(name)) addNeeded(group.dataset(name), needed);
  }
}

/// Where HDF5 looks first. A name leads nowhere else than into the folder of the file.
std::optional<fs::path> pathOf(const std::string& name, const fs::path& file) {
  std::error_code error;
  for (const fs::path& from : {file, fs::canonical(file, error)}) {
    fs::path path = from.parent_path() / name;
    if (fs::is_regular_file(path, error)) return path;
  }
  return std::nullopt;
}

bool leavesFolder(const fs::path& name) {
  return name.is_absolute() || std::find(name.begin(), name.end(), "..") != name.end();
}

std::optional<std::string> textOf(const Group& top, const std::string& name) {
  if (!top.isGroup("simulation") || !top.group("simulation").isDataset(name)) return std::nullopt;
  return top.group("simulation").readText(name);
}

/// `path` names a data set from the root of the file.
Dataset datasetAt(const Group& group, const std::string& path) {
  const std::size_t from = path.find_first_not_of('/'), slash = path.find('/', from);
  if (from == std::string::npos || slash == std::string::npos)
    return group.dataset(from == std::string::npos ? path : path.substr(from));
  return datasetAt(group.group(path.substr(from, slash - from)), path.substr(slash));
}

std::string problemOf(const fs::path& path, const std::map<std::string, std::int64_t>& needed,
                      const std::optional<std::string>& run) {
  try {
    const hdf5::File file = hdf5::File::open(path);
    const Group top = file.root();
    const std::optional<std::string> other = textOf(top, kRunText);
    if (run && other && run != other) return "is of another run";
    for (const auto& [name, rows] : needed)
      if (datasetAt(top, name).rows() < rows) return "ends before its last frame";
  } catch (const Error& e) {
    return "is damaged: " + e.message();
  }
  return {};
}

}  // namespace

std::vector<FileElsewhere> filesElsewhere(const hdf5::File& whole, const fs::path& file) {
  RowsNeeded needed;
  addNeeded(whole.root(), needed);
  const std::optional<std::string> run = textOf(whole.root(), kRunText);
  std::vector<FileElsewhere> files;
  for (const auto& [name, rows] : needed) {
    FileElsewhere& found = files.emplace_back(FileElsewhere{.name = name, .problem = {}});
    const std::optional<fs::path> path = leavesFolder(name) ? std::nullopt : pathOf(name, file);
    found.problem = leavesFolder(name) ? "is not below the folder of this file"
                    : !path            ? "is missing"
                                       : problemOf(*path, rows, run);
  }
  return files;
}

void checkWhole(const std::vector<FileElsewhere>& files) {
  std::vector<std::string> problems;
  for (const FileElsewhere& file : files)
    if (!file.problem.empty()) problems.push_back(printable(file.name, 200) + " " + file.problem);
  if (problems.empty()) return;
  constexpr std::size_t kMax = 8;
  const std::size_t more = problems.size() - std::min(problems.size(), kMax);
  problems.resize(problems.size() - more);
  throw ioError(fmt::format("of the {} other files that this one consists of, {}{}", files.size(),
                            joinNames(problems, "; "), more > 0 ? fmt::format("; and {} more", more) : ""),
                "all of them as they were written, where they were beside this one");
}

double bytesOfSet(const fs::path& file) {
  std::error_code error;
  double bytes = static_cast<double>(fs::file_size(file, error));
  if (error) return 0;
  const fs::path real = fs::canonical(file, error);
  for (const auto& entry : fs::directory_iterator(real.parent_path() / folderOfRanks(real), error)) {
    const auto size = entry.file_size(error);
    if (!error) bytes += static_cast<double>(size);
  }
  return bytes;
}

}  // namespace weir
