"""A simulation that is watched in a notebook, by ipywidgets, which are imported when they are asked for."""

from __future__ import annotations

import atexit
import math
import struct
import threading
import zlib
from typing import TYPE_CHECKING, Any

from ._errors import Error
from ._optional import imported

if TYPE_CHECKING:
    from ._simulation import Simulation


def png_of(picture: Any) -> bytes:
    """A PNG of an array (height, width, 3) of uint8; lines are not filtered."""
    height, width, _ = picture.shape
    lines = b"".join(b"\0" + line.tobytes() for line in picture)

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))
            + chunk(b"IDAT", zlib.compress(lines, 1)) + chunk(b"IEND", b""))


class Orbit:
    """A camera that goes round its target. Angles in degrees, relative to where the scene has the camera."""

    def __init__(self, eye: Any, target: Any, up: Any):
        import numpy

        self.target, self.up = numpy.array(target, float), numpy.array(up, float)
        self.up /= numpy.linalg.norm(self.up)
        arm = numpy.array(eye, float) - self.target
        height = float(arm @ self.up)
        across = arm - height * self.up
        self.length, self.start = float(numpy.linalg.norm(arm)), math.degrees(math.atan2(height, numpy.linalg.norm(across)))
        if numpy.linalg.norm(across) < 1e-9 * self.length:  # from straight above: any direction
            across = numpy.cross(self.up, [1, 0, 0] if abs(self.up[0]) < 0.9 else [0, 0, 1])
        self.across = across / numpy.linalg.norm(across)
        self.aside = numpy.cross(self.up, self.across)

    def camera(self, turn: float, rise: float, distance: float) -> dict[str, Any]:
        """Turned about `up`, raised, and at so many times the distance."""
        import numpy

        a, b = math.radians(turn), math.radians(max(-89.0, min(89.0, self.start + rise)))
        flat = math.cos(a) * self.across + math.sin(a) * self.aside
        eye = self.target + distance * self.length * (math.cos(b) * flat + math.sin(b) * self.up)
        return {"eye": tuple(map(float, eye)), "target": tuple(map(float, numpy.array(self.target))),
                "up": tuple(map(float, self.up))}


def orbit_of(simulation: Simulation) -> Orbit:
    """About what the scene's camera looks at; where it says nothing, about the particles that are there now, from so far
    that all are seen."""
    import numpy

    camera = simulation.scene.render.camera
    boxes = numpy.array([node["bounds"] for node in simulation.statistics["nodes"].values() if node.get("bounds")])
    if len(boxes) == 0:  # no particles yet
        boxes = numpy.array([[[-0.5] * 3, [0.5] * 3]])
    low, high = boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)
    target = numpy.array(camera.target or (low + high) / 2)
    away = max(float(numpy.linalg.norm(high - low)), 1e-6) / 2 / math.sin(math.radians(camera.fov) / 2)
    direction = numpy.array([0.55, 0.42, 0.72])
    return Orbit(camera.eye or target + away * direction / numpy.linalg.norm(direction), target, camera.up)


class LiveView:
    """What sim.view() gives: a picture of the simulation, drawn anew at each frame while it plays, with buttons and a camera.

    It plays on a thread of its own, so the notebook goes on; the simulation and its scene are the view's until pause().
    """

    def __init__(self, simulation: Simulation, width: int | None, height: int | None, samples: int):
        widgets = imported("ipywidgets", "ipywidgets")
        self._sim, self._size, self._samples = simulation, (width, height), samples
        self._orbit = None  # until the camera is moved
        self._lock, self._thread, self._playing = threading.RLock(), None, False
        self._picture = widgets.Image(format="png")
        self._state = widgets.Label()
        self._play = widgets.ToggleButton(description="Play", icon="play")
        self._step = widgets.Button(description="Step", icon="step-forward", tooltip="To the next frame")
        self._reset = widgets.Button(description="Reset", icon="refresh", tooltip="Back to time 0")
        self._turn = widgets.FloatSlider(0, min=-180, max=180, description="turn", readout_format=".0f")
        self._rise = widgets.FloatSlider(0, min=-90, max=90, description="rise", readout_format=".0f")
        self._distance = widgets.FloatSlider(1, min=0.2, max=4, step=0.05, description="distance")
        self._play.observe(lambda change: self.play() if change["new"] else self.pause(), "value")
        self._step.on_click(lambda _: self.step())
        self._reset.on_click(lambda _: self.reset())
        for slider in (self._turn, self._rise, self._distance):
            slider.observe(lambda _: self.draw(), "value")
        self.widget = widgets.VBox([self._picture, widgets.HBox([self._play, self._step, self._reset, self._state]),
                                    widgets.HBox([self._turn, self._rise, self._distance])])
        self.draw()

    def _repr_mimebundle_(self, **options: Any) -> Any:
        return self.widget._repr_mimebundle_(**options)

    @property
    def playing(self) -> bool:
        """Whether it plays."""
        return self._playing

    def play(self) -> None:
        """Go on, frame by frame, to the end of the scene's duration or until pause()."""
        if self._playing:
            return
        self.pause()  # waits for the thread of the last time
        self._playing = True
        self._play.value = True
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()
        atexit.register(self.pause)  # a step is not cut off where Python ends

    def pause(self) -> None:
        """Stop at the next step; then the simulation is the caller's again."""
        self._playing = False
        self._play.value = False
        if self._thread is not None and self._thread is not threading.current_thread():
            self._thread.join()
            self._thread = None
            atexit.unregister(self.pause)

    def step(self) -> None:
        """Go to the next frame, and stop there."""
        self.pause()
        self._guarded(lambda: self._sim.advance(1))

    def reset(self) -> None:
        """Go back to time 0."""
        self.pause()
        self._guarded(self._sim.reset)

    def draw(self) -> None:
        """Draw what is there now, as after a change of the scene."""
        self._guarded(lambda: None)

    def _guarded(self, work: Any) -> bool:
        """Does it and draws; what goes wrong is told under the picture, as nobody would see it otherwise."""
        try:
            with self._lock:
                work()
                self._draw()
            return True
        except Error as error:
            self._state.value = str(error)
            return False

    def _camera(self) -> dict[str, Any] | None:
        """None for the scene's own, until a slider is moved."""
        moved = self._turn.value, self._rise.value, self._distance.value
        if moved == (0, 0, 1):
            return None
        if self._orbit is None:
            self._orbit = orbit_of(self._sim)
        return self._orbit.camera(*moved) | {"fov": float(self._sim.scene.render.camera.fov)}

    def _draw(self) -> None:
        camera = self._camera()
        self._picture.value = png_of(self._sim.render(*self._size, camera=camera, samples=self._samples))
        self._state.value = f"{self._sim.time:.3g} s of {self._sim.duration:.3g} s, frame {self._sim.frame}"

    def _run(self) -> None:
        while self._playing and not self._sim.done:
            if not self._guarded(lambda: self._sim.advance(1, lambda _: not self._playing)):
                break
        self._playing = False
        self._play.value = False
