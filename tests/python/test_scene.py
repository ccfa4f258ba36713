"""Scenes in Python: parameters, links, modules, files."""

import json
import os
import pydoc

import numpy as np
import pytest

import weir
from conftest import dam_break


def test_parameters_are_attributes(scene):
    assert scene.water.spacing == 0.05
    scene.water.spacing = np.float64(0.04)
    assert scene["water"].spacing == 0.04
    scene.block.max = np.array([0.5, 0.25, 0.5])
    assert scene.block.max == (0.5, 0.25, 0.5)
    scene.world.gravity = (0, -1, 0)
    assert scene.world.gravity == (0, -1, 0)
    assert scene.tank.inverted is True and scene.tank.shape == "box"
    assert scene.water.mu is None


@pytest.mark.parametrize(
    ("name", "value", "found"),
    [("spacing", -1, "found -1"), ("spacing", "thin", 'found "thin"'), ("calibration", "none", 'found "none"'),
     ("rest_steps", 1.5, "found 1.5"), ("spacing", [1, 2], "found [1, 2]"), ("spacing", float("nan"), "found nan")])
def test_a_wrong_value_is_refused_as_in_a_file(scene, name, value, found):
    before = getattr(scene.water, name)
    with pytest.raises(weir.Error) as caught:
        setattr(scene.water, name, value)
    error = caught.value
    assert error.kind == "scene" and error.node == "water" and error.parameter == name
    assert found in error.found and error.allowed
    assert str(error).startswith(error.where + ": " + error.found)
    assert getattr(scene.water, name) == before
    # The same text as from a file, but for the file.
    if not (isinstance(value, float) and value != value):
        text = json.loads(scene.to_json())
        text["nodes"]["water"]["params"][name] = value
        with pytest.raises(weir.Error) as from_file:
            weir.loads(json.dumps(text))
        assert str(from_file.value).endswith(str(error))


def test_a_wrong_name_is_refused_with_a_suggestion(scene):
    with pytest.raises(weir.Error, match="did you mean 'spacing'"):
        scene.water.spacin = 0.1
    with pytest.raises(AttributeError):
        scene.water.spacin
    with pytest.raises(weir.Error, match="did you mean 'ParticleFluid'"):
        scene.add("ParticleFluit", "more")
    with pytest.raises(weir.Error, match="did you mean 'water'"):
        scene["watre"]
    with pytest.raises(weir.Error, match="did you mean 'solver'"):
        scene.water.modules["solvr"]
    with pytest.raises(weir.Error, match="two nodes 'water'"):
        scene.add("ParticleFluid", "water")


def test_a_value_of_no_kind_of_weir_is_a_type_error(scene):
    with pytest.raises(TypeError, match="object"):
        scene.water.spacing = object()
    with pytest.raises(TypeError, match="strings"):
        scene.water.set(**{"spacing": {1: 2}})


def test_several_at_once_are_all_or_none(scene):
    with pytest.raises(weir.Error):
        scene.water.set(spacing=0.03, rest_density=-5)
    assert scene.water.spacing == 0.05 and scene.water.rest_density == 1000


def test_links(scene):
    assert scene.links == ["block.particles -> water.initial", "tank.boundary -> water.boundaries"]
    wall = scene.add(weir.nodes.StaticBoundary, "wall", shape="sphere", radius=0.1)
    scene.link("wall.boundary", scene.water.boundaries)
    assert scene.links[-1] == "wall.boundary -> water.boundaries"
    with pytest.raises(weir.Error, match="Boundary"):
        wall.boundary >> scene.water.initial
    with pytest.raises(weir.Error, match="another scene"):
        wall.boundary >> dam_break().water.boundaries
    with pytest.raises(TypeError):
        wall.boundary >> scene.water


def test_modules_are_parametrised_disabled_inserted_and_replaced(scene):
    modules = scene.water.modules
    assert list(modules)[:2] == ["predict", "approach"] and "solver" in modules and len(modules) == 8
    modules["solver"].iterations = 5
    modules["viscosity"].enabled = False
    modules.insert("tension", "SurfaceTension", after="viscosity", coefficient=0.07)
    modules.replace("solver", weir.modules.Pbf, iterations=7)
    written = json.loads(scene.to_json())["nodes"]["water"]["modules"]
    assert written["viscosity"] == {"enabled": False}
    assert written["tension"] == {"type": "SurfaceTension", "after": "viscosity", "params": {"coefficient": 0.07}}
    assert written["solver"] == {"type": "Pbf", "params": {"iterations": 7}}
    with pytest.raises(weir.Error, match="at least"):
        modules["solver"].iterations = -1
    with pytest.raises(weir.Error, match="neither"):
        modules.insert("other", "SurfaceTension")
    with pytest.raises(weir.Error, match="two modules"):
        modules.insert("tension", "SurfaceTension", before="solver")
    with pytest.raises(weir.Error, match="did you mean 'Drag'"):
        modules.insert("drag", "Darg", before="solver")


