"""Pictures as arrays, and what PyVista gets."""

import struct
import sys
import time
import zlib

import numpy as np
import pytest

import weir
from conftest import dam_break


def drawn(sim: weir.Simulation, *args, **options) -> np.ndarray:
    try:
        return sim.render(*args, **options)
    except weir.Error as error:
        if error.kind == "io":
            pytest.skip(f"this machine cannot draw: {error}")
        raise


def read_png(path) -> np.ndarray:
    """A PNG of 8 bits a colour: the filters of its lines are undone one by one."""
    data, at, packed, size = path.read_bytes(), 8, b"", None
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at : at + 8])
        body = data[at + 8 : at + 8 + length]
        if kind == b"IHDR":
            size = struct.unpack(">IIBB", body[:10])
        packed += body if kind == b"IDAT" else b""
        at += 12 + length
    width, height, depth, colors = size
    assert depth == 8 and colors in (2, 6)
    n = 3 if colors == 2 else 4
    lines = np.frombuffer(zlib.decompress(packed), np.uint8).reshape(height, 1 + n * width)
    picture = np.zeros((height, n * width), int)
    for y, line in enumerate(lines):
        above = picture[y - 1] if y > 0 else np.zeros(n * width, int)
        for x in range(n * width):
            a, b = (picture[y, x - n] if x >= n else 0), above[x]
            c = above[x - n] if x >= n else 0
            p = a + b - c
            nearest = min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]
            picture[y, x] = (int(line[1 + x]) + (0, a, b, (a + b) // 2, nearest)[line[0]]) % 256
    return picture.reshape(height, width, n)[:, :, :3].astype(np.uint8)


def test_a_picture_is_an_array():
    scene = dam_break()
    sim = weir.Simulation(scene, device="cpu")
    picture = drawn(sim, 160, 90)
    assert picture.dtype == np.uint8 and picture.shape == (90, 160, 3) and picture.flags.c_contiguous
    assert picture.std() > 5  # it shows something
    assert np.array_equal(picture, sim.render(160, 90))
    sim.advance(3)
    assert not np.array_equal(picture, sim.render(160, 90))
    scene.render.set(width=64, height=48)
    assert sim.render().shape == (48, 64, 3) and sim.render(width=32).shape == (24, 32, 3)


def test_it_is_the_picture_of_a_file(tmp_path):
    scene = dam_break()
    scene.render.set(width=96, height=64)
    sim = weir.Simulation(scene, device="cpu")
    drawn(sim, 8, 8)
    sim.run(duration=0, images=tmp_path)
    (file,) = tmp_path.iterdir()
    assert np.array_equal(sim.render(), read_png(file))


def test_the_camera_looks_where_it_is_told_to():
    scene = dam_break()
    sim = weir.Simulation(scene, device="cpu")
    usual = drawn(sim, 120, 80)
    away = sim.render(120, 80, camera={"eye": (0.2, 0.2, 5), "target": (0.2, 0.2, 20)})
    near = sim.render(120, 80, camera={"eye": (0.2, 0.2, 1.5), "target": (0.2, 0.2, 0), "fov": 20})
    assert near.std() > 5 > away.std() or away.std() < near.std()
    assert np.array_equal(usual, sim.render(120, 80))  # the scene's again


@pytest.mark.parametrize("options, found", [
    ({"width": 0}, "found width=0"), ({"height": 20000}, "found height=20000"), ({"samples": 5}, "found samples=5"),
    ({"camera": {"eye": (0, 0, 1)}}, "there is no 'target'"), ({"camera": {"eye": (0, 0), "target": (1, 1, 1)}}, "found eye=(0, 0)"),
    ({"camera": {"ey": 1}}, "found 'ey'"), ({"camera": {"eye": (0, 0, 1), "target": (0, 0, 0), "fov": 180}}, "found fov=180"),
])
def test_what_cannot_be_drawn_is_refused(sim, options, found):
    with pytest.raises(weir.Error) as raised:
        sim.render(**options)
    assert raised.value.found == found and raised.value.allowed


def test_a_camera_that_looks_nowhere_spoils_nothing(sim):
    before = drawn(sim, 32, 24)
    with pytest.raises(weir.Error):
        sim.render(32, 24, camera={"eye": (1, 1, 1), "target": (1, 1, 1)})
    assert np.array_equal(sim.render(32, 24), before)
    sim.step()


def test_without_pyvista_a_sentence_says_so(sim, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyvista", None)
    with pytest.raises(weir.Error, match="PyVista cannot be imported") as raised:
        sim.to_pyvista()
    assert raised.value.hint == "pip install pyvista"


def test_pyvista_gets_particles_surfaces_and_solids():
    pytest.importorskip("pyvista")
    scene = dam_break()
    scene.water.fluid >> scene.add("FluidSurface", "skin").fluid
    wall = scene.add("BoxMesh", "wall", min=(0.7, 0, 0), max=(0.8, 0.3, 0.4))
    solid = scene.add("SemiAnalyticalSFI", "solid", velocity=(1, 0, 0))
    wall.surface >> solid.solids
    scene.water.fluid >> solid.fluid
    sim = weir.Simulation(scene, device="cpu")
    sim.advance(2)
    blocks = sim.to_pyvista()
    assert blocks.keys() == ["water", "skin", "wall"]
    assert np.array_equal(blocks["water"].points, scene.water.positions)
    assert np.array_equal(blocks["water"]["density"], scene.water.particles["density"])
    mesh = scene.skin.surface.value
    assert np.array_equal(blocks["skin"].faces.reshape(-1, 4)[:, 1:], mesh.faces) and blocks["skin"].n_open_edges == 0
    assert np.array_equal(blocks["skin"]["velocity"], mesh.velocities)
    assert blocks["wall"].bounds[0] == pytest.approx(0.7 + sim.time, abs=1e-5)


def view_of(scene, **options):
    pytest.importorskip("ipywidgets")
    sim = weir.Simulation(scene, device="cpu")
    drawn(sim, 32, 24)
    return sim, sim.view(64, 48, **options)


def picture_in(view, path) -> np.ndarray:
    path.write_bytes(view.widget.children[0].value)
    return read_png(path)


def test_a_view_draws_what_render_draws(tmp_path):
    sim, view = view_of(dam_break())
    expected = sim.render(64, 48, samples=1)
    assert (picture_in(view, tmp_path / "a.png") == expected).all()
    turn, rise, distance = view.widget.children[2].children
    turn.value = 90
    assert (picture_in(view, tmp_path / "b.png") != expected).any(axis=2).sum() > 100
    turn.value = 0
    assert (picture_in(view, tmp_path / "c.png") == expected).all()


def test_the_camera_of_a_view_goes_round_what_the_scene_looks_at(tmp_path):
    scene = dam_break()
    scene.render.camera.eye, scene.render.camera.target = (2, 1.5, 0.25), (0.5, 0.5, 0.25)
    sim, view = view_of(scene)
    turn, rise, distance = view.widget.children[2].children
    turn.value, distance.value = 90, 2
    there = {"eye": (0.5, 2.5, 0.25 - 3), "target": (0.5, 0.5, 0.25), "up": (0, 1, 0), "fov": scene.render.camera.fov}
    expected = sim.render(64, 48, samples=1, camera=there)
    # Angles round, so an edge may fall on the other side of a pixel.
    assert (picture_in(view, tmp_path / "a.png") != expected).any(axis=2).sum() <= 6


def test_a_view_steps_plays_pauses_and_resets(tmp_path):
    scene = dam_break()
    scene.world.duration = 4 / scene.world.frame_rate
    sim, view = view_of(scene)
    first = picture_in(view, tmp_path / "a.png")
    play, step, reset, state = view.widget.children[1].children
    step.click()
    assert sim.frame == 1 and "frame 1" in state.value
    play.value = True
    view._thread.join()
    assert sim.done and not view.playing and not play.value and "frame 4" in state.value
    assert (picture_in(view, tmp_path / "b.png") != first).any()
    reset.click()
    assert sim.frame == 0 and (picture_in(view, tmp_path / "c.png") == first).all()


def test_a_view_that_is_paused_gives_the_simulation_back():
    scene = dam_break()
    scene.world.duration = 100
    sim, view = view_of(scene)
    view.play()
    state = view.widget.children[1].children[3]
    while state.value.endswith("frame 0") and view.playing:
        time.sleep(0.01)
    view.pause()
    stood = sim.steps
    assert stood > 0 and not view.playing
    sim.step()
    assert sim.steps == stood + 1


def test_a_view_tells_what_goes_wrong_under_the_picture():
    sim, view = view_of(dam_break())
    sim.close()
    view.step()
    state = view.widget.children[1].children[3]
    assert "closed" in state.value and not view.playing


def test_without_ipywidgets_it_says_how_to_get_them(monkeypatch):
    monkeypatch.setitem(sys.modules, "ipywidgets", None)
    with pytest.raises(weir.Error, match="pip install ipywidgets"):
        weir.Simulation(dam_break(), device="cpu").view()
