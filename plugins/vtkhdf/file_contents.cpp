#include "plugins/vtkhdf/file_contents.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "framework/base/packed.h"
#include "framework/base/text.h"
#include "framework/run/checkpoint_parts.h"
#include "framework/run/progress.h"
#include "framework/scene/scene_file.h"
#include "plugins/vtkhdf/checkpoint_file.h"
#include "plugins/vtkhdf/isolated.h"
#include "plugins/vtkhdf/vtkhdf_reader.h"

namespace weir {

namespace {

namespace fs = std::filesystem;

std::string componentsText(const std::string& name, int components) {
  return components == 1 ? name : fmt::format("{} ({})", name, components);
}

/// "2.4 MB"
std::string sizeText(double bytes) {
  constexpr double kThousand = 1000;
  for (const char* unit : {"bytes", "kB", "MB"}) {
    if (bytes < kThousand) return fmt::format("{:.3g} {}", bytes, unit);
    bytes /= kThousand;
  }
  return fmt::format("{:.4g} GB", bytes);
}

std::string range(std::int64_t first, std::int64_t last) {
  if (first == last) return groupedText(first);
  return fmt::format("{} in the first frame, {} in the last", groupedText(first), groupedText(last));
}

/// The particles of each node: what stands below "nodes/NAME/…/" beside positions.
void addParticles(const StateArrays& state, std::vector<InfoEntry>& entries) {
  constexpr std::string_view kNodes = "nodes/", kPosition = "/position";
  for (const auto& [path, positions] : state) {
    const bool ofParticles = path.starts_with(kNodes) && path.ends_with(kPosition) && positions.columns == 3;
    if (!ofParticles) continue;
    const std::string prefix = path.substr(0, path.size() - kPosition.size() + 1);
    const std::string node = path.substr(kNodes.size(), path.find('/', kNodes.size()) - kNodes.size());
    std::vector<std::string> attributes;
    for (auto it = state.lower_bound(prefix); it != state.end() && it->first.starts_with(prefix); ++it)
      if (it->second.rows == positions.rows)
        attributes.push_back(componentsText(it->first.substr(prefix.size()), it->second.columns));
    entries.push_back({"particles of " + node, groupedText(positions.rows)});
    entries.push_back({"attributes of " + node, joinNames(attributes, ", ")});
  }
}

void addInputs(const std::string& text, std::vector<InfoEntry>& entries) {
  const Value inputs = parseJson(text, "the checkpoint's list of files");
  for (const auto& [parameter, input] : inputs.asObject()) {
    const Value *file = input.find("file"), *bytes = input.find("bytes");
    if (file == nullptr || bytes == nullptr || !file->isString() || !bytes->isNumber()) continue;
    entries.push_back(
        {"file of " + parameter, fmt::format("{} ({})", file->asString(), sizeText(bytes->asDouble()))});
  }
}

/// "water (ParticleFluid), …"
std::string nodesOf(const std::string& scene) {
  const Value read = parseJson(scene, "the scene in the file");
  const Value* nodes = read.isObject() ? read.find("nodes") : nullptr;
  if (nodes == nullptr || !nodes->isObject()) return {};
  std::vector<std::string> names;
  for (const auto& [name, node] : nodes->asObject()) {
    const Value* type = node.isObject() ? node.find("type") : nullptr;
    names.push_back(type != nullptr && type->isString() ? name + " (" + type->asString() + ")" : name);
  }
  return joinNames(names, ", ");
}

/// What of the arrays changes from frame to frame.
struct FrameCounts {
  std::int64_t points = 0, triangles = 0;
};

FrameCounts countsOf(const VtkHdfReader& reader, std::size_t frame) {
  try {
    return {.points = static_cast<std::int64_t>(reader.read(frame).positions.size()),
            .triangles = static_cast<std::int64_t>(reader.triangles(frame).size())};
  } catch (const Error& e) {
    throw ioError(fmt::format("the file is damaged: frame {} of {} cannot be read: {}", frame,
                              reader.times().size(), e.message()));
  }
}

std::string commaList(std::string lines) {
  while (lines.ends_with('\n')) lines.pop_back();
  for (std::size_t at = 0; (at = lines.find('\n', at)) != std::string::npos; at += 2)
    lines.replace(at, 1, ", ");
  return lines;
}

/// "3: run_ranks/cells.hdf5, run_ranks/rank_0.vtkhdf, run_ranks/rank_1.vtkhdf"
std::string otherFilesText(std::vector<std::string> names) {
  if (names.empty()) return {};
  constexpr std::size_t kMax = 8;
  const std::size_t all = names.size();
  names.resize(std::min(all, kMax));
  if (all > kMax) names.emplace_back("…");
  return fmt::format("{}: {}", all, joinNames(names, ", "));
}

FileContents contentsOf(const VtkHdfReader& reader) {
  const auto& times = reader.times();
  const auto text = [&](const char* name) {
    return reader.hasText(name) ? reader.text(name) : std::string();
  };
  const bool ofMeshes = reader.hasText("surfaces") || reader.hasText("solids");
  FileContents contents{.kind = !ofMeshes                  ? "an export of particles"
                                : reader.hasText("solids") ? "an export of solids"
                                                           : "an export of surfaces",
                        .entries = {},
                        .scene = text("scene")};
  const auto add = [&](std::string name, std::string value) {
    if (!value.empty()) contents.entries.push_back({std::move(name), std::move(value)});
  };
  const bool own = reader.hasText("version");
  if (!own) contents.kind = "VTKHDF of another program";
  add("version", text("version"));
  add("frames", groupedText(static_cast<std::int64_t>(times.size())));
  add("other files", otherFilesText(reader.otherFiles()));
  add("of rank", text("rank"));
  add("fluids", commaList(text("fluids")));
  add("surfaces", commaList(text("surfaces")));
  add("solids", commaList(text("solids")));
  if (!times.empty()) {
    add("times", fmt::format("{:.6g} s to {:.6g} s", times.front(), times.back()));
    const FrameCounts first = countsOf(reader, 0);
    FrameCounts last = first;
    for (std::size_t frame = 1; frame < times.size(); ++frame) last = countsOf(reader, frame);
    add(own && !ofMeshes ? "particles" : "points", range(first.points, last.points));
    if (first.triangles + last.triangles > 0) add("triangles", range(first.triangles, last.triangles));
    std::vector<std::string> attributes;
    for (const VtkHdfArray& array : reader.readLast().arrays)
      attributes.push_back(componentsText(array.name, array.components));
    add("attributes", joinNames(attributes, ", "));
  }
  // An export of particles has the statistics once its run has ended.
  if (own && !ofMeshes && !reader.hasText("rank"))
    add("run", reader.hasText("statistics") ? "has ended" : "goes on, or was stopped before its end");
  if (!contents.scene.empty()) add("nodes", nodesOf(contents.scene));
  return contents;
}

std::string packed(const FileContents& contents) {
  Packer packer;
  packer.addText(contents.kind);
  packer.addText(contents.scene);
  for (const InfoEntry& entry : contents.entries) {
    packer.addText(entry.name);
    packer.addText(entry.text);
  }
  return packer.take();
}

FileContents unpackedContents(const std::string& bytes) {
  Unpacker unpacker(bytes);
  FileContents contents;
  contents.kind = unpacker.text();
  contents.scene = unpacker.text();
  while (!unpacker.atEnd()) {
    InfoEntry& entry = contents.entries.emplace_back();
    entry.name = unpacker.text();
    entry.text = unpacker.text();
  }
  return contents;
}

std::string arraysText(const StateArrays& state) {
  double bytes = 0;
  for (const auto& [path, array] : state) bytes += static_cast<double>(array.bytes());
  return fmt::format("{}, {}; all digests are right", state.size(), sizeText(bytes));
}

/// How much they have, and nothing of what: it may be more than there is memory for.
void addSizes(const StateArrays& part, StateArrays& to) {
  for (const auto& [path, array] : part)
    to.try_emplace(path, StateArray{array.kind, 0, array.columns, {}}).first->second.rows += array.rows;
}

FileContents contentsOfPart(const Checkpoint& part, int rank) {
  FileContents contents{.kind = "a part of a checkpoint",
                        .entries = {{"version", part.version}, {"of rank", std::to_string(rank)}},
                        .scene = part.scene};
  addParticles(part.state, contents.entries);
  contents.entries.push_back({"arrays", arraysText(part.state)});
  return contents;
}

}  // namespace

FileContents CheckpointContents::read(const fs::path& file) const {
  const Hdf5CheckpointStore store;
  Checkpoint checkpoint = store.read(file);
  if (const std::optional<int> rank = rankOfPart(checkpoint)) return contentsOfPart(checkpoint, *rank);
  const CheckpointParts parts = CheckpointParts::of(checkpoint);
  for (std::size_t part = 0; part < parts.names.size(); ++part)
    addSizes(parts.read(store, file, part), checkpoint.state);
  FileContents contents{.kind = "a checkpoint", .entries = {}, .scene = checkpoint.scene};
  const auto add = [&](std::string name, std::string text) {
    contents.entries.push_back({std::move(name), std::move(text)});
  };
  try {
    std::int64_t frame = 0, steps = 0;
    double time = 0;
    const StateReader clock = StateReader(checkpoint.state).in("clock");
    clock.get("frame", frame);
    clock.get("steps", steps);
    clock.get("time", time);
    add("version", checkpoint.version);
    add("back end", checkpoint.device);
    add("frame", fmt::format("{} at {:.6g} s, after {} steps", frame, time, groupedText(steps)));
    if (!parts.names.empty()) add("other files", otherFilesText(parts.names));
    addParticles(checkpoint.state, contents.entries);
    add("arrays", arraysText(checkpoint.state));
    addInputs(checkpoint.inputs, contents.entries);
    add("nodes", nodesOf(checkpoint.scene));
  } catch (Error& e) {
    throw e.at({.file = file.string()});
  }
  return contents;
}

FileContents VtkHdfContents::read(const fs::path& file) const {
  try {
    return unpackedContents(
        hdf5::runIsolated([&] { return packed(contentsOf(VtkHdfReader(file))); }, hdf5::cpuSecondsFor(file)));
  } catch (Error& e) {
    throw e.at({.file = file.string()});
  }
}

}  // namespace weir
