"""Makes a page that shows molecular surfaces in a browser, without a network.

Used by eses-view, and by the Python package for notebooks. pages/viewer/ has the parts of the page.
Arrays are stored as differences between rows, which gzip compresses well, and read by
pages/viewer/data.js.
"""

from __future__ import annotations

import base64
import dataclasses
import gzip
import html
import json
import math
import pathlib
import typing

from eses_tools import SCHEMES, STYLES

try:
    import numpy
except ImportError:
    numpy = None  # fill() needs none
else:
    from eses_tools import patch_borders

FOLDER = pathlib.Path(__file__).resolve().parent / "pages"  # head.html is the head of all pages
PARTS = FOLDER / "viewer"
SCRIPTS = ("data", "colors", "shaders", "graphics", "parts", "table", "picture", "layout", "ligands",
           "viewer", "input")
STEPS = 65535  # of a coordinate of a vertex
NORMAL_STEPS = 1023  # on each side of zero of an octahedral coordinate
POTENTIAL_STEPS = 32767  # on each side of zero
COMPRESSION_LEVEL = 6
PATCH_COLORS = ((86, 180, 233), (240, 228, 66), (213, 94, 0))  # those of --color patch
# Colours of the potential from negative to positive: red, white, blue.
DIVERGING = ((200, 20, 30), (245, 160, 140), (248, 248, 248), (140, 170, 245), (25, 50, 205))


AMINO_ACIDS = frozenset("ALA ARG ASN ASP CYS GLN GLU GLY HIS ILE LEU LYS MET PHE PRO SER THR TRP TYR VAL".split())
NUCLEOTIDES = frozenset("A C G U DA DC DG DT DU".split())
CAPS = frozenset("CNO")  # elements of caps of one atom, such as NH2; other single atoms are metals and ions
LONGEST_BOND = 1.9  # angstrom, of light elements; between carbon and sulfur 1.8, from a metal to its ligands 2.0
BACKBONES = ({"N", "CA", "C"}, {"C3'", "C4'", "O3'"}, {"C3*", "C4*", "O3*"})


def is_polymer(residue, names):
    """Whether a residue with atoms of these names is part of a protein or nucleic acid."""
    return (residue in AMINO_ACIDS or residue in NUCLEOTIDES
            or any(backbone <= names for backbone in BACKBONES))


def is_near(centers, others, reach):
    """Whether an atom is less than `reach` from one of the others."""
    low, high = centers.min(axis=0) - reach, centers.max(axis=0) + reach
    near = others[((others >= low) & (others <= high)).all(axis=1)]
    return any((((near - center)**2).sum(axis=1) < reach**2).any() for center in centers)


@dataclasses.dataclass
class Atoms:
    """The atoms that the vertices name. Arrays have a row for each atom; texts may be empty."""

    serial: numpy.ndarray  # number in the input, from 1
    centers: typing.Optional[numpy.ndarray] = None  # angstrom
    radii: typing.Optional[numpy.ndarray] = None
    areas: typing.Optional[numpy.ndarray] = None
    names: typing.Optional[typing.Sequence[str]] = None
    elements: typing.Optional[typing.Sequence[str]] = None
    residues: typing.Optional[typing.Sequence[tuple]] = None  # name, number and chain
    are_ligands: typing.Optional[numpy.ndarray] = None  # atoms beside the surface, which are drawn

    def ligands(self):
        """Returns which atoms belong to ligands and metals: to residues that are no part of a protein
        or nucleic acid and not bonded to one, if other residues are; None if there are none."""
        if self.residues is None or self.names is None:
            return None
        atoms_of = {}
        for atom, residue in enumerate(self.residues):
            atoms_of.setdefault(residue, []).append(atom)
        found = numpy.ones(len(self.residues), bool)
        for residue, atoms in atoms_of.items():
            found[atoms] = not is_polymer(residue[0], {self.names[atom] for atom in atoms})
        others = self.centers[~found]
        for residue, atoms in atoms_of.items():
            may_be_bonded = len(atoms) > 1 or self.elements[atoms[0]] in CAPS
            if found[atoms[0]] and may_be_bonded and is_near(self.centers[atoms], others, LONGEST_BOND):
                found[atoms] = False
        return found if found.any() and not found.all() else None


@dataclasses.dataclass
class Molecule:
    """A surface as triangles. `atom` has the index in `atoms` of each vertex."""

    name: str
    points: numpy.ndarray
    normals: numpy.ndarray
    triangles: numpy.ndarray
    patch: typing.Optional[numpy.ndarray] = None  # 1 convex, 2 saddle, 3 concave
    component: typing.Optional[numpy.ndarray] = None
    potential: typing.Optional[numpy.ndarray] = None  # kT/e
    color: typing.Optional[numpy.ndarray] = None  # bytes
    atom: typing.Optional[numpy.ndarray] = None
    atoms: typing.Optional[Atoms] = None
    voids: typing.Optional[typing.Sequence[float]] = None  # volume of each cavity, cubic angstrom


