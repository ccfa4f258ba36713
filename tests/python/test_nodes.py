"""Nodes that are written in Python."""

import gc
import json
import pydoc
import sys
import weakref

import numpy as np
import pytest

import weir
from conftest import DEVICE, dam_break, falling_drop

G = 9.8


class Middle(weir.Node):
    """Measures where the middle of the particles is, and how far they have come."""

    fluid = weir.Input("Particles", doc="What it measures.")
    above = weir.Param(0.0, unit="m", doc="The level from which it counts.", animated=True)
    state = ("path",)

    def reset(self):
        self.path = 0.0
        self.first = self.middle()

    def step(self, dt):
        self.path += dt * float(np.abs(on_host(self.fluid.value.velocities)).mean(0)[1])

    def middle(self):
        return on_host(self.fluid.value.positions).mean(0)

    def report(self):
        return {"height": self.middle()[1] - self.above, "fallen": self.first[1] - self.middle()[1], "path": self.path,
                "middle": self.middle(), "count": len(self.fluid.value)}


class Drops(weir.Node):
    """Lets drops of one particle fall, one each time."""

    drops = weir.Output(doc="The drops.")
    every = weir.Param(4, min=1, doc="Steps from one drop to the next.")
    state = ("steps", "random")

    def reset(self):
        self.steps, self.random = 0, np.random.default_rng(5)

    def step(self, dt):
        if self.steps % self.every == 0:
            place = self.random.uniform(-1, 1, (1, 3)).astype(np.float32)
            self.drops.set_particles(place + (0, 5, 0), (0, -1, 0), {"born": [self.steps]})
        self.steps += 1

    def report(self):
        return {"drops": -(-self.steps // self.every)}


class Lattice(weir.Node):
    """Fills a cube with particles, as far apart as the fluid asks for."""

    particles = weir.Output()
    size = weir.Param(0.4, unit="m", above=0)

    def reset(self):
        n = round(self.size / self.particles.spacing)
        self.particles.set_particles(self.particles.spacing * (0.5 + np.argwhere(np.ones((n, n, n)))))


def on_host(array):
    return array.numpy() if isinstance(array, weir.DeviceArray) else array


def sphere(radius, count=40):
    """Vertices and faces of a ball about the origin, from a grid of angles."""
    polar, around = np.meshgrid(np.linspace(0, np.pi, count), np.linspace(0, 2 * np.pi, 2 * count, endpoint=False), indexing="ij")
    vertices = radius * np.stack([np.sin(polar) * np.cos(around), np.cos(polar), np.sin(polar) * np.sin(around)], -1)
    i, j = (index.ravel() for index in np.meshgrid(np.arange(count - 1), np.arange(2 * count), indexing="ij"))
    k = (j + 1) % (2 * count)
    a, b, c, d = i * 2 * count + j, i * 2 * count + k, (i + 1) * 2 * count + k, (i + 1) * 2 * count + j
    return vertices.reshape(-1, 3), np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])


def with_middle(scene, **params):
    scene.water.fluid >> scene.add(Middle, "middle", **params).fluid
    return scene


def raining(duration=0.4):
    """Drops that touch nothing, on one fluid."""
    scene = falling_drop()
    scene.world.duration = duration
    scene.add(Drops, "rain").drops >> scene.water.emitters
    return with_middle(scene)


def test_a_node_measures_a_free_fall():
    scene = with_middle(falling_drop(), above=-2)
    middle = scene.middle
    assert isinstance(middle, Middle) and scene["middle"] is middle and scene.nodes["middle"] is middle
    assert (middle.name, middle.type, middle.above, repr(middle)) == ("middle", "Middle", -2, "<Middle 'middle'>")
    sim = weir.Simulation(scene, device=DEVICE)
    start = middle.values["height"]
    sim.advance(5)
    t, dt = 0.5, 0.01
    assert middle.time == pytest.approx(t)
    # Weir moves by the velocity after the pull: a fall of g t (t + dt) / 2.
    fallen = G * t * (t + dt) / 2
    found = middle.values
    assert found["fallen"] == pytest.approx(fallen, rel=1e-4)
    assert found["path"] == pytest.approx(fallen, rel=1e-4)
    assert found["height"] == pytest.approx(start - fallen, rel=1e-4)
    assert start == pytest.approx(2, abs=0.01) and found["count"] == scene.water.count
    assert sim.statistics["nodes"]["middle"] == {"type": "Middle", **found}
    middle.above = 1
    assert middle.values["height"] == pytest.approx(start - 3 - fallen, rel=1e-4)
    sim.reset()
    assert middle.values["path"] == 0


