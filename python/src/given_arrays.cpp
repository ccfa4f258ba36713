#include "python/src/given_arrays.h"

#include <nanobind/stl/string.h>

#include "framework/base/text.h"
#include "nodes/mesh_file/mesh_file.h"
#include "nodes/particle_file/particle_file.h"
#include "python/src/numpy_arrays.h"

namespace weir::python {

namespace {

bool isOfInts(nb::handle array) {
  return nb::cast<std::string>(array.attr("dtype").attr("kind")) == "i";
}

/// Of an array (n,) of int32 or float32, or (n, 3) of float32.
ParticleColumn columnOf(const std::string& name, nb::handle array) {
  if (!isName(name))
    throw usageError(inQuotes(name) + " is not a valid name for an attribute",
                     "letters, digits, '_' and '-', starting with a letter");
  const auto dimensions = nb::cast<int>(array.attr("ndim"));
  ParticleColumn column{.info = {.name = name}};
  if (dimensions == 1 && isOfInts(array)) {
    column.info.type = AttributeType::kInt;
    column.values = fromNumpy<int>(array);
  } else if (dimensions == 1) {
    column.info.type = AttributeType::kFloat;
    column.values = fromNumpy<float>(array);
  } else {
    column.info.type = AttributeType::kVec3;
    column.values = fromNumpy<Vec3f>(array);
  }
  return column;
}

ParticleData particlesOf(nb::dict arrays) {
  ParticleData data{.positions = fromNumpy<Vec3f>(arrays["positions"]),
                    .velocities = fromNumpy<Vec3f>(arrays["velocities"])};
  for (const auto& [name, array] : nb::cast<nb::dict>(arrays["attributes"]))
    data.columns.push_back(columnOf(nb::cast<std::string>(name), array));
  return data;
}

nb::dict toPython(const ParticleData& data) {
  nb::dict all, attributes;
  all["positions"] = toNumpy(data.positions);
  all["velocities"] = toNumpy(data.velocities);
  for (const ParticleColumn& column : data.columns)
    attributes[column.info.name.c_str()] =
        std::visit([](const auto& values) { return toNumpy(values); }, column.values);
  all["attributes"] = attributes;
  return all;
}

}  // namespace

void giveArrays(Node& node, nb::dict arrays) {
  if (auto* file = dynamic_cast<ParticleFile*>(&node)) return file->give(particlesOf(arrays));
  if (auto* file = dynamic_cast<MeshFile*>(&node))
    return file->give({fromNumpy<Vec3f>(arrays["vertices"]), fromNumpy<Vec3i>(arrays["faces"])});
  throw sceneError("a " + std::string(node.info().type) + " takes no arrays", "a ParticleFile or a MeshFile")
      .inNode(node.name());
}

void fillBatch(ParticleBatch& batch, Device& device, nb::dict arrays) {
  const ParticleData data = particlesOf(arrays);
  batch.assign(device, data.positions, data.velocities);
  batch.attributes.clear();
  for (const ParticleColumn& column : data.columns)
    std::visit(
        [&]<class T>(const std::vector<T>& values) {
          batch.attributes.push_back({column.info, Array<T>(device, values)});
        },
        column.values);
}

nb::object givenArrays(const Node& node) {
  if (const auto* file = dynamic_cast<const ParticleFile*>(&node);
      file != nullptr && file->given() != nullptr)
    return toPython(*file->given());
  const auto* file = dynamic_cast<const MeshFile*>(&node);
  if (file == nullptr || file->given() == nullptr) return nb::none();
  nb::dict all;
  all["vertices"] = toNumpy(file->given()->vertices);
  all["faces"] = toNumpy(file->given()->triangles);
  return all;
}

std::vector<std::string> nodesWithArrays(const Scene& scene) {
  std::vector<std::string> names;
  for (const auto& node : scene.graph.nodes())
    if (const auto* given = dynamic_cast<const GivenData*>(node.get()); given && given->givenDigest())
      names.push_back(node->name());
  return names;
}

}  // namespace weir::python
