#include "python/src/particles.h"

#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "framework/base/text.h"
#include "framework/neighbors/neighbor_rows.h"
#include "nodes/particle_fluid/particle_fluid.h"
#include "python/src/stream_order.h"
#include "python/src/values.h"

namespace weir::python {

namespace {

nb::capsule ownerOf(const LentMemory& lent) {
  return {new LentMemory(lent), [](void* held) noexcept { delete static_cast<LentMemory*>(held); }};
}

template <class T>
nb::object numpyArray(const LentMemory& lent, T* data, const std::vector<std::size_t>& shape) {
  return nb::cast(nb::ndarray<nb::numpy, T>(data, shape.size(), shape.data(), ownerOf(lent)));
}

template <class Number>
DeviceArray::Numbers numbersOf() {
  if constexpr (std::is_same_v<Number, float>)
    return {"float32", "<f4", sizeof(Number)};
  else if constexpr (std::is_same_v<Number, std::int64_t>)
    return {"int64", "<i8", sizeof(Number)};
  else
    return {"int32", "<i4", sizeof(Number)};
}

nb::dlpack::dtype typeOf(const DeviceArray::Numbers& numbers) {
  const std::string_view name = numbers.name;
  if (name == "int64") return nb::dtype<std::int64_t>();
  return name == "int32" ? nb::dtype<std::int32_t>() : nb::dtype<float>();
}

/// A view of the first `count` elements.
template <class T>
nb::object viewOf(const LentMemory& lent, T* elements, std::size_t count) {
  using Number = typename AttributeTraits<T>::Number;
  std::vector<std::size_t> shape{count};
  if (std::is_same_v<T, Mat3f>) shape.insert(shape.end(), {3, 3});
  if (std::is_same_v<T, Vec3f>) shape.push_back(3);
  auto* data = reinterpret_cast<Number*>(elements);
  if (lent.device->kind() == DeviceKind::kCpu) return numpyArray<Number>(lent, data, shape);
  letStreamWait(*lent.device, kLegacyStream);
  return nb::cast(DeviceArray(lent, data, std::move(shape), numbersOf<Number>()));
}

AttributeType typeNamed(const std::string& name) {
  if (const std::optional<AttributeType> type = attributeTypeNamed(name)) return *type;
  const std::vector<std::string> names = attributeTypeNames();
  throw usageError("found " + inQuotes(name) + " as the type of an attribute", joinNames(names),
                   didYouMean(name, names));
}

}  // namespace

std::size_t DeviceArray::bytes() const {
  std::size_t elements = 1;
  for (const std::size_t extent : shape_) elements *= extent;
  return numbers_.bytes * elements;
}

nb::dict DeviceArray::cudaArrayInterface() const {
  nb::list shape;
  for (const std::size_t extent : shape_) shape.append(extent);
  nb::dict interface;
  interface["shape"] = nb::tuple(shape);
  interface["typestr"] = numbers_.typeCode;
  interface["data"] = nb::make_tuple(reinterpret_cast<std::uintptr_t>(data_), false);
  interface["strides"] = nb::none();
  interface["version"] = 3;
  interface["stream"] = streamOf(*lent_.device);
  return interface;
}

nb::tuple DeviceArray::dlpackDevice() const {
  const auto& cuda = static_cast<const CudaDevice&>(*lent_.device);
  return nb::make_tuple(int(nb::device::cuda::value), cuda.index());
}

nb::object DeviceArray::dlpack(nb::object stream, nb::kwargs options) const {
  if (options.contains("copy") && nb::cast<bool>(nb::bool_(options["copy"])))
    throw nb::buffer_error("the array is shared, not copied: copy it on your side");
  const auto& cuda = static_cast<const CudaDevice&>(*lent_.device);
  const auto number = stream.is_none() ? std::int64_t(kLegacyStream) : nb::cast<std::int64_t>(stream);
  if (number != -1) letStreamWait(cuda, static_cast<std::uintptr_t>(number));
  const nb::ndarray<> array(data_, shape_.size(), shape_.data(), ownerOf(lent_), nullptr, typeOf(numbers_),
                            nb::device::cuda::value, cuda.index());
  // Without a framework it becomes a capsule, of the version that every reader knows.
  return nb::cast(array);
}

nb::object DeviceArray::toHost() const {
  nb::object array = nb::module_::import_("numpy").attr("empty")(nb::cast(shape_), numbers_.name);
  void* to = nb::cast<nb::ndarray<nb::c_contig>>(array).data();
  if (bytes() > 0) {
    waitForStream(*lent_.device, kLegacyStream);
    lent_.device->download(to, data_, bytes());
  }
  return array;
}

void DeviceArray::assign(nb::handle values) {
  const nb::module_ numpy = nb::module_::import_("numpy");
  const nb::object wide = numpy.attr("broadcast_to")(values, nb::cast(shape_));
  const nb::object array = numpy.attr("ascontiguousarray")(wide, numbers_.name);
  if (bytes() == 0) return;
  waitForStream(*lent_.device, kLegacyStream);
  lent_.device->upload(data_, nb::cast<nb::ndarray<nb::c_contig, nb::ro>>(array).data(), bytes());
  lent_.device->synchronize();  // as the array goes
}

std::int64_t Particles::count() const {
  return set().refreshCount();
}

std::vector<std::string> Particles::names() const {
  std::vector<std::string> names;
  for (const AttributeInfo& info : set().attributes()) names.push_back(info.name);
  return names;
}

nb::object Particles::array(const std::string& name) const {
  ParticleSet& particles = set();
  const AttributeInfo* info = particles.find(name);
  if (info == nullptr)
    throw usageError("there is no particle attribute " + inQuotes(name), joinNames(names()),
                     didYouMean(name, names()))
        .inNode(node_);
  const auto count = static_cast<std::size_t>(particles.refreshCount());
  nb::object result;
  withAttributeType(info->type, [&]<class T>(std::type_identity<T>) {
    const std::shared_ptr<Device>& device = scene_->device();
    const ArrayView<T> elements = particles.get<T>(name).write();
    result =
        viewOf({device, elements.size == 0 ? nullptr : device->lend(elements.data)}, elements.data, count);
  });
  return result;
}

void Particles::assign(const std::string& name, nb::handle values) const {
  const nb::object array = this->array(name);
  if (nb::isinstance<DeviceArray>(array)) {
    nb::cast<DeviceArray&>(array).assign(values);
  } else {
    array[nb::ellipsis()] = values;
  }
}

nb::object Particles::add(const std::string& name, const std::string& type, const std::string& unit,
                          const std::string& doc) const {
  if (!isName(name))
    throw usageError(inQuotes(name) + " is not a valid name for an attribute",
                     "letters, digits, '_' and '-', starting with a letter");
  const AttributeInfo info{name, typeNamed(type), unit, doc};
  ParticleSet& particles = set();
  withAttributeType(info.type, [&]<class T>(std::type_identity<T>) { particles.add<T>(info); });
  return array(name);
}

nb::dict Particles::describe() const {
  nb::dict all;
  for (const AttributeInfo& info : set().attributes()) {
    nb::dict one;
    one["type"] = std::string(nameOf(info.type));
    one["unit"] = info.unit;
    one["doc"] = info.doc;
    one["derived"] = info.derived;
    all[info.name.c_str()] = one;
  }
  return all;
}

nb::tuple Particles::neighbors() const {
  const auto* fluid = dynamic_cast<const ParticleFluid*>(&scene_->node(node_));
  if (fluid == nullptr)
    throw usageError("the particles have no lists of neighbours", "those of a ParticleFluid").inNode(node_);
  if (set().haloCount() > 0)
    throw usageError("neighbours of particles in a periodic domain may be images, which have no index",
                     "a fluid with \"periodic\": \"none\"")
        .inNode(node_);
  const std::int64_t particles = set().refreshCount();
  const NeighborList* lists = fluid->neighbors();
  const auto& running = scene_->running;
  const bool tooEarly = running && running->node == node_ && !running->knowsNeighbors;
  if (tooEarly || lists == nullptr || lists->counts().size < particles)
    throw usageError("the neighbours of this step are not known yet",
                     "the method step of a module that stands after the search, as one that is inserted "
                     "with after=\"neighbors\"")
        .inNode(node_);
  const std::shared_ptr<Device>& device = scene_->device();
  const auto rows = std::make_shared<NeighborRows>(rowsOf(*device, *lists, particles));
  const auto view = [&](Array<int>& numbers) {
    return viewOf({device, rows}, numbers.data(), static_cast<std::size_t>(numbers.size()));
  };
  return nb::make_tuple(view(rows->offsets), view(rows->indices));
}

namespace {

constexpr const char* kParticlesDoc = R"(The particles of a fluid, with their attributes as arrays.

`particles["velocity"]` is a NumPy array on the CPU and a DeviceArray on CUDA. It shares memory with the
simulation: what is written into it, the simulation goes on with. An array is valid until the simulation makes
its next step, which sorts the particles and may move them to other memory: ask for it again after each step.
An older array can still be read and written without harm, but what stands in it means nothing.)";

constexpr const char* kNeighborsDoc =
    R"(The neighbours of all particles as two arrays of int32, offsets and indices: those of particle i are
indices[offsets[i]:offsets[i + 1]], without i itself.

They are those of the last search, nearer than the support radius at the positions that it saw: in a step, the
predicted ones. The arrays are copies of the lists, made at each call and in the device's memory.)";

constexpr const char* kDeviceArrayDoc =
    R"(Numbers of particles in the memory of a GPU, shared with the simulation.

PyTorch, CuPy, JAX and Numba use it in place: `torch.from_dlpack(array)`, `cupy.asarray(array)`,
`jax.dlpack.from_dlpack(array)`, `numba.cuda.as_cuda_array(array)`. It is valid until the next step.)";

}  // namespace

