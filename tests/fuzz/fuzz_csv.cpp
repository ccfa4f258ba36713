// Tables of particles.
#include "nodes/particle_file/csv_reader.h"
#include "tests/fuzz/fuzz_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return weir::fuzz::withFile(data, size, ".csv", [](const std::string& file) {
    const weir::ParticleData read = weir::CsvReader().read(file);
    if (read.positions.empty() || read.positions.size() != read.velocities.size()) std::abort();
  });
}
