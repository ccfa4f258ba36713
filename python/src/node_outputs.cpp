#include "python/src/node_outputs.h"

#include <nanobind/stl/string.h>

#include "framework/base/text.h"
#include "framework/geometry/dynamic_mesh.h"
#include "framework/geometry/triangle_mesh.h"
#include "framework/particles/particle_batch.h"
#include "framework/particles/particles.h"
#include "framework/solids/solid.h"
#include "nodes/rigid_body/rigid_body.h"
#include "nodes/semi_analytical_sfi/semi_analytical_sfi.h"
#include "python/src/numpy_arrays.h"
#include "python/src/point_sums.h"
#include "python/src/values.h"

namespace weir::python {

Node& readyNode(const PythonScene& scene, const std::string& name) {
  Node& node = scene.node(name);
  if (scene.simulation() == nullptr)
    throw usageError("the node has nothing to show yet", "a node of a scene with an open weir.Simulation")
        .inNode(name);
  if (!scene.staleBecause.empty())
    throw usageError("the node has nothing to show after " + scene.staleBecause,
                     "reset() of the simulation, which goes back to time 0")
        .inNode(name);
  return node;
}

namespace {

/// The particles on the host, for sums at points.
class HostParticles {
 public:
  explicit HostParticles(const weir::Particles& particles)
      : set_(particles.set()), count_(set_.refreshCount()), positions_(hostCopy<Vec3f>("position")) {
    const MaterialField& volume = particles.material.volume;
    volumes_ = volume.byParticle() ? hostCopy<float>(volume.attribute) : std::vector{volume.value};
    sums_.emplace(positions_, volumes_, particles.material.spacing);
  }

  const PointSums& sums() const { return *sums_; }
  template <class T>
  std::vector<T> hostCopy(const std::string& attribute) const {
    std::vector<T> values(static_cast<std::size_t>(count_));
    const ArrayView<const T> view = std::as_const(set_).template get<T>(attribute).read();
    if (count_ > 0) set_.device().download(values.data(), view.data, values.size() * sizeof(T));
    return values;
  }

