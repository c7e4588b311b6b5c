"""Finds the structures below a folder and gives them ids."""

import collections
import fnmatch
import gzip
import os
import pathlib
import re
import zlib

from eses_tools.common import Failed

KINDS = (".xyzr, .pqr, .pdb, .pdb1, .pdb2 and so on, .ent, .cif, .mmcif, .mcif and .pdbx, each "
         "also .gz")

# Suffixes and the formats of eses-blocks --format.
LAYOUTS = {"xyzr": "xyzr", "pqr": "pqr", "pdb": "pdb", "ent": "pdb", "cif": "mmcif",
           "mmcif": "mmcif", "mcif": "mmcif", "pdbx": "mmcif"}

# First lines of files of areas, by suffix.
AREA_HEADINGS = {"pdb": b"REMARK 999 B-FACTORS ARE ", "cif": b"data_areas\n"}

# Suffix of the PDB's files of assemblies, in the format PDB. Their models are copies of chains.
ASSEMBLY_SUFFIX = r"pdb[0-9]+"

# id: text like a path, unique among the structures of a folder. layout: xyzr, pqr, pdb or mmcif.
Structure = collections.namedtuple("Structure", "id path layout bytes mtime_ns")


def is_assembly_file(name):
    """Whether a file has the suffix of an assembly of the PDB, such as 1abc.pdb1.gz."""
    return re.search(rf"\.{ASSEMBLY_SUFFIX}(\.gz)?\Z", name, re.IGNORECASE) is not None


def split_name(name):
    """Returns stem and layout of a structure file, or None for other files.

    The stem of an assembly file has its suffix: 1abc.pdb1 for 1abc.pdb1.gz. Names that begin with a
    dot are skipped: unfinished files, and files that macOS leaves (._1abc.pdb).
    """
    match = re.fullmatch(rf"(?P<stem>[^.].*)\.(?P<suffix>{'|'.join(LAYOUTS)}|{ASSEMBLY_SUFFIX})"
                         r"(?:\.gz)?", name, re.IGNORECASE | re.DOTALL)
    if match is None:
        return None
    stem, suffix = match["stem"], match["suffix"]
    return (f"{stem}.{suffix}", "pdb") if is_assembly_file(name) else (stem, LAYOUTS[suffix.lower()])


def make_id(folders, stem):
    """Joins folders and stem, without the repetition of PDBbind: 1a30/1a30_protein.pdb is 1a30."""
    name = stem.removesuffix("_protein") or stem
    return "/".join(folders if folders[-1:] == (name,) else (*folders, name))


def is_pocket(stem, stems):
    """Whether the file is a pocket, the part of a protein that PDBbind stores beside it."""
    return stem.endswith("_pocket") and stem.removesuffix("_pocket") + "_protein" in stems


def walk(root, without, on_error):
    """Yields each folder with the names of its files, for the root and every folder below.

    Links are followed, but no folder is entered twice.
    """
    seen = {os.path.realpath(without)} if without else set()
    for folder, below, files in os.walk(root, followlinks=True, onerror=on_error):
        place = os.path.realpath(folder)
        if place in seen:
            below.clear()
            continue
        seen.add(place)
        below[:] = sorted(name for name in below if not name.startswith("."))
        yield pathlib.Path(folder), sorted(files)


def is_area_file(path):
    """Whether eses-blocks has written a file of areas, by its name and its first line."""
    heading = re.search(r"\.areas\.(pdb|cif)(\.gz)?\Z", path.name, re.IGNORECASE)
    if heading is None:
        return False
    try:
        with (gzip.open if heading[2] else open)(path, "rb") as file:
            return file.readline(200).startswith(AREA_HEADINGS[heading[1].lower()])
    except (OSError, EOFError, zlib.error):
        return False  # is reported when the file is read


def find_structures(root, without=None, only=None, on_error=None, on_areas=None):
    """Returns all structures below `root`, sorted by id, except those below the folder `without`.

    `only` is a shell pattern for the path below the root; scripts with an option --only pass it.
    `on_error` receives the OSError of each folder that cannot be read, and `on_areas` the path of
    each file of areas that `eses-blocks` has written, which is no structure. Throws Failed if two files
    have the same id.
    """
    found = {}
    for folder, files in walk(root, without, on_error):
        folders = folder.relative_to(root).parts
        known = {name: split for name in files if (split := split_name(name))}
        stems = {stem for stem, _ in known.values()}
        for name, (stem, layout) in known.items():
            path = folder / name
            below_root = "/".join((*folders, name))
            if (is_pocket(stem, stems) or not fnmatch.fnmatchcase(below_root, only or "*")
                    or not path.is_file()):
                continue
            if is_area_file(path):
                if on_areas:
                    on_areas(path)
                continue
            status = path.stat()
            structure = Structure(make_id(folders, stem), path, layout, status.st_size,
                                  status.st_mtime_ns)
            other = found.setdefault(structure.id, structure)
            if other is not structure:
                advice = ("" if only is None else
                          f"; choose with --only, e.g. --only '*{''.join(path.suffixes[-2:])}'")
                raise Failed(f"{other.path} and {path} would both be {structure.id!r}{advice}")
    return sorted(found.values(), key=lambda structure: structure.id)
