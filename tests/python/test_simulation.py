"""Simulations in Python: steps, runs, callbacks, interruptions, threads."""

import json
import logging
import os
import signal
import subprocess
import sys
import threading

import numpy as np
import pytest

import weir
from conftest import dam_break, falling_drop


def test_time_passes(sim):
    assert (sim.time, sim.frame, sim.steps, sim.done) == (0, 0, 0, False)
    sim.step()
    assert sim.steps == 1 and 0 < sim.time <= 0.001
    assert sim.advance() is True
    assert sim.frame == 1 and sim.time == pytest.approx(1 / 30)
    assert sim.run() is True
    assert sim.time == pytest.approx(0.2) and sim.done
    with pytest.raises(weir.Error, match="at its end"):
        sim.step()
    with pytest.raises(weir.Error, match="0 to 0"):
        sim.advance()
    sim.duration = 0.3
    assert sim.advance(frames=2) and sim.time == pytest.approx(8 / 30)
    with pytest.raises(weir.Error, match="simulated already"):
        sim.duration = 0.1


def test_steps_advances_and_runs_are_the_same_bit_for_bit():
    results = []
    for how in ("step", "advance", "run"):
        scene = dam_break(duration=0.1)
        sim = weir.Simulation(scene, device="cpu")
        if how == "step":
            while not sim.done:
                sim.step()
        elif how == "advance":
            sim.advance(3)
        else:
            sim.run()
        results.append(scene.water.positions.copy())
    assert np.array_equal(results[0], results[1]) and np.array_equal(results[0], results[2])


def test_a_duration_with_a_rest_is_met():
    sim = weir.Simulation(dam_break(duration=0.05), device="cpu")
    while not sim.done:
        sim.step()
    assert sim.time == pytest.approx(0.05) and sim.frame == 1
    sim.reset()
    sim.run()
    assert sim.time == pytest.approx(0.05) and sim.done


def test_runs_go_on_and_write_what_they_are_asked_for(sim, scene, tmp_path):
    scene.water.velocities[:, 0] += 1
    sim.step()
    sim.run(duration=0.05, series=tmp_path / "first.jsonl")
    sim.run(duration=0.5, series=tmp_path / "second.jsonl")  # longer than the scene's
    first, second = ([json.loads(line)["frame"] for line in (tmp_path / name).read_text().splitlines()]
                     for name in ("first.jsonl", "second.jsonl"))
    assert first == [1, 2] and second[0] == 2 and second[-1] == sim.frame == 17
    assert scene.world.duration == pytest.approx(17 / 30)
    if "export" in weir._library.library.outputs():
        sim.run(duration=0.1, export=tmp_path / "out.vtkhdf")
        assert (tmp_path / "out.vtkhdf").stat().st_size > 1000


def test_wrong_outputs_are_refused(sim, tmp_path):
    with pytest.raises(weir.Error, match="there is no output 'vidoe'"):
        sim.run(vidoe=tmp_path / "a.mp4")
    with pytest.raises(weir.Error, match=r"\.jsonl"):
        sim.run(series=tmp_path / "a.txt")
    with pytest.raises(weir.Error, match="there is no folder"):
        sim.run(series=tmp_path / "nowhere" / "a.jsonl")
    assert sim.steps == 0


def test_callbacks(sim):
    times = []
    assert sim.advance(1, callback=lambda s: times.append(s.time)) is True
    assert len(times) == sim.steps and times == sorted(times)
    assert sim.run(callback=lambda s: s.steps == 60) is False
    assert sim.steps == 60
    sim.run()
    assert sim.done


def test_an_exception_of_a_callback_leaves_the_simulation_usable(sim, tmp_path):
    def fail(s):
        if s.steps == 50:
            raise ZeroDivisionError("of the callback")

    with pytest.raises(ZeroDivisionError, match="of the callback") as caught:
        sim.run(callback=fail, series=tmp_path / "a.jsonl")
    assert "fail" in [entry.name for entry in caught.traceback]
    assert len((tmp_path / "a.jsonl").read_text().splitlines()) == 2  # complete up to there
    assert sim.steps == 50
    with pytest.raises(ZeroDivisionError):
        sim.advance(1, callback=lambda s: 1 / 0)
    sim.run()
    assert sim.done


def test_steps_within_callbacks_are_refused(sim):
    with pytest.raises(weir.Error, match="within a step"):
        sim.advance(1, callback=lambda s: s.step())
    with pytest.raises(weir.Error, match="within a step"):
        sim.advance(1, callback=lambda s: s.close())
    sim.step()


def test_control_c_ends_a_run_with_its_outputs(tmp_path):
    script = """
import os, signal, sys
sys.path.insert(0, sys.argv[1])
import weir
from conftest import dam_break
sim = weir.Simulation(dam_break(duration=1000), device="cpu")
def interrupt(s):
    if s.steps == 100:
        os.kill(os.getpid(), signal.SIGINT)
try:
    sim.run(series=sys.argv[2], callback=interrupt)
except KeyboardInterrupt:
    print(sim.steps)
    sim.step()
    print(sim.steps)
"""
    found = subprocess.run([sys.executable, "-B", "-c", script, os.path.dirname(__file__), tmp_path / "a.jsonl"],
                           capture_output=True, text=True, timeout=60)
    assert found.stdout.split() in (["100", "101"], ["101", "102"]), found.stderr
    assert len((tmp_path / "a.jsonl").read_text().splitlines()) == 3


