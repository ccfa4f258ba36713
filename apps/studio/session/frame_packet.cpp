#include "apps/studio/session/frame_packet.h"

#include <algorithm>
#include <cstring>
#include <span>
#include <utility>

#include "apps/studio/session/frame_kernels.h"
#include "framework/compute/array.h"
#include "framework/compute/dispatch.h"
#include "framework/compute/host_copy.h"
#include "framework/compute/readback.h"
#include "framework/geometry/triangle_mesh.h"
#include "framework/graph/outputs_of.h"
#include "framework/particles/particles.h"
#include "framework/solids/motion_of.h"

namespace weir::studio {

namespace {

Value vectorValue(const Vec3f& v) {
  return Value(Value::Array{v.x, v.y, v.z});
}

Value poseValue(const Pose& pose) {
  const Vec3f& p = pose.translation;
  const Quatf& q = pose.rotation;
  return Value(Value::Array{p.x, p.y, p.z, q.x, q.y, q.z, q.w});
}

/// That of an empty range is 0 to 0.
Range<float> closed(const Range<float>& range) {
  return range.low <= range.high ? range : Range<float>{};
}

}  // namespace

/// What viewers get of one fluid.
class FrameMaker::FluidFrame {
 public:
  explicit FluidFrame(Device& device)
      : device_(device),
        kept_(device, 1),
        ranges_(device, 1),
        indices_(device),
        ids_(device),
        points_(device),
        values_(device),
        onHost_(device) {}

  Value make(const std::string& node, const Particles& source, const FrameView& view, PacketWriter& writer) {
    ParticleSet& particles = source.set();
    const std::int64_t total = particles.refreshCount();
    const ChosenParticles chosen = choose(particles, total, view.max);
    const bool hasValues = place(particles, view.attribute, chosen);

    onHost_.resize(kIdsAt + chosen.count * (kIdBytes + kPointBytes + kValueBytes));
    const std::int64_t pointsAt = kIdsAt + chosen.count * kIdBytes;
    const std::int64_t valuesAt = pointsAt + chosen.count * kPointBytes;
    start(0, ranges_.data(), 1);
    start(kIdsAt, chosen.indices.data != nullptr ? ids_.data() : particles.ids().read().data(), chosen.count);
    start(pointsAt, points_.data(), chosen.count * kAxes);
    if (hasValues) start(valuesAt, values_.data(), chosen.count);
    const std::span<const char> bytes = onHost_.wait();
    const auto part = [&](std::int64_t at, std::int64_t size) {
      return writer.add(bytes.subspan(static_cast<std::size_t>(at), static_cast<std::size_t>(size)));
    };
    Ranges ranges;
    std::memcpy(&ranges, bytes.data(), sizeof ranges);

    const Range<float> x = closed({ranges.points.low.x, ranges.points.high.x});
    const Range<float> y = closed({ranges.points.low.y, ranges.points.high.y});
    const Range<float> z = closed({ranges.points.low.z, ranges.points.high.z});
    Value v = Value::object();
    v["node"] = node;
    v["total"] = total;
    v["count"] = chosen.count;
    v["spacing"] = source.material.spacing;
    v["low"] = vectorValue({x.low, y.low, z.low});
    v["high"] = vectorValue({x.high, y.high, z.high});
    v["positions"] = part(pointsAt, chosen.count * kPointBytes);
    v["ids"] = part(kIdsAt, chosen.count * kIdBytes);
    Value names = Value(Value::Array{"speed"});
    for (const AttributeInfo& info : particles.attributes()) names.push(info.name);
    v["attributes"] = std::move(names);
    if (!hasValues) return v;
    const Range<float> range = closed(ranges.values);
    const AttributeInfo* info = particles.find(view.attribute);
    Value a = Value::object();
    a["name"] = view.attribute;
    a["unit"] = info != nullptr ? info->unit : "m/s";
    a["low"] = range.low;
    a["high"] = range.high;
    a["values"] = part(valuesAt, chosen.count * kValueBytes);
    v["attribute"] = std::move(a);
    return v;
  }

 private:
  struct Ranges {
    Range<Vec3f> points;
    Range<float> values;
  };
  static constexpr std::int64_t kAxes = 3;
  static constexpr std::int64_t kValueBytes = sizeof(std::uint16_t), kPointBytes = kAxes * kValueBytes,
                                kIdBytes = sizeof(std::int64_t), kIdsAt = sizeof(Ranges);