def test_parameters_that_moved_make_the_solver_the_other_one(scene):
    modules = scene.water.modules
    modules["solver"].iterations = 40
    modules["solver"].tolerance = 0.01
    written = json.loads(scene.to_json())["nodes"]["water"]["modules"]["solver"]
    assert written == {"params": {"tolerance": 0.01, "max_iterations": 40, "acceleration": "none"}}
    modules["solver"].acceleration = "nesterov"
    assert modules["solver"].acceleration == "nesterov"
    modules.replace("solver", weir.modules.SemiImplicitSolver, tolerance=0.02)
    assert modules["solver"].tolerance == pytest.approx(0.02)
    modules.replace("solver", weir.modules.SemiImplicitSolver, path_stages=4)
    assert "AcceleratedSolver" not in scene.to_json()


def test_sections_and_groups(scene):
    if "render" not in dir(scene):
        pytest.skip("the plugin that draws pictures is not there")
    scene.render.camera.eye = (1, 2, 3)
    scene.render.camera = {"fov": 30}
    assert scene.render.camera.eye == (1, 2, 3) and scene.render.camera.fov == 30
    with pytest.raises(weir.Error, match="did you mean 'fov'"):
        scene.render.camera.fow = 3
    assert json.loads(scene.to_json())["render"]["camera"] == {"eye": [1, 2, 3], "fov": 30}


def test_keyframes(scene):
    scene.world.gravity = weir.keyframes((0, (0, -9.8, 0)), (1, (0, 0, 0)))
    assert scene.world.gravity == {"keyframes": ((0, (0, -9.8, 0)), (1, (0, 0, 0)))}
    with pytest.raises(weir.Error):
        scene.world.gravity = weir.keyframes((1, (0, 0, 0)), (0, (0, 0, 0)))


def test_a_saved_scene_reads_back(scene, tmp_path):
    scene.water.modules["solver"].iterations = 4
    scene.save(tmp_path / "dam.json")
    again = weir.load(tmp_path / "dam.json", set={"water.spacing": 0.03})
    assert again.water.spacing == 0.03
    assert again.water.modules["solver"].iterations == 4
    assert weir.loads(scene.to_json()).to_json() == scene.to_json() == scene.copy().to_json()


def test_paths_lead_to_the_same_file_from_another_folder(tmp_path, monkeypatch):
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    (tmp_path / "a" / "drops.csv").write_text("x,y,z\n0,0,0\n")
    monkeypatch.chdir(tmp_path / "a")
    scene = weir.Scene()
    scene.add("ParticleFile", "drops", file="drops.csv")
    monkeypatch.chdir(tmp_path)
    scene.save("b/scene.json")
    assert json.loads((tmp_path / "b/scene.json").read_text())["nodes"]["drops"]["params"]["file"] == str(
        tmp_path / "a" / "drops.csv")
    (tmp_path / "a" / "scene.json").write_text(
        '{"weir": 1, "nodes": {"drops": {"type": "ParticleFile", "params": {"file": "drops.csv"}}}}')
    read = weir.load("a/scene.json")
    assert read.drops.file == "drops.csv"
    read.save("a/again.json")
    read.save("b/again.json")
    assert '"drops.csv"' in (tmp_path / "a/again.json").read_text()
    written = json.loads((tmp_path / "b/again.json").read_text())["nodes"]["drops"]["params"]["file"]
    assert os.path.samefile(written, tmp_path / "a" / "drops.csv")
    assert os.path.samefile(read.copy().drops.file, tmp_path / "a" / "drops.csv")
    of_text = weir.loads(read.to_json(), folder="a")
    of_text.save("b/of_text.json")
    assert weir.load("b/of_text.json").drops.file == written


def test_a_broken_file_says_where(tmp_path):
    (tmp_path / "broken.json").write_text('{\n  "weir": 1,\n  "nodes": {"a": {"type": "Nothing"}}\n}')
    with pytest.raises(weir.Error) as caught:
        weir.load(tmp_path / "broken.json")
    assert caught.value.file.endswith("broken.json") and caught.value.line == 3
    with pytest.raises(weir.Error) as caught:
        weir.load(tmp_path / "missing.json")
    assert caught.value.kind == "io"


def test_types_explain_themselves(scene):
    assert {"spacing", "modules", "boundaries", "positions"} <= set(dir(scene.water))
    assert {"water", "tank", "world"} <= set(dir(scene))
    text = pydoc.plain(pydoc.render_doc(weir.nodes.ParticleFluid))
    assert "Distance of particles at rest" in text and "float [m]" in text
    assert "Solids and containers" in text
    assert "iterations" in weir.modules.SemiImplicitSolver.__doc__
    assert "ParticleFluid" in dir(weir.nodes)
    with pytest.raises(AttributeError):
        weir.nodes.Nothing


def test_an_incomplete_scene_is_refused():
    scene = weir.Scene()
    scene.add("MeshSampler", "inside")
    with pytest.raises(weir.Error, match="inside.surface"):
        scene.validate()
    with pytest.raises(weir.Error, match="inside.surface"):
        weir.Simulation(scene, device="cpu")