def nice_limit(values):
    """Returns a round limit for a symmetric scale, which 2 per cent of the values exceed."""
    limit = float(numpy.quantile(numpy.abs(values), 0.98)) or 1.0
    power = 10 ** math.floor(math.log10(limit))
    return next(factor * power for factor in (1, 2, 5, 10) if factor * power >= limit * (1 - 1e-9))


def potential_colors(values, limit):
    """Returns the colours of potentials on a scale from -limit to limit."""
    places = numpy.linspace(-limit, limit, len(DIVERGING))
    return numpy.stack([numpy.interp(values, places, column) for column in zip(*DIVERGING)], axis=1)


# --------------------------------------------------------------------------------------- arrays


def octahedral(normals):
    """Returns two numbers from 0 to 2 NORMAL_STEPS for each normal (Z. H. Cigolle et al.,
    Journal of Computer Graphics Techniques 3 (2014) 2)."""
    normals = numpy.asarray(normals, float)
    flat = normals / numpy.maximum(numpy.abs(normals).sum(axis=1, keepdims=True), 1e-30)
    places = flat[:, :2]
    folded = (1 - numpy.abs(places[:, ::-1])) * numpy.where(places < 0, -1, 1)
    places = numpy.where(flat[:, 2:] < 0, folded, places)
    return numpy.rint((places + 1) * NORMAL_STEPS)


def packed(values, width):
    """Returns differences between the rows, modulo 2^(8 width), the lowest bytes first."""
    rows = numpy.asarray(values).astype(f"<u{width}")
    rows[1:] -= rows[:-1].copy()
    return rows.reshape(-1).view("u1").reshape(-1, width).T.tobytes()


def width_of(count):
    return 1 if count <= 1 << 8 else 2 if count <= 1 << 16 else 4


class Arrays:
    """Collects arrays of unsigned numbers and describes their layout."""

    def __init__(self):
        self.layout, self.data = [], []

    def add(self, name, values, width):
        values = numpy.asarray(values)
        self.layout.append({"name": name, "width": width, "rows": len(values),
                            "columns": values.shape[1] if values.ndim > 1 else 1})
        self.data.append(packed(values, width))

    def add_names(self, name, values):
        """Adds the index of each value in a list of distinct values, which is returned."""
        index = {}
        numbers = [index.setdefault(value, len(index)) for value in values]
        self.add(name, numbers, width_of(len(index)))
        return list(index)

    def text(self):
        return base64.b64encode(gzip.compress(b"".join(self.data), COMPRESSION_LEVEL, mtime=0)
                                ).decode("ascii")


# -------------------------------------------------------------------------------------- molecules


def describe_atoms(atoms, arrays):
    info = {}
    arrays.add("serial", atoms.serial, 4)
    info["elements"] = arrays.add_names("element", atoms.elements or [""] * len(atoms.serial))
    if atoms.names is not None and any(atoms.names):
        info["names"] = arrays.add_names("name_of_atom", atoms.names)
    if atoms.residues is not None:
        info["residues"] = arrays.add_names("residue", map(tuple, atoms.residues))
        info["chains"] = arrays.add_names("chain", [chain for _, _, chain in atoms.residues])
    if atoms.are_ligands is not None:
        arrays.add("ligand", atoms.are_ligands, 1)
    if atoms.areas is not None:
        arrays.add("area", numpy.rint(100 * numpy.asarray(atoms.areas)), 4)
    if atoms.centers is not None:
        origin = numpy.floor(atoms.centers.min(axis=0))
        info["atom_origin"] = origin.tolist()
        arrays.add("center", numpy.rint(1000 * (atoms.centers - origin)), 4)
        arrays.add("radius", numpy.rint(1000 * numpy.asarray(atoms.radii)), 4)
    return info


def facts(molecule):
    count = len(molecule.triangles)
    parts = [f"{count:,} triangle{'s' if count != 1 else ''}"]
    if molecule.atoms is not None and molecule.atoms.centers is not None:
        atoms = len(molecule.atoms.serial)
        parts.insert(0, f"{atoms:,} atom{'s' if atoms != 1 else ''}")
    return ", ".join(parts)


def principal_axes(points):
    """Returns the axes of a right-handed frame, that of the largest extent first."""
    apart = points - points.mean(axis=0)
    _, columns = numpy.linalg.eigh(apart.T @ apart)
    longest, middle = (axis * (1 if axis[numpy.abs(axis).argmax()] > 0 else -1)
                       for axis in (columns[:, 2], columns[:, 1]))
    return numpy.stack([longest, middle, numpy.cross(longest, middle)])


def radius_about(middle, molecule):
    """Returns the radius of the ball about a point that has the surface and the atoms."""
    radius = numpy.linalg.norm(molecule.points - middle, axis=1).max()
    if molecule.atoms is not None and molecule.atoms.centers is not None:
        radius = max(radius, numpy.linalg.norm(molecule.atoms.centers - middle, axis=1).max())
    return float(radius)


