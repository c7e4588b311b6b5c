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
    ({"probe_radius": "1.4"}, TypeError, "^probe_radius must be a number, not '1.4'"),
    ({"threads": "all"}, TypeError, "^threads must be a number"),
    ({"unknown_radius": "x"}, TypeError, "^unknown_radius must be a number"),
    ({"hydrogens": True}, ValueError, "^hydrogens must be 'auto', 'keep' or 'drop', not True"),
    ({"models": 5}, ValueError, "^models must be 'all' or numbers, not 5"),
    ({"select": [0]}, TypeError, r"^select must be a text for files, not \[0\]$"),
])
def test_arguments(path, arguments, error, message):
    with pytest.raises(error, match=message):
        eses.measure(path, **arguments)


def test_arguments_of_other_functions_are_not_suggested(path):
    for call, name in ((eses.read_molecule, "probe_radius"), (eses.interfaces, "surfaces"), (eses.interfaces, "report"),
                       (lambda found, **options: eses.interface(found, "A", **options), "report")):
        with pytest.raises(TypeError, match=f"^unknown argument '{name}'$"):
            call(path, **{name: 1})
    with pytest.raises(TypeError, match="^threads must be a number, not 'x'"):
        eses.interfaces(path, threads="x")


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
