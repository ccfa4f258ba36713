// The particles of a fluid as arrays of Python: NumPy's on the CPU, DeviceArray on CUDA.
#pragma once

#include <nanobind/nanobind.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "framework/particles/particle_set.h"
#include "python/src/python_scene.h"

namespace weir::python {

namespace nb = nanobind;

/// What arrays keep alive: first the memory goes, then the device.
struct LentMemory {
  std::shared_ptr<Device> device;
  std::shared_ptr<void> memory;
};

/// Memory on a CUDA device, for libraries that know __cuda_array_interface__ or DLPack.
class DeviceArray {
 public:
  DeviceArray(LentMemory lent, void* data, std::vector<std::size_t> shape, bool isInt)
      : lent_(std::move(lent)), data_(data), shape_(std::move(shape)), isInt_(isInt) {}

  const std::vector<std::size_t>& shape() const { return shape_; }
  nb::dict cudaArrayInterface() const;
  nb::tuple dlpackDevice() const;
  /// `stream` is where the caller will use it: None, or as DLPack numbers streams.
  nb::object dlpack(nb::object stream, nb::kwargs options) const;
  nb::object toHost() const;
  void assign(nb::handle values);
  bool isInt() const { return isInt_; }

 private:
  std::size_t bytes() const;

  LentMemory lent_;
  void* data_;
  std::vector<std::size_t> shape_;
  bool isInt_;  // else float; both have 4 bytes
};

/// Everything that Python knows of a fluid's particles.
class Particles {
 public:
  Particles(std::shared_ptr<PythonScene> scene, std::string node)
      : scene_(std::move(scene)), node_(std::move(node)) {}

  std::int64_t count() const;
  std::vector<std::string> names() const;
  /// The present values, without copying. Throws a usage Error for an unknown name.
  nb::object array(const std::string& name) const;
  /// Writes them, from anything that has the same shape or can be repeated to it.
  void assign(const std::string& name, nb::handle values) const;
  nb::object add(const std::string& name, const std::string& type, const std::string& unit,
                 const std::string& doc) const;
  nb::dict describe() const;
  /// Offsets and indices of the neighbours of a ParticleFluid's particles, see NeighborRows. Throws a usage
  /// Error for other particles, and in a module before the search of its step.
  nb::tuple neighbors() const;

 private:
  ParticleSet& set() const { return scene_->particles(node_); }

  std::shared_ptr<PythonScene> scene_;
  std::string node_;
};

void bindParticles(nb::module_& m);

}  // namespace weir::python
