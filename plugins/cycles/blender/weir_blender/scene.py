"""Makes a scene of Blender of a frame that Weir handed over, and changes it to the next frame.

What it makes stands in a collection of its own, and is found again by its name. An object whose material slot holds
another material than the one made here keeps it: that is how an artist takes over.
"""

import math

import bpy
import mathutils
import numpy

from . import foam, materials
from .handover import camera_matrix, is_closed, linear, pose_matrix, turned

COLLECTION = "Weir"
PREFIX = "Weir "
COLOR = materials.COLOR
RADIUS = "weir_radius"


class SceneBuilder:
    def __init__(self, scene=None):
        self.scene = scene or bpy.context.scene
        self._closed = {}  # whether a mesh that stays as it is is closed, by its file
        self._shown = {}  # what an object or a material was made of, by its name

    # What is there ----------------------------------------------------------------------------------------------

    def show(self, frame):
        """Makes the scene show it. Lights, camera and settings of the picture as well."""
        description = frame.scene
        used = set()
        for index, item in enumerate(description["surfaces"]):
            used.add(self._surface(frame, index, item))
        for index, item in enumerate(description["particles"]):
            used.add(self._particles(frame, index, item))
        if description["ground"]:
            used.add(self._ground(description))
        self._hide_others(used)
        self._camera(description)
        self._light(frame)
        self._picture(description)

    def _collection(self):
        collection = bpy.data.collections.get(COLLECTION) or bpy.data.collections.new(COLLECTION)
        if COLLECTION not in self.scene.collection.children:
            self.scene.collection.children.link(collection)
        return collection

    def _object(self, name, data):
        """The object of that name, or a new one with what `data` makes."""
        found = bpy.data.objects.get(name)
        if found is None:
            found = bpy.data.objects.new(name, data())
            self._collection().objects.link(found)
        found.hide_render = found.hide_viewport = False
        return found

    def _hide_others(self, used):
        """What earlier frames showed and this one does not."""
        for thing in self._collection().objects:
            if thing.type == "MESH" and thing.name.startswith(PREFIX) and thing.name not in used:
                thing.hide_render = thing.hide_viewport = True

    def _changed(self, name, made_of):
        """Whether what has this name was made of something else."""
        if self._shown.get(name) == made_of:
            return False
        self._shown[name] = made_of
        return True

    def _dress(self, thing, name, made_of, make):
        """Gives it the material of that name, unless somebody gave it another."""
        slots = thing.data.materials
        if len(slots) > 0 and slots[0] is not None and slots[0].name != name:
            return slots[0]
        if self._changed("material " + name, made_of) or name not in bpy.data.materials:
            make()
        material = bpy.data.materials[name]
        if len(slots) == 0:
            slots.append(material)
        else:
            slots[0] = material
        return material

    # Surfaces ----------------------------------------------------------------------------------------------------

    def _surface(self, frame, index, item):
        name = PREFIX + item["name"]
        thing = self._object(name, lambda: bpy.data.meshes.new(name))
        file, colors = item.get("mesh"), frame.surface_colors(index)
        if file is None or self._changed("mesh " + name, (str(frame.path.parent), file)):
            vertices, triangles = frame.mesh(index)
            velocities, cover = (frame.array(f"surface{index}_{what}") for what in ("velocities", "foam"))
            fill_mesh(thing.data, vertices, triangles, velocities, colors, cover)
            if velocities is not None and cover is not None:
                carry_foam(thing.data, turned(vertices), turned(velocities), item["foam_reach"], frame.scene["time"])
            self._closed[name] = is_closed(triangles)
        self._place(thing, frame.scene, item)
        closed, carried = self._closed[name], materials.FOAM_SHARES in thing.data.attributes
        caustics = frame.scene["cycles"]["caustics"]
        waters = frame.scene["waters"]
        made_of = repr((item["look"], item["color"], closed, caustics, colors is not None,
                        waters[item["water"]] if item["look"] == "water" else None, item.get("foam_reach"), carried))
        self._dress(thing, name, made_of,
                    lambda: materials.surface(name, item, waters, closed, caustics, colors is not None, carried))
        return name

    def _place(self, thing, description, item):
        """Where it is, and for motion blur the way that it went in the last frame, straight on."""
        thing.rotation_mode = "QUATERNION"
        thing.animation_data_clear()
        now = mathutils.Matrix(pose_matrix(item["position"], item["rotation"]))
        if description["cycles"]["shutter"] > 0 and item.get("position_before"):
            before = mathutils.Matrix(pose_matrix(item["position_before"], item["rotation_before"]))
            if before != now:
                self._animate(thing, before, now)
        thing.matrix_world = now

    def _animate(self, thing, before, now):
        number = self.scene.frame_current
        rotation = now.to_quaternion()
        for at, matrix in ((number - 1, before), (number, now), (number + 1, _further(before, now))):
            quaternion = matrix.to_quaternion()
            quaternion.make_compatible(rotation)
            thing.location, thing.rotation_quaternion = matrix.to_translation(), quaternion
            thing.keyframe_insert("location", frame=at)
            thing.keyframe_insert("rotation_quaternion", frame=at)

    # Particles ---------------------------------------------------------------------------------------------------

    def _particles(self, frame, index, item):
        name = PREFIX + item["name"]
        thing = self._object(name, lambda: bpy.data.meshes.new(name))
        colors = frame.particle_colors(index)
        positions = frame.positions(index)
        whole = numpy.isfinite(positions).all(axis=1)
        velocities, radii = (frame.array(f"particles{index}_{what}") for what in ("velocities", "radii"))
        if radii is not None:
            whole &= radii > 0
        fill_points(thing.data, *(None if of is None else of[whole] for of in (positions, velocities, colors, radii)))
        colored, white = colors is not None, item.get("white", False)
        material = self._dress(thing, name, repr((item["color"], colored, white)),
                               lambda: materials.white_water(name, item["color"]) if white else
                               materials.particles(name, item["color"], colored))
        modifier = thing.modifiers.get("Spheres") or thing.modifiers.new("Spheres", "NODES")
        radius = item["radius"] if radii is None else None
        if self._changed("spheres " + name, (radius, material.name)) or modifier.node_group is None:
            modifier.node_group = sphere_nodes(name, radius, material)
        return name

    # Ground, camera, light ---------------------------------------------------------------------------------------

    def _ground(self, description):
        name, item = PREFIX + "ground", description["ground"]
        thing = self._object(name, lambda: _disc(name))
        center = turned(item["center"])
        sky = description["environment"]["look"] != "studio"
        radius = item["radius"] * (60 if sky else 4)
        thing.location = (float(center[0]), float(center[1]), float(item["height"]) - 1e-4 * item["radius"])
        thing.scale = (radius, radius, 1)
        thing.is_shadow_catcher = bool(description["picture"]["transparent"])
        made_of = repr((item["color"], item["tiles"], radius, sky))
        self._dress(thing, name, made_of,
                    lambda: materials.ground(name, item["color"], radius, item["tiles"], not sky))
        return name

    def _camera(self, description):
        item, look = description["camera"], description["cycles"]
        camera = self._object(PREFIX + "camera", lambda: bpy.data.cameras.new(PREFIX + "camera"))
        camera.matrix_world = mathutils.Matrix(camera_matrix(item))
        lens = camera.data
        distance = math.dist(item["eye"], item["target"])
        lens.sensor_fit = "VERTICAL"
        lens.angle = math.radians(item["fov"])
        lens.clip_start, lens.clip_end = 1e-3 * distance, 1e4 * max(distance, 1)
        lens.dof.use_dof = look["aperture"] > 0
        if lens.dof.use_dof:
            # The lens is given by its own diameter, whatever the size of the sensor.
            lens.dof.aperture_fstop = 1e-3 * lens.lens / look["aperture"]
            lens.dof.focus_distance = look["focus"] or distance
        self.scene.camera = camera

    def _light(self, frame):
        description = frame.scene
        item = description["environment"]
        sun = self._object(PREFIX + "sun", lambda: bpy.data.lights.new(PREFIX + "sun", "SUN"))
        towards = mathutils.Vector([float(c) for c in turned(item["towards_sun"])]).normalized()
        sun.rotation_mode = "QUATERNION"
        sun.rotation_quaternion = towards.to_track_quat("Z", "Y")
        sky = item["look"] == "sky"
        # White paper that faces the sun shows radiance strength / pi.
        sun.data.energy = math.pi * (1.2 if sky else 0.75) * item["sun_strength"]
        sun.data.color = (1.0, 0.95, 0.87) if sky else (1.0, 0.98, 0.96)
        sun.data.angle = math.radians(0.53 if sky else 6.0)
        if self._changed("world", repr(item)) or self.scene.world is None:
            self.scene.world = _world(item, frame.environment_light())

    # The picture -------------------------------------------------------------------------------------------------

    def _picture(self, description):
        picture, look = description["picture"], description["cycles"]
        scene, render, cycles = self.scene, self.scene.render, self.scene.cycles
        render.engine = "CYCLES"
        render.resolution_x, render.resolution_y = picture["width"], picture["height"]
        render.resolution_percentage = 100
        render.film_transparent = picture["transparent"]
        render.fps, render.fps_base = _frames_per_second(description["frame_rate"])
        render.use_motion_blur = look["shutter"] > 0
        render.motion_blur_shutter = max(look["shutter"], 0.01)
        render.dither_intensity = 0
        render.use_persistent_data = False
        render.image_settings.file_format = "PNG"
        render.image_settings.color_mode = "RGBA" if picture["transparent"] else "RGB"
        render.image_settings.color_depth = "8"
        cycles.samples = look["samples"]
        cycles.use_adaptive_sampling = True
        cycles.adaptive_threshold = look["noise"]
        cycles.use_denoising = look["denoise"] and _can_denoise()
        cycles.seed = 0
        cycles.max_bounces, cycles.transmission_bounces, cycles.glossy_bounces = 24, 24, 8
        cycles.transparent_max_bounces = 32
        cycles.volume_bounces = 4
        cycles.caustics_reflective = cycles.caustics_refractive = look["caustics"]
        _tone(scene, picture)


