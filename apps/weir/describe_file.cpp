#include "apps/weir/describe_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>

#include "apps/weir/each_file.h"
#include "apps/weir/standard_streams.h"
#include "framework/base/text.h"
#include "framework/graph/guard.h"
#include "framework/run/file_contents.h"
#include "framework/run/progress.h"
#include "nodes/mesh_file/mesh_reader.h"
#include "nodes/mesh_file/ply_mesh_reader.h"
#include "nodes/particle_file/csv_reader.h"
#include "nodes/particle_file/particle_reader.h"
#include "nodes/particle_file/ply_reader.h"

namespace weir::app {

namespace {

namespace fs = std::filesystem;

FileContents contentsOf(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) throw ioError("the file holds no triangles");
  const auto bounds = mesh.bounds();
  return {
      .kind = "a mesh",
      .entries = {{"vertices", groupedText(static_cast<std::int64_t>(mesh.vertices.size()))},
                  {"triangles", groupedText(static_cast<std::int64_t>(mesh.triangles.size()))},
                  {"bounds", fmt::format("({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g})", bounds.lo.x,
                                         bounds.lo.y, bounds.lo.z, bounds.hi.x, bounds.hi.y, bounds.hi.z)}},
      .scene = {}};
}

FileContents contentsOf(const ParticleData& data) {
  FileContents contents{
      .kind = "particles",
      .entries = {{"particles", groupedText(static_cast<std::int64_t>(data.positions.size()))}},
      .scene = {}};
  if (!data.unused.empty()) contents.entries.push_back({"more attributes", joinNames(data.unused, ", ")});
  return contents;
}

/// Asks one reader after another for what a file holds.
class Asking {
 public:
  explicit Asking(const fs::path& file) : file_(file), ending_(lowerCase(file.extension().string())) {}

  template <class Reader>
  void ask(const Reader& reader, const std::string& what, const std::string& source) {
    GuardedPart{what, source}.call("read", [&] {
      const std::vector<std::string> endings = reader.extensions();
      readable_.insert(endings.begin(), endings.end());
      if (found_ || std::find(endings.begin(), endings.end(), ending_) == endings.end()) return;
      try {
        if constexpr (std::is_same_v<Reader, FileContentsReader>)
          found_ = reader.read(file_);
        else
          found_ = contentsOf(reader.read(file_));
      } catch (Error& e) {
        // A .ply may be a mesh or particles: if it is neither, the last refusal is what counts.
        refusal_ = e.at({.file = file_.string()});
      }
    });
  }
  template <class Interface>
  void askServices(const Registry& registry, const std::string& what) {
    for (const auto& [name, reader, source] : registry.createServices<Interface>())
      ask<Interface>(*reader, what + " " + inQuotes(name), source);
  }

  FileContents answer() const {
    if (found_) return *found_;
    if (refusal_) throw *refusal_;
    throw usageError(inQuotes(file_.string()) +
                         (ending_.empty() ? " has no ending that says what it is" : " is of no known kind"),
                     "a file that ends in " + joinNames({readable_.begin(), readable_.end()}),
                     "plugins can bring more kinds of files");
  }

 private:
  fs::path file_;
  std::string ending_;
  std::set<std::string> readable_;
  std::optional<FileContents> found_;
  std::optional<Error> refusal_;
};

FileContents contentsOf(const Registry& registry, const fs::path& file) {
  std::error_code ignored;
  if (!fs::exists(file, ignored)) throw ioError("there is no such file").at({.file = file.string()});
  if (!fs::is_regular_file(file, ignored))
    throw ioError("this is a folder or a device, not a file").at({.file = file.string()});
  Asking asking(file);
  asking.askServices<FileContentsReader>(registry, "file reader");
  asking.ask<MeshReader>(PlyMeshReader(), "mesh reader 'ply'", std::string(kOwnSource));
  asking.ask<ParticleReader>(PlyReader(), "particle reader 'ply'", std::string(kOwnSource));
  asking.ask<ParticleReader>(CsvReader(), "particle reader 'csv'", std::string(kOwnSource));
  asking.askServices<MeshReader>(registry, "mesh reader");
  asking.askServices<ParticleReader>(registry, "particle reader");
  return asking.answer();
}

/// Files may hold any bytes, terminals may not be sent them.
std::string described(const std::string& file, const FileContents& contents) {
  constexpr std::size_t kLongest = 2000;
  std::string text = fmt::format("{}: {}, whole\n", printable(file, kLongest), contents.kind);
  for (const InfoEntry& entry : contents.entries)
    text += fmt::format("  {}: {}\n", printable(entry.name), printable(entry.text, kLongest));
  return text;
}

std::string sceneIn(const std::string& file, const FileContents& contents) {
  if (contents.scene.empty())
    throw ioError("there is no scene in this file", "a checkpoint, or an export that Weir wrote")
        .at({.file = file});
  return contents.scene.ends_with('\n') ? contents.scene : contents.scene + "\n";
}

}  // namespace

int describeFiles(Program& program, const std::vector<std::string>& files, bool sceneOnly) {
  return forEachFile(program, files, [&](const std::string& file) {
    const FileContents contents = contentsOf(program.registry(), file);
    print(sceneOnly ? sceneIn(file, contents) : described(file, contents));
    return kDone;
  });
}

}  // namespace weir::app
