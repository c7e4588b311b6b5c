"""Types of arguments by their names, and messages about wrong ones."""

from __future__ import annotations

import difflib
import importlib
import inspect
import os
from typing import Any, Callable, Iterable, NoReturn

import numpy as np


def imported(name: str, caller: Any) -> Any:
    """Returns a module of another package, which only `caller` needs."""
    try:
        return importlib.import_module(name)
    except ModuleNotFoundError as error:
        package = name.partition(".")[0]
        raise ImportError(f"{caller} needs {package}; install it, for example with `pip install {package}`") from error


def _is_text(value: Any) -> bool:
    return isinstance(value, str)


def _is_flag(value: Any) -> bool:
    return isinstance(value, (bool, np.bool_)) or (isinstance(value, int) and value in (0, 1))


def _is_integer(value: Any) -> bool:
    return hasattr(value, "__index__") and np.ndim(value) == 0


def _is_number(value: Any) -> bool:
    return (hasattr(value, "__float__") or hasattr(value, "__index__")) and np.ndim(value) == 0


def _is_path(value: Any) -> bool:
    return isinstance(value, (str, bytes, os.PathLike))


def _is_name_list(value: Any) -> bool:
    return isinstance(value, (list, tuple)) and all(isinstance(each, str) for each in value)


def _has_numbers(*counts: int) -> Callable[[Any], bool]:
    def check(value: Any) -> bool:
        try:
            return np.size(value) in counts and all(_is_number(each) for each in np.ravel(value).tolist())
        except (TypeError, ValueError):  # such as rows of different lengths
            return False

    return check


_Kind = tuple[Callable[[Any], bool], str]
_NUMBER: _Kind = _is_number, "a number"
_INTEGER: _Kind = _is_integer, "a whole number"
_FLAG: _Kind = _is_flag, "True or False"
_TEXT: _Kind = _is_text, "a text"
_TRIPLE: _Kind = _has_numbers(3), "three numbers"
_CORNERS: _Kind = _has_numbers(6), "two corners of three whole numbers each"
_KINDS: dict[str, _Kind] = {
    **dict.fromkeys(["probe_radius", "unknown_radius", "spacing", "margin", "large_probe", "min_volume", "ion_radius",
                     "solute", "solvent", "area_cutoff", "residue_cutoff"], _NUMBER),
    **dict.fromkeys(["threads", "frame", "block_size", "max_memory", "axis", "height", "n_points"], _INTEGER),
    **dict.fromkeys(["waters", "hetatm", "ses", "van_der_waals", "by_atom", "derivatives", "inside", "crossings", "quality",
                     "component", "allow_far_atoms", "get_mapping", "ignore_ions"], _FLAG),
    **dict.fromkeys(["format", "hydrogens", "chain_names", "surface", "reference", "column", "level", "title", "backend",
                     "style", "mode"], _TEXT),
    **dict.fromkeys(["origin", "center"], _TRIPLE),
    **dict.fromkeys(["blocks", "region"], _CORNERS),
    "model": (lambda value: _is_integer(value) and abs(int(value)) < 2**31, "a whole number"),
    "altloc": (_is_text, "a text such as 'A'"),
    "assembly": (_is_text, "a text such as '1'"),
    "select": (_is_text, "a text such as '//A'"),
    "chains": (_is_name_list, "a list of names such as ['A', 'B']"),
    "color": (_is_text, "a text"),
    "shape": (_has_numbers(3), "three whole numbers"),
    "grid": (lambda value: type(value).__name__ == "Grid", "a Grid, such as that of Surface.grid()"),
    "path": (lambda value: _is_path(value) or hasattr(value, "read"), "a path or an open file"),
}


def _require(name: str, value: Any, default: Any) -> None:
    """Raises TypeError for an argument of another type, unless it is the default."""
    if name not in _KINDS or (value is None and default is None):
        return
    is_valid, description = _KINDS[name]
    if not is_valid(value):
        raise TypeError(f"{name} must be {description}, not {value!r:.80}")


def require_types(defaults: dict[str, Any], arguments: dict[str, Any]) -> None:
    """Raises TypeError for the first argument of a wrong type. `defaults` has the values of arguments that are
    not given."""
    for name, value in arguments.items():
        _require(name, value, defaults.get(name, inspect.Parameter.empty))


