#include "plugins/vtkhdf/checkpoint_file.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <system_error>

#include "framework/base/digest.h"
#include "framework/base/text.h"
#include "plugins/vtkhdf/hdf5.h"
#include "plugins/vtkhdf/isolated.h"

namespace weir {

namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kFormat = 2;
constexpr std::int64_t kChunkRows = 1 << 15;
constexpr const char* kRoot = "checkpoint";
constexpr const char* kKind = "kind";
constexpr const char* kDigest = "digest";
#ifdef WEIR_TRUST_DIGESTS  // tests/fuzz, which looks for what is behind them
constexpr bool kComparesDigests = false;
#else
constexpr bool kComparesDigests = true;
#endif

/// Calls f with the name of a kind, the number type of HDF5, and a number of it.
template <class F>
void withKind(StateKind kind, F&& f) {
  switch (kind) {
    case StateKind::kFloat:
      return f(float{});
    case StateKind::kDouble:
      return f(double{});
    case StateKind::kInt:
      return f(std::int32_t{});
    case StateKind::kInt64:
      return f(std::int64_t{});
    case StateKind::kByte:
      return f(std::uint8_t{});
  }
}

/// In the order of StateKind.
constexpr std::array<std::string_view, 5> kKindNames{"float", "double", "int", "int64", "byte"};

std::int64_t digestOf(const std::string& path, const StateArray& array) {
  Digest digest;
  digest.addText(path).addNumber(static_cast<std::int64_t>(array.kind)).addNumber(array.rows);
  return digest.addNumber(array.columns).add(array.data).value();
}

/// Of all but what the digests of the arrays stand for.
std::int64_t digestOf(const Checkpoint& checkpoint, const std::map<std::string, std::int64_t>& ofArrays) {
  Digest digest;
  digest.addNumber(kFormat);
  for (const std::string& text : {checkpoint.version, checkpoint.scene, checkpoint.device, checkpoint.inputs})
    digest.addText(text);
  for (const auto& [path, ofArray] : ofArrays) digest.addText(path).addNumber(ofArray);
  return digest.value();
}

std::int64_t readDigest(const hdf5::Object& object) {
  const std::vector<std::int64_t> digest = object.intAttribute(kDigest);
  if (digest.size() != 1) throw object.error("has no digest");
  return digest[0];
}

void writeArray(hdf5::Group& group, const std::string& name, const StateArray& array, std::int64_t digest) {
  withKind(array.kind, [&]<class T>(T) {
    hdf5::Dataset set =
        group.createGrowing(name, {.type = hdf5::kNumberType<T>,
                                   .columns = array.columns,
                                   .matrix = true,
                                   .chunkRows = std::clamp<std::int64_t>(array.rows, 1, kChunkRows)});
    set.setAttribute(kKind, kKindNames[static_cast<std::size_t>(array.kind)]);
    set.setAttribute(kDigest, digest);
    set.append(
        std::span<const T>(reinterpret_cast<const T*>(array.data.data()), array.data.size() / sizeof(T)));
  });
}

/// The arrays from `first` on whose paths begin with `prefix`; returns the first behind them.
StateArrays::const_iterator writeGroup(hdf5::Group& group, const std::string& prefix,
                                       StateArrays::const_iterator first, const StateArrays& all,
                                       const std::map<std::string, std::int64_t>& digests) {
  while (first != all.end() && first->first.starts_with(prefix)) {
    const std::string rest = first->first.substr(prefix.size());
    const std::size_t slash = rest.find('/');
    if (slash == std::string::npos) {
      writeArray(group, rest, first->second, digests.at(first->first));
      ++first;
      continue;
    }
    hdf5::Group below = group.createGroup(rest.substr(0, slash));
    first = writeGroup(below, prefix + rest.substr(0, slash + 1), first, all, digests);
  }
  return first;
}

StateArray readArray(const hdf5::Dataset& set) {
  StateArray array;
  const std::string kind = set.textAttribute(kKind);
  const auto found = std::find(kKindNames.begin(), kKindNames.end(), kind);
  if (found == kKindNames.end()) throw set.error("is of the kind " + inQuotes(kind));
  array.kind = static_cast<StateKind>(found - kKindNames.begin());
  array.rows = set.rows();
  array.columns = static_cast<int>(set.columns());
  withKind(array.kind, [&]<class T>(T) {
    // First, as it refuses what is not there: then there is memory for it.
    const std::vector<T> values = set.readAll<T>();
    array.data.resize(array.bytes());
    if (!values.empty()) std::memcpy(array.data.data(), values.data(), array.data.size());
  });
  return array;
}

Error damaged(const std::string& what) {
  return ioError("the checkpoint is damaged: " + what + " is not what was written", {},
                 "the one before it is kept beside it, as NAME.previous.h5");
}

/// Checks each array's digest, which it collects.
void readGroup(const hdf5::Group& group, const std::string& prefix, int depth, StateArrays& to,
               std::map<std::string, std::int64_t>& digests) {
  constexpr int kDeepest = 32;
  if (depth > kDeepest) throw group.error("is nested too deeply");
  for (const std::string& name : group.members()) {
    if (!group.isDataset(name)) {
      readGroup(group.group(name), prefix + name + "/", depth + 1, to, digests);
      continue;
    }
    const hdf5::Dataset set = group.dataset(name);
    const std::string path = prefix + name;
    const StateArray& array = to.emplace(path, readArray(set)).first->second;
    const std::int64_t digest = readDigest(set);
    if (kComparesDigests && digest != digestOf(path, array)) throw damaged("its array " + inQuotes(path));
    digests.emplace(path, digest);
  }
}

Checkpoint readWhole(const fs::path& file) {
  const hdf5::Session session;
  const hdf5::File opened = hdf5::File::open(file);
  const hdf5::Group top = opened.root();
  if (!top.isGroup(kRoot))
    throw ioError("this is not a checkpoint", "a file that --checkpoint wrote").at({.file = file.string()});
  const hdf5::Group root = top.group(kRoot);
  const std::vector<std::int64_t> format = root.intAttribute("format");
  if (format.size() != 1 || format[0] != kFormat)
    throw ioError("the checkpoint is of " +
                      (format.size() == 1 ? "format " + std::to_string(format[0]) : "no known format"),
                  "format " + std::to_string(kFormat) + ", which this program writes",
                  "resume it with the program that wrote it, or run the scene from the start")
        .at({.file = file.string()});
  Checkpoint checkpoint{.version = root.readText("program"),
                        .scene = root.readText("scene"),
                        .device = root.readText("device"),
                        .inputs = root.readText("inputs"),
                        .state = {}};
  std::map<std::string, std::int64_t> digests;
  readGroup(root.group("state"), "", 0, checkpoint.state, digests);
  if (readDigest(root) != digestOf(checkpoint, digests) && kComparesDigests)
    throw damaged("the list of its arrays, or a text,");
  return checkpoint;
}

}  // namespace

