"""Reads all steps of an export of a run with VTK's own reader, and prints how many there are.

usage: read_steps.py FILE.vtkhdf

Exits with an error if a step has another number of particles than was written, or lacks a point's velocity.
"""

import sys

from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
from vtkmodules.vtkIOHDF import vtkHDFReader


def main(file):
    reader = vtkHDFReader()
    if not reader.CanReadFile(file):
        sys.exit(f"VTK cannot read {file}")
    reader.SetFileName(file)
    reader.UpdateInformation()
    times = reader.GetOutputInformation(0).Get(vtkStreamingDemandDrivenPipeline.TIME_STEPS()) or ()
    for time in times:
        reader.UpdateTimeStep(time)
        data = reader.GetOutput()
        points = data.GetNumberOfPoints()
        count = data.GetFieldData().GetArray("particles")  # which exports of surfaces and solids have not
        written = count.GetValue(0) if count else points
        velocity = data.GetPointData().GetArray("velocity")
        if points != written or velocity.GetNumberOfTuples() != written:
            sys.exit(f"at {time} s there are {points} particles, and {written} were written")
    print(len(times))


if __name__ == "__main__":
    main(sys.argv[1])
