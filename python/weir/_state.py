"""The state of modules that are written in Python, as the bytes that a checkpoint holds.

It is JSON, so that reading a checkpoint runs no code that stands in it. What JSON does not have is an object with one
member, whose name says what it is.
"""

from __future__ import annotations

import base64
import io
import json
import random
import sys
from typing import Any

_GENERATORS = ("MT19937", "PCG64", "PCG64DXSM", "Philox", "SFC64")


def packed(value: Any, owner: str) -> bytes:
    """The bytes of a value. Raises TypeError if it is of no kind that can be kept."""
    return json.dumps(_encode(value, owner)).encode()


def unpacked(data: bytes) -> Any:
    """What was packed."""
    return _decode(json.loads(data))


def _encode(value: Any, at: str) -> Any:
    if value is None or type(value) in (bool, int, float, str):
        return value
    if type(value) is list:
        return [_encode(v, f"{at}[{i}]") for i, v in enumerate(value)]
    if type(value) is tuple:
        return {"tuple": [_encode(v, f"{at}[{i}]") for i, v in enumerate(value)]}
    if type(value) is dict:
        return {"dict": [[_encode(k, at), _encode(v, f"{at}[{k!r}]")] for k, v in value.items()]}
    if type(value) is bytes:
        return {"bytes": base64.b64encode(value).decode()}
    if type(value) is random.Random:
        return {"random": _encode(value.getstate(), at)}
    numpy = sys.modules.get("numpy")
    if numpy is not None:
        if isinstance(value, numpy.random.Generator) and type(value.bit_generator).__name__ in _GENERATORS:
            return {"generator": _encode(value.bit_generator.state, at)}
        if type(value) is numpy.ndarray and not value.dtype.hasobject:
            return {"array": _bytes_of(value)}
        if isinstance(value, numpy.generic) and not value.dtype.hasobject:
            return {"number": _bytes_of(numpy.asarray(value))}
    raise TypeError(f"{at} is of the type {type(value).__name__}, which a checkpoint cannot hold; allowed: None, bool, int, "
                    "float, str, bytes, list, tuple, dict, numpy's arrays, numbers and random generators, random.Random")


def _decode(value: Any) -> Any:
    if isinstance(value, list):
        return [_decode(v) for v in value]
    if not isinstance(value, dict):
        return value
    (kind, held), = value.items()
    if kind == "tuple":
        return tuple(_decode(v) for v in held)
    if kind == "dict":
        return {_decode(k): _decode(v) for k, v in held}
    if kind == "bytes":
        return base64.b64decode(held)
    if kind == "random":
        generator = random.Random()
        generator.setstate(_decode(held))
        return generator
    if kind == "generator":
        return _generator(_decode(held))
    if kind in ("array", "number"):
        array = _array(held)
        return array if kind == "array" else array[()]
    raise ValueError(f"the checkpoint holds a value of the unknown kind {kind!r}")


def _bytes_of(array: Any) -> str:
    import numpy

    file = io.BytesIO()
    numpy.save(file, array, allow_pickle=False)
    return base64.b64encode(file.getvalue()).decode()


def _array(text: str) -> Any:
    import numpy

    return numpy.load(io.BytesIO(base64.b64decode(text)), allow_pickle=False)


def _generator(state: dict) -> Any:
    import numpy

    name = state["bit_generator"]
    if name not in _GENERATORS:
        raise ValueError(f"the checkpoint holds a random generator of the unknown kind {name!r}")
    bits = getattr(numpy.random, name)()
    bits.state = state
    return numpy.random.Generator(bits)
