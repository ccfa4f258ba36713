"""Opens an export of Weir in ParaView: particles as spheres of their size, coloured by speed, with the time.

As a macro: in ParaView, Macros > Import new macro, this file; then it asks for the export.
From a shell: pvpython open_weir_run.py run.vtkhdf [picture.png] makes a picture of the last frame.

Needs ParaView 5.12 or newer, the first that reads particles which move from VTKHDF.
"""

import math
import sys

from paraview import simple

NOT_SHOWN = ("vtkGhostType",)


def file_from_user():
    """Asks in a window; only within ParaView, which brings Qt."""
    try:
        from PySide6.QtWidgets import QFileDialog
    except ImportError:
        from PyQt5.QtWidgets import QFileDialog
    return QFileDialog.getOpenFileName(None, "Open an export of Weir", "", "VTKHDF (*.vtkhdf)")[0]


def last_number(information):
    """The value of a FieldData array of one number; None if it is not there."""
    return information.GetRange(0)[1] if information is not None else None


def spacing_of(source):
    """Distance of particles at rest, m: what the export says, or what fits the box that holds the particles."""
    told = last_number(source.FieldData.GetArray("spacing"))
    if told:
        return told
    data = source.GetDataInformation()
    x0, x1, y0, y1, z0, z1 = data.GetBounds()
    sides = [max(b - a, 1e-6) for a, b in ((x0, x1), (y0, y1), (z0, z1))]
    return (math.prod(sides) / max(data.GetNumberOfPoints(), 1)) ** (1 / 3)


def show(file):
    """Shows the file's last frame in the active view; returns the view."""
    source = simple.OpenDataFile(file)
    if source is None:
        raise RuntimeError(f"ParaView cannot open {file}: is it 5.12 or newer?")
    view = simple.GetActiveViewOrCreate("RenderView")
    times = list(source.TimestepValues)
    scene = simple.GetAnimationScene()
    scene.UpdateAnimationUsingDataTimeSteps()
    if times:
        scene.AnimationTime = times[-1]
    source.UpdatePipeline(times[-1] if times else 0)

    spheres = simple.Show(source, view)
    spheres.SetRepresentationType("Point Gaussian")
    spheres.ShaderPreset = "Sphere"
    spheres.GaussianRadius = spacing_of(source) / 2
    if source.PointData.GetArray("velocity") is not None:
        simple.ColorBy(spheres, ("POINTS", "velocity", "Magnitude"))
        spheres.RescaleTransferFunctionToDataRangeOverTime()
        spheres.SetScalarBarVisibility(view, True)

    simple.Show(simple.AnnotateTimeFilter(source, Format="{time:.3f} s"), view)
    view.CameraViewUp = [0, 1, 0]  # heights are y
    view.ResetActiveCameraToNegativeZ()
    simple.ResetCamera(view)
    simple.Render(view)
    return view


def main(arguments):
    file = arguments[0] if arguments else file_from_user()
    if not file:
        return
    view = show(file)
    if len(arguments) > 1:
        simple.SaveScreenshot(arguments[1], view)


if __name__ in ("__main__", "__vtkconsole__"):
    main(sys.argv[1:])
