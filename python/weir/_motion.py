"""Motions from arrays: poses over time for the nodes that move solids."""

from __future__ import annotations

from typing import Any

from ._arrays import array_error, floats, on_host

_MAX_KEYFRAMES = 100_000
_TOLERANCE = 1e-3


def motion(times: Any, positions: Any = None, rotations: Any = None, *, poses: Any = None) -> dict[str, Any]:
    """Poses over time, as parameters of a node that moves solids:

        stirrer.set(**weir.motion(times, positions, rotations))

    `times` (n,) in s increase. `positions` (n, 3) in m move the solids from where they are. `rotations` turn them
    about the node's pivot: (n, 4) quaternions w, x, y, z, (n, 3, 3) matrices, (n, 3) Euler angles in degrees, or a
    Rotation of SciPy. In place of both, `poses` (n, 4, 4) are matrices that map points at rest to where they are, with
    the pivot at the origin. Between two times positions and angles are linear, and of quaternions and matrices it is the
    shortest turn at a constant rate. Before the first time and after the last one all stays as it is there.
    """
    moments = _times(times)
    count = len(moments)
    if poses is not None:
        if positions is not None or rotations is not None:
            raise array_error("poses", "positions or rotations are given, too", "poses alone")
        matrices = floats(poses, "poses", (count, 4, 4), allowed=f"(n, 4, 4) with n = {count}, the number of times")
        if (abs(matrices[:, 3] - (0, 0, 0, 1)) > _TOLERANCE).any():
            raise array_error("poses", "the last row of a matrix is not 0, 0, 0, 1", "turns and displacements")
        positions, rotations = matrices[:, :3, 3], matrices[:, :3, :3]
    if positions is None and rotations is None:
        raise array_error("positions", "found neither positions nor rotations", "positions, rotations, both, or poses")
    given = {}
    if positions is not None:
        allowed = f"(n, 3) with n = {count}, the number of times"
        given["position"] = _keyframes(moments, floats(positions, "positions", (count, 3), allowed=allowed))
    if rotations is not None:
        given["rotation"] = _keyframes(moments, _rotations(rotations, count))
    if poses is not None:
        given["pivot"] = (0, 0, 0)
    return given


def _keyframes(times: Any, values: Any) -> dict[str, list]:
    return {"keyframes": [list(pair) for pair in zip(times.tolist(), values.tolist())]}


def _times(times: Any) -> Any:
    import numpy

    floats(times, "times", (None,), allowed="(n,)")
    moments = numpy.asarray(on_host(times, "times"), numpy.float64)
    if not 1 <= len(moments) <= _MAX_KEYFRAMES:
        raise array_error("times", f"found {len(moments)} times", f"1 to {_MAX_KEYFRAMES}")
    if moments[0] < 0:
        raise array_error("times", f"begins at {moments[0]:g} s", "at least 0")
    late = numpy.diff(moments) <= 0
    if late.any():
        row = int(late.argmax())
        raise array_error("times", f"row {row + 1} is {moments[row + 1]:g}, after {moments[row]:g}", "times that increase")
    return moments


def _rotations(rotations: Any, count: int) -> Any:
    if hasattr(rotations, "as_matrix"):
        rotations = rotations.as_matrix()
    allowed = f"(n, 4) quaternions, (n, 3, 3) matrices or (n, 3) angles in degrees, with n = {count}, the number of times"
    values = floats(rotations, "rotations", (count, 4), (count, 3, 3), (count, 3), allowed=allowed)
    if values.shape[1:] == (3, 3):
        return _quaternions(values)
    if values.shape[1:] == (4,):
        return _unit_quaternions(values)
    return values


def _unit_quaternions(values: Any) -> Any:
    import numpy

    lengths = numpy.linalg.norm(values.astype(numpy.float64), axis=1)
    bad = abs(lengths - 1) > _TOLERANCE
    if bad.any():
        row = int(bad.argmax())
        raise array_error("rotations", f"the quaternion in row {row} has the length {lengths[row]:.4g}", "the length 1")
    return values / lengths[:, None]


def _quaternions(matrices: Any) -> Any:
    """S. W. Shepperd, Quaternion from Rotation Matrix, 1978: the largest of the four numbers first."""
    import numpy

    m = matrices.astype(numpy.float64)
    off = abs(m @ m.transpose(0, 2, 1) - numpy.eye(3)).max(axis=(1, 2)) + abs(numpy.linalg.det(m) - 1)
    if (off > _TOLERANCE).any():
        row = int((off > _TOLERANCE).argmax())
        raise array_error("rotations", f"the matrix in row {row} is no rotation", "orthonormal matrices with determinant 1")
    # Four times the products of w, x, y, z with each other.
    products = numpy.empty((len(m), 4, 4))
    diagonal = m[:, [0, 1, 2], [0, 1, 2]]
    products[:, 0, 0] = 1 + diagonal.sum(axis=1)
    for i in range(3):
        products[:, i + 1, i + 1] = 1 + 2 * diagonal[:, i] - diagonal.sum(axis=1)
        j, k = (i + 1) % 3, (i + 2) % 3
        products[:, 0, i + 1] = products[:, i + 1, 0] = m[:, k, j] - m[:, j, k]
        products[:, j + 1, k + 1] = products[:, k + 1, j + 1] = m[:, k, j] + m[:, j, k]
    largest = products[:, range(4), range(4)].argmax(axis=1)
    rows = products[numpy.arange(len(m)), largest]
    return rows / numpy.linalg.norm(rows, axis=1)[:, None]
