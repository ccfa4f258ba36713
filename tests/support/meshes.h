// Small meshes that several tests use, and what is known of them by other means.
#pragma once

#include "framework/geometry/triangle_mesh.h"

namespace weir::test {

/// An icosahedron about the origin whose triangles were divided in four `levels` times, all vertices on the
/// sphere: 20·4^levels triangles.
TriangleMesh icosphere(int levels, float radius = 1);

/// The largest depth of the icosphere's surface below the sphere.
double icosphereSagitta(const TriangleMesh& sphere, double radius = 1);

/// The axis-aligned box from lo to hi, 12 triangles.
TriangleMesh boxMesh(const Vec3f& lo, const Vec3f& hi);

/// A square of size 2 in the plane z = 0, of cells² pairs of triangles: open all round.
TriangleMesh sheet(int cells);

/// Both meshes in one, `added` moved by `offset`.
void append(TriangleMesh& mesh, const TriangleMesh& added, const Vec3f& offset = {});

/// The distance from p to the nearest point of the mesh, in double, by asking every triangle.
double slowDistance(const TriangleMesh& mesh, const Vec3f& p);

/// The solid angle of every triangle by l'Huilier's theorem, signed by the side that p is on; over 4π.
double slowWindingNumber(const TriangleMesh& mesh, const Vec3f& p);

}  // namespace weir::test
