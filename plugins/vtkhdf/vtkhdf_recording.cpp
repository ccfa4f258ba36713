#include "plugins/vtkhdf/vtkhdf_recording.h"

#include <sstream>
#include <utility>

#include "framework/base/error.h"
#include "plugins/vtkhdf/isolated.h"
#include "plugins/vtkhdf/particle_export.h"
#include "plugins/vtkhdf/vtkhdf_reader.h"

namespace weir {

namespace {

/// Of the rows of an array, those of which `of` is `index`.
template <class T>
std::vector<T> chosen(const std::vector<T>& values, const std::vector<std::int64_t>& of, std::int64_t index,
                      int components) {
  std::vector<T> result;
  for (std::size_t i = 0; i < of.size(); ++i)
    if (of[i] == index) {
      const auto row = values.begin() + static_cast<std::ptrdiff_t>(i) * components;
      result.insert(result.end(), row, row + components);
    }
  return result;
}

class VtkHdfRecording final : public Recording {
 public:
  explicit VtkHdfRecording(const std::filesystem::path& file) : file_(file.string()), reader_(file) {
    std::istringstream lines(reader_.hasText("fluids") ? reader_.text("fluids") : std::string());
    for (std::string line; std::getline(lines, line);) fluids_.push_back(line);
    if (times().empty())
      throw ioError("the file holds no time step", "one or more steps").at({.file = file_});
  }

  const std::vector<double>& times() const override { return reader_.times(); }
  const std::vector<std::string>& fluids() const override { return fluids_; }

  std::vector<RecordedFluid> read(std::size_t frame) const override {
    try {
      return split(reader_.read(frame));
    } catch (Error& error) {
      throw error.at({.file = file_});
    }
  }

 private:
  std::vector<RecordedFluid> split(VtkHdfStep step) const {
    std::vector<RecordedFluid> result;
    if (fluids_.size() < 2) {
      result.push_back({.positions = std::move(step.positions), .arrays = std::move(step.arrays)});
      return result;
    }
    const VtkHdfArray* array = step.find(kFluidIndexName);
    const auto* indices = array != nullptr ? std::get_if<std::vector<std::int64_t>>(&array->values) : nullptr;
    if (indices == nullptr)
      throw ioError("the file names several fluids, but says not which particle is of which",
                    "integers called fluid_index");
    for (std::size_t i = 0; i < fluids_.size(); ++i) {
      const auto index = static_cast<std::int64_t>(i);
      RecordedFluid& fluid = result.emplace_back();
      fluid.positions = chosen(step.positions, *indices, index, 1);
      for (const VtkHdfArray& from : step.arrays)
        std::visit(
            [&](const auto& values) {
              fluid.arrays.push_back(
                  {from.name, from.components, chosen(values, *indices, index, from.components)});
            },
            from.values);
    }
    return result;
  }

  std::string file_;
  VtkHdfReader reader_;
  std::vector<std::string> fluids_;
};

}  // namespace

std::unique_ptr<Recording> VtkHdfRecordingReader::open(const std::filesystem::path& file) const {
  constexpr int kMaxSeconds = 600;
  try {
    hdf5::runIsolated(
        [&] {
          const VtkHdfRecording recording(file);
          recording.read(recording.times().size() - 1);
          return std::string();
        },
        kMaxSeconds);
    return std::make_unique<VtkHdfRecording>(file);
  } catch (Error& error) {
    throw error.at({.file = file.string()});
  }
}

}  // namespace weir
