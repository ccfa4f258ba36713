"""Modules that are written in Python."""

import gc
import json
import weakref

import numpy as np
import pytest

import weir
from conftest import dam_break, falling_drop


class Push(weir.Module):
    """Pushes the fluid."""

    push = weir.Param((1.0, 0.0, 0.0), unit="m/s^2", doc="Acceleration.", animated=True)
    strength = weir.Param(1.0, min=0, doc="A factor.")
    only_even = weir.Param(False, doc="Of even numbers only.")

    def step(self, fluid, dt):
        fluid.velocities[...] += self.strength * dt * np.float32(self.push)


class Count(weir.Module):
    """Counts its calls for each particle."""

    def reset(self, fluid):
        self.resets = getattr(self, "resets", 0) + 1
        fluid.particles.add("calls", "int")
        self.seen = []

    def step(self, fluid, dt):
        fluid["calls"][:] += 1
        self.seen.append((fluid.time, fluid.dt, dt, fluid.index, fluid.count))

    def report(self):
        return {"calls": len(self.seen)}


def test_a_module_is_a_step_of_the_pipeline():
    scene = falling_drop()
    scene.world.gravity = (0, 0, 0)
    scene.water.modules.insert("push", Push(push=(0, 3, 0), strength=2), before="predict")
    sim = weir.Simulation(scene, device="cpu")
    sim.step()
    assert scene.water.velocities == pytest.approx(np.tile([0, 0.06, 0], (scene.water.count, 1)), abs=1e-6)
    scene.water.modules["push"].strength = 0
    sim.step()
    assert scene.water.velocities[:, 1] == pytest.approx(0.06, abs=1e-6)


def test_it_is_the_scenes_own_gravity():
    """A push in place of gravity gives the same run, step by step."""
    with_gravity, with_push = falling_drop(), falling_drop()
    with_push.world.gravity = (0, 0, 0)
    with_push.water.modules.insert("push", Push(push=(0, -9.8, 0)), before="predict")
    a, b = weir.Simulation(with_gravity, device="cpu"), weir.Simulation(with_push, device="cpu")
    a.advance(3)
    b.advance(3)
    order, other = np.argsort(with_gravity.water.ids), np.argsort(with_push.water.ids)
    assert np.allclose(with_gravity.water.positions[order], with_push.water.positions[other], atol=1e-5)


def test_attributes_of_modules_travel_and_are_reported(tmp_path):
    scene = dam_break()
    count = Count()
    assert scene.water.modules.insert("count", count, after="contact") is count
    assert scene.water.modules["count"] is count
    sim = weir.Simulation(scene, device="cpu")
    sim.advance(2)
    assert count.resets == 1 and len(count.seen) == sim.steps
    assert (scene.water.particles["calls"] == sim.steps).all()
    times = [seen[0] for seen in count.seen]
    assert times == sorted(times) and all(seen[1] == seen[2] for seen in count.seen)
    assert [seen[3] for seen in count.seen] == list(range(sim.steps))
    assert sim.statistics["nodes"]["water"]["calls"] == sim.steps
    count.enabled = False
    sim.advance(1)
    assert count.name == "count" and (scene.water.particles["calls"] < sim.steps).all()
    sim.reset()
    assert count.resets == 2


def test_parameters_are_checked_and_animated():
    with pytest.raises(weir.Error, match="at least 0"):
        Push(strength=-1)
    with pytest.raises(weir.Error, match="did you mean 'strength'"):
        Push(strenth=1)
    module = Push(strength=3)
    assert module.strength == 3 and module.push == (1, 0, 0) and module.only_even is False
    with pytest.raises(weir.Error):
        module.strength = "much"
    assert module.strength == 3
    with pytest.raises(weir.Error, match="cannot change over time"):
        module.strength = weir.keyframes((0, 1), (1, 2))
    scene = falling_drop()
    scene.world.gravity = (0, 0, 0)
    pushes = weir.keyframes((0, (0, 0, 0)), (1, (0, 10, 0)))
    scene.water.modules.insert("push", Push(push=pushes), before="predict")
    sim = weir.Simulation(scene, device="cpu")
    sim.advance(5)
    # At the beginning of each step of 0.01 s: 10·(0 + 0.01 + … + 0.49)·0.01.
    assert scene.water.velocities[:, 1] == pytest.approx(0.1 * sum(range(50)) * 0.01, rel=1e-4)