def _can_denoise():
    """Debian's Blender is built without."""
    try:
        import _cycles
    except ImportError:
        return True
    return getattr(_cycles, "with_openimagedenoise", True)


def _further(before, now):
    """As much further as `now` is from `before`."""
    turn = now.to_quaternion() @ before.to_quaternion().inverted()
    matrix = (turn @ now.to_quaternion()).to_matrix().to_4x4()
    matrix.translation = 2 * now.to_translation() - before.to_translation()
    return matrix


def _frames_per_second(rate):
    """As Blender has it, a whole number and what that is divided by: 59.94 is 60 / 1.001."""
    whole = max(1, math.ceil(rate))
    return whole, whole / rate


def _tone(scene, picture):
    view = scene.view_settings
    wanted = ("AgX", "Filmic") if picture["tone"] == "filmic" else ("Standard",)
    for name in wanted:
        try:
            view.view_transform = name
            break
        except TypeError:  # not in this version's settings of colours
            continue
    view.look = "None"
    if view.view_transform == "AgX":
        try:
            view.look = "AgX - Medium High Contrast"
        except TypeError:
            pass
    view.gamma = 1
    # AgX makes white paper grey, to have room above it.
    view.exposure = math.log2(picture["exposure"]) + (0.6 if view.view_transform == "AgX" else 0)


