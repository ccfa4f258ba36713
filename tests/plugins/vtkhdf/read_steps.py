"""Reads all steps of an export of a run with VTK's own reader.

usage: read_steps.py FILE.vtkhdf STEPS

Exits with an error if the file does not hold STEPS steps, or if one has another number of particles than was written,
or lacks a point's velocity. One step more may be there, without a time, for which VTK takes 0: its run was killed.
"""

import sys

from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
from vtkmodules.vtkIOHDF import vtkHDFReader


def main(file, steps):
    reader = vtkHDFReader()
    if not reader.CanReadFile(file):
        sys.exit(f"VTK cannot read {file}")
    if steps == 0:
        return  # VTK takes any file for one of a step at least
    reader.SetFileName(file)
    reader.UpdateInformation()
    # Without times VTK takes a file of one step for one that stands still.
    times = reader.GetOutputInformation(0).Get(vtkStreamingDemandDrivenPipeline.TIME_STEPS()) or (0.0,)
    if not len(times) == reader.GetNumberOfSteps() or tuple(times[steps:]) not in ((), (0.0,)) or len(times) < steps:
        sys.exit(f"there are {len(times)} times and {reader.GetNumberOfSteps()} steps in place of {steps}")
    for time in times[:steps]:
        reader.UpdateTimeStep(time)
        data = reader.GetOutput()
        points = data.GetNumberOfPoints()
        count = data.GetFieldData().GetArray("particles")  # which exports of surfaces and solids have not
        written = count.GetValue(0) if count else points
        velocity = data.GetPointData().GetArray("velocity")
        if points != written or velocity.GetNumberOfTuples() != written:
            sys.exit(f"at {time} s there are {points} particles, and {written} were written")


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]))
