#include "framework/run/checkpoint_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <functional>
#include <string_view>
#include <system_error>

#include "framework/base/digest.h"
#include "framework/base/error.h"
#include "framework/base/text.h"

namespace weir {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kParts = "parts", kOfRank = ".rank_";
constexpr const char *kNames = "names", *kDigests = "digests", *kRank = "rank";
/// Where a part says that it is one.
constexpr std::string_view kPart = "part";

bool leavesFolder(const fs::path& name) {
  return name.is_absolute() || std::find(name.begin(), name.end(), "..") != name.end();
}

Error brokenPart(const fs::path& file, const std::string& name, const std::string& problem) {
  return ioError(fmt::format("the part {} of the checkpoint {}", printable(name, 200), problem),
                 "all parts as they were written, where they were beside this file",
                 "the one before it is kept beside it, as NAME.previous" + file.extension().string())
      .at({.file = file.string()});
}

/// Beside the file, or beside what it is a link to.
std::optional<fs::path> placeOf(const std::string& name, const fs::path& file) {
  std::error_code error;
  for (const fs::path& from : {file, fs::canonical(file, error)}) {
    fs::path place = from.parent_path() / name;
    if (fs::exists(place, error)) return place;
  }
  return std::nullopt;
}

/// 7 of "7.rank_0.h5", if a part has this name.
std::optional<std::int64_t> numberOf(const fs::path& part, const fs::path& file) {
  const std::string name = part.filename().string(), ending = file.extension().string();
  const char* const end = name.data() + name.size();
  std::int64_t number = 0;
  int rank = 0;
  const auto afterNumber = std::from_chars(name.data(), end, number);
  if (afterNumber.ec != std::errc() || number < 1) return std::nullopt;
  std::string_view rest(afterNumber.ptr, static_cast<std::size_t>(end - afterNumber.ptr));
  if (!rest.starts_with(kOfRank)) return std::nullopt;
  rest.remove_prefix(kOfRank.size());
  const auto afterRank = std::from_chars(rest.data(), end, rank);
  const bool whole = afterRank.ec == std::errc() && std::string_view(afterRank.ptr) == ending;
  return whole ? std::optional(number) : std::nullopt;
}

void append(StateArray& to, const StateArray& part, const SharedRows& rows) {
  const auto bytesOfRow = static_cast<std::int64_t>(sizeOf(part.kind)) * part.columns;
  const auto first = part.data.begin() + rows.first * bytesOfRow;
  to.data.insert(to.data.end(), first, first + rows.count * bytesOfRow);
  to.rows += rows.count;
}

/// Takes them over where nothing has to be copied.
void append(StateArrays& to, StateArrays part, std::size_t number, std::size_t parts, RankShare share,
            const std::function<void(const std::string&)>& refuse) {
  for (auto& [path, array] : part) {
    const SharedRows rows = SharedRows::of(array.rows, number, parts, share);
    const auto found = to.find(path);
    if (found == to.end() && rows.count == array.rows) {
      to.emplace(path, std::move(array));
      continue;
    }
    StateArray& present = to.try_emplace(path, StateArray{array.kind, 0, array.columns, {}}).first->second;
    if (present.kind != array.kind || present.columns != array.columns) refuse(path);
    append(present, array, rows);
    array.data = {};
  }
}

std::optional<PartNames> namesIn(const CheckpointStore& store, const fs::path& file) {
  try {
    const std::vector<std::string> names = CheckpointParts::of(store.read(file)).names;
    return PartNames(names.begin(), names.end());
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace

std::int64_t digestOf(const StateArrays& state) {
  Digest digest;
  for (const auto& [path, array] : state) {
    digest.addText(path).addNumber(static_cast<std::int64_t>(array.kind)).addNumber(array.rows);
    digest.addNumber(array.columns).add(array.data);
  }
  return digest.value();
}

CheckpointParts CheckpointParts::of(const Checkpoint& checkpoint) {
  CheckpointParts parts;
  const StateReader from = StateReader(checkpoint.state).in(kParts);
  if (!from.has(kDigests)) return parts;
  detail::getState(from, kNames, parts.names);
  parts.digests = from.getAll<std::int64_t>(kDigests);
  if (parts.names.size() != parts.digests.size())
    from.refuse(kDigests, fmt::format("{} numbers", parts.digests.size()),
                fmt::format("{}, one for each part", parts.names.size()));
  return parts;
}

void CheckpointParts::save(StateArrays& to) const {
  const StateWriter below = StateWriter(to).in(kParts);
  detail::putState(below, kNames, names);
  detail::putState(below, kDigests, digests);
}

StateArrays CheckpointParts::read(const CheckpointStore& store, const fs::path& file,
                                  std::size_t part) const {
  const std::string& name = names[part];
  const auto broken = [&](const std::string& problem) { return brokenPart(file, name, problem); };
  if (leavesFolder(name)) throw broken("is not below the folder of this file");
  const std::optional<fs::path> place = placeOf(name, file);
  if (!place) throw broken("is missing");
  Checkpoint read;
  try {
    read = store.read(*place);
  } catch (const Error& e) {
    throw broken("cannot be read: " + e.message());
  }
  if (digestOf(read.state) != digests[part]) throw broken("is of another checkpoint");
  std::erase_if(read.state, [](const auto& entry) { return entry.first.starts_with("part/"); });
  return std::move(read.state);
}

SharedRows SharedRows::of(std::int64_t rows, std::size_t part, std::size_t parts, RankShare share) {
  // A part has as many units as there are ranks, so that a rank has as many as there are parts.
  const auto units = std::int64_t{share.ranks};
  const std::int64_t before = static_cast<std::int64_t>(part) * units;
  const auto rowAt = [&](std::int64_t rank) {
    return rows * std::clamp<std::int64_t>(rank * static_cast<std::int64_t>(parts) - before, 0, units) /
           units;
  };
  const std::int64_t first = rowAt(share.rank);
  return {first, rowAt(share.rank + 1) - first};
}

void readParts(const CheckpointStore& store, const fs::path& file, Checkpoint& checkpoint, RankShare share) {
  const CheckpointParts parts = CheckpointParts::of(checkpoint);
  const std::size_t count = parts.names.size();
  StateArrays rows;
  for (std::size_t part = 0; part < count; ++part) {
    const auto refuse = [&](const std::string& path) {
      throw brokenPart(file, parts.names[part], "has not the same " + inQuotes(path) + " as others");
    };
    // Whatever number of rows it has, a part is read by whom some of them would belong to.
    if (SharedRows::of(share.ranks, part, count, share).count == 0) continue;
    append(rows, parts.read(store, file, part), part, count, share, refuse);
  }
  checkpoint.state.merge(rows);
  if (!rows.empty())
    throw brokenPart(file, parts.names.front(), "has an array that this file has: " + rows.begin()->first);
}

std::optional<int> rankOfPart(const Checkpoint& checkpoint) {
  const StateReader from = StateReader(checkpoint.state).in(kPart);
  if (!from.has(kRank)) return std::nullopt;
  int rank = 0;
  from.get(kRank, rank);
  return rank;
}

void saveRankOfPart(StateArrays& to, int rank) {
  StateWriter(to).in(kPart).put(kRank, rank);
}

fs::path folderOfParts(const fs::path& file) {
  return fs::path(file).replace_extension(".parts");
}

std::string nameOfPart(const fs::path& file, std::int64_t number, int rank) {
  return fmt::format("{}/{}{}{}{}", folderOfParts(file).filename().string(), number, kOfRank, rank,
                     file.extension().string());
}

std::int64_t nextNumberOfParts(const fs::path& file) {
  std::int64_t last = 0;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folderOfParts(file), error))
    last = std::max(last, numberOf(entry.path(), file).value_or(0));
  return last + 1;
}

std::optional<PartNames> partsInUse(const CheckpointStore& store, const fs::path& file) {
  std::error_code error;
  if (!fs::exists(folderOfParts(file), error)) return PartNames{};
  for (const fs::path& candidate : {file, Checkpoints::previousOf(file)}) {
    if (!fs::exists(candidate, error)) continue;
    return namesIn(store, candidate);
  }
  return PartNames{};
}

void removeUnnamedParts(const CheckpointStore& store, const fs::path& file) {
  std::error_code error;
  if (!fs::exists(folderOfParts(file), error)) return;
  PartNames kept;
  for (const fs::path& named : {file, Checkpoints::previousOf(file)}) {
    if (!fs::exists(named, error)) continue;
    std::optional<PartNames> names = namesIn(store, named);
    if (!names) return;
    kept.merge(*names);
  }
  removeOtherParts(file, kept);
}

void removeOtherParts(const fs::path& file, const PartNames& kept) {
  const fs::path folder = folderOfParts(file);
  std::error_code error;
  std::vector<fs::path> others;
  for (const auto& entry : fs::directory_iterator(folder, error))
    if (numberOf(entry.path(), file) &&
        !kept.contains((folder.filename() / entry.path().filename()).string()))
      others.push_back(entry.path());
  for (const fs::path& other : others) fs::remove(other, error);
  if (kept.empty() && fs::is_empty(folder, error)) fs::remove(folder, error);
}

}  // namespace weir
