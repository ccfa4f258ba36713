"""What nodes have made, as arrays. All are copies, which stay as they are when the simulation goes on."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from . import _core
from ._arrays import floats


@dataclass(frozen=True, eq=False)
class Mesh:
    """A triangle mesh: the surface of a fluid, or of a solid as it stands at time 0."""

    vertices: Any
    """(n, 3) float32, m."""
    faces: Any
    """(m, 3) int32: indices of vertices, counter-clockwise seen from outside."""
    normals: Any = None
    """(n, 3) float32, of length 1, outwards; of a fluid's surface."""
    velocities: Any = None
    """(n, 3) float32, m/s, of the fluid at the vertices; of a fluid's surface. NaN where no particle is near."""

    def to_pyvista(self) -> Any:
        """A pyvista.PolyData of it."""
        from ._pyvista import surface

        return surface(self)

    def __repr__(self) -> str:
        return f"<Mesh of {len(self.vertices)} vertices and {len(self.faces)} faces>"


@dataclass(frozen=True, eq=False)
class ParticleArrays:
    """Particles on their way into a fluid."""

    positions: Any
    """(n, 3) float32, m."""
    velocities: Any
    """(n, 3) float32, m/s."""
    attributes: dict[str, Any] = field(default_factory=dict)
    """What else they bring with them, by name."""

    def __len__(self) -> int:
        return len(self.positions)


@dataclass(frozen=True, eq=False)
class SolidForce:
    """What fluids do to a solid: means since the frame before."""

    force: Any
    """(3,) float64, N."""
    torque: Any
    """(3,) float64, N m, about the moved pivot."""


@dataclass(frozen=True, eq=False)
class Pose:
    """Where a solid is: x = R x_rest + translation."""

    rotation: Any
    """(4,) float64: the quaternion w, x, y, z of R."""
    translation: Any
    """(3,) float64, m."""

    @property
    def matrix(self) -> Any:
        """(4, 4) float64, for points with a 1 behind them."""
        import numpy

        w, x, y, z = self.rotation
        made = numpy.eye(4)
        made[:3, :3] = [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]
        made[:3, 3] = self.translation
        return made

    def apply(self, points: Any) -> Any:
        """Where points at rest, (n, 3), are."""
        matrix = self.matrix
        return points @ matrix[:3, :3].T + matrix[:3, 3]


@dataclass(frozen=True, eq=False)
class BodyMotion:
    """How a body moves."""

    velocity: Any
    """(3,) float64, m/s, of its centre of mass."""
    angular_velocity: Any
    """(3,) float64, rad/s."""


class Walls:
    """Solids that a fluid may not enter: those of a StaticBoundary and what it includes."""

    def __init__(self, core: _core.Walls):
        self._core = core

    def distances(self, points: Any) -> Any:
        """(n,) float32, m: from points (n, 3) to the nearest solid, negative in it."""
        return self._query(points)[0]

    def normals(self, points: Any) -> Any:
        """(n, 3) float32, of length 1: out of the solid that is nearest to the points (n, 3)."""
        return self._query(points)[1]

    def _query(self, points: Any) -> tuple[Any, Any]:
        return self._core.query(floats(points, "points", (None, 3), allowed="(n, 3)"))


def as_result(kind: str, held: dict[str, Any]) -> Any:
    """What an output of a type holds."""
    import numpy

    if kind == "ParticleBatch":
        return ParticleArrays(**held)
    if kind == "SolidForces":
        return {solid: SolidForce(*map(numpy.array, pair)) for solid, pair in held["solids"].items()}
    return Mesh(**held)


def as_motion(velocity: tuple, angular_velocity: tuple) -> BodyMotion:
    import numpy

    return BodyMotion(numpy.array(velocity, numpy.float64), numpy.array(angular_velocity, numpy.float64))


def as_pose(rotation: tuple, translation: tuple) -> Pose:
    import numpy

    return Pose(numpy.array(rotation, numpy.float64), numpy.array(translation, numpy.float64))
