"""Materials of Cycles for the looks that surfaces have in Weir."""

import bpy

from .handover import linear

# Not "color": Cycles shows that black on point clouds.
COLOR = "weir_color"
FOAM = "weir_foam"
FOAM_PATTERNS = ("weir_foam_places_0", "weir_foam_places_1")  # see foam.py
FOAM_SHARES = "weir_foam_shares"
FOAM_GAIN = 1.6  # so that about three times the area of the foam is white, up to a third of all
WHITE = (0.95, 0.97, 0.98)


def _new(name):
    """An empty material of that name; one that an artist has taken over is left alone (see `ours`)."""
    material = bpy.data.materials.get(name) or bpy.data.materials.new(name)
    material.use_nodes = True
    material.node_tree.nodes.clear()
    return material


class _Nodes:
    """Makes the nodes of a tree, and links them."""

    def __init__(self, tree):
        self.tree = tree

    def add(self, kind, **inputs):
        node = self.tree.nodes.new(kind)
        for name, value in inputs.items():
            socket = self.socket(node, name)
            if hasattr(value, "is_output"):
                self.tree.links.new(value, socket)
            else:
                socket.default_value = value
        return node

    @staticmethod
    def socket(node, name):
        """An input by one of its names: 'Transmission_Weight' is what newer versions call 'Transmission'."""
        for candidate in (name.replace("_", " "), *_OLD_NAMES.get(name, ())):
            if candidate in node.inputs:
                return node.inputs[candidate]
        if name[-1].isdigit():
            return node.inputs[int(name[-1])]
        raise KeyError(f"{node.bl_idname} has no input {name}")

    def math(self, operation, a, b=0.0):
        node = self.tree.nodes.new("ShaderNodeMath")
        node.operation = operation
        for socket, value in zip(node.inputs, (a, b)):
            if hasattr(value, "is_output"):
                self.tree.links.new(value, socket)
            else:
                socket.default_value = value
        return node.outputs[0]

    def mix(self, share, first, second):
        """Of two shaders."""
        node = self.tree.nodes.new("ShaderNodeMixShader")
        for socket, value in zip(node.inputs, (share, first, second)):
            if hasattr(value, "is_output"):
                self.tree.links.new(value, socket)
            else:
                socket.default_value = value
        return node.outputs[0]

    def output(self, surface=None, volume=None):
        node = self.tree.nodes.new("ShaderNodeOutputMaterial")
        if surface is not None:
            self.tree.links.new(surface, node.inputs["Surface"])
        if volume is not None:
            self.tree.links.new(volume, node.inputs["Volume"])


_OLD_NAMES = {"Specular_IOR_Level": ("Specular",), "Transmission_Weight": ("Transmission",)}


def _rgba(color):
    return (*(float(c) for c in linear(color[:3])), 1.0)


def _base(nodes, color, colored):
    if not colored:
        return _rgba(color)
    attribute = nodes.add("ShaderNodeAttribute")
    attribute.attribute_name = COLOR
    return attribute.outputs["Color"]


def opaque(name, color, metallic, roughness, colored=False):
    """Of one colour, or of the attribute COLOR."""
    material = _new(name)
    nodes = _Nodes(material.node_tree)
    shader = nodes.add("ShaderNodeBsdfPrincipled", Base_Color=_base(nodes, color, colored), Metallic=metallic, Roughness=roughness,
                       Specular_IOR_Level=0.5 if metallic else 0.25)
    nodes.output(shader.outputs[0])
    return material


def particles(name, color, colored):
    """Of spheres: the attribute COLOR, or one colour."""
    material = _new(name)
    nodes = _Nodes(material.node_tree)
    shader = nodes.add("ShaderNodeBsdfPrincipled", Base_Color=_base(nodes, color, colored), Roughness=0.4, Specular_IOR_Level=0.35)
    nodes.output(shader.outputs[0])
    return material


def white_water(name, color):
    """Of drops and bubbles too small to be seen one by one: light comes out of them on all sides alike, and much of it
    passes between them, so that few are mist and many are white."""
    material = _new(name)
    nodes = _Nodes(material.node_tree)
    tint = _rgba(color)
    clear = nodes.add("ShaderNodeBsdfTransparent", Color=(1, 1, 1, 1)).outputs[0]
    nodes.output(nodes.mix(0.3, _froth(nodes, tint), clear))
    return material