void Hdf5CheckpointStore::write(const fs::path& file, const Checkpoint& checkpoint) const {
  const hdf5::Session session;
  std::unique_ptr<hdf5::File> made;
  const auto giveUp = [&] {
    if (made) made->abandon();
    made.reset();
    std::error_code ignored;
    fs::remove(file, ignored);
  };
  try {
    made = std::make_unique<hdf5::File>(hdf5::File::create(file, file.string()));
    {
      hdf5::Group root = made->root().createGroup(kRoot);
      root.setAttribute("format", kFormat);
      root.writeText("program", checkpoint.version);
      root.writeText("scene", checkpoint.scene);
      root.writeText("device", checkpoint.device);
      root.writeText("inputs", checkpoint.inputs);
      std::map<std::string, std::int64_t> digests;
      for (const auto& [path, array] : checkpoint.state) digests.emplace(path, digestOf(path, array));
      root.setAttribute(kDigest, digestOf(checkpoint, digests));
      hdf5::Group state = root.createGroup("state");
      writeGroup(state, "", checkpoint.state.begin(), checkpoint.state, digests);
    }
    made->sync();
    made->close();
  } catch (Error& e) {
    giveUp();
    throw e.at({.file = file.string()});
  } catch (...) {  // no memory
    giveUp();
    throw;
  }
}

Checkpoint Hdf5CheckpointStore::read(const fs::path& file) const {
  // A damaged file can crash the library, so another process reads it first.
  constexpr int kMaxSeconds = 600;
  try {
    hdf5::runIsolated([&] { return readWhole(file).version; }, kMaxSeconds);
    return readWhole(file);
  } catch (Error& e) {
    throw e.at({.file = file.string()});
  }
}

}  // namespace weir
