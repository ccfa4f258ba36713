"""The module types: `help(weir.modules.SemiImplicitSolver)`."""

from . import _nodes


def __getattr__(name: str) -> type:
    found = _nodes.module_classes().get(name)
    if found is None:
        raise AttributeError(f"there is no module type '{name}'; there are {', '.join(_nodes.module_classes())}")
    return found


def __dir__() -> list[str]:
    return list(_nodes.module_classes())
