#include "plugins/vtkhdf/export_file.h"

#include "framework/base/build_info.h"
#include "framework/base/file_output.h"

namespace weir {

void ExportFile::begin(const Simulation& simulation) {
  checkWritable(path_);
  sceneText_ = simulation.scene().text;
}

ExportTexts ExportFile::texts(const char* listName, const std::vector<std::string>& names) const {
  std::string lines;
  for (const std::string& name : names) lines += name + "\n";
  return {{"version", std::string(version())}, {"scene", sceneText_}, {listName, lines}};
}

void ExportFile::open(VtkHdfLayout layout, const ExportTexts& texts) {
  if (earlier_) {
    writer_ = std::make_unique<VtkHdfWriter>(path_, std::move(layout), *earlier_);
    return;
  }
  writer_ = std::make_unique<VtkHdfWriter>(path_, std::move(layout));
  for (const auto& [name, text] : texts) writer_->setText(name, text);
}

void ExportFile::close() {
  if (writer_) writer_->close();
}

void ExportFile::save(const StateWriter& to) {
  writer_->sync();
  to.put("frames", writer_->framesWritten());
}

void ExportFile::resume(const StateReader& from) {
  std::int64_t frames = 0;
  from.get("frames", frames);
  earlier_ = frames;
}

}  // namespace weir
