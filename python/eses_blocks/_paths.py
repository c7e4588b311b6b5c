"""Paths, open files and contents of files."""

from __future__ import annotations

import gzip
import os
import re
import weakref
from typing import Any, Union

from . import _core, adaptors

_GZIP = b"\x1f\x8b"


def format_of(text: bytes, name: str) -> str:
    """Returns the format of a text by the suffix of its name, else by its first lines."""
    stem = name.lower().removesuffix(".gz")
    for suffixes, layout in (((".cif", ".mmcif", ".mcif", ".pdbx"), "mmcif"), ((".pqr",), "pqr"),
                             ((".xyzr",), "xyzr"), ((".pdb", ".ent"), "pdb")):
        if stem.endswith(suffixes):
            return layout
    if re.search(r"\.pdb\d+$", stem):  # a biological assembly
        return "pdb"
    if re.search(rb"(?m)^\s*(data_|_atom_site\.)", text[:100000]):
        return "mmcif"
    record = re.search(rb"(?m)^(ATOM  |HETATM|HEADER|CRYST1|REMARK)", text)
    return "pdb" if record else "xyzr"


def is_file(found: Any) -> bool:
    """Whether an object is a path, an open file, or the bytes or text of a file."""
    return (isinstance(found, (str, bytes, bytearray, memoryview, os.PathLike))
            or (hasattr(found, "read") and adaptors.find_adaptor(found) is None))  # Biotite's PDBFile has `read`, too


def is_path(found: Any) -> bool:
    """Whether an object is a path, and no open file or content."""
    if isinstance(found, bytes):
        return bool(found) and b"\n" not in found and found[:2] != _GZIP
    return isinstance(found, os.PathLike) or (isinstance(found, str) and "\n" not in found)


def name_of(found: Any) -> str:
    """Returns the name of a file for messages."""
    name = found if is_path(found) else getattr(found, "name", None)
    return os.fsdecode(name) if isinstance(name, (str, bytes, os.PathLike)) else "text"


# The paths of the files from which atoms and surfaces were read.
_files_of: weakref.WeakKeyDictionary[Union[_core.Atoms, _core.Surface], tuple[str, ...]] = weakref.WeakKeyDictionary()


def remember_files(found: Union[_core.Atoms, _core.Surface], *paths: Union[str, bytes]) -> None:
    """Remembers the files from which an object was read, as far as the paths are those of files."""
    _files_of[found] = tuple(os.path.abspath(os.fsdecode(path)) for path in paths if os.path.exists(path))


def files_of(found: Union[_core.Atoms, _core.Surface]) -> tuple[str, ...]:
    """Returns the paths of the files from which an object was read."""
    return _files_of.get(found, ())


def read_content(found: Any, layout: str) -> tuple[bytes, str, str]:
    """Returns the content, the name and the format of a path, or as `read_opened`."""
    if not is_path(found):
        return read_opened(found, layout)
    with open(found, "rb") as opened:
        return read_opened(opened, layout)


def read_opened(found: Any, layout: str) -> tuple[bytes, str, str]:
    """Returns the content, the name and the format of an open file, or of the bytes or text of a file."""
    name = name_of(found)
    data = found.read() if hasattr(found, "read") else found
    data = _unpacked(data.encode() if isinstance(data, str) else bytes(data))
    return data, name, format_of(data, name) if layout == "auto" else layout


def _unpacked(data: bytes) -> bytes:
    return gzip.decompress(data) if data[:2] == _GZIP else data