def test_its_numbers_stand_in_series(tmp_path):
    scene = with_middle(falling_drop())
    weir.Simulation(scene, device=DEVICE).run(duration=0.3, series=tmp_path / "fall.jsonl")
    lines = [json.loads(line) for line in (tmp_path / "fall.jsonl").read_text().splitlines()]
    fallen = [line["nodes"]["middle"]["fallen"] for line in lines if "nodes" in line]
    assert fallen == pytest.approx([G * t * (t + 0.01) / 2 for t in (0, 0.1, 0.2, 0.3)], rel=1e-3, abs=1e-6)


def test_measuring_changes_no_bit():
    seen = []
    for measured in (False, True):
        scene = with_middle(dam_break()) if measured else dam_break()
        weir.Simulation(scene, device="cpu", threads=2).run()
        seen.append(scene.water.positions[np.argsort(scene.water.ids)].tobytes())
    assert seen[0] == seen[1]


def test_a_sampler_fills_as_far_apart_as_the_fluid_asks():
    scene = weir.Scene("A cube")
    water = scene.add("ParticleFluid", "water", spacing=0.1, rest_steps=0)
    cube = scene.add(Lattice(size=0.5), "cube")
    assert cube.particles.spacing is None
    cube.particles >> water.initial
    sim = weir.Simulation(scene, device=DEVICE)
    assert water.count == 125 and cube.particles.spacing == pytest.approx(0.1)
    assert on_host(water.positions).mean(0) == pytest.approx([0.25, 0.25, 0.25])
    assert len(cube.particles.value) == 125 and cube.particles.links[0].path == "water.initial"
    sim.advance(1)
    assert water.count == 125 and len(cube.particles.value) == 0


def test_an_emitter_gives_particles_in_steps():
    scene = raining()
    scene.rain.every = 8
    sim = weir.Simulation(scene, device=DEVICE)
    before = scene.water.count
    sim.run()
    assert sim.steps == 40 and scene.rain.values["drops"] == 5 and scene.water.count == before + 5
    born = on_host(scene.water.particles["born"])[np.argsort(on_host(scene.water.ids))]
    assert born[-5:].tolist() == [0, 8, 16, 24, 32]
    newest = np.argmax(on_host(scene.water.ids))
    t, dt = (40 - 32) * 0.01, 0.01
    assert on_host(scene.water.velocities)[newest, 1] == pytest.approx(-1 - G * t, rel=1e-4)
    places = np.random.default_rng(5).uniform(-1, 1, (5, 3)).astype(np.float32)
    assert on_host(scene.water.positions)[newest] == pytest.approx(
        places[4] + (0, 5 - t - G * t * (t + dt) / 2, 0), abs=1e-4)


