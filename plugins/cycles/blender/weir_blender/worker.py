"""Renders frames for Weir, without a window: run by `blender --background --python` or by a Python that has bpy.

One line of JSON on the standard input asks for each picture: {"frame": FILE.npz, "picture": FILE.png}, or for the
scene as a file: {"frame": FILE.npz, "blend": FILE.blend}. The file takes its name once it is whole. The program ends
with its input; what is wrong is the last line on stderr that begins with 'weir: ', and the exit code is 1.
"""

import json
import os
import pathlib
import shutil
import sys

# Before this file's own folder: its name is no module that others should find.
sys.path[:] = [str(pathlib.Path(__file__).resolve().parent.parent)] + [
    entry for entry in sys.path if entry and pathlib.Path(entry).resolve() != pathlib.Path(__file__).resolve().parent]

sys.dont_write_bytecode = True  # the folder may be the system's

import bpy  # noqa: E402

from weir_blender.devices import choose_device  # noqa: E402
from weir_blender.handover import Frame, HandoverError  # noqa: E402
from weir_blender.scene import SceneBuilder  # noqa: E402


def _part(target):
    """Beside it, with its extension, which says what is in it."""
    return target.with_name(f"{target.stem}.part{os.getpid()}{target.suffix}")


class Worker:
    def __init__(self):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        self._builder = SceneBuilder(bpy.context.scene)
        self._meshes = {}
        self._device = None

    def show(self, path):
        frame = Frame(path, self._meshes)
        scene = bpy.context.scene
        scene.frame_set(frame.scene["frame"])
        self._builder.show(frame)
        if self._device is None:
            self._device = choose_device(scene, frame.scene["cycles"]["device"])
            print(f"weir: Cycles renders on {self._device}", file=sys.stderr, flush=True)
        return frame

    def picture(self, request):
        self.show(request["frame"])
        target = pathlib.Path(request["picture"])
        part = _part(target)
        bpy.context.scene.render.filepath = str(part)
        bpy.ops.render.render(write_still=True)
        os.replace(part, target)

    def blend(self, request):
        frame = self.show(request["frame"])
        scene = bpy.context.scene
        scene["weir_run"] = str(frame.path.parent)  # for the add-on
        scene.frame_start, scene.frame_end = 0, frame.scene["frame"]
        target = pathlib.Path(request["blend"])
        part = _part(target)
        bpy.context.preferences.filepaths.save_version = 0
        bpy.ops.wm.save_as_mainfile(filepath=str(part), compress=True, copy=True, relative_remap=False)
        os.replace(part, target)


def main():
    try:
        worker = Worker()
        for line in sys.stdin:
            request = json.loads(line)
            if "picture" in request:
                worker.picture(request)
            else:
                worker.blend(request)
    except HandoverError as error:
        print(f"weir: {error}", file=sys.stderr, flush=True)
        return 1
    except Exception as error:
        import traceback
        traceback.print_exc()
        print(f"weir: {type(error).__name__}: {error}", file=sys.stderr, flush=True)
        return 1
    return 0


if __name__ == "__main__":
    code = main()
    sys.stdout.flush()
    sys.stderr.flush()
    shutil.rmtree(bpy.app.tempdir, ignore_errors=True)  # which goes with Blender else
    os._exit(code)  # Blender's own way out takes the code for a script's that did not fail