def fill_mesh(mesh, vertices, triangles, velocities=None, colors=None, cover=None):
    """Makes it the mesh of these triangles, smooth; the velocities are for motion blur, the colours light."""
    mesh.clear_geometry()
    vertices = turned(vertices)
    mesh.vertices.add(len(vertices))
    mesh.vertices.foreach_set("co", numpy.ascontiguousarray(vertices, dtype=numpy.float32).ravel())
    corners = numpy.ascontiguousarray(triangles, dtype=numpy.int32).ravel()
    count = len(corners) // 3
    mesh.loops.add(len(corners))
    mesh.loops.foreach_set("vertex_index", corners)
    mesh.polygons.add(count)
    mesh.polygons.foreach_set("loop_start", numpy.arange(0, 3 * count, 3, dtype=numpy.int32))
    if bpy.app.version < (4, 1, 0):
        mesh.polygons.foreach_set("loop_total", numpy.full(count, 3, dtype=numpy.int32))
    mesh.polygons.foreach_set("use_smooth", _smooth(vertices, corners))
    _set_velocities(mesh, velocities)
    _set(mesh, COLOR, "FLOAT_COLOR", "color", colors)
    _set(mesh, materials.FOAM, "FLOAT", "value", cover)
    mesh.update(calc_edges=True)
    mesh.validate()


