#include "plugins/vtkhdf/vtkhdf_writer.h"

#include <cmath>
#include <utility>

#include "framework/base/check.h"
#include "plugins/vtkhdf/polydata_file.h"

namespace weir {

VtkHdfWriter::VtkHdfWriter(const std::filesystem::path& file, VtkHdfLayout layout)
    : layout_(std::move(layout)) {
  const hdf5::Session session;
  file_ = std::make_unique<PolyDataFile>(file, layout_);
}

VtkHdfWriter::VtkHdfWriter(const std::filesystem::path& file, VtkHdfLayout layout, std::int64_t frames)
    : layout_(std::move(layout)), framesWritten_(frames) {
  const hdf5::Session session;
  file_ = std::make_unique<PolyDataFile>(file, layout_, frames);
}

VtkHdfWriter::~VtkHdfWriter() {
  try {
    close();
  } catch (...) {
    // Whoever wants to know calls close().
  }
}

void VtkHdfWriter::append(const VtkHdfFrame& frame) {
  check(frame);
  attempt([&] { file_->write(frame); });
  lastTime_ = frame.time;
  ++framesWritten_;
}

void VtkHdfWriter::setText(const std::string& name, std::string_view text) {
  attempt([&] { file_->setText(name, text); });
}

void VtkHdfWriter::sync() {
  attempt([&] { file_->sync(); });
}

void VtkHdfWriter::close() {
  if (!file_) return;
  attempt([&] { file_->close(); });
  const hdf5::Session session;
  file_.reset();
}

void VtkHdfWriter::attempt(const std::function<void()>& write) {
  if (error_) std::rethrow_exception(error_);
  WEIR_CHECK(file_ != nullptr);
  const hdf5::Session session;
  try {
    write();
  } catch (...) {
    error_ = std::current_exception();
    file_->abandon();
    file_.reset();
    throw;
  }
}

void VtkHdfWriter::check(const VtkHdfFrame& frame) const {
  WEIR_CHECK(std::isfinite(frame.time));
  WEIR_CHECK(frame.time > lastTime_);
  WEIR_CHECK((frame.triangles.empty() || layout_.triangles));
  WEIR_CHECK(frame.fields.size() == layout_.fields.size());
  WEIR_CHECK(frame.attributes.size() == layout_.attributes.size());
  for (std::size_t i = 0; i < frame.attributes.size(); ++i) {
    const VtkHdfAttribute& attribute = layout_.attributes[i];
    // The alternatives of VtkHdfValues stand in the order of VtkHdfType.
    WEIR_CHECK(frame.attributes[i].index() == static_cast<std::size_t>(attribute.type));
    const std::size_t numbers =
        std::visit([](const auto& values) { return values.size(); }, frame.attributes[i]);
    WEIR_CHECK(numbers == frame.positions.size() * static_cast<std::size_t>(attribute.components));
  }
}

}  // namespace weir
