"""Wrong arguments and molecules are refused with a message that names them."""

import sys

import numpy as np
import pytest

import eses_blocks as eses
from conftest import PDB

pytestmark = pytest.mark.usefixtures("needs_gemmi")


@pytest.fixture(name="path")
def fixture_path(tmp_path):
    path = tmp_path / "two.pdb"
    path.write_text(PDB)
    return path


@pytest.mark.parametrize(("arguments", "error", "message"), [
    ({"probe": 1.2}, TypeError, "^unknown argument 'probe'; did you mean probe_radius"),
    ({"water": True}, TypeError, "^unknown argument 'water'; did you mean waters"),
    ({"threds": 1}, TypeError, "^unknown argument 'threds'; did you mean threads"),
    ({"fill": 1}, TypeError, "^unknown argument 'fill'; did you mean fill_cavities"),
    ({"zzz": 1}, TypeError, "^unknown argument 'zzz'$"),
    ({"probe_radius": "1.4"}, TypeError, "^probe_radius must be a number, not '1.4'$"),
    ({"threads": "all"}, TypeError, "^threads must be a whole number, not 'all'$"),
    ({"unknown_radius": "x"}, TypeError, "^unknown_radius must be a number"),
    ({"assembly": 1}, TypeError, "^assembly must be a text such as '1', not 1$"),
    ({"model": None}, TypeError, "^model must be a whole number, not None$"),
    ({"altloc": 1}, TypeError, "^altloc must be a text such as 'A', not 1$"),
    ({"format": 5}, TypeError, "^format must be a text, not 5$"),
    ({"chains": "A"}, TypeError, r"^chains must be a list of names such as \['A', 'B'\], not 'A'$"),
    ({"waters": "no"}, TypeError, "^waters must be True or False, not 'no'$"),
    ({"derivatives": "no"}, TypeError, "^derivatives must be True or False, not 'no'$"),
    ({"hydrogens": True}, ValueError, "^hydrogens must be 'auto', 'keep' or 'drop', not True"),
    ({"models": ["a"]}, TypeError, "^model must be a whole number, not 'a'$"),
    ({"model": 2**40}, TypeError, "^model must be a whole number, not 1099511627776$"),
    ({"reference": []}, TypeError, r"^reference must be a text, not \[\]$"),
    ({"surfaces": 5}, ValueError, "^surfaces must be ses, sas, vdw or all, or several of them, not 5$"),
    ({"models": 5}, ValueError, "^models must be 'all' or numbers, not 5"),
    ({"report": ["A", "B"]}, TypeError, r"^report must be .* not \['A', 'B'\]; give chains as one text, 'A\+B'$"),
    ({"select": ["A"]}, TypeError, r"^select must be .* not \['A'\]; give chains as one text, 'A'$"),
])
def test_arguments(path, arguments, error, message):
    with pytest.raises(error, match=message):
        eses.measure(path, **arguments)


def test_what_is_no_molecule(path):
    with pytest.raises(TypeError, match="^None, which libraries return for what they cannot read or select, is not a known molecule"):
        eses.measure(None)
    gemmi = pytest.importorskip("gemmi")
    with pytest.raises(TypeError, match="^model: only PDB, mmCIF and PQR files have these arguments; use frame= "):
        eses.measure(gemmi.read_structure(str(path)), model=1)
    pdb_io = pytest.importorskip("biotite.structure.io.pdb")
    with pytest.raises(TypeError, match="PDBFile is not a molecule with coordinates"):  # although it has `read`
        eses.measure(pdb_io.PDBFile.read(str(path)))


def test_arguments_of_other_functions_are_not_suggested(path):
    for call, name in ((eses.read_molecule, "probe_radius"), (eses.interfaces, "surfaces"), (eses.interfaces, "report"),
                       (lambda found, **options: eses.interface(found, "A", **options), "report")):
        with pytest.raises(TypeError, match=f"^unknown argument '{name}'$"):
            call(path, **{name: 1})
    with pytest.raises(TypeError, match="^threads must be a whole number, not 'x'"):
        eses.interfaces(path, threads="x")


