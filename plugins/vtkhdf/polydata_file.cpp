#include "plugins/vtkhdf/polydata_file.h"

#include <unistd.h>

#include <algorithm>
#include <numeric>

#include "framework/base/check.h"
#include "framework/base/file_output.h"
#include "framework/base/text.h"

namespace weir {

namespace {

namespace fs = std::filesystem;
using hdf5::Growing;
using hdf5::NumberType;

/// Rows of particle data that are stored together: small enough that a short export stays small, large enough
/// that a long one of a million particles has some 10,000 chunks a data set.
constexpr std::int64_t kParticleChunk = 1 << 14;
constexpr std::int64_t kStepChunk = 1 << 8;

Growing perStep(NumberType type = NumberType::kInt64, int columns = 1) {
  return {.type = type, .columns = columns, .chunkRows = kStepChunk};
}

/// Point ids and offsets, which count up. They would compress to almost nothing, but a compressed chunk is
/// written anew, in another place, when it grows: after a kill in between, steps from before could not be
/// read. Values of particles hardly shrink anyway, also those that are integers (particles are sorted in
/// space, so their ids are in no order).
Growing ascending(std::int64_t chunkRows) {
  return {.type = NumberType::kInt64, .chunkRows = chunkRows};
}

Growing layoutOf(const VtkHdfAttribute& attribute) {
  return {.type = numberType(attribute.type), .columns = attribute.components, .chunkRows = kParticleChunk};
}

void checkLayout(const VtkHdfLayout& layout) {
  std::vector<std::string> names;
  const auto check = [&](const std::string& name) {
    const bool good = !name.empty() && name != "." && name.find('/') == std::string::npos;
    WEIR_CHECK(good);
    WEIR_CHECK(std::count(names.begin(), names.end(), name) == 0);
    names.push_back(name);
  };
  for (const VtkHdfAttribute& attribute : layout.attributes) {
    check(attribute.name);
    WEIR_CHECK(attribute.components > 0);
  }
  names.clear();
  for (const std::string& field : layout.fields) check(field);
}

/// The file that a path stands for, symbolic links followed. Throws an io Error if no file can be there.
fs::path target(const fs::path& file) {
  const std::string name = file.string();
  const auto refuse = [&](const std::string& what, const std::string& allowed) {
    return ioError(what, allowed).at({.file = name});
  };
  if (lowerCase(file.extension().string()) != ".vtkhdf")
    throw refuse("the export would be a file of type " + inQuotes(file.extension().string()),
                 "a name that ends in .vtkhdf");
  std::error_code error;
  // Absolute first: of a bare name that does not exist, weakly_canonical would leave out the folder.
  const fs::path real = fs::weakly_canonical(fs::absolute(file, error), error);
  if (error) throw refuse("cannot create the file: " + error.message(), "");
  const fs::file_status status = fs::status(real, error);
  if (fs::is_directory(status)) throw refuse("the export would replace a folder", "the name of a file");
  if (fs::exists(status) && !fs::is_regular_file(status))
    throw refuse("the export would replace something that is not a file", "the name of a file");
  if (fs::exists(status) && ::access(real.c_str(), W_OK) != 0)
    throw refuse("the file exists and may not be written", "a file that may be written, or a new name");
  if (!fs::is_directory(real.parent_path(), error))
    throw refuse("there is no folder " + inQuotes(file.parent_path().string()), "a folder that exists");
  return real;
}

/// Where a new file is made before it takes its place.
fs::path draftOf(const fs::path& real) {
  return real.string() + "." + std::to_string(::getpid()) + ".part";
}

void writeHeader(hdf5::Group& root) {
  constexpr std::int64_t kVersion[] = {2, 0};
  root.setAttribute("Version", std::span<const std::int64_t>(kVersion));
  root.setAttribute("Type", std::string_view("PolyData"));
}

hdf5::Group makeRoot(hdf5::File& file) {
  hdf5::Group top = file.root();
  hdf5::Group root = top.openGroup("VTKHDF");
  if (!root.hasAttribute("Type")) writeHeader(root);
  return root;
}

/// Appends step·first, step·(first + 1), … step·(end − 1) without holding them all.
void appendAscending(hdf5::Dataset& set, std::int64_t first, std::int64_t end, std::int64_t step = 1) {
  std::vector<std::int64_t> block;
  for (; first < end; first += kParticleChunk) {
    block.resize(static_cast<std::size_t>(std::min(end - first, kParticleChunk)));
    for (std::size_t k = 0; k < block.size(); ++k) block[k] = step * (first + static_cast<std::int64_t>(k));
    set.append(std::span<const std::int64_t>(block));
  }
}

}  // namespace

PolyDataFile::Cells::Cells(hdf5::Group& root, const std::string& kind, std::int64_t chunkRows)
    : Cells(root.openGroup(kind), chunkRows) {}

PolyDataFile::Cells::Cells(hdf5::Group group, std::int64_t chunkRows)
    : cellCounts(group.openGrowing("NumberOfCells", perStep())),
      connectivityCounts(group.openGrowing("NumberOfConnectivityIds", perStep())),
      connectivity(group.openGrowing("Connectivity", ascending(chunkRows))),
      offsets(group.openGrowing("Offsets", ascending(chunkRows))) {}

PolyDataFile::Steps::Steps(hdf5::Group& root)
    : group(root.openGroup("Steps")),
      values(group.openGrowing("Values", perStep(NumberType::kFloat64))),
      partOffsets(group.openGrowing("PartOffsets", perStep())),
      partCounts(group.openGrowing("NumberOfParts", perStep())),
      pointOffsets(group.openGrowing("PointOffsets", perStep())),
      cellOffsets(group.openGrowing("CellOffsets", perStep(NumberType::kInt64, 4))),
      connectivityOffsets(group.openGrowing("ConnectivityIdOffsets", perStep(NumberType::kInt64, 4))) {
  if (!group.hasAttribute("NSteps")) group.setAttribute("NSteps", std::int64_t{0});
}

PolyDataFile::Contents::Contents(hdf5::File& file, const VtkHdfLayout& layout)
    : root(makeRoot(file)),
      simulation(file.root().openGroup("simulation")),
      steps(root),
      points(root.openGrowing("Points", {.type = NumberType::kFloat32,
                                         .columns = 3,
                                         .chunkRows = kParticleChunk,
                                         .deflate = layout.roundPositions})),
      pointCounts(root.openGrowing("NumberOfPoints", perStep())),
      vertices(root, "Vertices", layout.triangles ? kStepChunk : kParticleChunk),
      lines(root, "Lines", kStepChunk),
      polygons(root, "Polygons", layout.triangles ? kParticleChunk : kStepChunk),
      strips(root, "Strips", kStepChunk) {
  hdf5::Group pointData = root.openGroup("PointData");
  hdf5::Group pointOffsets = steps.group.openGroup("PointDataOffsets");
  hdf5::Group units = simulation.openGroup("units");
  units.setAttribute("Points", std::string_view("m"));
  units.setAttribute("Values", std::string_view("s"));
  for (const VtkHdfAttribute& attribute : layout.attributes) {
    attributes.push_back({pointData.openGrowing(attribute.name, layoutOf(attribute)),
                          pointOffsets.openGrowing(attribute.name, perStep())});
    units.setAttribute(attribute.name.c_str(), attribute.unit);
  }
  hdf5::Group fieldData = root.openGroup("FieldData");
  hdf5::Group fieldOffsets = steps.group.openGroup("FieldDataOffsets");
  hdf5::Group fieldSizes = steps.group.openGroup("FieldDataSizes");
  for (const std::string& name : layout.fields)
    fields.push_back({fieldData.openGrowing(name, perStep(NumberType::kFloat64)),
                      fieldOffsets.openGrowing(name, perStep()),
                      fieldSizes.openGrowing(name, perStep(NumberType::kInt64, 2))});
}

void PolyDataFile::Cells::truncate(std::int64_t parts, std::int64_t ids, std::int64_t offsetRows) {
  cellCounts.truncate(parts);
  connectivityCounts.truncate(parts);
  connectivity.truncate(ids);
  offsets.truncate(offsetRows);
}

void PolyDataFile::Cells::appendNone() {
  appendCounts(0, 0);
  offsets.append(std::int64_t{0});
}

void PolyDataFile::Cells::appendCounts(std::int64_t cells, std::int64_t ids) {
  cellCounts.append(cells);
  connectivityCounts.append(ids);
}

void PolyDataFile::Cells::appendPoints(std::int64_t count) {
  appendCounts(count, count);
  // All parts share one row of ids, as long as the largest needs.
  appendAscending(connectivity, connectivity.rows(), count);
  appendAscending(offsets, 0, count + 1);
}

void PolyDataFile::Cells::appendTriangles(std::span<const Vec3i> triangles) {
  const auto count = static_cast<std::int64_t>(triangles.size());
  appendCounts(count, 3 * count);
  appendAscending(offsets, 0, count + 1, 3);
  std::vector<std::int64_t> block;
  for (std::size_t first = 0; first < triangles.size(); first += kParticleChunk) {
    block.clear();
    for (const Vec3i& t :
         triangles.subspan(first, std::min<std::size_t>(kParticleChunk, triangles.size() - first)))
      block.insert(block.end(), {t.x, t.y, t.z});
    connectivity.append(std::span<const std::int64_t>(block));
  }
}

void PolyDataFile::Steps::truncate(std::int64_t steps) {
  for (hdf5::Dataset* set :
       {&values, &partOffsets, &partCounts, &pointOffsets, &cellOffsets, &connectivityOffsets})
    set->truncate(steps);
  group.setAttribute("NSteps", steps);
}

void PolyDataFile::truncate(std::int64_t steps) {
  Contents& in = *contents_;
  const std::vector<std::int64_t> partOfStep = in.steps.partOffsets.read<std::int64_t>(0, steps);
  const std::vector<std::int64_t> counts = in.pointCounts.readAll<std::int64_t>();
  frames_ = steps;
  for (const std::int64_t part : partOfStep) points_ += counts.at(static_cast<std::size_t>(part));
  parts_ = partOfStep.empty() ? 0 : partOfStep.back() + 1;
  std::int64_t largest = 0;
  for (std::int64_t part = 0; part < parts_; ++part) {
    partPoints_ = counts.at(static_cast<std::size_t>(part));
    largest = std::max(largest, partPoints_);
  }
  for (const std::int64_t count : cells().cellCounts.read<std::int64_t>(0, parts_)) {
    partCells_ = count;
    cells_ += count;
  }
  in.steps.truncate(steps);
  in.points.truncate(points_);
  in.pointCounts.truncate(parts_);
  for (Cells* kind : {&in.vertices, &in.lines, &in.polygons, &in.strips}) {
    const bool used = kind == &cells();
    kind->truncate(parts_, !used ? 0 : triangles_ ? 3 * cells_ : largest, parts_ + (used ? cells_ : 0));
  }
  for (Column& column : in.attributes) {
    column.values.truncate(points_);
    column.offsets.truncate(steps);
  }
  for (Field& field : in.fields)
    for (hdf5::Dataset* set : {&field.values, &field.offsets, &field.sizes}) set->truncate(steps);
}

PolyDataFile::PolyDataFile(const fs::path& file, const VtkHdfLayout& layout, std::int64_t steps)
    : triangles_(layout.triangles) {
  checkLayout(layout);
  const fs::path real = target(file), draft = draftOf(real);
  std::error_code error;
  fs::copy_file(real, draft, fs::copy_options::overwrite_existing, error);
  if (error) throw ioError("cannot go on with the file: " + error.message()).at({.file = file.string()});
  replaceBy(real, draft, [&] {
    file_ = std::make_unique<hdf5::File>(hdf5::File::reopen(draft));
    contents_ = std::make_unique<Contents>(*file_, layout);
    truncate(steps);
  });
}

template <class F>
void PolyDataFile::replaceBy(const fs::path& real, const fs::path& draft, const F& fill) {
  try {
    fill();
    file_->flush();
    std::error_code error;
    fs::rename(draft, real, error);
    if (error) throw ioError("cannot create the file: " + error.message()).at({.file = real.string()});
    syncFolderOf(real);
  } catch (...) {  // an Error, or no memory
    if (file_) abandon();
    std::error_code ignored;
    fs::remove(draft, ignored);
    throw;
  }
}

PolyDataFile::PolyDataFile(const fs::path& file, const VtkHdfLayout& layout) : triangles_(layout.triangles) {
  checkLayout(layout);
  const fs::path real = target(file);
  const fs::path draft = draftOf(real);
  replaceBy(real, draft, [&] {
    file_ = std::make_unique<hdf5::File>(hdf5::File::create(draft, file.string()));
    contents_ = std::make_unique<Contents>(*file_, layout);
  });
}

PolyDataFile::PolyDataFile(const fs::path& file, const VtkHdfLayout& layout, const VirtualSteps& from,
                           const ExportTexts& texts)
    : virtual_(true) {
  checkLayout(layout);
  WEIR_CHECK(!layout.triangles);
  const fs::path real = target(file), draft = draftOf(real);
  replaceBy(real, draft, [&] {
    file_ = std::make_unique<hdf5::File>(hdf5::File::create(draft, file.string()));
    makeVirtualSets(*file_, layout, from);
    contents_ = std::make_unique<Contents>(*file_, layout);
    for (const VirtualStep& step : from.steps) {
      appendStep({.fields = step.fields, .points = step.points(), .triangles = {}});
      contents_->steps.values.append(step.time);
    }
    contents_->steps.group.setAttribute("NSteps", frames_);
    for (const auto& [name, text] : texts) contents_->simulation.writeText(name, text);
    file_->sync();
  });
}

void PolyDataFile::writeVirtual(const fs::path& file, const VtkHdfLayout& layout, const VirtualSteps& from,
                                const ExportTexts& texts) {
  PolyDataFile(file, layout, from, texts).close();
}

void PolyDataFile::writeCounting(const fs::path& file, std::int64_t end) {
  PolyDataFile made;
  const fs::path draft = draftOf(file);
  made.replaceBy(file, draft, [&] {
    made.file_ = std::make_unique<hdf5::File>(hdf5::File::create(draft, file.string()));
    makeCountingSet(*made.file_, end);
    made.file_->sync();
  });
  made.close();
}

void PolyDataFile::write(const VtkHdfFrame& frame) {
  appendValues(frame);
  appendStep({.fields = frame.fields,
              .points = static_cast<std::int64_t>(frame.positions.size()),
              .triangles = frame.triangles});
  // The step counts only once all that belongs to it is on its way to the disk. Its time comes last: VTK (9.3
  // to 9.7) makes room for NSteps times and reads all that there are, so it crashes where a run was killed
  // between the two the other way round.
  file_->flush();
  contents_->steps.group.setAttribute("NSteps", frames_);
  file_->flush();
  contents_->steps.values.append(frame.time);
  file_->flush();
}

void PolyDataFile::appendValues(const VtkHdfFrame& frame) {
  Contents& to = *contents_;
  WEIR_CHECK(frame.attributes.size() == to.attributes.size());
  to.points.append(std::get<std::span<const float>>(flat(frame.positions)));
  for (std::size_t i = 0; i < to.attributes.size(); ++i)
    std::visit([&](const auto& values) { to.attributes[i].values.append(values); }, frame.attributes[i]);
}

void PolyDataFile::appendStep(const Step& step) {
  Contents& to = *contents_;
  WEIR_CHECK(step.fields.size() == to.fields.size());
  for (Column& column : to.attributes) column.offsets.append(points_);
  for (std::size_t i = 0; i < to.fields.size(); ++i) {
    constexpr std::int64_t kOneNumber[] = {1, 1};
    to.fields[i].values.append(step.fields[i]);
    to.fields[i].offsets.append(frames_);
    to.fields[i].sizes.append(std::span<const std::int64_t>(kOneNumber));
  }
  if (triangles_ || step.points != partPoints_) addPart(step);

  // Of vertices, lines, polygons and strips.
  const std::int64_t first = cells_ - partCells_;
  const std::int64_t cellOffsets[] = {triangles_ ? 0 : first, 0, triangles_ ? first : 0, 0};
  const std::int64_t idOffsets[] = {0, 0, triangles_ ? 3 * first : 0, 0};
  to.steps.partOffsets.append(parts_ - 1);
  to.steps.partCounts.append(std::int64_t{1});
  to.steps.pointOffsets.append(points_);
  to.steps.cellOffsets.append(std::span<const std::int64_t>(cellOffsets));
  to.steps.connectivityOffsets.append(std::span<const std::int64_t>(idOffsets));
  points_ += step.points;
  ++frames_;
}

void PolyDataFile::addPart(const Step& step) {
  partPoints_ = step.points;
  partCells_ = triangles_ ? static_cast<std::int64_t>(step.triangles.size()) : partPoints_;
  contents_->pointCounts.append(partPoints_);
  for (Cells* kind : {&contents_->vertices, &contents_->lines, &contents_->polygons, &contents_->strips})
    if (kind != &cells()) kind->appendNone();
  if (triangles_)
    cells().appendTriangles(step.triangles);
  else if (virtual_)
    cells().appendCounts(partPoints_, partPoints_);
  else
    cells().appendPoints(partPoints_);
  ++parts_;
  cells_ += partCells_;
}

void PolyDataFile::setText(const std::string& name, std::string_view text) {
  contents_->simulation.writeText(name, text);
  file_->flush();
}

void PolyDataFile::sync() {
  file_->sync();
}

void PolyDataFile::close() {
  contents_.reset();
  file_->close();
}

void PolyDataFile::abandon() {
  file_->abandon();
  contents_.reset();
  file_.reset();
}

}  // namespace weir
