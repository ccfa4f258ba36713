"""Weir: a node-graph framework for simulating liquids, on CPUs and CUDA.

    import weir

    scene = weir.load("dam_break.json")
    weir.Simulation(scene).run(duration=2, video="dam_break.mp4")

Scene builds and reads scenes, Simulation runs them, and `scene.water.positions` and its like are the particles as
arrays that share memory with the simulation. Module and Node are the bases of modules and nodes that are written in
Python. All node and module types explain themselves: `help(weir.nodes.ParticleFluid)`, `help(weir.modules.SemiImplicitSolver)`.
Messages go to the logger "weir" of Python's logging.
"""

from . import modules, nodes
from ._core import DeviceArray, FluidStep, Particles
from ._errors import Error
from ._library import devices, load_plugin, plugins, schema, version
from ._module import Module
from ._motion import motion
from ._node import Input, Node, Output
from ._nodes import ModuleHandle, Modules, NodeHandle, Port
from ._part import Param, register
from ._results import BodyMotion, Mesh, ParticleArrays, Pose, SolidForce, Walls
from ._scene import Scene, Section, keyframes, load, loads
from ._simulation import Simulation

__version__ = version()
__all__ = ["BodyMotion", "DeviceArray", "Error", "FluidStep", "Input", "Mesh", "Module", "ModuleHandle", "Modules", "Node",
           "NodeHandle", "Output", "Param", "ParticleArrays", "Particles", "Port", "Pose", "Scene", "Section", "Simulation",
           "SolidForce", "Walls", "devices", "keyframes", "load", "load_plugin", "loads", "modules", "motion", "nodes", "plugins",
           "register", "schema", "version"]