READING = {"assembly": 1, "model": None, "altloc": 1, "format": 5, "waters": "no", "unknown_radius": "x", "threads": 1.5,
           "chains": 7, "hetatm": [], "chain_names": 3, "frame": "1", "hydrogens": 7}
CALLS = {"measure": eses.measure, "read_molecule": eses.read_molecule, "read_atoms": eses.read_atoms, "Surface": eses.Surface,
         "interfaces": eses.interfaces}


@pytest.mark.parametrize(("call", "name"), [
    (call, name) for call in CALLS for name in READING
    if (call, name) not in (("read_atoms", "threads"), ("read_atoms", "frame"), ("read_molecule", "threads"))])
def test_messages_do_not_list_overloads(path, call, name):
    """A wrong type is an error that begins with the name of the argument."""
    with pytest.raises((TypeError, ValueError), match=f"^{name} must be "):
        CALLS[call](path, **{name: READING[name]})


def test_compiled_functions(path):
    surface = eses.Surface(path)
    grid = surface.grid(1.0)
    for call, message in ((lambda: surface.compute(5), "^grid must be a Grid, such as that of Surface.grid.., not 5$"),
                          (lambda: surface.compute(), "^compute: missing a required argument: 'grid'$"),
                          (lambda: surface.compute(grid, max_memry=5), "^unknown argument 'max_memry'; did you mean max_memory.$"),
                          (lambda: surface.compute(grid, region=[1, 2]), "^region must be two corners of three whole numbers"),
                          (lambda: surface.measure(by_atom="yes"), "^by_atom must be True or False, not 'yes'$"),
                          (lambda: surface.measure("1.4"), "^probe_radius must be a number, not '1.4'$"),
                          (lambda: surface.pockets(spacing=None), "^spacing must be a number, not None$"),
                          (lambda: surface.grid(spacing="fine"), "^spacing must be a number, not 'fine'$"),
                          (lambda: eses.Grid("x", 1, (2, 2, 2)), "^origin must be three numbers, not 'x'$"),
                          (lambda: eses.Grid((0, 0, 0), 1), "^__init__: missing a required argument: 'shape'$"),
                          (lambda: eses.Surface(path, probe=1), "^unknown argument 'probe'; did you mean probe_radius.$"),
                          (lambda: eses.read_atoms(), "^read_atoms: missing a required argument: 'path'$"),
                          (lambda: surface.grid(1, 1, 1), "^grid: too many positional arguments$"),
                          (lambda: surface.cavities(atoms="A"), "^atoms must be a sequence of indices, not 'A'$"),
                          (lambda: surface.pockets(balls=3), "^balls must be a pair of centers and radii, not 3$"),
                          (lambda: surface.show(spacing={}), "^spacing must be a number, not {}$"),
                          (lambda: surface.show(atoms=3), "^atoms must be Atoms, not 3$"),
                          (lambda: eses.measure(path).save(5), "^path must be a path, not 5$"),
                          (lambda: eses.measure(path).save("x.csv", level=[]), r"^level must be a text, not \[\]$"),
                          (lambda: surface.compute(grid).mesh(quality="high"), "^quality must be True or False")):
        with pytest.raises(TypeError, match=message):
            call()
    assert surface.measure(2).ses_area == surface.measure(2.0).ses_area  # conversions come first


