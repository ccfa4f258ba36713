"""Scenes as the runner needs them: read one, and make it smaller.

The scale is a factor on the number of particles. There are two ways to have fewer of them:
  "size"     the scene shrinks by the cube root, and the spacing stays: for figures about the spacing itself
  "spacing"  the spacing grows by the cube root, and the scene stays: for figures that show a scene
"""

import json


def read(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def parameter(scene, path):
    """The value of "NODE.PARAM" or "render.camera.eye"; a KeyError that names the path if there is none."""
    first, *rest = path.split(".")
    at = scene["nodes"][first]["params"] if first in scene["nodes"] else scene.get(first, {})
    for key in rest:
        if key not in at:
            raise KeyError(f"the scene has no {path}")
        at = at[key]
    return at


def text(value):
    """As --set takes it: numbers of at most six digits."""
    if isinstance(value, list):
        return "[" + ", ".join(text(v) for v in value) + "]"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        return f"{value:.6g}"
    return str(value)


def multiplied(value, factor):
    if isinstance(value, list):
        return [multiplied(v, factor) for v in value]
    return float(value) * factor


def scaled(scene, scaling, scale, lengths=()):
    """The settings, {path: text}, that make the scene hold `scale` times as many particles."""
    if not 0 < scale <= 1:
        raise ValueError(f"the scale is {scale}; allowed: above 0 to 1")
    if scale == 1:
        return {}
    factor = scale ** (1 / 3)
    if scaling == "spacing":
        return {"water.spacing": text(parameter(scene, "water.spacing") / factor)}
    if scaling == "size":
        settings = {path: text(multiplied(parameter(scene, path), factor)) for path in lengths}
        speeds = parameter(scene, "render.color.range")
        settings["render.color.range"] = text(multiplied(speeds, time_factor(scaling, scale)))
        return settings
    raise ValueError(f"no scaling is called {scaling!r}")


def scaled_overrides(settings, scaling, scale, lengths=()):
    """Settings of one run, {path: text}, with those that are lengths made smaller like the scene's."""
    if scaling != "size" or scale == 1:
        return settings
    factor = scale ** (1 / 3)
    return {path: text(multiplied(json.loads(value), factor)) if path in lengths else value
            for path, value in settings.items()}


def time_factor(scaling, scale):
    """How much earlier the same things happen, and how much slower: as the square root of a height."""
    return scale ** (1 / 6) if scaling == "size" else 1.0
