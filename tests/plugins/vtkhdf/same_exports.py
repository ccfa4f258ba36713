"""Compares two exports of particles by VTK's own reader, number by number and in order, cells included.

usage: same_exports.py ONE.vtkhdf OTHER.vtkhdf

Prints how many steps they have; exits with an error where they differ.
"""

import sys

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
from vtkmodules.vtkIOHDF import vtkHDFReader


def arrays_of(data):
    verts = data.GetVerts()
    yield "ids", verts.GetConnectivityArray()
    yield "offsets", verts.GetOffsetsArray()
    if data.GetNumberOfPoints():
        yield "points", data.GetPoints().GetData()
    for kind in (data.GetPointData(), data.GetFieldData()):
        for i in range(kind.GetNumberOfArrays()):
            yield kind.GetArray(i).GetName(), kind.GetArray(i)


def steps_of(file):
    reader = vtkHDFReader()
    if not reader.CanReadFile(file):
        sys.exit(f"VTK cannot read {file}")
    reader.SetFileName(file)
    reader.UpdateInformation()
    for time in reader.GetOutputInformation(0).Get(vtkStreamingDemandDrivenPipeline.TIME_STEPS()) or ():
        reader.UpdateTimeStep(time)
        data = reader.GetOutput()
        if not data.IsA("vtkPolyData"):
            sys.exit(f"{file} holds a {data.GetClassName()}")
        yield time, {name: vtk_to_numpy(array).copy() for name, array in arrays_of(data)}


def main(one, other):
    steps = list(steps_of(one)), list(steps_of(other))
    if len(steps[0]) != len(steps[1]):
        sys.exit(f"there are {len(steps[0])} and {len(steps[1])} steps")
    for (time, left), (also, right) in zip(*steps):
        if time != also or left.keys() != right.keys():
            sys.exit(f"at {time} s there are {sorted(left)}, at {also} s {sorted(right)}")
        for name, values in left.items():
            if not np.array_equal(values, right[name], equal_nan=values.dtype.kind == "f"):
                sys.exit(f"{name} differs at {time} s")
    print(len(steps[0]))


if __name__ == "__main__":
    main(*sys.argv[1:])