def test_inputs_take_surfaces_meshes_and_solids():
    class Looks(weir.Node):
        surfaces = weir.Input("DynamicMesh", required=False)
        meshes = weir.Input("TriangleMesh", many=True)
        forces = weir.Input("SolidForces")
        walls = weir.Input("Boundary")
        particles = weir.Input("Particles")

        def report(self):
            solid = self.forces.links[0].node
            return {"meshes": [len(mesh.faces) for mesh in self.meshes.value], "no_surface": self.surfaces.value is None,
                    "force": self.forces.value["ball"].force, "place": solid.pose().translation,
                    "restitution": self.walls.links[0].node.restitution,
                    "wet": int((self.walls.value.distances(self.particles.value.positions) < 0.03).sum())}

    scene = dam_break()
    ball = scene.add("BoxMesh", "ball", min=(0.6, 0.1, 0.1), max=(0.8, 0.3, 0.3))
    other = scene.add("BoxMesh", "another", min=(0.6, 0.1, 0.1), max=(0.8, 0.3, 0.3))
    solid = scene.add("SemiAnalyticalSFI", "solid")
    ball.surface >> solid.solids
    scene.water.fluid >> solid.fluid
    looks = scene.add(Looks, "looks")
    ball.surface >> looks.meshes
    other.surface >> looks.meshes
    solid.forces >> looks.forces
    scene.tank.boundary >> looks.walls
    scene.water.fluid >> looks.particles
    assert looks.surfaces.links == []
    sim = weir.Simulation(scene, device=DEVICE)
    sim.advance(1)
    found = looks.values
    assert found["meshes"] == [12, 12] and found["no_surface"] is True
    assert len(found["force"]) == 3 and found["place"] == [0, 0, 0] and found["restitution"] == 0
    x, y, z = on_host(scene.water.positions).T
    assert found["wet"] == (np.min([x, 1 - x, y, 1 - y, z, 0.4 - z], axis=0) < 0.03).sum() > 50


def test_walls_are_asked_by_distance():
    scene = dam_break()
    ball = scene.add_mesh("ball", *sphere(0.3))
    wall = scene.add("StaticBoundary", "wall")
    ball.surface >> wall.meshes
    wall.boundary >> scene.water.boundaries
    weir.Simulation(scene, device=DEVICE)
    points = np.random.default_rng(2).normal(0, 0.15, (200, 3)) + 0.0
    walls = wall.boundary.value
    radii = np.linalg.norm(points, axis=1)
    near = np.abs(radii - 0.3) < 0.05
    assert near.sum() > 20
    assert walls.distances(points)[near] == pytest.approx(radii[near] - 0.3, abs=0.004)
    assert (walls.normals(points)[near] * points[near] / radii[near, None]).sum(1) == pytest.approx(1, abs=0.01)
    with pytest.raises(weir.Error, match="points"):
        walls.distances([(0, 1)])


def test_a_node_steers_others():
    class Holds(weir.Node):
        """A spring without damper, which a body swings on."""

        body = weir.Input("RigidBody")
        stiffness = weir.Param(40.0, unit="N/m")

        def step(self, dt):
            ship = self.body.links[0].node
            ship.applied_force = tuple(-self.stiffness * ship.pose().translation)

    scene = weir.Scene("A body on a spring")
    scene.world.set(duration=2, dt=0.001, frame_rate=10, gravity=(0, 0, 0))
    box = scene.add("BoxMesh", "box", min=(-0.1, -0.1, -0.1), max=(0.1, 0.1, 0.1))
    ship = scene.add("RigidBody", "ship", mass=10)
    box.surface >> ship.mesh
    outputs = {port.type: port for port in ship._outputs()}
    outputs["RigidBody"] >> scene.add(Holds, "spring").body
    sim = weir.Simulation(scene, device="cpu")
    ship.place(velocity=(1, 0, 0))
    sim.advance(8)
    omega = (40 / 10) ** 0.5
    assert ship.pose().translation[0] == pytest.approx(np.sin(omega * 0.8) / omega, rel=0.01)


def resumed_and_whole(tmp_path):
    seen = []
    for resumes in (True, False):
        scene = raining()
        sim = weir.Simulation(scene, device="cpu", threads=2)
        if resumes:
            sim.run(duration=0.2, checkpoint=tmp_path / "rain.h5", checkpoint_every=1)
            scene = raining()
            sim = weir.Simulation.resume(scene, tmp_path / "rain.h5", device="cpu", threads=2)
            assert sim.frame == 2 and scene.rain.steps == sim.steps
        sim.run()
        seen.append((scene.water.positions[np.argsort(scene.water.ids)].tobytes(), scene.rain.values["drops"],
                     scene.middle.values["path"]))
    return seen


def test_a_resumed_run_gives_the_same_bits(tmp_path):
    resumed, whole = resumed_and_whole(tmp_path)
    assert resumed == whole


