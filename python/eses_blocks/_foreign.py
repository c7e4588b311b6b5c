"""Files that other libraries read: BinaryCIF by Biotite, SDF, MOL and MOL2 by RDKit."""

import gzip
import pathlib
from typing import Any

from . import _arguments


def _opened(path: pathlib.Path) -> Any:
    return gzip.open(path, "rb") if path.suffix.lower() == ".gz" else open(path, "rb")


def _read_binary_cif(path: pathlib.Path, frame: int) -> Any:
    pdbx = _arguments.imported("biotite.structure.io.pdbx", path)
    with _opened(path) as source:
        return pdbx.get_structure(pdbx.BinaryCIFFile.read(source), model=frame + 1, altloc="occupancy")


def _read_sdf(path: pathlib.Path, frame: int) -> Any:
    chem = _arguments.imported("rdkit.Chem", path)
    with _opened(path) as source:
        for number, molecule in enumerate(chem.ForwardSDMolSupplier(source, removeHs=False)):
            if number == frame:
                return molecule
    return None


def _read_mol2(path: pathlib.Path, frame: int) -> Any:
    chem = _arguments.imported("rdkit.Chem", path)
    with _opened(path) as source:
        blocks = source.read().decode("utf-8", "replace").split("@<TRIPOS>MOLECULE")[1:]
    return chem.MolFromMol2Block("@<TRIPOS>MOLECULE" + blocks[frame], removeHs=False) if frame < len(blocks) else None


_READERS = {".bcif": _read_binary_cif, ".sdf": _read_sdf, ".sd": _read_sdf, ".mol": _read_sdf, ".mol2": _read_mol2}


def _suffix(name: str) -> str:
    return pathlib.PurePath(name.lower().removesuffix(".gz")).suffix


def is_foreign(name: str) -> bool:
    """Whether another library reads files of this name."""
    return _suffix(name) in _READERS


def read(name: str, frame: int) -> Any:
    """Returns the molecule of a file as an object of the library that reads it. `frame` is the index of the model of a
    BinaryCIF file, or of the molecule of an SDF or MOL2 file."""
    path = pathlib.Path(name)
    molecule = _READERS[_suffix(name)](path, frame)
    if molecule is None:
        raise ValueError(f"{path}: no valid molecule {frame}, counted from 0")
    return molecule
