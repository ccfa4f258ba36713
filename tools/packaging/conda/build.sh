#!/bin/sh
# How recipe.yaml builds: as `pip install .` does, with the libraries of the environment. CMAKE_ARGS is conda's.
set -eu
fonts=$("$PYTHON" -c 'import matplotlib; print(matplotlib.get_data_path())')/fonts/ttf
export CMAKE_ARGS="${CMAKE_ARGS:-} -DWEIR_CUDA=OFF -DWEIR_MPI=OFF -DWEIR_FONT_REGULAR=$fonts/DejaVuSans.ttf -DWEIR_FONT_BOLD=$fonts/DejaVuSans-Bold.ttf"
"$PYTHON" -m pip install . -vv --no-deps --no-build-isolation
