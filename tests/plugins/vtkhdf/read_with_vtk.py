"""Reads an export with VTK's own reader, and with PyVista where it is there, and compares all steps with what was
written.

usage: read_with_vtk.py WEIR_VTKHDF_TESTS     the test program, which writes the file
"""

import os
import subprocess
import sys
import tempfile

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkVersion
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
from vtkmodules.vtkIOHDF import vtkHDFReader

try:
    import pyvista
except ModuleNotFoundError:
    pyvista = None

COUNTS = [5, 5, 0, 0, 40000, 40000, 70000, 40000, 3, 0, 1]  # kCounts in vtkhdf_writer_test.cpp


def expected(step, count):
    """The formulas of SampleStep in sample_run.h."""
    i = np.arange(count)
    zero = np.zeros(count)
    return {
        "points": np.stack([i, zero + step, 0.5 * i], 1),
        "velocity": np.stack([zero + step, -i, zero + 1], 1),
        "density": 1000.0 + i - step,
        "id": i + 10 * step,
        "birth": 2**40 + i,
        "flags": np.stack([4000000000 + i, zero + step], 1),
    }


def array(data, name):
    found = data.GetArray(name)
    assert found is not None, f"there is no array {name}"
    return vtk_to_numpy(found)


def check_step(data, step, count):
    assert data.IsA("vtkPolyData"), data.GetClassName()
    assert data.GetNumberOfPoints() == count, (step, data.GetNumberOfPoints())
    assert data.GetNumberOfVerts() == count, (step, data.GetNumberOfVerts())
    assert data.GetNumberOfCells() == count, (step, data.GetNumberOfCells())
    particles = array(data.GetFieldData(), "particles")
    assert particles.tolist() == [count], (step, particles)
    if count == 0:
        return
    want = expected(step, count)
    assert np.array_equal(vtk_to_numpy(data.GetPoints().GetData()), want.pop("points")), step
    cells = vtk_to_numpy(data.GetVerts().GetConnectivityArray())
    assert np.array_equal(cells, np.arange(count)), step
    for name, values in want.items():
        assert np.array_equal(array(data.GetPointData(), name), values), (step, name)


def check_times(reader):
    reader.UpdateInformation()
    times = reader.GetOutputInformation(0).Get(vtkStreamingDemandDrivenPipeline.TIME_STEPS())
    assert np.allclose(times, np.arange(len(COUNTS)) / 30), times
    return times


def read_with_vtk(file):
    reader = vtkHDFReader()
    assert reader.CanReadFile(file)
    reader.SetFileName(file)
    times = check_times(reader)
    # Forwards, backwards and with jumps: what a reader keeps from the step before must not matter.
    order = list(range(len(COUNTS)))
    for step in order + order[::-1] + [6, 0, 10, 5, 4, 7, 2, 1]:
        reader.UpdateTimeStep(times[step])
        check_step(reader.GetOutput(), step, COUNTS[step])


def read_with_pyvista(file):
    reader = pyvista.get_reader(file).reader
    times = check_times(reader)
    for step, count in enumerate(COUNTS):
        reader.UpdateTimeStep(times[step])
        mesh = pyvista.wrap(reader.GetOutput())
        assert isinstance(mesh, pyvista.PolyData), type(mesh)
        assert mesh.n_points == mesh.n_verts == count, (step, mesh.n_points, mesh.n_verts)
        if count == 0:
            continue
        want = expected(step, count)
        assert np.array_equal(mesh.points, want.pop("points")), step
        for name, values in want.items():
            assert np.array_equal(mesh.point_data[name], values), (step, name)


def main(program):
    with tempfile.TemporaryDirectory() as folder:
        file = os.path.join(folder, "sample.vtkhdf")
        subprocess.run(
            [program, "--gtest_filter=VtkHdfSampleTest.*"],
            env={**os.environ, "WEIR_VTKHDF_SAMPLE": file},
            stdout=subprocess.DEVNULL,
            check=True,
        )
        read_with_vtk(file)
        if pyvista is not None:
            read_with_pyvista(file)
    readers = f"VTK {vtkVersion.GetVTKVersion()}"
    readers += f" and PyVista {pyvista.__version__} read" if pyvista is not None else " reads"
    print(f"{readers} all {len(COUNTS)} steps right")


if __name__ == "__main__":
    main(sys.argv[1])
