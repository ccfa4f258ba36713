// PLY files of particles.
#include "nodes/particle_file/ply_reader.h"
#include "tests/fuzz/fuzz_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return weir::fuzz::withFile(data, size, ".ply", [](const std::string& file) {
    const weir::ParticleData read = weir::PlyReader().read(file);
    if (read.positions.empty() || read.positions.size() != read.velocities.size()) std::abort();
  });
}
