"""Node trees: copies without groups, and what a socket's link leads to."""
import bpy

SKIPPED = {"name", "label", "parent", "location", "width", "height", "select", "dimensions", "color", "hide", "type",
           "use_custom_color", "show_options", "show_preview", "show_texture", "inputs", "outputs", "internal_links",
           "node_tree"}
"""Properties of nodes that `copy_node` leaves alone."""

LIGHTING = {"Is Diffuse Ray": 1.0, "Is Shadow Ray": 1.0}
"""Outputs of Light Path as the rays see them that transport light."""

CAMERA = {"Is Camera Ray": 1.0}


NEWER = {"Transmission": "Transmission Weight", "Specular": "Specular IOR Level", "Emission": "Emission Color",
         "Subsurface": "Subsurface Weight", "Clearcoat": "Coat Weight", "Clearcoat Roughness": "Coat Roughness",
         "Sheen": "Sheen Weight"}
"""Inputs of the Principled BSDF that Blender 4.0 renamed."""


def entry(node, name):
    """The input of a Principled BSDF by its name in Blender 3.4; None if this Blender has none like it."""
    return node.inputs.get(name) or node.inputs.get(NEWER.get(name, ""))


def coat_factor(node):
    """Reflection of a Principled BSDF's coat over that of glTF's. Before Blender 4.0 it is a quarter."""
    return 0.25 if "Clearcoat" in node.inputs else 1.0


def fresnel_mean(eta):
    """Mean reflectance of a dielectric under uniform light (Egan and Hilgeman's fit)."""
    return (eta - 1) / (4.08567 + 1.00071 * eta) if eta >= 1 else 1.0


def flat_copy(data, rays=CAMERA, backfacing=0.0):
    """A copy of a material, world or light whose node tree has no groups.

    Nodes that depend on the ray become constants: Light Path as `rays` says, Geometry's Backfacing, and the means of
    Fresnel and Layer Weight.
    """
    copy = data.copy()
    tree = copy.node_tree
    for node in tree.nodes:
        if node.type == "TEX_IES":  # Blender moves relative paths of linked data twice
            origin = data.node_tree.nodes[node.name].filepath
            node.filepath = bpy.path.abspath(origin, library=getattr(data, "library", None)) if origin else ""
    for _ in range(64):
        groups = [node for node in tree.nodes if node.bl_idname == "ShaderNodeGroup"]
        if not groups:
            break
        for node in groups:
            if node.node_tree and not node.mute:
                _inline(tree, node)
            tree.nodes.remove(node)
    for node in list(tree.nodes):
        if node.type == "LIGHT_PATH":
            _make_constant(tree, node, {out.name: rays.get(out.name, 0.0) for out in node.outputs})
        elif node.type == "NEW_GEOMETRY":
            _make_constant(tree, node, {"Backfacing": backfacing})
        elif node.type == "FRESNEL":
            eta = max(node.inputs["IOR"].default_value, 1.0)
            _make_constant(tree, node, {"Fac": fresnel_mean(eta)}, eta)
        elif node.type == "LAYER_WEIGHT":
            blend = min(max(node.inputs["Blend"].default_value, 0.0), 0.99999)
            power = 2 * blend if blend < 0.5 else 0.5 / (1 - blend)
            eta = 1 / (1 - blend)
            _make_constant(tree, node, {"Fresnel": fresnel_mean(eta)}, eta)
            _make_constant(tree, node, {"Facing": 1 - 2 / (power + 2)})
    return copy


def _make_constant(tree, node, values, eta=None):
    """Replaces the named outputs of a node by constants. A Fresnel factor keeps its index of refraction as `eta`."""
    for name, value in values.items():
        out = node.outputs.get(name)
        if out and out.is_linked:
            constant = tree.nodes.new("ShaderNodeValue")
            constant.outputs[0].default_value = value
            if eta:
                constant["eta"] = eta
            for link in list(out.links):
                tree.links.new(constant.outputs[0], link.to_socket)


def copy_node(tree, node):
    """A copy of `node` in another tree: its settings, and the values of its unlinked inputs."""
    new = tree.nodes.new(node.bl_idname)
    for prop in node.bl_rna.properties:
        if prop.identifier in SKIPPED:
            continue
        if not prop.is_readonly:
            try:
                setattr(new, prop.identifier, getattr(node, prop.identifier))
            except (AttributeError, TypeError, ValueError):
                pass
        elif prop.type == "POINTER":
            _copy_settings(getattr(node, prop.identifier), getattr(new, prop.identifier))
    for sockets, others in ((node.inputs, new.inputs), (node.outputs, new.outputs)):
        for socket, other in zip(sockets, others):
            if hasattr(socket, "default_value"):
                other.default_value = socket.default_value
    return new


