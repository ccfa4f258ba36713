"""Arrays that are given to Weir, checked and as the extension takes them: NumPy's, contiguous, of 32 bits."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from . import _core
from ._errors import Error

# What every particle has, and what files of particles call that.
_TAKEN_NAMES = ("position", "velocity", "id", "x", "y", "z", "vx", "vy", "vz")


def array_error(name: str, found: str, allowed: str, hint: str = "") -> Error:
    """The error of an array that a user gives."""
    text = f"array '{name}': {found}\n  allowed: {allowed}" + (f"\n  hint: {hint}" if hint else "")
    return Error(text, "usage", f"array '{name}'", found, allowed, hint)


def on_host(array: Any, name: str) -> Any:
    """What NumPy, PyTorch, CuPy, JAX or plain Python has, as an array of NumPy."""
    import numpy

    if isinstance(array, _core.DeviceArray):
        return array.numpy()
    if hasattr(array, "detach") and hasattr(array, "cpu"):  # a tensor, perhaps on a GPU or with a gradient
        array = array.detach().cpu()
    elif hasattr(array, "__cuda_array_interface__") and hasattr(array, "get"):
        array = array.get()
    try:
        return numpy.asarray(array)
    except (TypeError, ValueError) as reason:
        raise array_error(name, f"found a {type(array).__name__} that is no array of numbers ({reason})",
                     "an array of NumPy or PyTorch, or nested lists of numbers") from None


def _fits(shape: tuple[int, ...], wanted: tuple[int | None, ...]) -> bool:
    return len(shape) == len(wanted) and all(w is None or s == w for s, w in zip(shape, wanted))


def _finite(values: Any, name: str) -> Any:
    """The same, if no number is NaN or infinite; `values` has 64 bits and becomes 32."""
    import numpy

    with numpy.errstate(over="ignore"):
        narrow = numpy.ascontiguousarray(values, dtype=numpy.float32)
    bad = ~numpy.isfinite(narrow).all(axis=tuple(range(1, narrow.ndim)))
    if bad.any():
        row = int(bad.argmax())
        raise array_error(name, f"row {row} is {numpy.array2string(numpy.asarray(values[row]), separator=', ')}"
                     + (f", and {int(bad.sum()) - 1} more are not finite" if bad.sum() > 1 else ""),
                     "finite numbers that fit into single precision")
    return narrow


def floats(array: Any, name: str, *shapes: tuple[int | None, ...], allowed: str) -> Any:
    """An array of float32 of one of these shapes, in which None is any number. Throws an Error that says which array
    it is, what was found, and what is allowed."""
    values = on_host(array, name)
    if values.dtype.kind not in "fiu" or not any(_fits(values.shape, shape) for shape in shapes):
        raise array_error(name, f"found shape {values.shape}, {values.dtype}", f"{allowed}, of numbers")
    return _finite(values, name)


def numbers(array: Any, name: str, count: int) -> list[float]:
    """That many finite numbers, in double precision."""
    import numpy

    values = on_host(array, name)
    if values.dtype.kind not in "fiu" or values.shape != (count,) or not numpy.isfinite(values).all():
        raise array_error(name, f"found {numpy.array2string(values, separator=', ')}", f"{count} finite numbers")
    return values.astype(numpy.float64).tolist()


def indices(array: Any, name: str, width: int, below: int, of: str) -> Any:
    """An array (n, width) of int32 from 0 to below - 1."""
    import numpy

    values = on_host(array, name)
    if values.dtype.kind not in "iu" or not _fits(values.shape, (None, width)):
        raise array_error(name, f"found shape {values.shape}, {values.dtype}", f"(m, {width}), of integers")
    if len(values) == 0:
        raise array_error(name, "found no rows", "at least one")
    bad = ((values < 0) | (values >= below)).any(axis=1)
    if bad.any():
        row = int(bad.argmax())
        raise array_error(name, f"row {row} is {values[row].tolist()}", f"from 0 to {below - 1}, as there are {below} {of}")
    return numpy.ascontiguousarray(values, dtype=numpy.int32)


def _attribute(array: Any, name: str, count: int) -> Any:
    import numpy

    values = on_host(array, name)
    fits = any(_fits(values.shape, shape) for shape in ((count,), (count, 3)))
    whole = values.dtype.kind in "iub" and values.ndim == 1
    if not fits or values.dtype.kind not in "fiub":
        raise array_error(name, f"found shape {values.shape}, {values.dtype}", f"(n,) or (n, 3) with n = {count}, the number of positions, of numbers")
    if not whole:
        return _finite(values, name)
    limits = numpy.iinfo(numpy.int32)
    if values.dtype.kind != "b" and ((values < limits.min) | (values > limits.max)).any():
        raise array_error(name, f"found integers up to {values.max()}", "integers of 32 bits")
    return numpy.ascontiguousarray(values, dtype=numpy.int32)


def particle_arrays(positions: Any, velocities: Any, attributes: Mapping[str, Any] | None,
                    least: int = 1) -> dict[str, Any]:
    """What a ParticleFile takes in place of a file: at least that many particles."""
    import numpy

    places = floats(positions, "positions", (None, 3), allowed="(n, 3)")
    count = len(places)
    if count < least:
        raise array_error("positions", "found no particles", "at least one")
    if velocities is None:
        speeds = numpy.zeros((count, 3), numpy.float32)
    else:
        allowed = f"(n, 3) with n = {count}, the number of positions, or (3,) for all"
        speeds = floats(velocities, "velocities", (count, 3), (3,), allowed=allowed)
        speeds = numpy.ascontiguousarray(numpy.broadcast_to(speeds, (count, 3)))
    kept = {}
    for name, values in (attributes or {}).items():
        if name.lower() in _TAKEN_NAMES:
            raise array_error(name, "this is the name of what every particle has", "another name for the attribute")
        kept[name] = _attribute(values, name, count)
    return {"positions": places, "velocities": speeds, "attributes": kept}


def mesh_arrays(vertices: Any, faces: Any) -> dict[str, Any]:
    """What a MeshFile takes in place of a file."""
    points = floats(vertices, "vertices", (None, 3), allowed="(n, 3)")
    return {"vertices": points, "faces": indices(faces, "faces", 3, len(points), "vertices")}
