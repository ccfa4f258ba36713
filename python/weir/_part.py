"""What modules and nodes that are written in Python have in common: parameters and state."""

from __future__ import annotations

import inspect
import math
from typing import Any, TypeVar

from . import _core, _state
from ._errors import usage_error
from ._library import library


class Param:
    """A parameter of a module or a node, declared as a member of its class.

        rate = weir.Param(3.0, unit="1/s", min=0, doc="Angular frequency.")

    Its kind is that of the first value: bool, int, float, str, or two or three numbers. Values are checked like
    those of all parameters. With `above`, that value itself is refused too. With `animated`, a float or three
    numbers may be given as keyframes.
    """

    def __init__(self, default: Any, *, unit: str = "", doc: str = "", min: float = -math.inf, max: float = math.inf,
                 above: float | None = None, live: bool = True, animated: bool = False):
        self.default = default
        self.spec = {"unit": unit, "doc": doc, "min": min if above is None else above, "max": max,
                     "above": above is not None, "live": live, "animated": animated}
        self.__doc__ = doc

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    def __get__(self, part: Part | None, owner: type | None = None) -> Any:
        return self if part is None else part._get(self.name)

    def __set__(self, part: Part, value: Any) -> None:
        part._assign({self.name: value})


M = TypeVar("M")


def members_of(cls: type, kind: type[M]) -> dict[str, M]:
    """The members of that kind of a class, those of the classes it derives from first."""
    found: dict[str, M] = {}
    for base in reversed(cls.__mro__):
        found.update({name: member for name, member in vars(base).items() if isinstance(member, kind)})
    return found


class Part(_core.PartBase):
    """The base of weir.Module and weir.Node."""

    state: tuple[str, ...] = ()
    """Attributes that checkpoints hold: numbers, strings, lists, tuples, dicts, NumPy's arrays and random generators.
    Those of the classes it derives from are added. A resumed run gets them back after reset()."""

    _made = False

    def __init__(self, **params: Any):
        super().__init__()
        self._made = True
        self._begin(type(self).__name__, inspect.cleandoc(type(self).__doc__ or ""))
        for name, param in self.declared().items():
            self._define(name, param.default, **param.spec)
        self._assign(params)

    def _begin(self, type: str, doc: str) -> None:
        raise TypeError("a part of a scene derives from weir.Module or weir.Node")

    def _check_made(self) -> None:
        if not self._made:
            raise usage_error(f"the {type(self).__name__} is not made", "super().__init__(**params) in its __init__")

    @classmethod
    def declared(cls) -> dict[str, Param]:
        """Its parameters, those of the classes it derives from first."""
        return members_of(cls, Param)

    def _call(self, method: str, *arguments: Any) -> Any:
        try:
            return getattr(self, method)(*arguments)
        except Exception as error:
            if hasattr(error, "add_note"):  # from Python 3.11 on
                error.add_note(f"in {method}() of {self._title()}")
            raise

    def _title(self) -> str:
        return f"'{self.name}' ({type(self).__name__})"

    def save(self) -> Any:
        """What else a checkpoint shall hold, of the same kinds; None for nothing."""
        return None

    def restore(self, saved: Any) -> None:
        """Takes back what save() returned, when a run is resumed; after reset(), with `state` in place."""

    @classmethod
    def declared_state(cls) -> list[str]:
        """The names in `state` of the class and of those it derives from."""
        names: list[str] = []
        for base in reversed(cls.__mro__):
            own = vars(base).get("state", ())
            if isinstance(own, Param):
                continue
            if isinstance(own, str) or not all(isinstance(name, str) for name in own):
                raise TypeError(f"state of {base.__name__} is {own!r}, not a tuple of names of attributes")
            names += [name for name in own if name not in names]
        return names

    def _saved_state(self) -> bytes:
        kept = {}
        for name in self.declared_state():
            if not hasattr(self, name):
                raise AttributeError(f"state of {type(self).__name__} names {name!r}, which it does not have")
            kept[name] = getattr(self, name)
        return _state.packed({"state": kept, "saved": self.save()}, type(self).__name__)

    def _restore_state(self, packed: bytes) -> None:
        kept = _state.unpacked(packed)
        found, declared = sorted(kept["state"]), sorted(self.declared_state())
        if found != declared:
            raise usage_error(f"the checkpoint holds the state {found} of {type(self).__name__}, which declares {declared}",
                              "a checkpoint of the same class")
        for name, value in kept["state"].items():
            setattr(self, name, value)
        if kept["saved"] is not None:
            self.restore(kept["saved"])

    def report(self) -> dict[str, Any] | None:
        """Numbers by name, for statistics and series."""
        return None


C = TypeVar("C", bound=type)


def register(part: C) -> C:
    """Make a class of modules or nodes known by its name, so that scenes which name it can be read from files.

    Can be used as a decorator. The class must be callable without arguments.
    """
    if not (isinstance(part, type) and issubclass(part, Part)):
        raise usage_error(f"found {part!r}, which cannot be registered", "a class that derives from weir.Module or weir.Node")
    part._register(library)
    return part
