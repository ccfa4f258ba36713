// What nodes have made and measured, as arrays and numbers of Python. All are copies, which stay as they are.
#pragma once

#include <nanobind/nanobind.h>

#include <array>
#include <optional>
#include <string>

#include "python/src/python_scene.h"

namespace weir::python {

namespace nb = nanobind;

/// A node of an open simulation, which has been reset. Throws a usage Error for others.
Node& readyNode(const PythonScene& scene, const std::string& name);

/// What an output holds, as a dict: of a mesh `vertices`, `faces`, `normals` and `velocities` (the latter two
/// only of a fluid's surface), of particles on their way into a fluid `positions`, `velocities` and
/// `attributes`, of forces on solids `solids`. Throws a usage Error where there is no open simulation, and
/// for an output of another type.
nb::dict outputOf(const PythonScene& scene, const std::string& node, const std::string& output);

/// The numbers that the node adds to a run's statistics.
nb::object reportOf(const PythonScene& scene, const std::string& node);

/// Where the solids of a node are: the quaternion w, x, y, z, and the place of the origin in m, at `time` in
/// s or, without it, at the present time. Throws a usage Error if it moves nothing.
nb::tuple poseOf(const PythonScene& scene, const std::string& node, std::optional<double> time);

/// The velocity of a body's centre of mass, m/s, and its angular velocity, rad/s, as they are now. Throws a
/// usage Error if the node is no body.
nb::tuple motionOf(const PythonScene& scene, const std::string& node);

/// Puts a body's mesh there: the quaternion w, x, y, z, the place of its origin in m, and the velocities of
/// motionOf(). Throws a usage Error if the node is no body, or for what RigidBody::placeMesh refuses.
void placeBody(const PythonScene& scene, const std::string& node, const std::array<double, 4>& rotation,
               const std::array<double, 3>& translation, const std::array<double, 3>& velocity,
               const std::array<double, 3>& angularVelocity);

/// An attribute of the particles at points in space, (n, 3) float32, as `Gauge` finds it (point_sums.h); with
/// the name "", the share of space that is filled. NaN where no particle is near.
nb::object sampled(const PythonScene& scene, const std::string& node, const std::string& attribute,
                   nb::handle points);

}  // namespace weir::python