void bindParticles(nb::module_& m) {
  nb::class_<DeviceArray>(m, "DeviceArray", kDeviceArrayDoc)
      .def_prop_ro(
          "shape", [](const DeviceArray& a) { return nb::tuple(nb::cast(a.shape())); },
          nb::sig("def shape(self) -> tuple[int, ...]"), "Extents: (particles,) or (particles, 3).")
      .def_prop_ro("dtype", &DeviceArray::dtype, nb::sig("def dtype(self) -> str"),
                   "\"float32\", \"int32\" or \"int64\".")
      .def("__len__", [](const DeviceArray& a) { return a.shape()[0]; })
      .def_prop_ro("__cuda_array_interface__", &DeviceArray::cudaArrayInterface)
      .def("__dlpack__", &DeviceArray::dlpack, nb::kw_only(), nb::arg("stream") = nb::none(),
           nb::arg("options"),
           nb::sig("def __dlpack__(self, *, stream: int | None = None, **options) -> typing.Any"))
      .def("__dlpack_device__", &DeviceArray::dlpackDevice,
           nb::sig("def __dlpack_device__(self) -> tuple[int, int]"))
      .def("numpy", &DeviceArray::toHost, nb::sig("def numpy(self) -> numpy.ndarray"), "A copy on the host.")
      .def("assign", &DeviceArray::assign, nb::arg("values"),
           "Write values from the host, of the same shape or one that can be repeated to it.");
  nb::class_<Particles>(m, "Particles", kParticlesDoc)
      .def("__len__", &Particles::count)
      .def("__getitem__", &Particles::array, nb::arg("name"),
           nb::sig("def __getitem__(self, name: str) -> numpy.ndarray | DeviceArray"))
      .def("__setitem__", &Particles::assign, nb::arg("name"), nb::arg("values"))
      .def("__contains__",
           [](const Particles& p, const std::string& name) { return p.describe().contains(name.c_str()); })
      .def("__iter__", [](const Particles& p) { return nb::iter(nb::cast(p.names())); })
      .def("keys", &Particles::names, "Names of the attributes.")
      .def("describe", &Particles::describe, nb::sig("def describe(self) -> dict[str, dict]"),
           "Type, unit and doc of each attribute; a derived one is up to date at frames.")
      .def("add", &Particles::add, nb::arg("name"), nb::arg("type") = "float", nb::arg("unit") = "",
           nb::arg("doc") = "",
           nb::sig("def add(self, name: str, type: str = 'float', unit: str = '', doc: str = '') "
                   "-> numpy.ndarray | DeviceArray"),
           "Give every particle another attribute, 0 at first and at birth: a float, vec3, int, mat3 or "
           "int64. It is sorted and exported like the others. One that is there already is found. A reset "
           "forgets it.")
      .def("neighbors", &Particles::neighbors, kNeighborsDoc,
           nb::sig("def neighbors(self) -> tuple[numpy.ndarray | DeviceArray, numpy.ndarray | DeviceArray]"))
      .def_prop_ro("count", &Particles::count, "How many particles there are.")
      .def_prop_rw(
          "positions", [](const Particles& p) { return p.array("position"); },
          [](const Particles& p, nb::handle values) { p.assign("position", values); },
          nb::for_getter(nb::sig("def positions(self) -> numpy.ndarray | DeviceArray")),
          "Positions, m: (n, 3).")
      .def_prop_rw(
          "velocities", [](const Particles& p) { return p.array("velocity"); },
          [](const Particles& p, nb::handle values) { p.assign("velocity", values); },
          nb::for_getter(nb::sig("def velocities(self) -> numpy.ndarray | DeviceArray")),
          "Velocities, m/s: (n, 3).")
      .def_prop_ro(
          "ids", [](const Particles& p) { return p.array("id"); },
          nb::sig("def ids(self) -> numpy.ndarray | DeviceArray"),
          "A number of 64 bits that stays with each particle: (n,).");
}

}  // namespace weir::python
