"""What a picture is asked for with."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from ._errors import usage_error

if TYPE_CHECKING:
    from ._scene import Scene

_LARGEST = 16384


def _settings(scene: Scene) -> Any:
    if "render" not in scene._core.sections():
        raise usage_error("no plugin that draws pictures is loaded", "the plugin 'rendering', which comes with Weir")
    return scene.render


def size_of(scene: Scene, width: int | None, height: int | None) -> tuple[int, int]:
    """The size in pixels; that of the scene where it is left out, in the scene's proportions if one number is."""
    settings = _settings(scene)
    for name, number in (("width", width), ("height", height)):
        if number is not None and not (isinstance(number, int) and 1 <= number <= _LARGEST):
            raise usage_error(f"found {name}={number!r}", f"an integer from 1 to {_LARGEST}, in pixels")
    if width is None and height is None:
        return settings.width, settings.height
    if width is None:
        return max(1, round(height * settings.width / settings.height)), height
    return width, height if height is not None else max(1, round(width * settings.height / settings.width))


def camera_of(scene: Scene, camera: Mapping[str, Any] | None) -> dict[str, list[float]] | None:
    """A camera with all that it needs, each as a list of numbers; None for that of the scene."""
    if camera is None:
        return None
    known = {"eye": 3, "target": 3, "up": 3, "fov": 1}
    for name in camera:
        if name not in known:
            raise usage_error(f"found {name!r}", ", ".join(known), "camera")
    given = {"up": (0, 1, 0), "fov": _settings(scene).camera.fov, **camera}
    for name, count in known.items():
        if name not in given:
            raise usage_error(f"there is no {name!r}", "an eye and a target, both (x, y, z) in m", "camera")
        values = given[name] if count == 3 else [given[name]]
        try:
            given[name] = [float(number) for number in values]
        except (TypeError, ValueError):
            given[name] = []
        if len(given[name]) != count or not all(map(math.isfinite, given[name])):
            raise usage_error(f"found {name}={camera.get(name)!r}", "three finite numbers" if count == 3 else "a finite number",
                              "camera")
    if not 0 < given["fov"][0] < 180:
        raise usage_error(f"found fov={camera['fov']!r}", "above 0 and below 180 degrees", "camera")
    return given