def _froth(nodes, tint):
    """White on both sides."""
    front = nodes.add("ShaderNodeBsdfDiffuse", Color=tint).outputs[0]
    back = nodes.add("ShaderNodeBsdfTranslucent", Color=tint).outputs[0]
    return nodes.mix(0.5, front, back)


def glass(name, color, closed):
    """Of a closed mesh: bends light. Of an open one, a thin pane: light passes straight, less what is mirrored."""
    material = _new(name)
    nodes = _Nodes(material.node_tree)
    tint = _rgba(color)
    path = nodes.add("ShaderNodeLightPath")
    clear = nodes.add("ShaderNodeBsdfTransparent", Color=tint).outputs[0]
    if closed:
        solid = nodes.add("ShaderNodeBsdfGlass", Color=tint, Roughness=0.0, IOR=1.5).outputs[0]
    else:
        mirror = nodes.add("ShaderNodeBsdfGlossy", Roughness=0.0).outputs[0]
        rim = nodes.add("ShaderNodeFresnel", IOR=1.5).outputs[0]
        solid = nodes.mix(rim, clear, mirror)
    nodes.output(nodes.mix(path.outputs["Is Shadow Ray"], solid, clear))
    return material


def water(name, look, caustics, foam_reach=None, carried=False):
    """Beer and Lambert: of light that goes x metres, exp(-absorption x) is left. Without caustics light goes straight
    on through the surface to what it lights, and is absorbed on its way as well. `carried`: whether the mesh has the
    attributes by which foam goes along with the water."""
    material = _new(name)
    nodes = _Nodes(material.node_tree)
    surface = nodes.add("ShaderNodeBsdfGlass", Color=(1, 1, 1, 1), Roughness=0.0,
                        IOR=float(look["refractive_index"])).outputs[0]
    if not caustics:
        path = nodes.add("ShaderNodeLightPath")
        clear = nodes.add("ShaderNodeBsdfTransparent", Color=(1, 1, 1, 1)).outputs[0]
        surface = nodes.mix(path.outputs["Is Shadow Ray"], surface, clear)
    if foam_reach is not None:
        surface = nodes.mix(_lace(nodes, foam_reach, carried), surface, _froth(nodes, _rgba(WHITE)))
    nodes.output(surface, _inside(nodes, look))
    return material


def _attribute(nodes, name):
    node = nodes.add("ShaderNodeAttribute")
    node.attribute_name = name
    return node


def _lace(nodes, reach, carried):
    """How white it is, by the attribute FOAM. Finer than the mesh: little foam lies in threads around cells of clear
    water, which close as it becomes more."""
    share = nodes.math("MULTIPLY", nodes.math("SQRT", _attribute(nodes, FOAM).outputs["Fac"]), FOAM_GAIN)
    if carried:
        height = _carried_threads(nodes, reach)
    else:
        height = _threads(nodes, reach, nodes.add("ShaderNodeTexCoord").outputs["Object"])
    lies = nodes.tree.nodes.new("ShaderNodeMapRange")
    lies.interpolation_type = "SMOOTHSTEP"
    nodes.tree.links.new(nodes.math("ADD", share, height), lies.inputs[0])
    for socket, value in zip(lies.inputs[1:5], (0.75, 1.25, 0.0, 0.95)):
        socket.default_value = value
    return lies.outputs[0]


def _carried_threads(nodes, reach):
    """Two patterns that go along with the water for a while, by what foam.py gives each vertex."""
    shares = nodes.add("ShaderNodeSeparateXYZ", Vector=_attribute(nodes, FOAM_SHARES).outputs["Vector"])
    height = shares.outputs[2]
    for pattern, part in zip(FOAM_PATTERNS, shares.outputs):
        threads = _threads(nodes, reach, _attribute(nodes, pattern).outputs["Vector"])
        height = nodes.math("ADD", height, nodes.math("MULTIPLY", threads, part))
    return height


