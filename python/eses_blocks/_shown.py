"""Methods of Atoms, Mesh, Result and Surface that need other Python packages, and pages for notebooks."""

import html
import inspect

import numpy as np

from eses_tools import page as _page

from . import _arguments, _core
from ._files import output_path
from ._locations import first_of_runs

# The endings of names that no page has.
_OTHER_SUFFIXES = (".pdb", ".ent", ".cif", ".mmcif", ".mcif", ".pdbx", ".pqr", ".xyzr", ".gz", ".csv", ".dx",
                   ".png", ".jpg", ".jpeg", ".gif", ".svg", ".tif", ".tiff", ".bmp", ".webp", ".pdf")


class Page:
    """A page that shows a surface. Notebooks display it; save() writes it to a file."""

    def __init__(self, text, height):
        self._text, self._height = text, height

    def __str__(self):
        return self._text

    def _repr_html_(self):
        return (f'<iframe srcdoc="{html.escape(self._text)}" title="molecular surface" '
                f'style="width: 100%; height: {self._height}px; border: 0"></iframe>')

    def save(self, path):
        """Write the page to a file, which any browser can open. Raises ValueError for the suffix of a
        structure, a table or a picture."""
        path = output_path(path)
        if path.lower().endswith(_OTHER_SUFFIXES):
            raise ValueError(f"{path} would be a page; use a name that ends in .html")
        with open(path, "w", encoding="utf-8") as target:
            target.write(self._text)


# -------------------------------------------------------------------------------------- pages


def _page_atoms(centers, radii, areas, atoms):
    """Returns the atoms of a page; `atoms` is an eses.Atoms with their names, or None."""
    count = len(radii)
    made = _page.Atoms(serial=np.arange(1, count + 1), centers=centers, radii=radii, areas=areas)
    if atoms is None:
        return made
    made.elements = atoms.element.tolist()
    if atoms.labels is not None:
        labels = atoms.labels
        made.names = labels.atom_name.tolist()
        made.residues = list(zip(labels.residue.tolist(), labels.residue_number.tolist(),
                                 labels.chain.tolist()))
    return made


def _make_page(mesh, atoms, color, style, title, height):
    indices = mesh.atoms.astype(np.int64)
    if atoms is None:
        found, indices = np.unique(indices, return_inverse=True)
        atoms = _page.Atoms(serial=found + 1)
    molecule = _page.Molecule(title, mesh.vertices, mesh.normals, mesh.faces, patch=mesh.kind,
                              component=mesh.component, atom=indices, atoms=atoms)
    return Page(_page.make_page([molecule], title, color, style), height)


def _k3d_plot(mesh):
    k3d = _arguments.imported("k3d", "show(backend='k3d')")
    colors = _page.PATCH_COLORS
    plot = k3d.plot()
    codes = np.array([(r << 16) + (g << 8) + b for r, g, b in colors], np.uint32)
    plot += k3d.mesh(mesh.vertices.astype(np.float32), mesh.faces.astype(np.uint32),
                     normals=mesh.normals.astype(np.float32),
                     colors=codes[mesh.kind - 1], side="double")
    return plot


# What the descriptions of both show() have at {page}.
_PAGE_PARAMETERS = """\
backend : str
    ``page`` for a page that is complete in itself, or ``k3d`` for a plot of k3d, in the colours
    of the patches.
title : str
    The name of the molecule in the page.
height : int
    The height of the page in the notebook, in pixels.

Returns
-------
Page or k3d.plot.Plot
    An object that notebooks display. ``save(path)`` of a page writes it to a file.

Raises
------
ImportError
    If k3d is chosen and not installed."""


def _check_choices(color, style, backend):
    if backend not in ("page", "k3d"):
        raise ValueError("backend must be page or k3d")
    for name, value, known in (("color", color, _page.SCHEMES), ("style", style, _page.STYLES)):
        if value is not None and value not in known:
            raise ValueError(f"{name} must be one of {', '.join(known)}")


def _show(mesh, atoms, color, style, backend, title, height):
    if not isinstance(title, str):
        raise TypeError(f"title must be text, not {type(title).__name__}")
    if isinstance(height, bool) or not isinstance(height, (int, float, np.integer, np.floating)):
        raise TypeError(f"height must be a number, not {type(height).__name__}")
    if len(mesh.faces) == 0:
        raise ValueError("the mesh has no triangles")
    if color == "component" and mesh.component is None:
        raise ValueError("the mesh has no components; make it with component=True")
    return (_k3d_plot(mesh) if backend == "k3d"
            else _make_page(mesh, atoms, color, style, title, height))


