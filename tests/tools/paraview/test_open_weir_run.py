"""The macro for ParaView, with a stand-in for ParaView: which calls it makes, in which order, and what it makes of
exports with and without a spacing. What ParaView does with them is not tested here."""

import sys
import types
import unittest
from pathlib import Path
from unittest import mock

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tools" / "paraview"))

simple = mock.MagicMock()
paraview = types.ModuleType("paraview")
paraview.simple = simple
sys.modules["paraview"] = paraview

import open_weir_run  # noqa: E402


def source(spacing, has_velocity=True):
    made = mock.MagicMock()
    made.TimestepValues = [0.0, 0.5]
    field = mock.MagicMock()
    field.GetRange.return_value = (spacing, spacing)
    made.FieldData.GetArray.side_effect = lambda name: field if name == "spacing" and spacing else None
    made.PointData.GetArray.side_effect = lambda name: mock.MagicMock() if has_velocity else None
    made.GetDataInformation().GetBounds.return_value = (0, 1, 0, 1, 0, 1)
    made.GetDataInformation().GetNumberOfPoints.return_value = 1000
    return made


class OpenWeirRun(unittest.TestCase):
    def setUp(self):
        simple.reset_mock()

    def show(self, made):
        simple.OpenDataFile.return_value = made
        spheres = mock.MagicMock()
        simple.Show.return_value = spheres
        open_weir_run.show("run.vtkhdf")
        return spheres

    def test_shows_the_last_frame_as_spheres_of_their_size(self):
        made = source(0.02)
        spheres = self.show(made)
        made.UpdatePipeline.assert_called_once_with(0.5)
        self.assertEqual(spheres.GaussianRadius, 0.01)
        simple.ColorBy.assert_called_once_with(spheres, ("POINTS", "velocity", "Magnitude"))

    def test_guesses_the_size_where_the_export_does_not_say_it(self):
        self.assertAlmostEqual(self.show(source(None)).GaussianRadius, 0.05)

    def test_needs_no_velocity(self):
        self.show(source(0.02, has_velocity=False))
        simple.ColorBy.assert_not_called()

    def test_says_which_paraview_it_needs(self):
        simple.OpenDataFile.return_value = None
        with self.assertRaisesRegex(RuntimeError, "5.12"):
            open_weir_run.show("run.vtkhdf")


if __name__ == "__main__":
    unittest.main()