def _threads(nodes, reach, places):
    """From 0 to 1, highest where foam lies first: around cells of two sizes."""
    bent = nodes.add("ShaderNodeTexNoise", Vector=places, Scale=0.4 / reach, Detail=4.0)
    moved = nodes.add("ShaderNodeVectorMath", Vector=bent.outputs["Color"])
    moved.operation = "MULTIPLY_ADD"
    moved.inputs[1].default_value = (2 * reach,) * 3
    nodes.tree.links.new(places, moved.inputs[2])
    grain = nodes.add("ShaderNodeTexNoise", Vector=places, Scale=3 / reach, Detail=2.0)
    height = nodes.math("MULTIPLY", grain.outputs["Fac"], 0.3)
    for size, weight in ((2.5, 0.45), (0.7, 0.25)):
        cells = nodes.add("ShaderNodeTexVoronoi", Vector=moved.outputs[0], Scale=1 / (size * reach))
        cells.feature = "DISTANCE_TO_EDGE"
        thread = nodes.math("MAXIMUM", nodes.math("SUBTRACT", 1.0, nodes.math("MULTIPLY", cells.outputs["Distance"], 3.0)))
        height = nodes.math("ADD", height, nodes.math("MULTIPLY", thread, weight))
    return height


def _inside(nodes, look):
    """What is scattered of light has a colour: the rest of it is absorbed."""
    scattering = float(look["scattering"])
    colors = [float(c) for c in linear(look["scattered"][:3])]
    absorbed = [float(a) + scattering * (1 - c) for a, c in zip(look["absorption"], colors)]
    volumes = []
    if max(absorbed) > 0:
        # The node absorbs density (1 - colour).
        most = max(absorbed)
        volumes.append(nodes.add("ShaderNodeVolumeAbsorption", Density=most,
                                 Color=(*(1 - a / most for a in absorbed), 1.0)).outputs[0])
    if scattering * max(colors) > 0:
        volumes.append(nodes.add("ShaderNodeVolumeScatter", Density=scattering, Color=(*colors, 1.0)).outputs[0])
    if len(volumes) < 2:
        return volumes[0] if volumes else None
    both = nodes.tree.nodes.new("ShaderNodeAddShader")
    for socket, volume in zip(both.inputs, volumes):
        nodes.tree.links.new(volume, socket)
    return both.outputs[0]


def ground(name, color, radius, tiles, fades):
    """A floor of tiles, of a disc of radius 1 that is scaled; where it fades, it is gone at its rim."""
    material = _new(name)
    nodes = _Nodes(material.node_tree)
    places = nodes.add("ShaderNodeTexCoord").outputs["Object"]
    base = _rgba(color)
    if tiles > 0:
        checker = nodes.add("ShaderNodeTexChecker", Vector=places, Color1=base, Scale=radius / tiles,
                            Color2=(*(0.62 * c for c in base[:3]), 1.0))
        base = checker.outputs["Color"]
    shader = nodes.add("ShaderNodeBsdfPrincipled", Base_Color=base, Roughness=0.55, Specular_IOR_Level=0.3).outputs[0]
    if fades:
        away = nodes.add("ShaderNodeVectorMath", Vector=places)
        away.operation = "LENGTH"
        share = nodes.tree.nodes.new("ShaderNodeMapRange")
        share.interpolation_type = "SMOOTHSTEP"
        nodes.tree.links.new(away.outputs["Value"], share.inputs[0])
        for socket, value in zip(share.inputs[1:5], (0.45, 0.98, 0.0, 1.0)):
            socket.default_value = value
        clear = nodes.add("ShaderNodeBsdfTransparent", Color=(1, 1, 1, 1)).outputs[0]
        shader = nodes.mix(share.outputs[0], shader, clear)
    nodes.output(shader)
    return material


def surface(name, item, waters, closed, caustics, colored, carried):
    """Of a surface of the hand-over, by its look."""
    if item["look"] == "water" and closed:
        return water(name, waters[item["water"]], caustics, item.get("foam_reach"), carried)
    if item["look"] in ("glass", "water"):
        return glass(name, item["color"], closed)
    if item["look"] == "metal":
        return opaque(name, item["color"], 1.0, 0.22, colored)
    return opaque(name, item["color"], 0.0, 0.4 if colored else 0.7, colored)
