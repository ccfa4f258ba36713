// Hands views over to Blender: a folder of frames, each a file that says all that there is to see.
//
// blender/weir_blender/handover.py reads it and says what is in it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "plugins/cycles/npz_file.h"
#include "plugins/views/picture_maker.h"
#include "plugins/views/render_settings.h"

namespace weir::rendering {

class Handover {
 public:
  /// Makes the folder if it is missing; the folder above must be there. `frameRate` is the run's, 1/s. Throws
  /// an io Error if it cannot be made, is not a folder, or if nothing can be written in it.
  Handover(std::filesystem::path folder, const CyclesSettings& settings, double frameRate);

  // Meshes as a PictureMaker has them. One that is added with triangles is written once. One that is replaced
  // belongs to each frame; its arrays must be there until the frame is written.
  MeshId addMesh(const TriangleMesh& mesh);
  void replaceMesh(MeshId id, const ShownMesh& mesh);

  /// Writes frame_00012.npz of a view whose particles are on the host; one that is there is replaced when the
  /// new one is whole. Returns its path. Throws an io Error.
  std::filesystem::path write(const View& view);

  const std::filesystem::path& folder() const { return folder_; }

 private:
  struct Mesh {
    std::string file;  // of one that is written; "" of one that is replaced
    ShownMesh span;
  };

  Value sceneOf(const View& view);
  Value environmentOf(const View& view);
  Value particlesOf(const ParticleView& particles, std::size_t index, NpzFile& arrays) const;
  Value surfaceOf(const SurfaceView& surface, std::size_t index, NpzFile& arrays) const;

  std::filesystem::path folder_;
  const CyclesSettings& settings_;
  double frameRate_;
  std::vector<Mesh> meshes_;
  std::shared_ptr<const EnvironmentImage> image_;  // that has been written
};

}  // namespace weir::rendering
