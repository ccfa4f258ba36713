"""What the tests of the Python package share. ctest runs them with the package of the build tree on PYTHONPATH."""

import os

import pytest

import weir

DEVICE = os.environ.get("WEIR_TEST_DEVICE", "cpu")


def dam_break(spacing: float = 0.05, duration: float = 0.2) -> weir.Scene:
    """A block of water in a tank, with few particles."""
    scene = weir.Scene("A dam breaks")
    scene.world.duration = duration
    block = scene.add("BoxSampler", "block", min=(0, 0, 0), max=(0.4, 0.4, 0.4))
    tank = scene.add("StaticBoundary", "tank", shape="box", min=(0, 0, 0), max=(1, 1, 0.4), inverted=True)
    water = scene.add("ParticleFluid", "water", spacing=spacing, rest_steps=0)
    block.particles >> water.initial
    tank.boundary >> water.boundaries
    return scene


def falling_drop(**water: object) -> weir.Scene:
    """A drop that touches nothing: each particle falls as its module of the weir.Predict alone moves it."""
    scene = weir.Scene("A drop falls")
    scene.world.set(duration=1, dt=0.01, frame_rate=10)
    drop = scene.add("SphereSampler", "drop", center=(0, 0, 0), radius=0.2)
    fluid = scene.add("ParticleFluid", "water", **{"spacing": 0.1, "rest_steps": 0, **water})
    drop.particles >> fluid.initial
    for module in ("solver", "viscosity"):
        fluid.modules[module].enabled = False
    return scene


@pytest.fixture
def scene() -> weir.Scene:
    return dam_break()


@pytest.fixture
def sim(scene: weir.Scene) -> weir.Simulation:
    return weir.Simulation(scene, device="cpu", threads=2)
