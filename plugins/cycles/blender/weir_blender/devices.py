"""On what Cycles renders."""

import bpy

from .handover import HandoverError

_KINDS = ("CUDA", "HIP", "METAL", "ONEAPI")


def choose_device(scene, wanted):
    """`wanted` is auto, cpu or gpu. Returns what it is called."""
    scene.cycles.device = "CPU"
    if wanted != "cpu":
        kind = _first_gpu()
        if kind:
            scene.cycles.device = "GPU"
            return kind
        if wanted == "gpu":
            raise HandoverError("render.cycles.device is gpu, but Cycles finds no GPU here; allowed: auto or cpu")
    return "the CPU"


def _first_gpu():
    """Switches it on; None without one."""
    addon = bpy.context.preferences.addons.get("cycles")
    if addon is None:
        return None
    preferences = addon.preferences
    for kind in _KINDS:
        try:
            preferences.compute_device_type = kind
            preferences.get_devices_for_type(kind)
        except (TypeError, AttributeError, ValueError):
            continue
        gpus = [device for device in preferences.devices if device.type == kind]
        if gpus:
            for device in preferences.devices:
                device.use = device.type == kind
            return f"{kind} ({gpus[0].name})"
    return None
