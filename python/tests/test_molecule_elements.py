"""Objects of other libraries have the elements of the file, also where the library derives them from names; residues of
coarse-grained models and dummy atoms are treated as those of files."""

import warnings

import numpy as np
import pytest

import eses_blocks as eses

pytestmark = pytest.mark.usefixtures("needs_gemmi")


def record(serial, name, residue, number, center, occupancy=1.0, element=""):
    x, y, z = center
    return (f"ATOM  {serial:5d} {name:4} {residue:>3} A{number:4d}    {x:8.3f}{y:8.3f}{z:8.3f}{occupancy:6.2f}  0.00"
            f"          {element:>2}\n")


def pdb_of(*atoms):
    return "".join(record(serial, *atom) for serial, atom in enumerate(atoms, 1)) + "END\n"


IONS = pdb_of(*((f" {name:3}", "ION", k, (6.0 * k, 0, 0)) for k, name in enumerate(("NA+", "CL-", "CA+", "MG+", "K+"))),
              *((f" {name:3}", name, k, (6.0 * k, 0, 0)) for k, name in enumerate(("SOD", "CLA", "POT", "NA", "CL"), 6)))
LIGAND = pdb_of((" C1 ", "LIG", 1, (0, 0, 0)), (" CL1", "LIG", 1, (1.74, 0, 0)), (" BR1", "LIG", 1, (0, 1.9, 0)),
                (" SI1", "LIG", 1, (0, 0, 1.87)), (" C2 ", "LIG", 1, (-0.7, -1.2, 0)))
HAEM = pdb_of((" NA ", "HEM", 1, (0, 2, 0)), (" NB ", "HEM", 1, (2, 0, 0)), (" FE ", "HEM", 1, (0, 0, 0)),
              (" C1A", "HEM", 1, (-1.1, 2.8, 0)), (" C1B", "HEM", 1, (2.8, 1.1, 0)), (" CAA", "HEM", 1, (-1.5, 4.2, 0)),
              (" CBA", "HEM", 1, (-1.5, 5.2, 1.1)))
LEFT = pdb_of(("N   ", "LYS", 1, (0, 0, 0)), ("CA  ", "LYS", 1, (1.46, 0, 0)), ("C   ", "LYS", 1, (2, 1.4, 0)),
              ("CB  ", "LYS", 1, (2, -0.8, 1.2)), ("CD  ", "LYS", 1, (3.5, -0.8, 1.2)), ("CE  ", "LYS", 1, (4.2, -2.1, 1.2)),
              ("NZ  ", "LYS", 1, (5.7, -2.1, 1.2)), ("ND1 ", "HIS", 2, (12, 0, 0)), ("CA  ", "HIS", 2, (13.4, 0, 0)))
MARTINI = pdb_of((" BB ", "ALA", 1, (0, 0, 0), 1, "C"), (" BB ", "LYS", 2, (3.5, 0, 0), 1, "C"),
                 (" SC1", "LYS", 2, (5.5, 2, 1), 1, "C"))
DUMMY = pdb_of((" N  ", "ALA", 1, (0, 0, 0), 1, "N"), (" CB ", "ALA", 1, (9999, 9999, 9999), 0, "C"),
               (" CA ", "ALA", 1, (1.4, 0, 0.4), 1, "C"))


def read_rdkit(path):
    return pytest.importorskip("rdkit.Chem").MolFromPDBFile(path, removeHs=False, sanitize=False, proximityBonding=False)


def read_prody(path):
    prody = pytest.importorskip("prody")
    prody.confProDy(verbosity="none")
    return prody.parsePDB(path)


READERS = {
    "ase": lambda path: pytest.importorskip("ase.io").read(path),
    "biopython": lambda path: pytest.importorskip("Bio.PDB").PDBParser(QUIET=True).get_structure("x", path),
    "biotite": lambda path: pytest.importorskip("biotite.structure.io.pdb").PDBFile.read(path).get_structure(
        extra_fields=["occupancy"]),
    "gemmi": lambda path: pytest.importorskip("gemmi").read_structure(path),
    "mdanalysis": lambda path: pytest.importorskip("MDAnalysis").Universe(path),
    "mdtraj": lambda path: pytest.importorskip("mdtraj").load(path, no_boxchk=True),
    "openmm": lambda path: pytest.importorskip("openmm.app").PDBFile(path),
    "parmed": lambda path: pytest.importorskip("parmed").load_file(path),
    "prody": read_prody,
    "rdkit": read_rdkit,
}


