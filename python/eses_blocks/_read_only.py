"""Attributes of results that cannot be changed."""

from __future__ import annotations

from typing import Any, NoReturn


class ReadOnly:
    """A class whose public attributes cannot be set."""

    def __setattr__(self, name: str, value: Any) -> None:
        if not name.startswith("_"):
            raise AttributeError(f"{name} of {type(self).__name__} cannot be set; results are read-only")
        super().__setattr__(name, value)


class Counts(dict[str, int]):
    """Numbers of atoms by their kind, as a dictionary that cannot be changed."""

    def _refuse(self, *_arguments: Any, **_keywords: Any) -> NoReturn:
        raise TypeError("the numbers of atoms are read-only; change a copy, dict(...)")

    def __reduce__(self) -> Any:
        return Counts, (dict(self),)


for _name in ("__setitem__", "__delitem__", "__ior__", "clear", "pop", "popitem", "setdefault", "update"):
    setattr(Counts, _name, Counts._refuse)
