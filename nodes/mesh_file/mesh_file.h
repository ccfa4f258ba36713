// A triangle mesh from a file, scaled and placed. A program may give the mesh in place of a file.
#pragma once

#include <optional>

#include "framework/base/api.h"
#include "framework/communication/on_ranks.h"
#include "framework/geometry/triangle_mesh.h"
#include "framework/graph/given_data.h"
#include "framework/graph/node.h"

namespace WEIR_API weir {

enum class UpAxis { kX, kY, kZ };
template <>
struct EnumNames<UpAxis> {
  static constexpr std::array<EnumName, 3> kNames{EnumName{"x", "The file's x axis points up."},
                                                  EnumName{"y", "The file's y axis points up."},
                                                  EnumName{"z", "The file's z axis points up."}};
};

enum class MeshAnchor { kOrigin, kCenter, kBase };
template <>
struct EnumNames<MeshAnchor> {
  static constexpr std::array<EnumName, 3> kNames{
      EnumName{"origin", "The file's origin."}, EnumName{"center", "The centre of the mesh's bounds."},
      EnumName{"base", "The centre of the bottom of the mesh's bounds."}};
};

class MeshFile final : public Node, public OnRanks, public GivenData {
 public:
  static constexpr NodeInfo kInfo{"MeshFile", "Reads a triangle mesh from a file.",
                                  "import, load, obj, stl, ply, gltf, model, cad, geometry"};
  const NodeInfo& info() const override { return kInfo; }

  Param<FilePath> file{*this, "file", {}, {.doc = "The file; its ending says what reads it."}};
  Param<float> unit{*this,
                    "unit",
                    1,
                    {.unit = "m",
                     .min = 0,
                     .aboveMin = true,
                     .doc = "Length of one unit of the file, such as 0.001 for millimetres."}};
  Param<std::optional<float>> fitSize{
      *this,
      "fit_size",
      std::nullopt,
      {.unit = "m",
       .min = 0,
       .aboveMin = true,
       .doc = "Scales the mesh so that the longest side of its bounds has this length; in place of unit."}};
  Param<UpAxis> up{*this, "up", UpAxis::kY, {.doc = "Which axis of the file points up."}};
  Param<MeshAnchor> anchor{*this,
                           "anchor",
                           MeshAnchor::kOrigin,
                           {.doc = "The point of the unturned mesh that comes to position, and about which "
                                   "rotation turns it."}};
  Param<Vec3f> position{*this, "position", {}, {.unit = "m", .doc = "Where the anchor is."}};
  Param<Rotation> rotation{*this, "rotation", {}, {.unit = "degrees", .doc = "Turns the mesh."}};
  Param<bool> flip{
      *this, "flip", false, {.doc = "Turns all triangles round, for a mesh that is inside out."}};

  Output<TriangleMesh> surface{*this, "surface", "The mesh, welded and without degenerate triangles."};

  /// Takes this mesh in place of a file's, until a file is named again: its vertices finite, and its
  /// triangles of these vertices.
  void give(TriangleMesh mesh);
  /// That one, or null if there is a file.
  const TriangleMesh* given() const { return given_ && file->empty() ? &*given_ : nullptr; }
  std::optional<std::uint32_t> givenDigest() const override;

  void validate() const override;
  /// Reads the mesh, as others tell by it what they need.
  void estimate(const SetupContext& context, MemoryNeeds& needs) override;
  void reset(const SetupContext& context) override;

 private:
  void load(const SetupContext& context);
  TriangleMesh read(const Registry& registry) const;
  void place(TriangleMesh& mesh) const;
  Error fileError(std::string message, std::string allowed = {}, std::string hint = {}) const;

  std::optional<TriangleMesh> given_;
  bool loaded_ = false;  // by estimate(), for reset()
};

}  // namespace weir