def test_other_threads_run_and_are_kept_out():
    scene = dam_break(duration=5)
    sim = weir.Simulation(scene, device="cpu")
    refused, counted, stop = [], [0], threading.Event()

    def look():
        while not stop.is_set():
            counted[0] += 1
            try:
                scene.water.positions
            except weir.Error as error:
                refused.append(str(error))

    thread = threading.Thread(target=look)
    thread.start()
    while len(refused) < 3 and sim.frame < 100:
        sim.advance()
    stop.set()
    thread.join()
    assert counted[0] > 0 and "another thread is stepping" in refused[0]
    assert scene.water.positions.shape[1] == 3


def test_worlds_run_side_by_side():
    alone = dam_break()
    weir.Simulation(alone, device="cpu", threads=1).run()
    scenes = [dam_break() for _ in range(3)]
    threads = [threading.Thread(target=lambda s=s: weir.Simulation(s, device="cpu", threads=1).run()) for s in scenes]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for scene in scenes:
        assert np.array_equal(scene.water.positions, alone.water.positions)


def test_a_newer_simulation_takes_the_scene(sim, scene):
    sim.advance(2)
    moved = scene.water.positions.copy()
    again = weir.Simulation(scene, device="cpu", threads=2)
    assert again.time == 0 and not np.array_equal(scene.water.positions, moved)
    with pytest.raises(weir.Error, match="closed"):
        sim.step()
    assert "closed" in repr(sim)
    again.advance(2)
    assert np.array_equal(scene.water.positions, moved)
    with pytest.raises(weir.Error, match="copy"):
        weir.Simulation(scene, device="cpu", threads=1)
    copy = weir.Simulation(scene.copy(), device="cpu", threads=1)
    copy.advance(2)
    assert np.array_equal(copy.scene.water.positions, moved)


def test_close(sim, scene):
    with sim:
        sim.step()
    with pytest.raises(weir.Error, match="closed"):
        sim.time
    assert scene.water.positions.shape[1] == 3
    scene.water.spacing = 0.1
    assert weir.Simulation(scene, device="cpu", threads=2).time == 0


def test_changes_that_take_a_reset(sim, scene):
    sim.step()
    scene.world.gravity = (0, 0, 0)
    scene.water.modules["solver"].max_iterations = 500
    sim.step()
    scene.water.spacing = 0.08
    with pytest.raises(weir.Error, match="water.spacing") as caught:
        sim.step()
    assert "reset" in caught.value.allowed
    before = scene.water.count
    sim.reset()
    assert scene.water.count < before
    scene.world.dt = 0.01
    sim.reset()
    sim.step()
    assert sim.time == pytest.approx(1 / 120)


def test_gravity_may_change_between_steps():
    scene = falling_drop()
    sim = weir.Simulation(scene, device="cpu")
    for gravity in (-10, 0, 20):
        scene.world.gravity = (0, gravity, 0)
        sim.step()
    assert scene.water.velocities[:, 1] == pytest.approx(0.01 * 10, abs=1e-6)


def test_statistics(sim):
    sim.advance(2)
    statistics = sim.statistics
    assert statistics["steps"] == sim.steps and statistics["end"] == "interrupted"
    assert statistics["nodes"]["water"]["particles_escaped"] == 0
    sim.run()
    assert sim.statistics["end"] == "finished"


def test_messages_go_to_logging(caplog):
    scene = dam_break()
    scene.world.dt = 0.02
    scene.world.gravity = (0, -9000, 0)  # far too much for such steps
    with caplog.at_level(logging.DEBUG, logger="weir"):
        weir.Simulation(scene, device="cpu")
    assert any("memory: up to" in record.message and record.levelno == logging.INFO for record in caplog.records)
    assert any(record.levelno == logging.WARNING for record in caplog.records)
    assert {record.name for record in caplog.records} == {"weir"}


def test_devices():
    names = [name for name, _ in weir.devices()]
    assert "cpu" in names
    with pytest.raises(weir.Error, match="warp"):
        weir.Simulation(dam_break(), device="warp")
    with pytest.raises(weir.Error, match="threads"):
        weir.Simulation(dam_break(), device="cpu", threads=-1)
    if not any(name.startswith("cuda") for name in names):
        with pytest.raises(weir.Error):
            weir.Simulation(dam_break(), device="cuda")


def test_a_scene_file_is_a_scene(scene, tmp_path):
    scene.save(tmp_path / "dam.json")
    sim = weir.Simulation(tmp_path / "dam.json", device="cpu")
    assert sim.scene.water.count > 100
    with pytest.raises(weir.Error, match="path of a scene file"):
        weir.Simulation(3)


def test_signals_between_steps():
    sim = weir.Simulation(dam_break(), device="cpu")
    heard = []
    before = signal.signal(signal.SIGUSR1, lambda *_: heard.append(sim.steps))
    try:
        sim.advance(1, callback=lambda s: s.steps == 5 and os.kill(os.getpid(), signal.SIGUSR1))
    finally:
        signal.signal(signal.SIGUSR1, before)
    assert heard and heard[0] in (5, 6)