def test_registered_modules_are_read_from_files(tmp_path):
    @weir.register
    class Registered(Push):
        """Known by its name."""

        more = weir.Param("text")

    scene = dam_break()
    scene.water.modules.insert("push", "Registered", before="solver", strength=2)
    scene.save(tmp_path / "scene.json")
    written = json.loads((tmp_path / "scene.json").read_text())["nodes"]["water"]["modules"]["push"]
    assert written == {"type": "Registered", "before": "solver", "params": {"strength": 2}} or written["after"] == "walls"
    again = weir.load(tmp_path / "scene.json", set={"water.push.more": "words"})
    module = again.water.modules["push"]
    assert isinstance(module, Registered) and module.strength == 2 and module.more == "words"
    with pytest.raises(weir.Error, match="two libraries add the module type 'Registered'"):
        weir.register(Registered)


class Gusts(weir.Module):
    """Pushes the fluid at random, and harder from step to step."""

    state = ("count", "random", "pushes")

    def reset(self, fluid):
        self.count, self.random, self.pushes = 0, np.random.default_rng(3), np.zeros(3, np.float32)
        self.log = []

    def step(self, fluid, dt):
        self.count += 1
        push = (self.count * self.random.normal(size=3)).astype(np.float32)
        self.pushes += push
        self.log.append(self.count)
        fluid.velocities[...] += np.float32(dt) * push

    def report(self):
        return {"count": self.count, "pushes": self.pushes.tolist(), "log": len(self.log)}

    def save(self):
        return {"log": tuple(self.log)}

    def restore(self, saved):
        self.log = list(saved["log"])


class Forgets(Gusts):
    """The same without its state."""

    @classmethod
    def declared_state(cls):
        return []


def gusty(kind, **parameters):
    scene = dam_break(**parameters)
    scene.water.modules.insert("gusts", kind(), before="predict")
    return scene


def resumed_and_whole(kind, tmp_path):
    """Positions by id and report of a run that was resumed after two frames, and of one that was not."""
    seen = []
    for resumes in (True, False):
        scene = gusty(kind)
        sim = weir.Simulation(scene, device="cpu", threads=2)
        if resumes:
            file = tmp_path / f"{kind.__name__}.h5"
            sim.run(duration=2 / scene.world.frame_rate, checkpoint=file, checkpoint_every=2)
            scene = gusty(kind)
            sim = weir.Simulation(scene, device="cpu", threads=2)
            steps = []
            sim.run(resume=file, callback=lambda s: steps.append(s.steps))
            assert steps[0] > 1 and steps == list(range(steps[0], sim.steps + 1))
        else:
            sim.run()
        water = scene.water
        seen.append((water.positions[np.argsort(water.particles["id"])].tobytes(),
                     {k: v for k, v in sim.statistics["nodes"]["water"].items() if k in ("count", "pushes", "log")}))
    return seen


def test_a_resumed_run_goes_on_with_the_state_of_its_modules(tmp_path):
    resumed, whole = resumed_and_whole(Gusts, tmp_path)
    assert resumed == whole
    resumed, whole = resumed_and_whole(Forgets, tmp_path)
    assert resumed[0] != whole[0]


def test_states_that_cannot_be_kept_are_named(tmp_path):
    class Odd(Gusts):
        state = ("odd",)

        def reset(self, fluid):
            super().reset(fluid)
            self.odd = {1: object()}

    class Missing(Gusts):
        state = ("missing",)

    class Text(Gusts):
        state = "count"

    for kind, error, words in ((Odd, TypeError, "Odd.*object.*cannot hold"), (Missing, AttributeError, "'missing'"),
                               (Text, TypeError, "not a tuple")):
        sim = weir.Simulation(gusty(kind), device="cpu")
        with pytest.raises(error, match=words):
            sim.run(checkpoint=tmp_path / "state.h5", checkpoint_every=1)