@pytest.fixture(name="read", params=READERS)
def fixture_read(request, tmp_path):
    """Returns a function that returns the object of a text, and the path of its file."""

    def read(text):
        path = tmp_path / "x.pdb"
        path.write_text(text)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return READERS[request.param](str(path)), path

    return read


@pytest.mark.parametrize("text", (IONS, LIGAND, HAEM, LEFT), ids=("ions", "ligand", "haem", "left"))
def test_elements_are_those_of_the_file(read, text):
    found, path = read(text)
    if found is None:
        return  # RDKit does not read files without elements
    expected, result = (eses.measure(each, "bondi") for each in (str(path), found))
    assert result.atoms["element"].tolist() == expected.atoms["element"].tolist()
    assert result.sas_area == pytest.approx(expected.sas_area, rel=1e-5)
    assert expected.radii.guessed.tolist() == {IONS: list(range(10)), LIGAND: [0, 1, 2, 3, 4], HAEM: list(range(7))}.get(text, [])
    given = eses.adaptors.columns_of(found).elements or [""] * len(result.atoms)
    changed = [i for i, (old, new) in enumerate(zip(given, result.atoms["element"].tolist())) if old.capitalize() != new]
    assert result.radii.guessed.tolist() == ([] if text == LEFT else changed)


def test_beads_without_elements_are_those_of_the_file(read):
    found, path = read(MARTINI.replace("           C\n", "\n"))
    if found is None:
        return
    expected, result = (eses.measure(each, "bondi") for each in (str(path), found))
    assert result.atoms["element"].tolist() == expected.atoms["element"].tolist() == ["B", "B", "S"]
    assert result.sas_area == pytest.approx(expected.sas_area, rel=1e-5)


def test_short_bonds_are_those_of_carbon():
    gemmi = pytest.importorskip("gemmi")
    text = pdb_of((" C1 ", "LIG", 1, (0, 0, 0), 1, "C"), (" CL1", "LIG", 1, (1.54, 0, 0), 1, "C"),
                  (" CL2", "LIG", 1, (-1.74, 0, 0), 1, "C"))
    result = eses.measure(gemmi.read_pdb_string(text), "bondi")
    assert result.atoms["element"].tolist() == ["C", "C", "Cl"] and result.radii.guessed.tolist() == [2]


def test_coarse_grained_residues_are_one_warning(read):
    found, _ = read(MARTINI)
    with pytest.warns(UserWarning) as caught:
        eses.measure(found, "bondi")
    texts = [str(one.message) for one in caught if "coarse-grained" in str(one.message)]
    assert len(texts) == 1 and texts[0].startswith("2 residues are no amino acids") and texts[0].endswith("indices 0, 1")


def test_dummy_atoms_are_left_out(read):
    found, path = read(DUMMY)
    result, expected = eses.measure(found), eses.measure(path)
    assert result.sas_area == pytest.approx(expected.sas_area, rel=1e-6)
    if len(result.atoms) == 3:  # RDKit leaves them out itself
        assert result.left_out == {"dummy": 1} and np.isnan(result.atoms["sas"]).tolist() == [False, True, False]


def test_names_of_water_do_not_leave_out_lipids():
    gemmi = pytest.importorskip("gemmi")
    atoms = [(" P  ", "OPC", 1, (0, 0, 0), 1, "P"), (" O1 ", "OPC", 1, (1.6, 0, 0), 1, "O"), (" C1 ", "OPC", 1, (2.4, 1.2, 0), 1, "C"),
             (" O  ", "OPC", 2, (20, 0, 0), 1, "O"), (" H1 ", "OPC", 2, (20.9, 0, 0), 1, "H")]
    result = eses.measure(gemmi.read_pdb_string(pdb_of(*atoms)), "bondi")
    assert result.left_out == {"water": 2} and len(result.molecule.kept) == 3
    result = eses.measure(gemmi.read_pdb_string(pdb_of(*atoms, (" W  ", "W", 3, (30, 0, 0), 1, "W"))), "bondi")
    assert result.left_out == {"water": 3}


def test_flat_molecules_of_files_are_no_drawings():
    chem = pytest.importorskip("rdkit.Chem")
    text = pdb_of((" N  ", "ALA", 1, (0, 0, 0), 1, "N"), (" CA ", "ALA", 1, (1.46, 0, 0), 1, "C"))
    flat = chem.MolFromPDBBlock(text, removeHs=False, sanitize=False, proximityBonding=False)
    assert eses.measure(flat, "bondi").sas_area == pytest.approx(eses.measure(text, "bondi").sas_area)
