#include "nodes/mesh_file/mesh_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include "framework/base/digest.h"
#include "framework/base/text.h"
#include "framework/graph/registry.h"
#include "nodes/mesh_file/mesh_reader.h"
#include "nodes/mesh_file/ply_mesh_reader.h"

namespace weir {

namespace {

namespace fs = std::filesystem;

/// The built-in readers, then those of plugins by name.
std::vector<Service<MeshReader>> allReaders(const Registry& registry) {
  std::vector<Service<MeshReader>> readers;
  readers.push_back({"ply", std::make_unique<PlyMeshReader>(), std::string(kOwnSource)});
  for (auto& service : registry.createServices<MeshReader>()) readers.push_back(std::move(service));
  return readers;
}

std::string lower(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

/// The rotation that takes an axis of the file to y.
Quatf uprightRotation(UpAxis up) {
  switch (up) {
    case UpAxis::kX:
      return quaternionFromEulerDegrees({0, 0, 90});
    case UpAxis::kZ:
      return quaternionFromEulerDegrees({-90, 0, 0});
    case UpAxis::kY:
      break;
  }
  return {};
}

}  // namespace

void MeshFile::give(TriangleMesh mesh) {
  file.set({});
  given_ = std::move(mesh);
  loaded_ = false;
}

std::optional<std::uint32_t> MeshFile::givenDigest() const {
  if (given() == nullptr) return std::nullopt;
  return Digest()
      .add(std::as_bytes(std::span(given_->vertices)))
      .add(std::as_bytes(std::span(given_->triangles)))
      .value();
}

void MeshFile::validate() const {
  if (file->empty() && !given_)
    throw sceneError("no file is given", "a path in \"file\"").inParameter(file.name());
  if (fitSize.get() && unit.isSet())
    throw sceneError("both unit and fit_size are given, and each sets the size", "one of them")
        .inParameter(fitSize.name());
}

Error MeshFile::fileError(std::string message, std::string allowed, std::string hint) const {
  if (given() != nullptr) return sceneError(std::move(message), std::move(allowed), std::move(hint));
  return ioError(std::move(message), std::move(allowed), std::move(hint))
      .at({.file = file->resolved.string()})
      .inParameter(file.name());
}

TriangleMesh MeshFile::read(const Registry& registry) const {
  if (const TriangleMesh* mesh = given()) return *mesh;
  const fs::path& path = file->resolved;
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) throw fileError("there is no such file");
  if (!fs::is_regular_file(status))
    throw fileError("this is a folder or a device, not a file", "a mesh file");

  const std::string ending = lower(path.extension().string());
  std::set<std::string> readable;
  std::string hint;
  for (const auto& [name, reader, source] : allReaders(registry)) {
    std::optional<TriangleMesh> mesh;
    const auto where = [&] { return hookText("mesh reader " + inQuotes(name), "", source); };
    const auto ask = [&] {
      for (const std::string& extension : reader->extensions()) {
        if (extension == ending && !mesh) mesh = reader->read(path);
        readable.insert(extension);
      }
      if (hint.empty()) hint = reader->hintFor(ending);
    };
    callGuarded(source, where, ask, /*filesSayEnough=*/true);
    if (mesh) return std::move(*mesh);
  }
  std::string list;
  for (const std::string& extension : readable) list += (list.empty() ? "" : ", ") + extension;
  const bool isAlone = registry.createServices<MeshReader>().empty();
  throw fileError(ending.empty() ? "the file's name has no ending that says what it is"
                                 : "no reader is known for files that end in " + inQuotes(ending),
                  list + (isAlone ? "; no plugin that reads meshes is loaded" : ""),
                  isAlone ? "'weir info' lists the plugins; assimp reads meshes" : hint);
}

void MeshFile::place(TriangleMesh& mesh) const {
  mesh.transform(1, uprightRotation(up), {});
  const Vec3f extent = mesh.bounds().size();
  const float scale = fitSize.get() ? *fitSize.get() / std::max({extent.x, extent.y, extent.z}) : unit.get();
  mesh.transform(scale, {}, {});
  const Aabb box = mesh.bounds();
  Vec3f pivot{};
  if (anchor == MeshAnchor::kCenter) pivot = box.center();
  if (anchor == MeshAnchor::kBase) pivot = {box.center().x, box.lo.y, box.center().z};
  mesh.transform(1, {}, -pivot);
  mesh.transform(1, rotation->toQuaternion(), position);
  const Aabb placed = mesh.bounds();
  if (!isFinite(placed.lo) || !isFinite(placed.hi))
    throw sceneError(fmt::format("the mesh is too large: scaled by {}, it has no finite size", scale),
                     "a smaller unit, or a fit_size");
}

void MeshFile::estimate(const SetupContext& context, MemoryNeeds&) {
  load(context);
  loaded_ = true;
}

void MeshFile::load(const SetupContext& context) {
  const TriangleMesh raw = read(context.registry);
  *surface = cleaned(raw);
  if (surface->empty()) {
    const std::string_view source = given() != nullptr ? "mesh" : "file";
    throw fileError(
        raw.empty() ? fmt::format("the {} holds no triangles", source)
                    : fmt::format("none of the {}'s {} triangles has an area", source, raw.triangles.size()),
        fmt::format("a {} with triangles or polygons", source));
  }
  if (flip) surface->flip();
  place(*surface);
}

void MeshFile::reset(const SetupContext& context) {
  if (!std::exchange(loaded_, false)) load(context);
  const MeshDiagnosis diagnosis = diagnose(*surface);
  if (!diagnosis.good())
    context.log.warn(fmt::format("node '{}': the mesh of {} triangles in {} has {}{}", name(),
                                 surface->triangles.size(),
                                 given() != nullptr ? "arrays" : inQuotes(file->text), diagnosis.message(),
                                 diagnosis.insideOut ? "; \"flip\": true turns it round" : ""));
}

}  // namespace weir