  /// All, or those with every n-th id, so that the same ones are seen in every frame.
  ChosenParticles choose(const ParticleSet& particles, std::int64_t total, std::int64_t max) {
    const std::int64_t every = std::max<std::int64_t>(1, (total + max - 1) / std::max<std::int64_t>(max, 1));
    if (every == 1) return {.indices = {}, .count = total};
    indices_.resizeDiscarding(total);
    dispatch(device_, [&](auto& device) {
      chooseEvery(device, {particles.ids().read().data(), total}, every, indices_.view(), kept_.data());
    });
    keptCopy_.request(kept_.data());
    const std::int64_t count = keptCopy_.wait();
    return {.indices = std::as_const(indices_).view(), .count = count};
  }

  /// Asks the device for all numbers; whether there are any of this attribute.
  bool place(const ParticleSet& particles, const std::string& attribute, const ChosenParticles& chosen) {
    const bool speed = attribute == "speed" && particles.find(attribute) == nullptr;
    const AttributeInfo* info = particles.find(speed ? "velocity" : attribute);
    Ranges* const ranges = ranges_.data();
    points_.resizeDiscarding(chosen.count * kAxes);
    values_.resizeDiscarding(info != nullptr ? chosen.count : 0);
    dispatch(device_, [&](auto& device) {
      if (chosen.indices.data != nullptr) {
        ids_.resizeDiscarding(chosen.count);
        takeIds(device, particles.ids().read(), chosen, ids_.view());
      }
      boundsOf(device, particles.positions().read(), chosen, &ranges->points);
      quantizePoints(device, particles.positions().read(), chosen, &ranges->points, points_.view());
      if (info == nullptr) return;
      withAttributeType(info->type, [&]<class T>(std::type_identity<T>) {
        const ArrayView<const T> elements = particles.get<T>(info->name).read();
        rangeOf(device, elements, chosen, &ranges->values);
        quantize(device, elements, chosen, &ranges->values, values_.view());
      });
    });
    return info != nullptr;
  }

  template <class T>
  void start(std::int64_t at, const T* from, std::int64_t count) {
    onHost_.start(at, reinterpret_cast<const char*>(from), count * static_cast<std::int64_t>(sizeof(T)));
  }

  Device& device_;
  Array<int> kept_;
  Readback<int> keptCopy_{device_};
  Array<Ranges> ranges_;
  Array<int> indices_;
  Array<std::int64_t> ids_;
  Array<std::uint16_t> points_, values_;
  HostCopy<char> onHost_;  // ranges, ids, points, values
};

FrameMaker::FrameMaker(Device& device) : device_(device) {}

FrameMaker::~FrameMaker() = default;

Packet FrameMaker::make(const Simulation& simulation, const FrameView& view) {
  writer_.clear();
  Value header = Value::object();
  header["kind"] = "frame";
  header["frame"] = simulation.frame();
  header["time"] = simulation.time();
  Value fluids = Value::array(), poses = Value::object();
  for (const auto& [node, output] : outputsOf<Particles>(simulation.scene().graph)) {
    if (!(*output)->exist()) continue;
    std::unique_ptr<FluidFrame>& fluid = fluids_[node];
    if (!fluid) fluid = std::make_unique<FluidFrame>(device_);
    fluids.push(fluid->make(node, **output, view, writer_));
  }
  for (const auto& [_, output] : outputsOf<TriangleMesh>(simulation.scene().graph))
    for (const auto& [name, motion] : movedMeshes(*output))
      if (motion != nullptr) poses[name] = poseValue(motion->poseAt(simulation.time()));
  header["fluids"] = std::move(fluids);
  header["poses"] = std::move(poses);
  return writer_.finish(header);
}

Packet geometryPacket(const Simulation& simulation) {
  PacketWriter writer;
  Value header = Value::object();
  header["kind"] = "geometry";
  Value meshes = Value::array();
  for (const auto& [_, output] : outputsOf<TriangleMesh>(simulation.scene().graph)) {
    const TriangleMesh& mesh = **output;
    const std::int64_t vertices = writer.add(std::span<const Vec3f>(mesh.vertices));
    const std::int64_t triangles = writer.add(std::span<const Vec3i>(mesh.triangles));
    for (const MovedMesh& moved : movedMeshes(*output)) {
      Value v = Value::object();
      v["node"] = moved.name;
      v["vertexCount"] = static_cast<std::int64_t>(mesh.vertices.size());
      v["triangleCount"] = static_cast<std::int64_t>(mesh.triangles.size());
      v["vertices"] = vertices;
      v["triangles"] = triangles;
      meshes.push(std::move(v));
    }
  }
  header["meshes"] = std::move(meshes);
  return writer.finish(header);
}

}  // namespace weir::studio
