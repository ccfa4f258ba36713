"""Pictures of several runs beside each other, in one JPEG."""

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

PANEL_WIDTH = 3.8  # inches


def montage(panels, file, dpi=120):
    """`panels`: (row, column, title, picture or None, note) each; the note tells what became of a failed run."""
    rows = 1 + max(panel[0] for panel in panels)
    columns = 1 + max(panel[1] for panel in panels)
    pictures = {path: plt.imread(path) for _, _, _, path, _ in panels if path is not None}
    aspect = next((p.shape[0] / p.shape[1] for p in pictures.values()), 0.6)
    heading = 0.28 if any(panel[2] for panel in panels) else 0.02  # inches
    size = (PANEL_WIDTH * columns, (PANEL_WIDTH * aspect + heading) * rows)
    drawing, axes = plt.subplots(rows, columns, figsize=size, squeeze=False)
    for axis in axes.flat:
        axis.set_axis_off()
    for row, column, title, path, note in panels:
        axis = axes[row][column]
        axis.set_title(title, fontsize=9, pad=3)
        if path is not None:
            axis.imshow(pictures[path], interpolation="lanczos")
        if note:
            axis.text(0.5, 0.06, note, transform=axis.transAxes, ha="center", fontsize=8, color="#b00000")
    drawing.subplots_adjust(left=0.004, right=0.996, bottom=0.004, top=1 - heading / size[1], wspace=0.02, hspace=0.1)
    drawing.savefig(file, dpi=dpi, pil_kwargs={"quality": 85, "optimize": True})
    plt.close(drawing)
