"""Blender's add-on for runs of Weir: opens the folder that `weir run --blender DIR` wrote, and shows each frame of the
timeline. Without Blender's window: blender --background --python-expr "import bpy; bpy.ops.weir.open_run(...)".
"""

bl_info = {
    "name": "Weir runs",
    "author": "The Weir authors",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "File > Import > Weir run",
    "description": "Opens runs of Weir, frame by frame, and renders them by Cycles",
    "category": "Import-Export",
}

try:
    import bpy
except ImportError:  # handover.py is of use without Blender
    bpy = None

if bpy is not None:
    from .addon import register, unregister  # noqa: F401