def test_a_checkpoint_of_another_state_is_refused(tmp_path, monkeypatch):
    weir.Simulation(gusty(Gusts), device="cpu").run(checkpoint=tmp_path / "state.h5", checkpoint_every=1)
    with pytest.raises(weir.Error, match="spacing"):
        weir.Simulation(gusty(Gusts, spacing=0.1), device="cpu").run(resume=tmp_path / "state.h5")
    with pytest.raises(weir.Error, match="no known kind"):
        weir.Simulation(gusty(Gusts), device="cpu").run(resume=tmp_path / "state.json")
    monkeypatch.setattr(Gusts, "state", ("count",))
    with pytest.raises(weir.Error, match="declares"):
        weir.Simulation(gusty(Gusts), device="cpu").run(resume=tmp_path / "state.h5")


def test_exceptions_travel_with_their_traceback():
    class Broken(weir.Module):
        def step(self, fluid, dt):
            if fluid.index == 3:
                raise KeyError("of the module")

    scene = dam_break()
    scene.water.modules.insert("broken", Broken(), after="solver")
    sim = weir.Simulation(scene, device="cpu")
    with pytest.raises(KeyError, match="of the module") as caught:
        sim.run()
    assert caught.traceback[-1].name == "step"
    with pytest.raises(weir.Error, match="failed within a step"):
        sim.step()
    assert sim.statistics["end"] == "failed"
    scene.water.modules["broken"].enabled = False
    sim.reset()
    sim.run()
    assert sim.done


def test_an_exception_in_reset_is_raised_where_it_is_asked_for():
    class Broken(weir.Module):
        def reset(self, fluid):
            raise ValueError("in reset")

        def step(self, fluid, dt):
            pass

    scene = dam_break()
    scene.water.modules.insert("broken", Broken(), after="solver")
    with pytest.raises(ValueError, match="in reset"):
        weir.Simulation(scene, device="cpu")
    scene.water.modules.replace("broken", Push(strength=0))
    assert weir.Simulation(scene, device="cpu").time == 0


def test_modules_without_a_step_say_so():
    class Nothing(weir.Module):
        pass

    scene = dam_break()
    scene.water.modules.insert("nothing", Nothing(), after="solver")
    sim = weir.Simulation(scene, device="cpu")
    with pytest.raises(NotImplementedError, match="Nothing has no method step"):
        sim.step()


def test_the_fluid_of_a_step_ends_with_it():
    class Keep(weir.Module):
        def step(self, fluid, dt):
            self.fluid, self.array = fluid, fluid.positions
            assert fluid.device == "cpu" and fluid.stream == 0
            assert fluid.spacing == pytest.approx(0.05) and fluid.support_radius == pytest.approx(0.075)
            assert fluid.particle_mass == pytest.approx(1000 * 0.05**3) and fluid.rest_density == 1000
            assert fluid.gravity[1] == pytest.approx(-9.8)

    scene = dam_break()
    scene.water.support_ratio = 1.5
    keep = scene.water.modules.insert("keep", Keep(), after="solver")
    sim = weir.Simulation(scene, device="cpu")
    sim.step()
    with pytest.raises(weir.Error, match="after its method has returned"):
        keep.fluid.positions
    assert keep.array.shape[1] == 3


def test_one_object_has_one_place():
    push = Push()
    scene = dam_break()
    scene.water.modules.insert("push", push, after="solver")
    with pytest.raises(weir.Error, match="in a scene already"):
        scene.water.modules.insert("other", push, after="solver")

    class Forgetful(weir.Module):
        def __init__(self):
            pass

    with pytest.raises(weir.Error, match="super"):
        scene.water.modules.insert("forgetful", Forgetful(), after="solver")


def test_a_module_whose_scene_is_gone_is_harmless():
    scene = dam_break()
    push = scene.water.modules.insert("push", Push(), after="solver")
    alive = weakref.ref(scene)
    del scene
    gc.collect()
    assert alive() is None
    with pytest.raises(weir.Error):
        push.strength


def test_parameters_of_no_kind_are_refused():
    class Odd(weir.Module):
        odd = weir.Param({"a": 1})

    with pytest.raises(TypeError, match="odd"):
        Odd()
