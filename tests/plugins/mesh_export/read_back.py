"""Reads exported surfaces and particles with trimesh and VTK, and compares them with each other.

usage: read_back.py WEIR     the program

Exits with 77 where a package is missing, which CTest shows as skipped.
"""

import json
import os
import subprocess
import sys
import tempfile

SKIPPED = 77
try:
    import numpy as np
    import trimesh
    import vtk
    from vtk.util.numpy_support import vtk_to_numpy
except ImportError as missing:
    print(f"skipped: {missing}; a Python with numpy, trimesh and vtk is needed (-DWEIR_TEST_PYTHON=…)")
    sys.exit(SKIPPED)

SIDE = 0.1  # m, of the cube of fluid
FRAMES = 3
SCENE = {
    "weir": 1,
    "world": {"gravity": [0, 0, 0], "dt": 0.002, "frame_rate": 50, "duration": 0.04},
    "nodes": {
        "block": {"type": "BoxSampler", "params": {"min": [0, 0, 0], "max": [SIDE] * 3, "velocity": [1, 0, 0]}},
        "water": {"type": "ParticleFluid", "params": {"spacing": 0.02}},
        "skin": {"type": "FluidSurface"},
    },
    "links": ["block.particles -> water.initial", "water.fluid -> skin.fluid"],
}


def check_meshes(folder, frame):
    """The PLY and OBJ files of a frame; returns its vertices, normals and triangles."""
    ply = trimesh.load(os.path.join(folder, "ply", f"skin_{frame:05}.ply"), process=False)
    obj = trimesh.load(os.path.join(folder, "obj", f"skin_{frame:05}.obj"), process=False)
    for mesh in (ply, obj):
        assert mesh.is_watertight and mesh.is_winding_consistent, frame
        assert abs(mesh.volume / SIDE**3 - 1) < 0.1, mesh.volume
    assert np.array_equal(ply.vertices.astype(np.float32), obj.vertices.astype(np.float32)), frame
    assert np.array_equal(ply.faces, obj.faces), frame
    return ply.vertices, ply.vertex_normals, ply.faces


def check_particles(folder, frame):
    """Returns the mean of their places along x."""
    points = trimesh.load(os.path.join(folder, "points", f"water_{frame:05}.ply"), process=False)
    assert len(points.vertices) == 125, len(points.vertices)
    return points.vertices[:, 0].mean()


def check_step(data, vertices, normals, faces):
    assert data.IsA("vtkPolyData"), data.GetClassName()
    assert data.GetNumberOfCells() == data.GetNumberOfPolys() == len(faces)
    assert np.array_equal(vtk_to_numpy(data.GetPoints().GetData()), vertices.astype(np.float32))
    cells = vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    assert np.array_equal(cells, faces)
    ours = vtk_to_numpy(data.GetPointData().GetArray("Normals"))
    assert np.allclose(np.linalg.norm(ours, axis=1), 1, atol=1e-5)
    # Normals of the field against those of the triangles.
    assert (ours * normals).sum(1).mean() > 0.9
    assert vtk_to_numpy(data.GetFieldData().GetArray("triangles")).tolist() == [len(faces)]
    edges = vtk.vtkFeatureEdges()
    edges.SetInputData(data)
    edges.FeatureEdgesOff()
    edges.Update()
    assert edges.GetOutput().GetNumberOfCells() == 0, "VTK finds open edges"


def main(weir):
    with tempfile.TemporaryDirectory() as folder:
        scene = os.path.join(folder, "scene.json")
        with open(scene, "w", encoding="utf-8") as file:
            json.dump(SCENE, file)
        export = os.path.join(folder, "skin.vtkhdf")
        options = ["--export-surface", export]
        for name, sub in (("ply", "ply"), ("obj", "obj"), ("ply-particles", "points")):
            options += [f"--{name}", os.path.join(folder, sub)]
        subprocess.run([weir, "run", scene, "--quiet", "--threads", "2", *options], check=True, stdout=subprocess.DEVNULL)
        reader = vtk.vtkHDFReader()
        reader.SetFileName(export)
        reader.UpdateInformation()
        times = reader.GetOutputInformation(0).Get(vtk.vtkStreamingDemandDrivenPipeline.TIME_STEPS())
        assert np.allclose(times, np.arange(FRAMES) / 50), times
        meshes = [check_meshes(folder, frame) for frame in range(FRAMES)]
        places = [check_particles(folder, frame) for frame in range(FRAMES)]
        # They fly at 1 m/s.
        assert np.allclose(np.diff(places), 1 / 50, rtol=0.02), places
        # Forwards, backwards and with a jump: what a reader keeps from the step before must not matter.
        for frame in (0, 1, 2, 1, 0, 2):
            reader.UpdateTimeStep(times[frame])
            check_step(reader.GetOutput(), *meshes[frame])
    print(f"trimesh {trimesh.__version__} and VTK {vtk.VTK_VERSION} read all {FRAMES} frames right")


if __name__ == "__main__":
    main(sys.argv[1])