def carry_foam(mesh, vertices, velocities, reach, time):
    """Gives each vertex what its foam's pattern is made of."""
    places, shares = foam.carried(vertices, velocities, reach, time)
    for name, values in zip((*materials.FOAM_PATTERNS, materials.FOAM_SHARES), (*places, shares)):
        _set(mesh, name, "FLOAT_VECTOR", "vector", values)


def _smooth(vertices, corners):
    """Meshes of few triangles, such as boxes, have edges; those of fluids and fine models are round."""
    few = 200
    return numpy.full(len(corners) // 3, len(corners) // 3 > few, dtype=bool)


def _set_velocities(mesh, velocities):
    if velocities is not None:
        _set(mesh, "velocity", "FLOAT_VECTOR", "vector", turned(velocities))


def _set(mesh, name, kind, member, values):
    """An attribute of the points of a mesh, if there are values."""
    if values is None or len(values) == 0:
        return
    attribute = mesh.attributes.get(name) or mesh.attributes.new(name, kind, "POINT")
    attribute.data.foreach_set(member, numpy.ascontiguousarray(values, dtype=numpy.float32).ravel())


def fill_points(mesh, positions, velocities=None, colors=None, radii=None):
    """A mesh of vertices alone, which become spheres."""
    mesh.clear_geometry()
    mesh.vertices.add(len(positions))
    mesh.vertices.foreach_set("co", numpy.ascontiguousarray(turned(positions), dtype=numpy.float32).ravel())
    _set_velocities(mesh, velocities)
    _set(mesh, COLOR, "FLOAT_COLOR", "color", colors)
    _set(mesh, RADIUS, "FLOAT", "value", radii)
    mesh.update()


def sphere_nodes(name, radius, material):
    """Geometry nodes that make a sphere of each vertex, which Cycles draws as such; of the attribute RADIUS if `radius`
    is None."""
    group = bpy.data.node_groups.get(name) or bpy.data.node_groups.new(name, "GeometryNodeTree")
    group.nodes.clear()
    if hasattr(group, "interface"):
        group.interface.clear()
        group.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
        group.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    elif not group.inputs:
        group.inputs.new("NodeSocketGeometry", "Geometry")
        group.outputs.new("NodeSocketGeometry", "Geometry")
    begin, end = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
    points, dress = group.nodes.new("GeometryNodeMeshToPoints"), group.nodes.new("GeometryNodeSetMaterial")
    if radius is None:
        each = group.nodes.new("GeometryNodeInputNamedAttribute")
        each.data_type = "FLOAT"
        each.inputs["Name"].default_value = RADIUS
        group.links.new(next(o for o in each.outputs if o.enabled and o.type == "VALUE"), points.inputs["Radius"])
    else:
        points.inputs["Radius"].default_value = radius
    dress.inputs["Material"].default_value = material
    group.links.new(begin.outputs[0], points.inputs[0])
    group.links.new(points.outputs[0], dress.inputs[0])
    group.links.new(dress.outputs[0], end.inputs[0])
    return group


def _disc(name):
    mesh = bpy.data.meshes.new(name)
    corners = 96
    angles = [2 * math.pi * i / corners for i in range(corners)]
    mesh.from_pydata([(math.cos(a), math.sin(a), 0) for a in angles], [], [list(range(corners))])
    return mesh


def _world(item, light):
    """What surrounds the scene."""
    world = bpy.data.worlds.get(PREFIX + "world") or bpy.data.worlds.new(PREFIX + "world")
    world.use_nodes = True
    tree = world.node_tree
    tree.nodes.clear()
    output = tree.nodes.new("ShaderNodeOutputWorld")
    background = tree.nodes.new("ShaderNodeBackground")
    surroundings = {"studio": _studio, "sky": _sky, "image": _image}[item["look"]]
    surroundings(tree, background, item, light)
    if item["look"] != "image" or item["background"]:
        tree.links.new(background.outputs[0], output.inputs[0])
        return world
    # What the camera sees of it is plain.
    plain = tree.nodes.new("ShaderNodeBackground")
    tree.links.new(_gradient(tree, item), plain.inputs["Color"])
    _by_ray(tree, output, background, plain)
    return world


def _seen(tree):
    """1 for what the camera sees, also through glass and water."""
    path = tree.nodes.new("ShaderNodeLightPath")
    seen = tree.nodes.new("ShaderNodeMath")
    seen.operation = "MAXIMUM"
    tree.links.new(path.outputs["Is Camera Ray"], seen.inputs[0])
    tree.links.new(path.outputs["Is Transmission Ray"], seen.inputs[1])
    return seen.outputs[0]


def _by_ray(tree, output, others, camera):
    """One background for what the camera sees, also through glass and water, and one for all else."""
    mix = tree.nodes.new("ShaderNodeMixShader")
    tree.links.new(_seen(tree), mix.inputs[0])
    tree.links.new(others.outputs[0], mix.inputs[1])
    tree.links.new(camera.outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], output.inputs[0])


