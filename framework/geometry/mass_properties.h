// Volume, centre of mass and inertia of what a closed mesh encloses.
#pragma once

#include "framework/base/api.h"
#include "framework/geometry/triangle_mesh.h"

namespace WEIR_API weir {

/// A symmetric matrix of 3 rows.
struct Symmetric3 {
  double xx = 0, yy = 0, zz = 0, xy = 0, yz = 0, zx = 0;
  friend bool operator==(const Symmetric3&, const Symmetric3&) = default;
};

/// Of matter of density 1.
struct MassProperties {
  double volume = 0;   ///< m³; negative if the mesh is inside out
  Vec3d center;        ///< m
  Symmetric3 inertia;  ///< m⁵, about the centre: ∫ (|r|²·1 − r·rᵀ) dV
};

/// Exact but for rounding, in double, as a sum of tetrahedra between the triangles and a point amid the mesh:
/// with corners a, b, c seen from there, ∫ r·rᵀ dV = det(a, b, c)/120·(aaᵀ + bbᵀ + ccᵀ + ssᵀ), s = a + b + c
/// (Tonon 2005; the same integrals as those over faces of Mirtich 1996 and Eberly). The mesh must be closed;
/// what is enclosed twice counts twice. All is 0 for a mesh without triangles.
MassProperties massProperties(const TriangleMesh& mesh);

}  // namespace weir
