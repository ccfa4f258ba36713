"""Simulations: scenes in time."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from typing import Any

from . import _core
from ._errors import usage_error
from ._scene import Scene, as_scene


class Simulation:
    """Runs a scene on one device.

        sim = weir.Simulation(scene)
        while sim.time < 1:
            sim.step()
            print(scene.water.positions[:, 1].max())

    It begins at time 0, with the particles that are there at first. A scene has one simulation at a time: another
    one of the same scene begins anew, and closes the one before. Other threads of Python run while it steps.
    """

    def __init__(self, scene: Scene | str | os.PathLike, device: str = "auto", threads: int | None = None,
                 deterministic: bool = False):
        """`device` is "auto" (a GPU if there is one), "cpu", "cuda" or "cuda:N"; `threads` those of the CPU, one a
        core if it is left out; `deterministic` makes results on CUDA bitwise the same from run to run."""
        self._scene = as_scene(scene)
        self._core = _core.Simulation(self._scene._core, device, threads or 0, deterministic)

    @property
    def scene(self) -> Scene:
        """What is simulated."""
        return self._scene

    def step(self) -> None:
        """Make one step."""
        self._core.step()

    def advance(self, frames: int = 1, callback: Callable[[Simulation], Any] | None = None) -> bool:
        """Step to the next frame, or over several.

        `callback` is called with the simulation after each step, and ends this by returning True; then the
        result is False.
        """
        return self._core.advance(frames, callback, self)

    def run(self, duration: float | None = None, *, video: str | os.PathLike | None = None,
            images: str | os.PathLike | None = None, export: str | os.PathLike | None = None,
            series: str | os.PathLike | None = None, checkpoint: str | os.PathLike | None = None,
            checkpoint_every: int | str = "600s", resume: str | os.PathLike | None = None,
            callback: Callable[[Simulation], Any] | None = None, **outputs: str | os.PathLike | None) -> bool:
        """Simulate from where it is to the end of the scene's duration, or for `duration` seconds.

        Every frame, the present one included, is drawn into `video` (FILE.mp4) and `images` (a folder), exported
        to `export` (FILE.vtkhdf), and described by numbers in `series` (FILE.jsonl). Outputs of plugins are named
        in the same way. With `duration` the run ends at a frame, and makes the scene's duration longer if need be.
        `callback` is called with the simulation after each step, and ends the run by returning True; then the
        result is False. After Ctrl-C, or an exception of the callback, outputs are complete up to there.

        `checkpoint` (FILE.h5) saves the state at every n frames, or seconds as "90s". `resume` goes on from
        such a file of the same scene, not from where the simulation is, and outputs go on behind what they had.
        """
        asked = {"video": video, "images": images, "export": export, "series": series, **outputs}
        paths = {name: os.fspath(path) for name, path in asked.items() if path is not None}
        return self._core.run(duration, paths, os.fspath(checkpoint or ""), str(checkpoint_every),
                              os.fspath(resume or ""), callback, self)

    def reset(self) -> None:
        """Go back to time 0, with all parameters as they are now."""
        self._core.reset()

    def refresh(self) -> None:
        """Bring derived attributes, such as the density, and statistics up to date with the last step, as they are
        at every frame. Sorts the particles."""
        self._core.refresh()

    def save(self, path: str | os.PathLike) -> None:
        """Write a checkpoint (FILE.h5), as run(checkpoint=…) and the command do, of the frame where it is; between two
        frames that is an Error. Attributes of particles and the state of modules are in it."""
        self._core.save(os.fspath(path))

    @classmethod
    def resume(cls, scene: Scene | str | os.PathLike, path: str | os.PathLike, device: str = "auto",
               threads: int | None = None, deterministic: bool = False) -> Simulation:
        """A simulation that goes on from a checkpoint of the same scene, as if it had never ended. The checkpoint may
        be one of save(), of run() or of the command `weir run --checkpoint`."""
        made = cls(scene, device, threads, deterministic)
        made._core.resume(os.fspath(path))
        return made

    def render(self, width: int | None = None, height: int | None = None, *, camera: Mapping[str, Any] | None = None,
               samples: int = 2) -> Any:
        """Draw what is there now, without a screen: an array (height, width, 3) of uint8, red, green and blue.

        The picture is as scene.render says, with its size and camera where none are given here. `camera` is
        {"eye": (x, y, z), "target": (x, y, z)} in m, with "up" and, in degrees, "fov" if need be. `samples` per axis of
        a pixel are 1 (fast, jagged) to 4. All is brought up to date for it, as by refresh().
        """
        from ._picture import camera_of, size_of

        width, height = size_of(self._scene, width, height)
        if samples not in (1, 2, 3, 4):
            raise usage_error(f"found samples={samples!r}", "1, 2, 3 or 4")
        return self._core.render(width, height, int(samples), camera_of(self._scene, camera))

    def view(self, width: int | None = None, height: int | None = None, *, samples: int = 1) -> Any:
        """A live view for notebooks: a picture as of render(), with buttons that play, step and reset, and sliders that
        move the camera about its target. Needs ipywidgets. It plays beside the notebook, on a thread of its own;
        view.pause() gives the simulation back."""
        from ._view import LiveView

        return LiveView(self, width, height, samples)

    def to_pyvista(self) -> Any:
        """A pyvista.MultiBlock of what is there now, with a block for each node that has particles or a mesh: particles
        with their attributes, surfaces of fluids with velocities, solids where they are. Needs PyVista."""
        from ._pyvista import blocks

        self._core.refresh()
        return blocks(self._scene)

    def close(self) -> None:
        """End it. The scene, and arrays of particles, remain."""
        self._core.close()

    def __enter__(self) -> Simulation:
        return self

    def __exit__(self, *args: object) -> None:
        self.close()

    @property
    def time(self) -> float:
        """Simulated time, s."""
        return self._core.time

    @property
    def duration(self) -> float:
        """When it ends, s; may be set at any time."""
        return self._core.duration

    @duration.setter
    def duration(self, seconds: float) -> None:
        self._core.duration = seconds

    @property
    def done(self) -> bool:
        """Whether the end of the duration is reached."""
        return self._core.at_end

    @property
    def frame(self) -> int:
        """The last frame that was reached; frame k is at time k / frame_rate."""
        return self._core.frame

    @property
    def steps(self) -> int:
        """How many steps were made."""
        return self._core.steps

    @property
    def device(self) -> str:
        """ "cpu" or "cuda:0"."""
        return self._core.device

    @property
    def stream(self) -> int:
        """The CUDA stream of the simulation, as a number; 0 on the CPU."""
        return self._core.stream

    @property
    def statistics(self) -> dict[str, Any]:
        """Numbers about the run, as `weir run --stats` writes them: times, memory, momentum, energies, …"""
        return self._core.statistics()

    def __repr__(self) -> str:
        if not self._core.is_open:
            return "<Simulation, closed>"
        return f"<Simulation of {self._scene.title!r} on {self.device} at {self.time:g} s of {self.duration:g} s>"