def check(function: Callable[..., Any], **arguments: Any) -> None:
    """Raises TypeError for the first argument of a function that has a wrong type."""
    parameters = inspect.signature(function).parameters
    require_types({name: each.default for name, each in parameters.items()}, arguments)


def require_not_negative(**arguments: Any) -> None:
    """Raises ValueError for the first number that is negative or not finite."""
    for name, value in arguments.items():
        if not 0 <= value < np.inf:
            raise ValueError(f"{name} must be finite and not negative, not {value}")


def require_choice(name: str, value: Any, *known: str) -> None:
    """Raises ValueError for an argument that is none of the known texts."""
    if not isinstance(value, str) or value not in known:
        names = [repr(each) for each in known]
        raise ValueError(f"{name} must be {', '.join(names[:-1])} or {names[-1]}, not {value!r:.80}")


def require_object(name: str, value: Any, attributes: Iterable[str], expected: str) -> None:
    """Raises TypeError for an object of another library that lacks one of the attributes."""
    if not all(hasattr(value, each) for each in attributes):
        raise TypeError(f"{name} must be {expected}, not {value!r:.80}")


def require_mask(name: str, given: Any, count: int) -> np.ndarray[Any, np.dtype[np.bool_]]:
    """Returns a mask with a value for each of `count` atoms. Raises ValueError for another shape, and TypeError for
    other values."""
    mask = np.asarray(given)
    if mask.dtype != bool and not (mask.dtype.kind in "iu" and np.isin(mask, (0, 1)).all()):
        raise TypeError(f"{name} must be a mask of atoms, not {given!r:.80}")
    if mask.shape != (count,):
        raise ValueError(f"{name}: a mask must have shape ({count},), one value for each atom, not {mask.shape}")
    return mask.astype(bool)


def require_indices(name: str, given: Any, count: int) -> np.ndarray[Any, np.dtype[np.int64]]:
    """Returns the indices of atoms, also those of a mask, in ascending order. Negative ones count from the end."""
    indices = np.asarray(given)
    if indices.dtype == bool:
        return np.flatnonzero(require_mask(name, given, count))
    if indices.ndim != 1 or (indices.size and indices.dtype.kind not in "iu"):
        raise TypeError(f"{name} must be a mask or indices of atoms, not {given!r:.80}")
    for index in indices.tolist():
        if not -count <= index < count:
            raise IndexError(f"{name}: there are {count} atoms, and no atom {index}, counted from 0")
    return np.unique(indices.astype(np.int64))


def require_radii(name: str, given: Any) -> dict[str, float]:
    """Returns radii by element. Raises TypeError for what is no mapping of radii, and ValueError for negative ones."""
    if given is None:
        return {}
    if not hasattr(given, "items"):
        raise TypeError(f"{name} must be a mapping of elements to radii, not {given!r:.80}")
    radii = dict(given.items())
    for element, radius in radii.items():
        if not _is_number(radius):
            raise TypeError(f"{name}: the radius of {element!r} must be a number, not {radius!r:.80}")
        require_not_negative(**{f"{name}: the radius of {element!r}": radius})
    return radii


def refuse_unknown(name: str, known: Iterable[str]) -> NoReturn:
    """Raises TypeError for an argument that a function does not have, with the name that was probably meant."""
    names = list(known)
    meant = [each for each in names if each.startswith(name)] or difflib.get_close_matches(name, names, 1, 0.7)
    raise TypeError(f"unknown argument {name!r}" + (f"; did you mean {meant[0]}?" if meant else ""))


def refuse(function: Callable[..., Any], arguments: tuple[Any, ...], keywords: dict[str, Any]) -> NoReturn:
    """Raises TypeError for arguments that a compiled function does not take. `arguments` has `self` of methods."""
    parameters = inspect.signature(function).parameters
    has_options = any(each.kind is each.VAR_KEYWORD for each in parameters.values())
    for name in keywords:
        if name not in parameters and not has_options:
            refuse_unknown(name, [each for each in parameters if each != "self"])
    try:
        bound = inspect.signature(function).bind(*arguments, **keywords).arguments
    except TypeError as error:  # too few or too many
        raise TypeError(f"{function.__name__}: {error}") from None
    check(function, **{name: value for name, value in bound.items() if name != "function"})
    values = ", ".join(f"{name}={value!r:.40}" for name, value in bound.items() if name != "self")
    raise TypeError(f"{function.__name__}: an argument has a wrong type: {values}")
