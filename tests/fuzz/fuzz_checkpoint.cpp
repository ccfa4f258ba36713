// Checkpoints that say anything; see hdf5_text.h. Digests are taken for right here (CMakeLists.txt), or else
// nothing behind them would be reached. What is read is written, and read back as the same.
#include <algorithm>
#include <filesystem>

#include "plugins/vtkhdf/checkpoint_file.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/hdf5_text.h"

namespace {

bool same(const weir::Checkpoint& a, const weir::Checkpoint& b) {
  if (a.version != b.version || a.scene != b.scene || a.device != b.device || a.inputs != b.inputs)
    return false;
  return std::equal(a.state.begin(), a.state.end(), b.state.begin(), b.state.end(),
                    [](const auto& left, const auto& right) {
                      const weir::StateArray &x = left.second, &y = right.second;
                      return left.first == right.first && x.kind == y.kind && x.rows == y.rows &&
                             x.columns == y.columns && x.data == y.data;
                    });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return weir::fuzz::withFile(data, size, ".h5", [&](const std::string& file) {
    weir::fuzz::writeHdf5(std::string_view(reinterpret_cast<const char*>(data), size), file);
    const weir::Hdf5CheckpointStore store;
    const weir::Checkpoint checkpoint = store.read(file);
    for (const auto& [path, array] : checkpoint.state)
      if (array.data.size() != array.bytes() || array.rows < 0 || array.columns < 0) std::abort();
    std::filesystem::remove(file);
    store.write(file, checkpoint);
    if (!same(store.read(file), checkpoint)) std::abort();
  });
}