def mesh_show(self, color=None, *, backend="page", title="surface", height=560):
    """Show the mesh in a notebook.

    Parameters
    ----------
    color : str, optional
        The first colours: ``plain`` (the default), ``patch``, ``atom``, or ``component`` if the
        mesh has components.
    {page}
    ValueError
        If the mesh has no triangles, or an argument is unknown.
    """
    _check_choices(color, "none", backend)
    return _show(self, None, color, "none", backend, title, height)


def surface_show(self, spacing=0.4, atoms=None, *, color=None, style="none", backend="page",
                 title="surface", height=560):
    """Compute the surface and show it in a notebook, with its atoms.

    Parameters
    ----------
    spacing : float
        The distance between grid points in angstrom.
    atoms : Atoms, optional
        The atoms of the surface, in the same order, for their names.
    color : str, optional
        The first colours: ``patch``, ``atom``, ``element``, ``chain`` (the default if there are
        several), ``residue``, ``area``, ``component`` or ``plain`` (otherwise the default).
    style : str
        How atoms are drawn at first: ``none``, ``sticks``, ``balls`` or ``spheres``.
    {page}
    ValueError
        If the number of atoms or their order is not that of the surface, or an argument is unknown.
    """
    _check_choices(color, style, backend)
    _arguments.check(surface_show, spacing=spacing)
    if atoms is not None:
        _require_atoms(atoms)
    result = self.compute(self.grid(spacing, 2 * spacing))  # does not cut the surface
    if atoms is not None:
        _require_order(result, atoms)
    shown = _page_atoms(self.centers, self.radii, result.atom_areas, atoms)
    return _show(result.mesh(component=True), shown, color, style, backend, title, height)


# ------------------------------------------------------------------------- other packages' types


def _attributes(mesh):
    """Returns the values of the vertices by their names in mesh files."""
    values = {"atom": mesh.atoms, "patch": mesh.kind}
    return values if mesh.component is None else values | {"component": mesh.component}


def mesh_to_trimesh(self):
    """Convert to a mesh of trimesh.

    Returns
    -------
    trimesh.Trimesh
        Copies of vertices, normals and faces, with the vertex attributes ``atom``, ``patch`` and,
        if the mesh has components, ``component``.

    Raises
    ------
    ImportError
        If trimesh is not installed.
    """
    trimesh = _arguments.imported("trimesh", "to_trimesh")
    return trimesh.Trimesh(self.vertices.copy(), self.faces.copy(),
                           vertex_normals=self.normals.copy(), process=False,
                           vertex_attributes={name: values.copy()
                                              for name, values in _attributes(self).items()})


def mesh_to_pyvista(self):
    """Convert to a mesh of PyVista.

    Returns
    -------
    pyvista.PolyData
        Copies of vertices and faces, with the point data ``Normals``, ``atom``, ``patch`` and, if
        the mesh has components, ``component``.

    Raises
    ------
    ImportError
        If PyVista is not installed.
    """
    pyvista = _arguments.imported("pyvista", "to_pyvista")
    faces = np.column_stack([np.full(len(self.faces), 3), self.faces])
    mesh = pyvista.PolyData(self.vertices.copy(), faces.ravel())
    mesh.point_data["Normals"] = self.normals
    mesh.point_data.update(_attributes(self))
    return mesh


def result_to_xarray(self):
    """Convert the inside points to a data set of xarray.

    Returns
    -------
    xarray.Dataset
        The variable ``inside`` with the dimensions x, y and z, whose coordinates are in angstrom,
        and the attributes ``area``, ``volume`` and ``spacing``.

    Raises
    ------
    ImportError
        If xarray is not installed.
    ValueError
        If the surface was computed with ``inside=False``.
    """
    inside = self.inside
    xarray = _arguments.imported("xarray", "to_xarray")
    low, high = self.region
    coordinates = {name: self.grid.coordinates(axis)[low[axis]:high[axis]]
                   for axis, name in enumerate("xyz")}
    return xarray.Dataset({"inside": (("x", "y", "z"), inside)}, coordinates,
                          {"area": self.area, "volume": self.volume,
                           "spacing": self.grid.spacing})


def _require_atoms(atoms):
    if not isinstance(atoms, _core.Atoms):
        raise TypeError(f"atoms must be Atoms, not {atoms!r:.80}")


def _require_order(result, atoms):
    """Raises ValueError if the atoms differ from those of the surface in their number, or have the same centres in
    another order. Atoms with other centres, such as those of another frame, are accepted."""
    centers, given = _core._spheres_of(result)[0], atoms.centers
    if len(given) != len(centers):
        raise ValueError(f"the surface has {len(centers)} atoms, but {len(given)} are given")
    if not np.array_equal(given, centers) and np.array_equal(*(each[np.lexsort(each.T)] for each in (given, centers))):
        raise ValueError("the atoms are those of the surface in another order")


