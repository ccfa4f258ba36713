"""The node types: `help(weir.nodes.ParticleFluid)`."""

from . import _nodes


def __getattr__(name: str) -> type:
    found = _nodes.node_class(name)
    if found is None:
        raise AttributeError(f"there is no node type '{name}'; there are {', '.join(_nodes.node_classes())}")
    return found


def __dir__() -> list[str]:
    return list(_nodes.node_classes())