def test_without_its_state_it_would_not(tmp_path, monkeypatch):
    monkeypatch.setattr(Drops, "declared_state", classmethod(lambda cls: []))
    with pytest.raises(AssertionError):
        resumed, whole = resumed_and_whole(tmp_path)
        assert resumed == whole


def test_registered_nodes_are_read_from_files_and_copied(tmp_path):
    @weir.register
    class Level(Middle):
        """Measures the level."""

    scene = falling_drop()
    scene.water.fluid >> scene.add("Level", "level", above=-1).fluid
    scene.save(tmp_path / "scene.json")
    written = json.loads((tmp_path / "scene.json").read_text())
    assert written["nodes"]["level"] == {"type": "Level", "params": {"above": -1}}
    for other in (weir.load(tmp_path / "scene.json"), scene.copy()):
        assert isinstance(other.level, Level) and other.level is not scene.level and other.level.above == -1
        assert other.links == scene.links
        weir.Simulation(other, device=DEVICE).advance(1)
        assert other.level.values["count"] == other.water.count
    assert "Level" in weir.schema() and "The level from which it counts." in weir.schema()
    assert "Measures the level." in pydoc.render_doc(weir.nodes.Level)
    with pytest.raises(weir.Error, match="two libraries add the node type 'Level'"):
        weir.register(Level)
    with pytest.raises(weir.Error, match=r"derives from weir\.Module or weir\.Node"):
        weir.register(dict)


def test_classes_without_a_docstring_are_registered():
    for base in (weir.Node, weir.Module):
        weir.register(type(f"Bare{base.__name__}", (base,), {}))
        assert f"Bare{base.__name__}" in weir.schema()


def test_a_copy_of_what_is_not_registered_says_so():
    with pytest.raises(weir.Error, match="no node type 'Middle'"):
        with_middle(falling_drop()).copy()


def test_help_tells_of_ports_and_state():
    text = pydoc.render_doc(weir.Node, renderer=pydoc.plaintext)
    assert "weir.Input(" in text and "Called in each step" in text and "checkpoints hold it" in text
    assert Middle.fluid.__doc__ == "What it measures." and Middle.above.__doc__ == "The level from which it counts."


def test_wrong_links_and_parameters_name_both_ends():
    scene = dam_break()
    middle = scene.add(Middle, "middle")
    with pytest.raises(weir.Error, match="'tank.boundary' and 'middle.fluid' do not fit"):
        scene.tank.boundary >> middle.fluid
    with pytest.raises(weir.Error, match="middle") as caught:
        weir.Simulation(scene, device=DEVICE)  # the input is required
    assert "fluid" in str(caught.value)
    scene.water.fluid >> middle.fluid
    with pytest.raises(weir.Error, match="middle.fluid"):
        scene.water.fluid >> middle.fluid
    with pytest.raises(weir.Error, match="did you mean 'above'") as caught:
        scene.add(Middle, "other", abov=1)
    assert caught.value.node == "other"
    with pytest.raises(weir.Error, match="did you mean 'middle'"):
        scene["midle"]
    with pytest.raises(AttributeError, match="linked"):
        middle.fluid = scene.water
    with pytest.raises(weir.Error):
        middle.above = "high"


def test_particles_are_given_in_reset_and_step_only():
    scene = raining()
    sim = weir.Simulation(scene, device=DEVICE)
    with pytest.raises(weir.Error, match="between steps"):
        scene.rain.drops.set_particles([(0, 0, 0)])
    with pytest.raises(weir.Error, match="no output of a node in Python"):
        scene.drop.particles.set_particles([(0, 0, 0)])
    with pytest.raises(weir.Error, match="no output of a node in Python"):
        scene.middle.fluid.set_particles([(0, 0, 0)])
    sim.step()


def failing(method, error, **members):
    """A class whose method raises."""

    def fails(self, *arguments):
        raise error

    return type("Fails", (weir.Node,), {method: fails, **members})