 private:
  ParticleSet& set_;
  std::int64_t count_;
  std::vector<Vec3f> positions_;
  std::vector<float> volumes_;
  std::optional<PointSums> sums_;
};

/// The particles whose surface a node makes, if it is such a node.
const weir::Particles* particlesBelow(const Node& node) {
  for (const InputPort* input : node.inputs())
    if (input->typeName() == weir::Particles::kPortType && !input->links().empty())
      return &*static_cast<const Output<weir::Particles>&>(*input->links().front());
  return nullptr;
}

nb::dict meshOf(const Node& node, const DynamicMesh& mesh) {
  nb::dict all;
  std::vector<Vec3f> vertices = mesh.vertices.toHost();
  if (const weir::Particles* fluid = particlesBelow(node); fluid != nullptr && fluid->exist()) {
    const HostParticles particles(*fluid);
    all["velocities"] =
        toNumpy(particles.sums().mean<Vec3f>(vertices, particles.hostCopy<Vec3f>("velocity")));
  }
  all["vertices"] = toNumpy(std::move(vertices));
  all["normals"] = toNumpy(mesh.normals.toHost());
  all["faces"] = toNumpy(mesh.triangles.toHost());
  return all;
}

nb::dict meshOf(const TriangleMesh& mesh) {
  nb::dict all;
  all["vertices"] = toNumpy(mesh.vertices);
  all["faces"] = toNumpy(mesh.triangles);
  return all;
}

nb::dict batchOf(const ParticleBatch& batch) {
  nb::dict all, attributes;
  const std::int64_t count = batch.count;
  all["positions"] = toNumpy(count > 0 ? batch.positions.toHost(count) : std::vector<Vec3f>());
  const bool each = batch.velocities.size() > 0 && count > 0;
  all["velocities"] = toNumpy(each ? batch.velocities.toHost(count)
                                   : std::vector<Vec3f>(static_cast<std::size_t>(count), batch.velocity));
  for (const BatchAttribute& attribute : batch.attributes)
    attributes[attribute.info.name.c_str()] = std::visit(
        [&]<class T>(const Array<T>& values) {
          return toNumpy(count > 0 ? values.toHost(count) : std::vector<T>());
        },
        attribute.values);
  all["attributes"] = attributes;
  return all;
}

nb::dict forcesOf(const SolidForces& forces) {
  nb::dict all, solids;
  for (const SolidForces::OfSolid& of : forces.solids)
    solids[of.solid.c_str()] = nb::make_tuple(nb::make_tuple(of.force.x, of.force.y, of.force.z),
                                              nb::make_tuple(of.torque.x, of.torque.y, of.torque.z));
  all["solids"] = solids;
  return all;
}

template <class T>
const T* valueOf(const OutputPort& output) {
  return output.typeName() == T::kPortType ? &*static_cast<const Output<T>&>(output) : nullptr;
}

}  // namespace

nb::dict outputOf(const PythonScene& scene, const std::string& name, const std::string& outputName) {
  const Node& node = readyNode(scene, name);
  const OutputPort* output = node.findOutput(outputName);
  WEIR_CHECK(output != nullptr);
  if (const auto* mesh = valueOf<DynamicMesh>(*output)) return meshOf(node, *mesh);
  if (const auto* mesh = valueOf<TriangleMesh>(*output)) return meshOf(*mesh);
  if (const auto* batch = valueOf<ParticleBatch>(*output)) return batchOf(*batch);
  if (const auto* forces = valueOf<SolidForces>(*output)) return forcesOf(*forces);
  throw usageError(
      "an output of the type " + output->typeName() + " has no value in Python",
      "outputs of the types TriangleMesh, DynamicMesh, Particles, ParticleBatch, SolidForces and Boundary")
      .inNode(name);
}

nb::object reportOf(const PythonScene& scene, const std::string& name) {
  Node& node = readyNode(scene, name);
  NodeReport report;
  node.report(report);
  return toPython(report.statistics, false);
}

nb::tuple poseOf(const PythonScene& scene, const std::string& name, std::optional<double> time) {
  const auto* motion = dynamic_cast<const RigidMotion*>(&readyNode(scene, name));
  if (motion == nullptr)
    throw usageError("the node moves nothing", "a node that moves solids, such as SemiAnalyticalSFI")
        .inNode(name);
  if (time && !(*time >= 0)) throw usageError("found a time of " + Value(*time).brief() + " s", "at least 0");
  const Pose pose = motion->poseAt(time.value_or(scene.simulation()->time()));
  const auto& [q, t] = pose;
  return nb::make_tuple(nb::make_tuple(q.w, q.x, q.y, q.z), nb::make_tuple(t.x, t.y, t.z));
}

namespace {

RigidBody& readyBody(const PythonScene& scene, const std::string& name) {
  auto* const body = dynamic_cast<RigidBody*>(&readyNode(scene, name));
  if (body == nullptr) throw usageError("the node is no body", "a RigidBody").inNode(name);
  return *body;
}

Vec3d vectorOf(const std::array<double, 3>& numbers) {
  return {numbers[0], numbers[1], numbers[2]};
}

}  // namespace

nb::tuple motionOf(const PythonScene& scene, const std::string& name) {
  const RigidBody& body = readyBody(scene, name);
  const auto [v, w] = twistOf(body.massOf(), body.state());
  return nb::make_tuple(nb::make_tuple(v.x, v.y, v.z), nb::make_tuple(w.x, w.y, w.z));
}

void placeBody(const PythonScene& scene, const std::string& name, const std::array<double, 4>& rotation,
               const std::array<double, 3>& translation, const std::array<double, 3>& velocity,
               const std::array<double, 3>& angularVelocity) {
  const auto& [w, x, y, z] = rotation;
  readyBody(scene, name)
      .placeMesh({w, x, y, z}, vectorOf(translation), {vectorOf(velocity), vectorOf(angularVelocity)});
}

nb::object sampled(const PythonScene& scene, const std::string& name, const std::string& attribute,
                   nb::handle at) {
  ParticleSet& set = scene.particles(name);
  const auto points = fromNumpy<Vec3f>(at);
  const weir::Particles* particles = nullptr;
  for (const OutputPort* output : scene.node(name).outputs())
    if (particles == nullptr) particles = valueOf<weir::Particles>(*output);
  const HostParticles host(*particles);
  if (attribute.empty()) return toNumpy(host.sums().filled(points));
  const AttributeInfo* info = set.find(attribute);
  std::vector<std::string> names;
  for (const AttributeInfo& each : set.attributes())
    if (each.type == AttributeType::kFloat || each.type == AttributeType::kVec3) names.push_back(each.name);
  if (info != nullptr && info->type == AttributeType::kFloat)
    return toNumpy(host.sums().mean<float>(points, host.hostCopy<float>(attribute)));
  if (info != nullptr && info->type == AttributeType::kVec3)
    return toNumpy(host.sums().mean<Vec3f>(points, host.hostCopy<Vec3f>(attribute)));
  throw usageError(info == nullptr ? "there is no particle attribute " + inQuotes(attribute)
                                   : "the attribute " + inQuotes(attribute) + " is of the type " +
                                         std::string(nameOf(info->type)) + ", which has no mean",
                   joinNames(names), info == nullptr ? didYouMean(attribute, names) : "")
      .inNode(name);
}

}  // namespace weir::python
