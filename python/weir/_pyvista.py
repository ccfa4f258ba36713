"""Particles and surfaces for PyVista, which is imported when it is asked for."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from . import _core
from ._optional import imported

if TYPE_CHECKING:
    from ._scene import Scene


def surface(mesh: Any, pose: Any = None) -> Any:
    """A mesh, moved to where a pose has it."""
    import numpy

    corners = numpy.full((len(mesh.faces), 1), 3, mesh.faces.dtype)
    vertices = mesh.vertices if pose is None else pose.apply(mesh.vertices).astype(numpy.float32)
    made = imported("pyvista", "PyVista").PolyData(vertices, numpy.hstack([corners, mesh.faces]).ravel())
    for name, values in (("Normals", mesh.normals), ("velocity", mesh.velocities)):
        if values is not None:
            made.point_data[name] = values
    return made


def points(particles: _core.Particles) -> Any:
    """Particles with all their attributes."""
    import numpy

    def copy_of(name: str) -> Any:
        values = particles[name]
        host = values.numpy() if isinstance(values, _core.DeviceArray) else numpy.array(values)
        return host.reshape(len(host), -1) if host.ndim > 1 else host

    made = imported("pyvista", "PyVista").PolyData(copy_of("position"))
    for name in particles:
        if name != "position":
            made.point_data[name] = copy_of(name)
    return made


def blocks(scene: Scene) -> Any:
    """One block for each node that has particles or a mesh, by its name."""
    made = imported("pyvista", "PyVista").MultiBlock()
    movers = {}
    for link in scene.links:
        output, input = link.split(" -> ")
        if hasattr(node := scene[input.split(".")[0]], "pose"):
            movers.setdefault(output, node)
    for name, node in scene.nodes.items():
        for port in node._outputs():
            if port.type == "Particles":
                made[name] = points(port.value)
            elif port.type == "DynamicMesh":
                made[name] = surface(port.value)
            elif port.type == "TriangleMesh":
                mover = movers.get(port.path)
                made[name] = surface(port.value, mover.pose() if mover else None)
    return made