def default_color(molecules):
    """Returns the scheme of colours that a page shows at first."""
    if any(one.potential is not None for one in molecules):
        return "potential"
    for one in molecules:
        if one.color is not None:
            is_by_patch = one.patch is not None and numpy.array_equal(
                one.color, numpy.array(PATCH_COLORS)[one.patch - 1])
            return "patch" if is_by_patch else "file"
    has_chains = any(one.atom is not None and one.atoms.residues is not None
                     and len({one.atoms.residues[atom][2] for atom in numpy.unique(one.atom)}) > 1
                     for one in molecules)
    return "chain" if has_chains else "plain"


def describe(molecule):
    """Returns what viewer/data.js needs to know of a molecule, and its arrays as text."""
    points = numpy.asarray(molecule.points, float)
    low, high = points.min(axis=0), points.max(axis=0)
    middle = (low + high) / 2
    step = max(float((high - low).max()), 1e-3) / STEPS
    arrays = Arrays()
    arrays.add("place", numpy.rint((points - low) / step), 2)
    arrays.add("normal", octahedral(molecule.normals), 2)
    arrays.add("triangle", molecule.triangles, 4)
    info = {
        "name": molecule.name, "facts": facts(molecule), "vertices": len(points),
        "triangles": len(molecule.triangles), "origin": low.tolist(), "step": step,
        "middle": middle.tolist(), "axes": principal_axes(points).tolist(),
        "radius_of_all": radius_about(middle, molecule),
    }
    if molecule.voids is not None:
        info["voids"] = list(molecule.voids)
    if molecule.patch is not None:
        arrays.add("patch", molecule.patch, 1)
        if molecule.atom is not None:
            arrays.add("border", patch_borders.border_heights(
                points, numpy.asarray(molecule.normals, float), numpy.asarray(molecule.triangles),
                numpy.asarray(molecule.patch), numpy.asarray(molecule.atom)), 1)
    if molecule.color is not None:
        arrays.add("color_of_file", molecule.color, 1)
    if molecule.component is not None:
        arrays.add("component", molecule.component, 4)
    if molecule.potential is not None:
        largest = float(numpy.abs(molecule.potential).max()) or 1.0
        info["potential_max"] = largest
        arrays.add("potential", numpy.rint(
            molecule.potential / largest * POTENTIAL_STEPS) + POTENTIAL_STEPS + 1, 2)
    if molecule.atom is not None:
        arrays.add("atom", molecule.atom, 4)
        info.update(describe_atoms(molecule.atoms, arrays))
    info["arrays"] = arrays.layout
    return info, arrays.text()


# ------------------------------------------------------------------------------------------ page


def script_text(value):
    """Returns JSON that cannot end the element <script> that contains it."""
    return json.dumps(value, ensure_ascii=True).replace("<", "\\u003c")


def replace_fields(text, fields):
    """Returns the text with the value of each {{name}}."""
    pieces = text.split("{{")  # each piece but the first begins with a name
    return pieces[0] + "".join(
        fields[name] + rest for name, _, rest in (piece.partition("}}") for piece in pieces[1:]))


def fill(folder, scripts, fields):
    """Returns page.html of the folder with its style, these scripts and other fields."""
    def part(name):
        return (folder / name).read_text(encoding="utf-8")

    head = replace_fields((FOLDER / "head.html").read_text(encoding="utf-8"),
                          {**fields, "style": part("style.css")})
    return replace_fields(part("page.html"),
                          {**fields, "head": head, "script": "\n".join(map(part, scripts))})


def make_page(molecules, title, color=None, style="none", opacity=None, potential_limit=None,
              table=None):
    """Returns the page. `color` is one of SCHEMES, `style` one of STYLES, `opacity` per cent,
    `potential_limit` the end of the scale of potentials in kT/e, and `table` name and text of a CSV
    table with columns to colour by."""
    values = [one.potential for one in molecules if one.potential is not None]
    if potential_limit is None:
        potential_limit = nice_limit(numpy.concatenate(values)) if values else 1
    is_chosen = opacity is not None
    if not is_chosen:
        opacity = 100 if style == "none" else 45
    described = [describe(one) for one in molecules]
    settings = {"color": color or default_color(molecules), "style": style, "opacity": opacity,
                "opacity_is_chosen": is_chosen}
    data = {"settings": settings,
            "limits": {"potential": potential_limit, "diverging": DIVERGING,
                       "patches": PATCH_COLORS},
            "molecules": [info for info, _ in described]}
    if table is not None:
        data["table"] = dict(zip(("name", "text"), table))
    arrays = "\n".join(f'<script type="text/plain" id="arrays-{number}">{text}</script>'
                       for number, (_, text) in enumerate(described))
    return fill(PARTS, [f"{part}.js" for part in SCRIPTS],
                {"title": html.escape(title), "molecules": script_text(data), "arrays": arrays})