def test_surfaces_read_as_measure(path):
    molecule = eses.read_molecule(path, select="//A")
    assert len(eses.Surface(molecule)) == len(molecule.kept) == len(eses.Surface(path, select="//A"))
    assert eses.measure(molecule).sas_area == eses.measure(path, select="//A").sas_area
    assert eses.measure(molecule, select="10").molecule.left_out["selection"] > molecule.left_out["selection"]
    with pytest.raises(TypeError, match="^radii: the molecule was read already; give it to read_molecule$"):
        eses.measure(molecule, "bondi")
    for name, value in (("waters", True), ("hydrogens", "keep"), ("unknown_radius", 2.0), ("frame", 1)):
        with pytest.raises(TypeError, match=f"^{name}: the molecule was read already; give it to read_molecule$"):
            eses.measure(molecule, **{name: value})
    with pytest.raises(TypeError, match="^radii: Atoms have radii already"):
        eses.measure(eses.read_atoms(path), "bondi")
    assert len(eses.Surface(path, waters=True)) == len(eses.read_atoms(path, waters=True)) > len(eses.Surface(path))
    assert len(eses.Surface([[0, 0, 0], [5, 0, 0]], [1.5, 1.5], select=[0])) == 1
    for call in (eses.measure, eses.Surface):
        for radii in (object(), [1.5]):
            with pytest.raises(TypeError, match=f"^radii: a file needs the name of a set of radii, not {type(radii).__name__}$"):
                call(path, radii=radii)
        for radii in (object(), ["x"]):
            with pytest.raises((TypeError, ValueError), match="^radii must be an array of real numbers"):
                call([[0, 0, 0]], radii)


def test_surfaces_of_objects_take_radii(path):
    structure = pytest.importorskip("gemmi").read_structure(str(path))
    radii = np.full(len(eses.measure(structure).molecule), 1.5)
    assert eses.Surface(structure, radii).measure().sas_area == eses.measure(structure, radii).sas_area
    with pytest.raises(ValueError, match="^radii must have shape "):
        eses.Surface(structure, radii[:3])


def test_files(path, tmp_path):
    with pytest.raises(TypeError, match="several files"):
        eses.measure([path, str(path)])
    with pytest.raises(ValueError, match="no ATOM or HETATM records"):
        eses.measure("HEADER    PROTEIN\nEND\n")  # PDB by its first record
    with pytest.raises(ValueError, match="the molecule has no atoms"):
        eses.measure((np.zeros((0, 3)), []))
    assert eses.Surface(path, "bondi").radii.tolist() == eses.measure(path, "bondi").molecule.radii.tolist()
    with pytest.raises(ValueError, match="did you mean bondi"):
        eses.Surface(path, "bodni")
    radii = tmp_path / "my.config"
    radii.write_text("types:\nT 3.5 apolar\natoms:\nANY ZN T\n")
    assert eses.Surface(path, radii).radii.tolist() == eses.measure(path, radii).molecule.radii.tolist()
    assert eses.measure(path, select=None).sas_area == eses.measure(path).sas_area


def test_objects(path):
    gemmi = pytest.importorskip("gemmi")
    structure = gemmi.read_structure(str(path))
    structure[0]["B"][0][0].pos.x = np.nan
    with pytest.raises(ValueError, match=r"^atom 13 \(counted from 0; B ZN ZN\) has coordinates \[nan, "):
        eses.measure(structure)
    for empty in (gemmi.Structure(), gemmi.Chain("A")):
        with pytest.raises(ValueError, match="is empty|has no atoms"):
            eses.measure(empty)
    biotite = pytest.importorskip("biotite.structure")
    with pytest.raises(TypeError, match="Atom is not a molecule with coordinates"):
        eses.measure(biotite.Atom([0, 0, 0]))
    nameless = biotite.AtomArray(1)
    nameless.coord = np.zeros((1, 3), np.float32)
    with pytest.raises(ValueError, match="1 atoms without a radius in the set bondi: .*; use unknown_radius=, or an array"):
        eses.measure(nameless)


def test_warnings_name_the_line_of_the_caller():
    atoms = pytest.importorskip("ase").Atoms("O", [(0, 0, 0)], pbc=True, cell=[9, 9, 9])
    for call in (eses.measure, eses.read_molecule, eses.Surface):
        with pytest.warns(UserWarning, match="without its periodic images") as found:
            call(atoms)
        assert found[0].filename == __file__


def test_modules_of_other_libraries_are_attributes():
    sys.modules.pop("eses_blocks.mdtraj", None)
    vars(eses).pop("mdtraj", None)
    assert callable(eses.mdtraj.shrake_rupley)
    with pytest.raises(AttributeError, match="has no attribute 'mdtrajs'"):
        eses.mdtrajs  # noqa: B018