def _gradient(tree, item):
    """From the colour below to that above, by how high the direction is."""
    places = tree.nodes.new("ShaderNodeTexCoord")
    parts = tree.nodes.new("ShaderNodeSeparateXYZ")
    tree.links.new(places.outputs["Generated"], parts.inputs[0])
    share = tree.nodes.new("ShaderNodeMapRange")
    tree.links.new(parts.outputs["Z"], share.inputs[0])
    for socket, value in zip(share.inputs[1:5], (-0.35, 0.35, 0.0, 1.0)):
        socket.default_value = value
    ramp = tree.nodes.new("ShaderNodeValToRGB")
    for element, name in zip(ramp.color_ramp.elements, ("bottom", "top")):
        element.color = (*(float(c) for c in linear(item[name][:3])), 1.0)
    tree.links.new(share.outputs[0], ramp.inputs[0])
    return ramp.outputs["Color"]


def _studio(tree, background, item, light):
    """The gradient, and lamps above that mirrors show: brighter the higher, in a broad band."""
    tree.links.new(_gradient(tree, item), background.inputs["Color"])
    strength = tree.nodes.new("ShaderNodeMapRange")
    tree.links.new(_seen(tree), strength.inputs[0])
    for socket, value in zip(strength.inputs[1:5], (0.0, 1.0, 0.5, 1.0)):
        socket.default_value = value
    tree.links.new(strength.outputs[0], background.inputs["Strength"])


def _sky(tree, background, item, light):
    """A clear sky, without the sun's disc, which is a light of its own."""
    sky = tree.nodes.new("ShaderNodeTexSky")
    for kind in ("NISHITA", "MULTIPLE_SCATTERING"):  # the name in newer versions
        try:
            sky.sky_type = kind
            break
        except TypeError:
            continue
    towards = mathutils.Vector([float(c) for c in turned(item["towards_sun"])]).normalized()
    sky.sun_disc = False
    sky.sun_elevation = max(math.asin(max(-1.0, min(1.0, towards.z))), math.radians(-5))
    sky.sun_rotation = math.atan2(towards.x, towards.y)
    tree.links.new(sky.outputs[0], background.inputs["Color"])
    # Such that it is about half as bright as white paper in the sun.
    background.inputs["Strength"].default_value = 0.3


def _image(tree, background, item, light):
    """Rows from below, as Blender has them; its middle is where Weir has -z, here +y."""
    height, width = light.shape[:2]
    image = bpy.data.images.get(PREFIX + "surroundings")
    if image is not None:
        bpy.data.images.remove(image)
    image = bpy.data.images.new(PREFIX + "surroundings", width, height, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    # In Weir column i is the direction (sin a, cos a) of x and z with a from -pi to pi; in Blender the middle is -y,
    # which is Weir's +z, and columns go the other way round.
    pixels = numpy.ones((height, width, 4), dtype=numpy.float32)
    pixels[..., :3] = light
    image.pixels.foreach_set(pixels.ravel())
    image.update()
    image.pack()
    node = tree.nodes.new("ShaderNodeTexEnvironment")
    node.image = image
    tree.links.new(node.outputs["Color"], background.inputs["Color"])