def _name_columns(count, atoms):
    """Returns the columns of the names of atoms, which are empty if they are unknown."""
    labels = None if atoms is None else atoms.labels
    names = {"name": "atom_name", "residue": "residue", "residue_number": "residue_number", "chain": "chain"}
    return {"serial": np.arange(1, count + 1),
            **{column: np.zeros(count, "U1") if labels is None else getattr(labels, name) for column, name in names.items()},
            "element": np.zeros(count, "U1") if atoms is None else atoms.element}


def atoms_to_dataframe(self):
    """Make a table of the atoms. Needs pandas.

    Returns
    -------
    pandas.DataFrame
        A row for each atom, by index from 0. The columns are ``serial`` (from 1), the texts ``name``,
        ``residue``, ``residue_number``, ``chain`` and ``element``, which are empty if they are unknown,
        the centre ``x``, ``y``, ``z`` and the ``radius`` in angstrom, and, for PQR files, the ``charge``
        in elementary charges.

    Raises
    ------
    ImportError
        If pandas is not installed.
    """
    pandas = _arguments.imported("pandas", "to_dataframe")
    columns = {**_name_columns(len(self), self), **dict(zip("xyz", self.centers.T)), "radius": self.radii}
    if self.charge is not None:
        columns["charge"] = self.charge
    return pandas.DataFrame(columns)


def result_atom_table(self, atoms=None):
    """Make a table of the atoms with their areas. Needs pandas.

    Parameters
    ----------
    atoms : Atoms, optional
        The atoms of the surface, in the same order, for their names. Without it the names are empty.

    Returns
    -------
    pandas.DataFrame
        A row for each atom, by index from 0. The columns are those of ``atoms.csv``: ``serial`` (from
        1), the texts ``name``, ``residue``, ``residue_number``, ``chain`` and ``element``, which are empty
        if they are unknown, the ``radius`` in angstrom and the ``area`` in square angstrom.

    Raises
    ------
    ImportError
        If pandas is not installed.
    ValueError
        If the number of atoms or their order is not that of the surface.
    """
    if atoms is not None:
        _require_atoms(atoms)
        _require_order(self, atoms)
    pandas = _arguments.imported("pandas", "atom_table")
    radii = _core._spheres_of(self)[1]
    return pandas.DataFrame({**_name_columns(len(radii), atoms), "radius": radii, "area": self.atom_areas})


def result_residue_table(self, atoms):
    """Make a table of the residues with their areas. Needs pandas.

    Parameters
    ----------
    atoms : Atoms
        The atoms of the surface, in the same order, for their names.

    Returns
    -------
    pandas.DataFrame
        A row for each run of atoms with the same chain, number and name. The columns are those of
        ``residue_area.csv``: ``chain``, ``residue_number``, ``residue``, the number of ``atoms``,
        and the ``area`` in square angstrom.

    Raises
    ------
    ImportError
        If pandas is not installed.
    ValueError
        If the number of atoms or their order is not that of the surface, or the atoms have no names.
    """
    _require_atoms(atoms)
    areas = self.atom_areas
    _require_order(self, atoms)
    labels = atoms.labels
    if labels is None:
        raise ValueError("the atoms have no names of residues")
    pandas = _arguments.imported("pandas", "residue_table")
    names = [labels.chain, labels.residue_number, labels.residue]
    starts = first_of_runs(*names)
    return pandas.DataFrame({
        "chain": names[0][starts], "residue_number": names[1][starts], "residue": names[2][starts],
        "atoms": np.diff(np.append(starts, len(areas))), "area": np.add.reduceat(areas, starts)})


def add_methods(atoms, mesh, result, surface):
    """Gives the classes of the extension module the methods of this file."""
    for owner, methods in ((atoms, (atoms_to_dataframe,)),
                           (mesh, (mesh_show, mesh_to_trimesh, mesh_to_pyvista)),
                           (result, (result_to_xarray, result_atom_table, result_residue_table)),
                           (surface, (surface_show,))):
        for method in methods:
            name = method.__name__.partition("_")[2]
            method.__name__, method.__module__ = name, "eses_blocks"
            method.__doc__ = inspect.cleandoc(method.__doc__).replace("{page}", _PAGE_PARAMETERS)
            method.__qualname__ = f"{owner.__name__}.{name}"
            setattr(owner, name, method)
