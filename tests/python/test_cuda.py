"""Particles on a GPU, shared with PyTorch, CuPy and Numba. Skipped where there is no GPU, unless WEIR_REQUIRE_DEVICES names
cuda, or no such library."""

import gc
import os

import numpy as np
import pytest

import weir
from conftest import dam_break, falling_drop

required = "cuda" in os.environ.get("WEIR_REQUIRE_DEVICES", "").split(",")
pytestmark = pytest.mark.skipif(not required and not any(name.startswith("cuda") for name, _ in weir.devices()),
                                reason="there is no CUDA device that works")


def pointer(array: weir.DeviceArray) -> int:
    return array.__cuda_array_interface__["data"][0]


@pytest.fixture
def moving():
    scene = dam_break()
    return weir.Simulation(scene, device="cuda"), scene.water


def test_an_array_says_what_it_is(moving):
    sim, water = moving
    positions = water.positions
    assert isinstance(positions, weir.DeviceArray) and len(positions) == water.count
    assert positions.shape == (water.count, 3) and positions.dtype == "float32" and water.ids.dtype == "int64"
    interface = positions.__cuda_array_interface__
    assert interface["shape"] == positions.shape and interface["typestr"] == "<f4" and interface["version"] == 3
    assert interface["stream"] == sim.stream != 0
    assert positions.__dlpack_device__() == (2, 0)
    host = dam_break()
    weir.Simulation(host, device="cpu")
    order, other = np.argsort(water.ids.numpy()), np.argsort(host.water.ids)
    assert np.allclose(positions.numpy()[order], host.water.positions[other], atol=1e-5)


def test_a_tensor_shares_memory(moving):
    torch = pytest.importorskip("torch")
    sim, water = moving
    tensor = torch.from_dlpack(water.positions)
    assert tensor.is_cuda and tensor.data_ptr() == pointer(water.positions)
    assert torch.as_tensor(water.velocities, device="cuda").data_ptr() == pointer(water.velocities)
    before = water.positions.numpy()
    tensor += 0.25
    assert np.allclose(water.positions.numpy(), before + 0.25)
    stream = torch.cuda.Stream()
    stream.wait_stream(torch.cuda.default_stream())
    with torch.cuda.stream(stream):
        other = torch.from_dlpack(water.positions)
        other -= 0.25
    torch.cuda.default_stream().wait_stream(stream)
    assert np.allclose(water.positions.numpy(), before, atol=1e-6)


def test_cupy_and_numba_share_memory(moving):
    cupy = pytest.importorskip("cupy")
    sim, water = moving
    velocities = cupy.asarray(water.velocities)
    assert velocities.data.ptr == pointer(water.velocities)
    velocities[:, 1] = 3
    assert (water.velocities.numpy()[:, 1] == 3).all()
    numba_cuda = pytest.importorskip("numba.cuda")
    array = numba_cuda.as_cuda_array(water.velocities)
    assert array.device_ctypes_pointer.value == pointer(water.velocities)


def test_what_is_written_is_simulated():
    torch = pytest.importorskip("torch")
    scene = falling_drop()
    scene.world.gravity = (0, 0, 0)
    sim = weir.Simulation(scene, device="cuda")
    start = scene.water.positions.numpy()[np.argsort(scene.water.ids.numpy())]
    velocities = torch.from_dlpack(scene.water.velocities)
    velocities[:] = torch.tensor([1.0, 2.0, 3.0], device="cuda")
    for _ in range(40):  # beyond the steps that are launched one by one
        sim.step()
    order = np.argsort(scene.water.ids.numpy())
    assert np.allclose(scene.water.positions.numpy()[order], start + sim.time * np.array([1, 2, 3]), atol=1e-5)
    scene.water.velocities = (0, 0, 0)
    assert not scene.water.velocities.numpy().any()
    scene.water.positions = scene.water.positions.numpy() + 1
    with pytest.raises(ValueError):
        scene.water.positions = np.zeros((2, 3))


def test_looking_changes_nothing():
    results = []
    for look in (False, True):
        scene = dam_break(duration=0.2)
        sim = weir.Simulation(scene, device="cuda", deterministic=True)
        kept = []
        sim.run(callback=lambda s: kept.append(scene.water.positions) if look else None)
        results.append(scene.water.positions.numpy())
    assert np.array_equal(*results)


def test_arrays_outlive_everything():
    torch = pytest.importorskip("torch")
    scene = dam_break()
    sim = weir.Simulation(scene, device="cuda")
    tensor = torch.from_dlpack(scene.water.positions)
    expected = scene.water.positions.numpy()
    sim.close()
    del sim, scene
    gc.collect()
    others = [dam_break() for _ in range(2)]
    simulations = [weir.Simulation(other, device="cuda") for other in others]
    for simulation in simulations:
        simulation.advance(1)
    assert np.array_equal(tensor.cpu().numpy(), expected)
    tensor.fill_(float("nan"))
    for simulation, other in zip(simulations, others):
        simulation.advance(1)
        assert np.isfinite(other.water.positions.numpy()).all()


class CupyLift(weir.Module):
    """Lifts the fluid."""

    def reset(self, fluid):
        fluid.particles.add("lifted", "int")

    def step(self, fluid, dt):
        import cupy

        cupy.asarray(fluid.velocities)[:, 1] += 12 * dt
        cupy.asarray(fluid["lifted"])[:] += 1


class StreamLift(weir.Module):
    """The same in the simulation's own stream."""

    def step(self, fluid, dt):
        import cupy

        with cupy.cuda.ExternalStream(fluid.stream):
            cupy.asarray(fluid.velocities)[:, 1] += 12 * dt


class NumpyLift(weir.Module):
    """The same on the CPU."""

    def step(self, fluid, dt):
        fluid.velocities[:, 1] += np.float32(12 * dt)


def test_modules_work_in_place():
    pytest.importorskip("cupy")
    heights = {}
    for module, device in ((NumpyLift, "cpu"), (CupyLift, "cuda"), (StreamLift, "cuda")):
        scene = falling_drop()
        scene.world.set(dt=0.001)
        scene.water.modules.insert("lift", module(), before="predict")
        sim = weir.Simulation(scene, device=device)
        sim.advance(2)
        to_host = (lambda a: a.numpy()) if device == "cuda" else (lambda a: a)
        heights[module] = to_host(scene.water.positions)[np.argsort(to_host(scene.water.ids))]
        if module is CupyLift:
            assert (scene.water.particles["lifted"].numpy() == sim.steps).all()
    assert np.allclose(heights[CupyLift], heights[NumpyLift], atol=1e-5)
    assert np.allclose(heights[StreamLift], heights[NumpyLift], atol=1e-5)


def test_exceptions_in_modules_leave_the_device_usable():
    class Broken(weir.Module):
        def step(self, fluid, dt):
            if fluid.index == 5:
                raise KeyError("of the module")

    scene = dam_break()
    scene.water.modules.insert("broken", Broken(), after="solver")
    sim = weir.Simulation(scene, device="cuda")
    with pytest.raises(KeyError):
        sim.advance(1)
    scene.water.modules["broken"].enabled = False
    sim.reset()
    sim.advance(2)
    assert np.isfinite(scene.water.positions.numpy()).all()


def test_nodes_measure_and_give():
    from test_nodes import raining

    found = {}
    for device in ("cpu", "cuda"):
        scene = raining()
        weir.Simulation(scene, device=device).run()
        found[device] = {name: value for name, value in scene.middle.values.items() if name != "middle"}
    assert found["cuda"] == pytest.approx(found["cpu"], rel=1e-4)