@pytest.mark.parametrize("method", ["reset", "step", "report"])
def test_exceptions_travel_and_name_the_node(method):
    scene = falling_drop()
    scene.add(failing(method, KeyError("of the node")), "bad")
    with pytest.raises(KeyError, match="of the node") as caught:
        sim = weir.Simulation(scene, device=DEVICE)
        sim.step()
        scene.bad.values
    assert caught.traceback[-1].name == "fails"
    if sys.version_info >= (3, 11):
        assert caught.value.__notes__ == [f"in {method}() of the node 'bad' (Fails)"]


def test_a_simulation_whose_node_failed_can_be_reset():
    class Late(weir.Node):
        def step(self, dt):
            if self.time > 0.05 and self.scene.world.gravity[1] < 0:
                raise ValueError("late")

    scene = falling_drop()
    scene.add(Late, "late")
    sim = weir.Simulation(scene, device=DEVICE)
    with pytest.raises(ValueError, match="late"):
        sim.run()
    with pytest.raises(weir.Error, match="failed within a step"):
        sim.step()
    scene.world.gravity = (0, 0, 0)
    sim.reset()
    sim.run()
    assert sim.done


def test_what_a_node_gives_is_checked():
    for given, words in (((np.zeros((3, 2)),), "found shape"), (([(0, 0, np.nan)],), "finite"),
                         (([(0, 0, 0)], [(0, 0, 0)] * 2), "velocities")):
        class Wrong(weir.Node):
            out = weir.Output()

            def step(self, dt):
                self.out.set_particles(*given)

        scene = falling_drop()
        scene.add(Wrong, "wrong").out >> scene.water.emitters
        with pytest.raises(weir.Error, match=words):
            weir.Simulation(scene, device=DEVICE).step()


def test_reports_are_dicts_of_numbers():
    for said, words in ((3, "'says' returns no dict of numbers: found a int"), ({"a": object()}, "'says'.*as a object"),
                        ({1: 2}, "'says'.*strings")):
        scene = falling_drop()
        scene.add(type("Says", (weir.Node,), {"report": lambda self: said}), "says")
        sim = weir.Simulation(scene, device=DEVICE)
        with pytest.raises(TypeError, match=words):
            scene.says.values
        assert "'says' returns no dict" in sim.statistics["nodes"]["says"]["error"]


def test_ports_are_checked_where_they_are_declared():
    with pytest.raises(TypeError, match="a text such as 'Particles', not 3"):
        weir.Input(3)
    with pytest.raises(TypeError, match="'time' of Wrong has the name"):
        type("Wrong", (weir.Node,), {"time": weir.Input("Particles")})()
    with pytest.raises(TypeError, match="'odd'.*begins as none of"):
        type("Odd", (weir.Node,), {"odd": weir.Param({})})()
    scene = falling_drop()
    unknown = scene.add(type("Unknown", (weir.Node,), {"fluid": weir.Input("Partickles")}), "unknown")
    with pytest.raises(weir.Error, match="the output is a Particles, the input takes a Partickles"):
        scene.water.fluid >> unknown.fluid


def test_a_cycle_is_spelled_out():
    class Both(weir.Node):
        fluid = weir.Input("Particles")
        drops = weir.Output()

    scene = falling_drop()
    both = scene.add(Both, "both")
    scene.water.fluid >> both.fluid
    with pytest.raises(weir.Error, match="water.*both"):
        both.drops >> scene.water.emitters


def test_one_object_has_one_place():
    scene, middle = falling_drop(), Middle()
    with pytest.raises(weir.Error, match="in no scene yet"):
        middle.fluid.value
    scene.add(middle, "middle")
    with pytest.raises(weir.Error, match="in a scene already"):
        scene.add(middle, "again")

    class Forgetful(weir.Node):
        def __init__(self):
            pass

    with pytest.raises(weir.Error, match="super"):
        scene.add(Forgetful, "forgetful")


def test_a_node_whose_scene_is_gone_is_harmless():
    scene = with_middle(falling_drop())
    middle, alive = scene.middle, weakref.ref(scene)
    weir.Simulation(scene, device=DEVICE).step()
    del scene
    gc.collect()
    assert alive() is None
    with pytest.raises(weir.Error):
        middle.above
