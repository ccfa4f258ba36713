"""What the add-on adds to Blender: a menu entry, and a handler that shows the frame of the timeline."""

import pathlib

import bpy
from bpy.app.handlers import persistent

from .handover import HandoverError, Run
from .scene import SceneBuilder

PROPERTY = "weir_run"  # of a scene: the folder of its run; .blend files of Weir have it, too

# Of scenes, by name.
_builders = {}
_shown = {}  # the folder and the frame


def show(scene):
    """The frame that the timeline is at. Throws a HandoverError."""
    folder = bpy.path.abspath(scene[PROPERTY])
    run, builder = _builders.get(scene.name, (None, None))
    if run is None or str(run.folder) != folder:
        run, builder = Run(folder), SceneBuilder(scene)
    run.frames = run.find_frames() or run.frames  # the run may go on
    number = run.nearest(scene.frame_current)
    if _shown.get(scene.name) != (folder, number):
        builder.show(run.frame(number))
    _builders[scene.name], _shown[scene.name] = (run, builder), (folder, number)


@persistent
def _at_frame(scene, *_):
    # Motion blur looks at times between frames, at which meshes stay as they are.
    if PROPERTY not in scene or scene.frame_subframe != 0:
        return
    try:
        show(scene)
    except HandoverError as error:
        print(f"weir: {error}")


@persistent
def _at_load(*_):
    _builders.clear()
    _shown.clear()


class OpenRun(bpy.types.Operator):
    """Open the folder that weir run --blender wrote"""

    bl_idname = "weir.open_run"
    bl_label = "Weir run"
    bl_options = {"REGISTER", "UNDO"}

    directory: bpy.props.StringProperty(name="Folder", subtype="DIR_PATH")

    def invoke(self, context, event):
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, context):
        scene = context.scene
        folder = pathlib.Path(bpy.path.abspath(self.directory))
        try:
            run = Run(folder)
            scene[PROPERTY] = str(folder)
            _builders.pop(scene.name, None)
            _shown.pop(scene.name, None)
            scene.frame_start, scene.frame_end = run.frames[0], run.frames[-1]
            scene.frame_set(run.frames[0])  # which shows it
            show(scene)
        except HandoverError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        self.report({"INFO"}, f"{len(run.frames)} frames")
        return {"FINISHED"}


def _menu(self, context):
    self.layout.operator(OpenRun.bl_idname, text="Weir run (folder)")


def register():
    bpy.utils.register_class(OpenRun)
    bpy.types.TOPBAR_MT_file_import.append(_menu)
    bpy.app.handlers.frame_change_post.append(_at_frame)
    bpy.app.handlers.load_post.append(_at_load)


def unregister():
    bpy.app.handlers.load_post.remove(_at_load)
    bpy.app.handlers.frame_change_post.remove(_at_frame)
    bpy.types.TOPBAR_MT_file_import.remove(_menu)
    bpy.utils.unregister_class(OpenRun)