def _copy_settings(source, target):
    if isinstance(source, bpy.types.ColorRamp):
        while len(target.elements) > len(source.elements):
            target.elements.remove(target.elements[-1])
        while len(target.elements) < len(source.elements):
            target.elements.new(1.0)
        for old, new in zip(source.elements, target.elements):
            new.position, new.color = old.position, old.color
        target.color_mode, target.interpolation = source.color_mode, source.interpolation
        target.hue_interpolation = source.hue_interpolation
    elif isinstance(source, bpy.types.CurveMapping):
        for old, new in zip(source.curves, target.curves):
            while len(new.points) < len(old.points):
                new.points.new(0.0, 0.0)
            for p, q in zip(old.points, new.points):
                q.location, q.handle_type = p.location, p.handle_type
        target.update()
    elif isinstance(source, (bpy.types.ImageUser, bpy.types.TexMapping)):
        for prop in source.bl_rna.properties:
            if not prop.is_readonly:
                setattr(target, prop.identifier, getattr(source, prop.identifier))


def _inline(tree, group):
    """Puts the nodes of a group into the tree that uses it, with the same links."""
    inner = group.node_tree
    copies, inputs = {}, {}
    output = next((n for n in inner.nodes if n.type == "GROUP_OUTPUT" and n.is_active_output), None)
    for index, socket in enumerate(group.inputs):
        inputs[socket.identifier] = socket.links[0].from_socket if socket.is_linked else _constant(tree, socket)
    for node in inner.nodes:
        if node.type not in {"GROUP_INPUT", "GROUP_OUTPUT", "FRAME"}:
            copies[node.name] = copy_node(tree, node)

    def outside(socket):
        """The socket of the outer tree that an output inside the group has become."""
        if socket.node.type == "GROUP_INPUT":
            return inputs.get(socket.identifier)
        node = copies.get(socket.node.name)
        return node.outputs[list(socket.node.outputs).index(socket)] if node else None

    for link in inner.links:
        if link.to_node.name in copies:
            source = outside(link.from_socket)
            if source:
                target = copies[link.to_node.name].inputs[list(link.to_node.inputs).index(link.to_socket)]
                tree.links.new(source, target)
    for socket, inside in zip(group.outputs, output.inputs if output else []):
        for link in list(socket.links):
            source = outside(inside.links[0].from_socket) if inside.is_linked else _constant(tree, inside)
            if source:
                tree.links.new(source, link.to_socket)
            else:
                tree.links.remove(link)


def _constant(tree, socket):
    """A node's output with the value of an unlinked input; None where the input has none to pass on."""
    if socket.hide_value or not hasattr(socket, "default_value") or socket.type in {"SHADER", "STRING"}:
        return None
    if socket.type == "RGBA":
        node = tree.nodes.new("ShaderNodeRGB")
        node.outputs[0].default_value = socket.default_value
    elif socket.type == "VECTOR":
        node = tree.nodes.new("ShaderNodeCombineXYZ")
        for k in range(3):
            node.inputs[k].default_value = socket.default_value[k]
    else:
        node = tree.nodes.new("ShaderNodeValue")
        node.outputs[0].default_value = socket.default_value
    return node.outputs[0]


def trace(socket):
    """(The output that feeds an input, through reroutes and muted nodes, or None; the last input on that way)."""
    while socket.is_linked:
        origin = socket.links[0].from_socket
        node = origin.node
        if node.type == "REROUTE":
            socket = node.inputs[0]
        elif node.mute:
            inside = next((link.from_socket for link in node.internal_links if link.to_socket == origin), None)
            if inside is None:
                break
            socket = inside
        else:
            return origin, socket
    return None, socket


def source(socket):
    """The output that feeds an input; None if the input is unlinked."""
    return trace(socket)[0]


def upstream(socket):
    """All nodes that an output depends on, with its own node."""
    found, waiting = [], [socket.node]
    while waiting:
        node = waiting.pop()
        if node not in found:
            found.append(node)
            waiting += [origin.node for origin in map(source, node.inputs) if origin]
    return found


def all_nodes(tree):
    """The nodes of a tree, and of the groups in it."""
    found, trees = [], [tree]
    for tree in trees:
        for node in tree.nodes:
            found.append(node)
            if node.bl_idname == "ShaderNodeGroup" and node.node_tree and node.node_tree not in trees:
                trees.append(node.node_tree)
    return found
