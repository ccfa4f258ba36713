// Exports, our own and other programs', that say anything; see hdf5_text.h.
#include "plugins/vtkhdf/vtkhdf_reader.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/hdf5_text.h"

namespace {

void readAll(const std::string& file) {
  const weir::VtkHdfReader reader(file);
  if (reader.times().empty()) return;
  for (const double time : {reader.times().front(), reader.times().back()}) {
    const std::size_t step = reader.nearestStep(time);
    const weir::VtkHdfStep read = reader.read(step);
    const auto points = static_cast<std::int64_t>(read.positions.size());
    const std::vector<weir::Vec3f> velocities = read.velocities();
    if (!velocities.empty() && velocities.size() != read.positions.size()) std::abort();
    const std::vector<weir::Vec3i> triangles = reader.triangles(step);
    if (static_cast<std::int64_t>(triangles.size()) != reader.polygonCount(step)) std::abort();
    for (const weir::Vec3i& t : triangles)
      for (int k = 0; k < 3; ++k)
        if (t[k] < 0 || t[k] >= points) std::abort();
  }
  if (reader.hasText("scene")) static_cast<void>(reader.text("scene"));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return weir::fuzz::withFile(data, size, ".vtkhdf", [&](const std::string& file) {
    weir::fuzz::writeHdf5(std::string_view(reinterpret_cast<const char*>(data), size), file);
    readAll(file);
  });
}
