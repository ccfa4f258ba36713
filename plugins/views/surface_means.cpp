#include "plugins/views/surface_means.h"

#include <algorithm>
#include <cmath>

#include "framework/base/check.h"
#include "plugins/views/in_parts.h"

namespace weir::rendering {

namespace {

/// The vertices that share an edge with each: those of vertex i are ends[first[i]] to ends[first[i + 1] - 1].
struct MeshEdges {
  std::vector<std::size_t> first;
  std::vector<int> ends;
  double meanSquare = 0;  ///< of their lengths, m^2
};

MeshEdges edgesOf(const MeshSpan& mesh) {
  MeshEdges edges{std::vector<std::size_t>(mesh.vertices.size() + 2), {}, 0};
  edges.ends.resize(3 * mesh.triangles.size());
  // In a closed mesh, each edge begins at each of its ends in one triangle.
  const auto forEach = [&](const auto& visit) {
    for (const Vec3i& t : mesh.triangles)
      for (int k = 0; k < 3; ++k) visit(t[k], t[(k + 1) % 3]);
  };
  forEach([&](int from, int to) {
    ++edges.first[std::size_t(from) + 2];
    const Vec3f way = mesh.vertices[std::size_t(to)] - mesh.vertices[std::size_t(from)];
    edges.meanSquare += dot(way, way);
  });
  for (std::size_t i = 2; i < edges.first.size(); ++i) edges.first[i] += edges.first[i - 1];
  forEach([&](int from, int to) { edges.ends[edges.first[std::size_t(from) + 1]++] = to; });
  edges.first.pop_back();
  edges.meanSquare /= double(std::max<std::size_t>(1, edges.ends.size()));
  return edges;
}

}  // namespace

std::vector<Vec3f> meansAt(std::span<const Vec3f> places, const NearParticles& particles,
                           std::span<const Vec3f> vectors) {
  WEIR_CHECK(vectors.size() == particles.size());
  std::vector<Vec3f> means(places.size());
  inParts(places.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Vec3f sum;
      float weights = 0;
      particles.visit(places[i], [&](std::size_t k, float weight) {
        if (!isFinite(vectors[k])) return;
        sum += weight * vectors[k];
        weights += weight;
      });
      if (weights > 0) means[i] = (1 / weights) * sum;
    }
  });
  return means;
}

std::vector<Vec3f> mixedAlong(const MeshSpan& mesh, std::vector<Vec3f> vectors, float deviation) {
  WEIR_CHECK(vectors.size() == mesh.vertices.size());
  const MeshEdges edges = edgesOf(mesh);
  if (!(edges.meanSquare > 0)) return vectors;
  constexpr double kMaxPasses = 100;  // for meshes that are much finer than what is mixed
  const int passes = int(std::min(kMaxPasses, std::round(2.0 * deviation * deviation / edges.meanSquare)));
  std::vector<Vec3f> mixed(vectors.size());
  for (int pass = 0; pass < passes; ++pass) {
    inParts(vectors.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        Vec3f sum;
        for (std::size_t k = edges.first[i]; k < edges.first[i + 1]; ++k)
          sum += vectors[std::size_t(edges.ends[k])];
        const auto around = float(edges.first[i + 1] - edges.first[i]);
        mixed[i] = around > 0 ? (1 / around) * sum : vectors[i];
      }
    });
    vectors.swap(mixed);
  }
  return vectors;
}

}  // namespace weir::rendering
