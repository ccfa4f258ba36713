#include "apps/studio/session/frame_packet.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "apps/studio/session/on_host.h"
#include "framework/graph/outputs_of.h"
#include "nodes/geometry/triangle_mesh.h"
#include "nodes/particle_fluid/particle_fluid.h"
#include "nodes/solids/motion_of.h"

namespace weir::studio {

namespace {

// The simulation waits while a frame is made, so nothing is copied twice.

/// An attribute as numbers, vectors by their length; nothing if there is none of that name.
std::optional<std::vector<float>> numbersOf(const ParticleSet& particles, const std::string& name,
                                            std::int64_t count) {
  const bool speed = name == "speed" && particles.find(name) == nullptr;
  const AttributeInfo* info = particles.find(speed ? "velocity" : name);
  if (info == nullptr) return std::nullopt;
  if (info->type == AttributeType::kFloat) return onHost(particles.get<float>(info->name), count);
  std::vector<float> numbers;
  numbers.reserve(static_cast<std::size_t>(count));
  if (info->type == AttributeType::kVec3)
    for (const Vec3f& v : onHost(particles.get<Vec3f>(info->name), count)) numbers.push_back(length(v));
  else
    for (const int i : onHost(particles.get<int>(info->name), count))
      numbers.push_back(static_cast<float>(i));
  return numbers;
}

/// Which particles are sent; nothing stands for all. Else those with every n-th id, so that the same ones are
/// seen in every frame.
using Selection = std::optional<std::vector<std::size_t>>;

Selection chosen(const std::vector<int>& ids, std::int64_t most) {
  const auto total = static_cast<std::int64_t>(ids.size());
  const std::int64_t every = std::max<std::int64_t>(1, (total + most - 1) / std::max<std::int64_t>(most, 1));
  if (every == 1) return std::nullopt;
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < ids.size(); ++i)
    if (ids[i] % every == 0) indices.push_back(i);
  return indices;
}

template <class T>
std::vector<T> select(std::vector<T> all, const Selection& selection) {
  if (!selection) return all;
  std::vector<T> some;
  some.reserve(selection->size());
  for (const std::size_t i : *selection) some.push_back(all[i]);
  return some;
}

Value vectorValue(const Vec3f& v) {
  return Value(Value::Array{v.x, v.y, v.z});
}

Value poseValue(const Pose& pose) {
  const Vec3f& p = pose.translation;
  const Quatf& q = pose.rotation;
  return Value(Value::Array{p.x, p.y, p.z, q.x, q.y, q.z, q.w});
}

Value fluidHeader(const std::string& node, const Fluid& fluid, const FrameView& view, PacketWriter& writer) {
  const ParticleSet& particles = *fluid.particles;
  const std::int64_t count = fluid.particles->refreshCount();
  std::vector<int> ids = onHost(particles.ids(), count);
  const Selection selection = chosen(ids, view.most);
  const std::vector<int> sent = select(std::move(ids), selection);
  const QuantizedPoints points =
      quantize(std::span<const Vec3f>(select(onHost(particles.positions(), count), selection)));
  Value v = Value::object();
  v["node"] = node;
  v["total"] = count;
  v["count"] = static_cast<std::int64_t>(sent.size());
  v["spacing"] = fluid.constants->spacing;
  v["low"] = vectorValue(points.low);
  v["high"] = vectorValue(points.high);
  v["positions"] = writer.add(std::span<const std::uint16_t>(points.values));
  v["ids"] = writer.add(std::span<const int>(sent));
  Value names = Value(Value::Array{"speed"});
  for (const AttributeInfo& info : particles.attributes()) names.push(info.name);
  v["attributes"] = std::move(names);
  if (auto numbers = numbersOf(particles, view.attribute, count)) {
    const Quantized values = quantize(std::span<const float>(select(std::move(*numbers), selection)));
    const AttributeInfo* info = particles.find(view.attribute);
    Value a = Value::object();
    a["name"] = view.attribute;
    a["unit"] = info != nullptr ? info->unit : "m/s";
    a["low"] = values.low;
    a["high"] = values.high;
    a["values"] = writer.add(std::span<const std::uint16_t>(values.values));
    v["attribute"] = std::move(a);
  }
  return v;
}

}  // namespace

Packet framePacket(const Simulation& simulation, const FrameView& view) {
  PacketWriter writer;
  Value header = Value::object();
  header["kind"] = "frame";
  header["frame"] = simulation.frame();
  header["time"] = simulation.time();
  Value fluids = Value::array(), poses = Value::object();
  for (const auto& [node, output] : outputsOf<Fluid>(simulation.scene().graph))
    fluids.push(fluidHeader(node, **output, view, writer));
  for (const auto& [node, output] : outputsOf<TriangleMesh>(simulation.scene().graph))
    if (const RigidMotion* motion = motionOf(*output))
      poses[node] = poseValue(motion->poseAt(simulation.time()));
  header["fluids"] = std::move(fluids);
  header["poses"] = std::move(poses);
  return writer.finish(header);
}

Packet geometryPacket(const Simulation& simulation) {
  PacketWriter writer;
  Value header = Value::object();
  header["kind"] = "geometry";
  Value meshes = Value::array();
  for (const auto& [node, output] : outputsOf<TriangleMesh>(simulation.scene().graph)) {
    const TriangleMesh& mesh = **output;
    Value v = Value::object();
    v["node"] = node;
    v["vertexCount"] = static_cast<std::int64_t>(mesh.vertices.size());
    v["triangleCount"] = static_cast<std::int64_t>(mesh.triangles.size());
    v["vertices"] = writer.add(std::span<const Vec3f>(mesh.vertices));
    v["triangles"] = writer.add(std::span<const Vec3i>(mesh.triangles));
    meshes.push(std::move(v));
  }
  header["meshes"] = std::move(meshes);
  return writer.finish(header);
}

}  // namespace weir::studio
