"""Molecules of files, texts, arrays and other libraries: the same atoms give the same areas, in the
order of the object. Libraries that are missing are skipped."""

import copy
import csv
import gzip
import io
import pickle
import sys
import warnings

import numpy as np
import pytest

import eses_blocks as eses
from conftest import DATA, PDB
from eses_blocks._references import REFERENCES

pytestmark = pytest.mark.usefixtures("needs_gemmi")

KEPT = [0, 1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 13]  # of the 15 atoms: location B, no water


@pytest.fixture(name="pdb")
def fixture_pdb(tmp_path):
    path = tmp_path / "two.pdb"
    path.write_text(PDB)
    return path


@pytest.fixture(name="expected")
def fixture_expected(pdb):
    """Returns the areas by the program's own reader."""
    atoms = eses.read_atoms(pdb)
    assert len(atoms) == len(KEPT)
    return eses.Surface(atoms.centers, atoms.radii).measure(by_atom=True)


def check(result, expected, kept, count, atol=1e-9):
    """The object's atoms `kept` have the areas of the file, and all others none."""
    kept = list(kept)
    assert len(result.atoms) == count
    assert result.molecule.kept.tolist() == kept
    assert result.sas_area == pytest.approx(expected.sas_area, abs=atol * 100)
    for name in ("sas", "ses"):
        column = result.atoms[name]
        np.testing.assert_allclose(column[kept], getattr(expected.by_atom, name), atol=atol)
        assert np.isnan(np.delete(column, kept)).all()


# ------------------------------------------------------------------------------ files and arrays


def test_files_texts_and_arrays(pdb, expected):
    for found in (pdb, str(pdb), PDB, PDB.encode(), gzip.compress(PDB.encode()), io.StringIO(PDB),
                  io.BytesIO(PDB.encode()), eses.read_atoms(pdb)):
        result = eses.measure(found)
        check(result, expected, range(12), 12)
        assert result.ses_area == expected.ses_area and result.ses_volume == expected.ses_volume
    with open(pdb, encoding="ascii") as source:
        check(eses.measure(source), expected, range(12), 12)
    atoms = eses.read_atoms(pdb)
    for result in (eses.measure((atoms.centers, atoms.radii)), eses.measure(atoms.centers, atoms.radii),
                   eses.measure(eses.Surface(atoms.centers, atoms.radii))):
        assert result.sas_area == expected.sas_area
        assert result.radii.name == "given"
    assert eses.Surface(pdb).measure().sas_area == expected.sas_area
    assert eses.measure(pdb, "bondi").radii.name == "bondi"
    assert eses.measure(pdb, waters=True).molecule.residue.tolist()[-1] == "HOH"
    assert len(eses.measure(pdb, hetatm=False).atoms) == 11
    assert eses.measure(DATA / "c60.xyzr").radii.name == "file"
    assert eses.measure(DATA / "fas2.pqr").radii.name == "file"


def test_unknown_objects_and_arguments_are_named(pdb):
    with pytest.raises(TypeError, match="^dict is not a known molecule; give a path"):
        eses.measure({})
    with pytest.raises(TypeError, match="unknown argument 'modl'; did you mean model"):
        eses.measure(pdb, modl=2)
    with pytest.raises(TypeError, match="model: only PDB, mmCIF and PQR files"):
        eses.measure(([[0, 0, 0]], [1.5]), model=2)
    with pytest.raises(ValueError, match=r"radii must have shape \(2,\)"):
        eses.measure([[0, 0, 0], [3, 0, 0]], [1.5])
    with pytest.raises(ValueError, match="reference must be one of tien"):
        eses.measure(pdb, reference="me")
    with pytest.raises(FileNotFoundError):
        eses.measure("missing.pdb")
    with pytest.raises(ValueError, match="hydrogens must be"):
        eses.measure(pdb, hydrogens="maybe")


def test_centres_in_nanometres_are_warned_about(ubiquitin):
    with pytest.warns(UserWarning, match="coordinates look like nanometres"):
        eses.measure(ubiquitin.centers / 10, ubiquitin.radii)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        eses.measure(ubiquitin.centers, ubiquitin.radii)


def test_another_library_can_be_added(monkeypatch):
    class Ion:
        """A molecule of this module."""

    monkeypatch.setitem(eses.adaptors.ADAPTORS, Ion.__module__.partition(".")[0],
                        lambda ion, frame: eses.adaptors.Columns(centers=[[0, 0, frame]], elements=["Zn"]))
    result = eses.measure(Ion(), frame=3)
    assert result.radii.name == "bondi"
    assert result.sas_area == pytest.approx(4 * np.pi * (1.39 + 1.4) ** 2)


# ------------------------------------------------------------------------------------ libraries


def test_gemmi(pdb, expected):
    gemmi = pytest.importorskip("gemmi")
    structure = gemmi.read_structure(str(pdb))
    for found in (structure, structure[0]):
        check(eses.measure(found), expected, KEPT, 15)
    result = eses.measure(structure[0]["A"])
    assert result.left_out == {"altloc": 2} and result.chains["chain"].tolist() == ["A"]
    assert eses.measure(structure).left_out == {"altloc": 2, "water": 1}
    for part in (structure[0]["A"].whole(), structure[0]["A"]["10"]):  # a ResidueSpan and a ResidueGroup
        assert eses.measure(part).sas_area == eses.measure(list(part)[0] if len(part) == 1 else structure[0]["A"]).sas_area
        expected_part = eses.measure(structure, report="//A" if len(part) > 1 else "//A/10").sas_area
        assert eses.measure(structure, report=part).sas_area == expected_part
    for molecule in (structure, pdb):
        assert (eses.measure(molecule, report=gemmi.Selection("//A/10")).sas_area
                == eses.measure(molecule, report="//A/10").sas_area)
    with pytest.raises(TypeError, match="^several molecules: measure each by itself$"):
        eses.measure([structure, structure])
    with pytest.raises(TypeError, match="gemmi.Atom is not a molecule"):
        eses.measure(structure[0]["A"][0][0])


def test_biopython(pdb, expected):
    parser = pytest.importorskip("Bio.PDB").PDBParser(QUIET=True)
    structure = parser.get_structure("two", str(pdb))
    for found in (structure, structure[0]):
        check(eses.measure(found), expected, range(12), 13, atol=1e-3)  # disordered atoms are one; float32
    assert len(eses.measure(structure[0]["A"]).atoms) == 11
    assert len(eses.measure(structure[0]["A"][10]).atoms) == 5


def test_mdanalysis(pdb, expected):
    mda = pytest.importorskip("MDAnalysis")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        universe = mda.Universe(str(pdb))
    for found in (universe, universe.atoms):
        check(eses.measure(found), expected, KEPT, 15, atol=1e-3)  # float32
    result = eses.measure(universe, report="protein")
    assert len(result.residues) == 2 and result.residues["icode"].tolist() == ["", "A"]
    assert eses.measure(universe.select_atoms("protein")).sas_area > result.sas_area
    protein, ion = universe.select_atoms("protein"), universe.select_atoms("resname ZN")
    assert eses.measure(universe, report=protein).sas_area == result.sas_area
    assert eses.interface(universe, ion, protein).sas_lost == eses.interface(universe, "resname ZN", "protein").sas_lost
    # Without elements, these follow from the names.
    bare = mda.Universe.empty(1, atom_resindex=[0], trajectory=True)
    bare.add_TopologyAttr("names", ["CL"])
    bare.add_TopologyAttr("resnames", ["CL"])
    found = eses.measure(bare)
    assert found.atoms["element"].tolist() == ["Cl"] and found.radii.guessed.tolist() == [0]
    # Those of amino acids are certain, also by their names in force fields.
    bare.atoms.names, bare.residues.resnames = ["CA"], ["HSD"]
    found = eses.measure(bare)
    assert found.atoms["radius"].tolist() == [1.88] and found.radii.guessed.tolist() == []


def test_mdtraj(pdb):
    mdtraj = pytest.importorskip("mdtraj")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        frames = mdtraj.load(str(pdb), no_boxchk=True)
    result = eses.measure(frames)  # converts nanometres; MDTraj reads the first location alone
    assert len(result.atoms) == 13 and result.left_out == {"water": 1}
    atoms = eses.read_atoms(pdb, altloc="A")
    check(result, eses.Surface(atoms.centers, atoms.radii).measure(by_atom=True), range(12), 13, atol=1e-3)
    assert len(eses.measure(frames, report="protein").residues) == 2
    with pytest.raises(ValueError, match="has 1 frame, counted from 0; there is no frame 1"):
        eses.measure(frames, frame=1)


def test_biotite(pdb, expected):
    biotite = pytest.importorskip("biotite.structure.io.pdb")
    stack = biotite.PDBFile.read(str(pdb)).get_structure(altloc="occupancy")
    check(eses.measure(stack), expected, range(12), 13, atol=1e-3)
    check(eses.measure(stack[0]), expected, range(12), 13, atol=1e-3)
    mask = stack[0].res_name == "SER"
    np.testing.assert_array_equal(~np.isnan(eses.measure(stack[0], report=mask).atoms["sas"]), mask)


def test_prody(pdb, expected):
    prody = pytest.importorskip("prody")
    prody.confProDy(verbosity="none")
    atoms = prody.parsePDB(str(pdb), altloc="B")
    result = eses.measure(atoms)
    np.testing.assert_allclose(result.sas_area, expected.sas_area, rtol=1e-6)
    assert len(eses.measure(atoms, report="protein").residues) == 2
    assert len(eses.measure(atoms.select("chain A")).atoms) == 11


def test_parmed(pdb):
    parmed = pytest.importorskip("parmed")
    structure = parmed.load_file(str(pdb))
    result = eses.measure(structure)
    assert len(result.atoms) == len(structure.atoms) and result.left_out["water"] == 1
    atoms = eses.read_atoms(pdb, altloc="A")
    np.testing.assert_allclose(result.sas_area, eses.Surface(atoms.centers, atoms.radii).measure().sas_area, rtol=1e-6)


def test_openmm(pdb):
    app = pytest.importorskip("openmm.app")
    path = pdb.with_name("one.pdb")
    path.write_text("\n".join(line for line in PDB.splitlines() if line[16:17] != "B"))
    found = app.PDBFile(str(path))
    atoms = eses.read_atoms(path)
    expected = eses.Surface(atoms.centers, atoms.radii).measure(by_atom=True)
    for each in (found, app.Modeller(found.topology, found.positions), (found.topology, found.positions)):
        check(eses.measure(each), expected, range(12), 13, atol=1e-6)
    with pytest.raises(TypeError, match="give the pair"):
        eses.measure(found.topology)
    elements = [atom.element for atom in found.topology.atoms()]
    for atom in found.topology.atoms():  # an ion that has no element, as manganese of PDB files
        atom.element = None if atom.residue.name == "ZN" else atom.element
    assert elements.count(None) < sum(atom.element is None for atom in found.topology.atoms())
    check(eses.measure(found), expected, range(12), 13, atol=1e-6)


def test_rdkit():
    chem = pytest.importorskip("rdkit.Chem")
    all_chem = pytest.importorskip("rdkit.Chem.AllChem")
    bare = chem.MolFromSmiles("CCO")
    with pytest.raises(ValueError, match="no coordinates"):
        eses.measure(bare)
    molecule = chem.AddHs(bare)
    all_chem.EmbedMultipleConfs(molecule, 2, randomSeed=7)
    result = eses.measure(molecule)
    assert result.radii.name == "bondi" and len(result.atoms) == 9
    assert not np.isnan(result.atoms["sas"]).any()
    # The hydroxyl's hydrogen is polar, those of carbon are not.
    polar = result.atoms["is_polar"]
    assert polar.sum() == 2 and result.polar + result.apolar == pytest.approx(result.sas_area)
    assert eses.measure(molecule, frame=1).sas_area != result.sas_area
    with pytest.warns(UserWarning, match="lacks hydrogens") as found:
        eses.measure(chem.RemoveHs(molecule))
    assert found[0].filename == __file__
    text = "".join(line for line in PDB.splitlines(True) if not line.startswith("HETATM"))
    with warnings.catch_warnings():  # the radii are those of united atoms
        warnings.simplefilter("error")
        peptide = eses.measure(chem.MolFromPDBBlock(text))
    with pytest.warns(UserWarning, match="lacks hydrogens"):
        eses.measure(chem.MolFromPDBBlock(text), "bondi")
    assert peptide.residues["residue"].tolist() == ["ALA", "SER"]


def test_files_of_small_molecules(tmp_path):
    chem = pytest.importorskip("rdkit.Chem")
    all_chem = pytest.importorskip("rdkit.Chem.AllChem")
    molecules = [chem.AddHs(chem.MolFromSmiles(smiles)) for smiles in ("CCO", "c1ccccc1")]
    path = tmp_path / "two.sdf"
    with chem.SDWriter(str(path)) as writer:
        for molecule in molecules:
            all_chem.EmbedMolecule(molecule, randomSeed=7)
            writer.write(molecule)
    (tmp_path / "two.sdf.gz").write_bytes(gzip.compress(path.read_bytes()))
    for frame, molecule in enumerate(molecules):
        expected = eses.measure(molecule)
        for file in (path, tmp_path / "two.sdf.gz"):
            assert eses.measure(file, frame=frame).sas_area == pytest.approx(expected.sas_area, rel=1e-3)  # of four decimals
    with pytest.raises(ValueError, match="no valid molecule 2"):
        eses.measure(path, frame=2)
    mol2 = tmp_path / "one.mol2"
    mol2.write_text("@<TRIPOS>MOLECULE\nw\n3 2 0 0 0\nSMALL\nNO_CHARGES\n@<TRIPOS>ATOM\n"
                    "1 O 0 0 0 O.3\n2 H1 0.76 0.59 0 H\n3 H2 -0.76 0.59 0 H\n@<TRIPOS>BOND\n1 1 2 1\n2 1 3 1\n")
    expected = eses.Surface([(0, 0, 0), (0.76, 0.59, 0), (-0.76, 0.59, 0)], [1.52, 1.2, 1.2]).measure()
    assert eses.measure(mol2).ses_area == pytest.approx(expected.ses_area)


def test_binary_cif(pdb, expected, tmp_path):
    pdbx = pytest.importorskip("biotite.structure.io.pdbx")
    from biotite.structure.io.pdb import PDBFile
    file = pdbx.BinaryCIFFile()
    pdbx.set_structure(file, PDBFile.read(pdb).get_structure(model=1, altloc="occupancy"))
    path = tmp_path / "two.bcif"
    file.write(path)
    check(eses.measure(path), expected, range(12), 13, atol=1e-3)


def test_foreign_files_name_the_missing_library(tmp_path, monkeypatch):
    for name, library in (("a.bcif", "biotite"), ("a.sdf.gz", "rdkit"), ("a.MOL2", "rdkit")):
        for module in (library, "biotite.structure.io.pdbx", "rdkit.Chem"):
            monkeypatch.setitem(sys.modules, module, None)
        (tmp_path / name).write_bytes(b"")
        with pytest.raises(ImportError, match=f"needs {library}"):
            eses.measure(tmp_path / name)


def test_ase():
    atoms = pytest.importorskip("ase").Atoms("OH2", [(0, 0, 0), (0.76, 0.59, 0), (-0.76, 0.59, 0)])
    result = eses.measure(atoms)
    expected = eses.Surface(atoms.positions, [1.52, 1.2, 1.2]).measure()
    assert result.sas_area == pytest.approx(expected.sas_area)
    atoms.pbc = True
    with pytest.warns(UserWarning, match="without its periodic images"):
        eses.measure(atoms)


# --------------------------------------------------------------------------------------- radii


def test_guessed_and_unknown_radii_are_named(pdb):
    radii = eses.measure(pdb).radii
    assert radii.name == "protor" and "10.1006/jmbi.1999.2829" in radii.source
    assert radii.guessed.tolist() == [11] and len(radii.unknown) == 0  # the ion has the radius of its element
    text = PDB.replace("ZN    ZN B", " X1  UNX B").replace("          ZN\n", "           X\n")
    with pytest.raises(ValueError, match="UNX X1"):
        eses.measure(text)
    radii = eses.measure(text, unknown_radius=2).radii
    assert radii.unknown.tolist() == [11]
    gemmi = pytest.importorskip("gemmi")
    structure = gemmi.read_pdb_string(text)
    with pytest.raises(ValueError, match="1 atoms without a radius in the set protor: UNX X1"):
        eses.measure(structure)
    result = eses.measure(structure, unknown_radius=2)
    assert result.radii.unknown.tolist() == [13] and result.atoms["radius"][13] == 2
    assert result.atoms["is_guessed"].tolist() == [i == 13 for i in range(15)]


def test_names_of_force_fields_are_those_of_standard_residues(tmp_path):
    serine = "".join(line for line in PDB.splitlines(True) if " SER " in line)
    assert serine
    path = tmp_path / "radii.config"
    path.write_text("types:\nT 2.0 apolar\nU 1.5 polar\natoms:\nHIS CA T\nANY N U\nANY CA U\nANY CB U\nANY C U\nANY O U\nANY OG U\n")
    for radii in ("protor", path):
        results = [eses.measure(serine.replace(" SER ", f" {name} "), radii) for name in ("HIS", "HIE", "HSD", "HSP")]
        for result in results[1:]:
            assert result.atoms["radius"].tolist() == results[0].atoms["radius"].tolist()
            np.testing.assert_array_equal(result.residues["relative_sas"], results[0].residues["relative_sas"])
    assert np.isfinite(results[0].residues["relative_sas"]).all()
    # Without nitrogen in its ring, HSE is homoserine.
    assert np.isnan(eses.measure(serine.replace(" SER ", " HSE ")).residues["relative_sas"]).all()


def test_radii_by_name(pdb, tmp_path):
    for name, radius, source in (("naccess", 1.87, "10.1016/0022-2836(76)90191-1"), ("OONS", 2.0, "10.1073/pnas.84.10.3086")):
        for found in (pdb, pytest.importorskip("gemmi").read_structure(str(pdb))):
            result = eses.measure(found, radii=name)
            assert result.radii.name == name.lower() and source in result.radii.source
            assert result.atoms["radius"][1] == radius  # CA
    for wrong, meant in (("protr", "protor"), ("nacess", "naccess"), ("oosn", "oons"), ("protor+cdd", r"protor\+ccd")):
        with pytest.raises(ValueError, match=f"^radii: .*; did you mean {meant}\\?$"):
            eses.measure(pdb, radii=wrong)
    path = tmp_path / "my.config"
    path.write_text("name: NACCESS\ntypes:\nT 2.0 apolar\natoms:\nANY CA T\n")
    assert eses.measure(pdb, path).radii.source == f"the configuration file {path}"


@pytest.mark.parametrize("library", ["gemmi", "MDAnalysis", "prody"])
@pytest.mark.parametrize("occupancies", [(0.6, 0.4), (0.4, 0.6), (0.5, 0.5)])
def test_of_two_residues_with_one_number_one_is_kept(tmp_path, library, occupancies):
    module = pytest.importorskip(library)
    path = tmp_path / "mutant.pdb"
    atoms = [(name, letter, residue, occupancy, x) for letter, residue, names, occupancy in zip(
        "AB", ("SER", "VAL"), (("N", "CA", "CB", "OG"), ("N", "CA", "CB", "CG1")), occupancies)
             for x, name in zip((0.0, 1.5, 3.0, 4.5 if residue == "SER" else 4.6), names)]
    atoms.append(("CA", " ", "ALA", 1.0, 8.0))
    path.write_text("".join(f"ATOM  {i:5d}  {name:<3}{letter}{residue} A{1 + (residue == 'ALA'):4d}    {x:8.3f}{0:8.3f}{0:8.3f}"
                            f"{occupancy:6.2f}  0.00          {name[0]:>2}\n"
                            for i, (name, letter, residue, occupancy, x) in enumerate(atoms, 1)) + "END\n")
    if library == "prody":
        module.confProDy(verbosity="none")
    read = {"gemmi": lambda: module.read_structure(str(path)), "MDAnalysis": lambda: module.Universe(str(path)),
            "prody": lambda: module.parsePDB(str(path), altloc="all")}[library]
    expected, found = eses.measure(path), eses.measure(read())
    kept = found.molecule.kept
    for column in ("residue", "name"):
        assert found.atoms[column][kept].tolist() == expected.atoms[column].tolist()
    assert found.left_out == expected.left_out == {"altloc": 4}
    assert found.sas_area == pytest.approx(expected.sas_area, rel=1e-6)


def test_hydrogens_that_are_left_out_choose_no_location(tmp_path):
    """Hydrogens have the occupancy 1 in location A, and the heavy atoms a higher one in location B."""
    path = tmp_path / "hydrogens.pdb"
    path.write_text("".join(f"ATOM  {i:5d}  {name:<3}{letter}SER A   1    {x:8.3f}{0:8.3f}{0:8.3f}{occupancy:6.2f}  0.00"
                            f"          {name[0]:>2}\n" for i, (name, letter, x, occupancy) in enumerate((
                                ("CA", " ", 0.0, 1.0), ("OG", "A", 1.4, 0.4), ("OG", "B", 2.8, 0.6), ("HG", "A", 3.0, 1.0)), 1)) + "END\n")
    for hydrogens, place in (("drop", 2.8), ("keep", 1.4)):
        for molecule in (path, pytest.importorskip("gemmi").read_structure(str(path))):
            found = eses.measure(molecule, radii="bondi", hydrogens=hydrogens)
            assert found.molecule.centers[1, 0] == place
            assert found.left_out == {"altloc": 1, **({"hydrogen": 1} if hydrogens == "drop" else {})}


def test_atoms_of_one_name_and_location_are_all_kept(tmp_path):
    path = tmp_path / "alkane.pdb"
    path.write_text("".join(f"ATOM  {i:5d}  C  AALK A   1    {1.5 * i:8.3f}{0:8.3f}{0:8.3f}  1.00  0.00           C\n"
                            for i in range(1, 5)) + "END\n")
    for molecule in (path, pytest.importorskip("gemmi").read_structure(str(path))):
        assert len(eses.measure(molecule).molecule.kept) == 4


@pytest.mark.parametrize("occupancies", [(0.6, 0.4), (0.4, 0.6), (1.0, 1.0)])
def test_locations_without_a_letter_are_alternatives(tmp_path, occupancies):
    path = tmp_path / "blank.pdb"
    path.write_text("".join(f"ATOM  {i:5d}  {name:<3}{letter}SER A   1    {x:8.3f}{0:8.3f}{0:8.3f}{occupancy:6.2f}  0.00"
                            f"          {name[0]:>2}\n" for i, (name, letter, x, occupancy) in enumerate((
                                ("CA", " ", 0.0, 1.0), ("CB", " ", 1.5, 1.0), ("OG", " ", 2.9, occupancies[0]),
                                ("OG", "B", 1.5, occupancies[1])), 1)) + "END\n")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # atoms with the same place and name
        expected, found = eses.measure(path), eses.measure(pytest.importorskip("gemmi").read_structure(str(path)))
    np.testing.assert_array_equal(found.molecule.centers, expected.molecule.centers)
    assert found.left_out == expected.left_out


def test_radii_of_ions(pdb):
    for name in ("protor", "bondi", "msms", "naccess", "oons"):
        for found in (pdb, pytest.importorskip("gemmi").read_structure(str(pdb))):
            plain, result = eses.measure(found, radii=name), eses.measure(found, radii=f"{name.upper()}+Shannon")
            is_zinc = result.atoms["residue"] == "ZN"
            assert result.radii.name == f"{name}+shannon" and result.radii.source == (
                plain.radii.source + "; ions: Shannon 1976, doi:10.1107/S0567739476001551, for six neighbours")
            assert result.atoms["radius"][is_zinc].tolist() == [0.74]
            np.testing.assert_array_equal(result.atoms["radius"][~is_zinc], plain.atoms["radius"][~is_zinc])
            assert not set(np.flatnonzero(is_zinc)) & set(result.radii.guessed)
            assert eses.measure(eses.read_atoms(pdb, radii=f"{name}+shannon")).radii.name == f"{name}+shannon"


def test_radii_of_bonds_and_ions():
    text = "".join(f"HETATM{i:5d}  {name:3} {residue:>3} A {i:3d}    {4.0 * i:8.3f}   0.000   0.000  1.00  0.00          {name[:2].strip():>2}\n"
                   for i, (name, residue) in enumerate((("C ", "ACE"), ("O ", "ACE"), ("ZN", "ZN")), 1))
    pytest.importorskip("biotite")
    plain = eses.measure(text)
    for name in ("protor+ccd+shannon", "ProtOr+Shannon+CCD"):
        for found in (text, pytest.importorskip("gemmi").read_pdb_string(text)):
            both = eses.measure(found, name)
            assert both.radii.name == "protor+ccd+shannon"
            assert "Biotite" in both.radii.source and "Shannon" in both.radii.source
            assert both.atoms["radius"].tolist() == [*eses.measure(found, "protor+ccd").atoms["radius"][:2], 0.74]
            assert both.atoms["radius"][2] != plain.atoms["radius"][2]
    for wrong, message in (("bondi+ccd", r"\+ccd needs protor, as in 'protor\+ccd'"), ("protor+cdd+shannon", r"did you mean protor\+ccd\+shannon\?"),
                           ("protor+ccd+shanon", r"did you mean protor\+shannon\?")):
        with pytest.raises(ValueError, match=f"^radii: .*{message}"):
            eses.measure(text, wrong)
    with pytest.raises(ValueError, match="use eses.measure or eses.read_molecule"):
        eses.read_atoms(io.StringIO(text), radii="protor+ccd", format="pdb")


@pytest.mark.parametrize("radii", ["bondi", "protor", [1.0, 2.0]])
def test_radii_beside_those_of_the_molecule_are_refused(radii):
    spheres = [[0, 0, 0], [3, 0, 0]], [1.5, 1.5]
    for function in (eses.measure, eses.interfaces, eses.read_molecule, *([eses.Surface] if isinstance(radii, str) else [])):
        with pytest.raises(ValueError, match=r"^radii: \(centers, radii\) has radii already; leave out radii="):
            function(spheres, radii)
    if isinstance(radii, str):
        for name in ("fas2.pqr", "1ubq.xyzr"):
            with pytest.raises(ValueError, match=f"^radii='{radii}' needs a PDB or mmCIF file; .*{name} is read as "):
                eses.measure(DATA / name, radii)


def test_modified_amino_acids(pdb):
    serine = "".join(line for line in PDB.splitlines(True) if " SER " in line)
    for name, same in (("MSE", "MET"), ("DSN", "SER"), ("SER", "SER")):
        result = eses.measure(serine.replace(" SER ", f" {name} "))
        assert result.residues["relative_sas"][0] == pytest.approx(result.residues["sas"][0] / REFERENCES["tien"].areas[same])
        assert result.notes == ()
    text = PDB.replace("SER A", "SEP A")
    result = eses.measure(text)
    assert result.notes == ("modified amino acids without a maximum area have no relative area: SEP (1)",)
    assert np.isnan(result.residues["relative_sas"]).tolist() == [False, True, True]
    assert np.isnan(result.residues["sas_main_chain"]).tolist() == [False, False, True]
    assert eses.measure(text, report="//A/10").notes == eses.measure(text, probe_radius=1.2).notes == ()
    assert eses.measure(pdb).notes == ()


def test_results_are_read_only(pdb):
    result, parts = eses.measure(pdb), eses.interfaces(pdb)
    for owner, names in ((result, ("sas_area", "atoms", "residues", "chains", "left_out", "radii", "new")),
                         (result.atoms, ("new",)), (parts, ("table", "new")),
                         (eses.interface(pdb, "A"), ("first", "second", "atoms", "residues", "sas_area"))):
        for name in names:
            with pytest.raises(AttributeError):
                setattr(owner, name, 1)
    for counts in (result.left_out, result.molecule.left_out, eses.read_atoms(pdb).left_out):
        assert counts == {"water": 1, "altloc": 2} and copy.deepcopy(counts) == counts
        for change in (lambda: counts.update(water=2), lambda: counts.pop("water"), lambda: counts.__setitem__("water", 2),
                       counts.clear, lambda: counts.setdefault("x", 1), counts.popitem):
            with pytest.raises(TypeError, match="the numbers of atoms are read-only"):
                change()
        assert counts == {"water": 1, "altloc": 2}


def test_radii_from_a_file(pdb, tmp_path):
    path = tmp_path / "my.config"
    path.write_text("name: mine\ntypes:\nT 2.0 apolar\natoms:\nANY CA T\n")
    result = eses.measure(pdb, path)
    assert result.radii.name == "mine" and "my.config" in result.radii.source
    assert result.atoms["radius"][1] == 2


def test_hydrogens_do_not_count_twice():
    gemmi = pytest.importorskip("gemmi")
    hydrogen = "ATOM      6  HA  ALA A  10      12.139   5.371  -5.147  1.00  0.00           H\n"
    structure = gemmi.read_pdb_string(PDB.replace("ATOM      6", hydrogen + "ATOM      6"))
    assert eses.measure(structure).left_out["hydrogen"] == 1
    assert "hydrogen" not in eses.measure(structure, "bondi").left_out
    assert "hydrogen" not in eses.measure(structure, hydrogens="keep").left_out
    assert eses.measure(structure, "bondi", hydrogens="drop").left_out["hydrogen"] == 1


# -------------------------------------------------------------------------------------- results


def test_tables_add_up(pdb):
    result = eses.measure(pdb)
    for table in (result.residues, result.chains):
        assert table["sas"].sum() == pytest.approx(result.sas_area)
        assert table["ses"].sum() == pytest.approx(result.ses_area)
        np.testing.assert_allclose(table["sas_polar"] + table["sas_apolar"], table["sas"])
    assert result.residues["residue_number"].tolist() == [10, 10, 1]
    assert result.chains["residues"].tolist() == [2, 1] and result.chains["atoms"].tolist() == [11, 1]
    residues = result.residues
    np.testing.assert_allclose(residues["sas_main_chain"] + residues["sas_side_chain"], [*residues["sas"][:2], np.nan])
    with pytest.raises(KeyError, match="'rsa'; the columns are chain"):
        residues["rsa"]
    with pytest.raises(ValueError, match="read-only"):
        residues["sas"][0] = 0


def test_relative_areas_have_a_reference(pdb):
    maxima = {"tien": (129, 155), "wilke": (129, 155), "miller": (113, 122), "sander": (106, 130)}
    for name, (alanine, serine) in maxima.items():
        result = eses.measure(pdb, reference=name)
        assert "doi:10." in result.reference
        np.testing.assert_allclose(result.residues["relative_sas"], result.residues["sas"] / [alanine, serine, np.nan])


def test_references_are_those_of_biopython():
    scales = pytest.importorskip("Bio.Data.PDBData").residue_sasa_scales
    for name, scale in (("tien", "Wilke"), ("miller", "Miller"), ("sander", "Sander")):
        assert REFERENCES[name].areas == scales[scale]


def test_report_keeps_what_blocks(pdb, expected):
    part = eses.measure(pdb, report="//A")  # gemmi's syntax
    whole = eses.measure(pdb)
    assert part.ses_volume == whole.ses_volume == expected.ses_volume
    np.testing.assert_array_equal(part.atoms["sas"][:11], whole.atoms["sas"][:11])
    assert np.isnan(part.atoms["sas"][11]) and part.sas_area == pytest.approx(whole.atoms["sas"][:11].sum())
    assert part.chains["chain"].tolist() == ["A"] and part.whole.sas_area == whole.sas_area
    for report in (range(11), np.arange(12) < 11, np.arange(11)):
        assert eses.measure(pdb, report=report).sas_area == part.sas_area
    assert eses.measure(pdb, report=[11]).residues["residue"].tolist() == ["ZN"]
    for report, message in (([], "no atoms"), ([99], "out of bounds"), ([True], r"shape \(12,\)")):
        with pytest.raises(ValueError, match=message):
            eses.measure(pdb, report=report)
    with pytest.raises(ValueError, match="no names of chains and residues"):
        eses.measure(([[0, 0, 0]], [1.5]), report="protein")


def test_report_of_atoms_that_are_left_out_is_refused(pdb):
    structure = pytest.importorskip("Bio.PDB").PDBParser(QUIET=True).get_structure("x", pdb)
    with pytest.raises(ValueError, match="report: all 1 atoms are left out"):
        eses.measure(structure, select="//A", report=[11])


def test_structures_with_areas(pdb, tmp_path):
    result = eses.measure(pdb)
    for name in ("areas.pdb", "areas.cif"):
        result.save(tmp_path / name)
        again = eses.measure(tmp_path / name)
        assert again.sas_area == pytest.approx(result.sas_area, rel=1e-6)
        assert again.residues["icode"].tolist() == ["", "A", ""]
    lines = (tmp_path / "areas.pdb").read_text().splitlines()
    assert [float(line[60:66]) for line in lines[:12]] == pytest.approx(result.atoms["sas"], abs=0.006)
    # Apart from the last columns, the file is the input.
    original = [line for line in PDB.splitlines() if line.startswith("ATOM") and line[16] == " "]
    assert [line[12:54] for line in lines[:9]] == [line[12:54] for line in original]
    result.save(tmp_path / "residues.pdb", "relative_sas", "residue")
    lines = (tmp_path / "residues.pdb").read_text().splitlines()
    assert [float(line[60:66]) for line in lines[:11]] == pytest.approx(
        [result.residues["relative_sas"][i] for i in (0,) * 5 + (1,) * 6], abs=0.006)
    assert len(lines) == 12  # the ion has no relative area
    result.save(tmp_path / "chains.csv", level="chain")
    assert (tmp_path / "chains.csv").read_text().splitlines()[0].startswith("chain,residues,atoms,ses,sas")


def test_tables_are_saved_as_parquet(tmp_path):
    pandas = pytest.importorskip("pandas")
    pytest.importorskip("pyarrow")
    result = eses.measure(PDB)
    result.save(tmp_path / "residues.parquet", level="residue")
    result.atoms.save(tmp_path / "atoms.parquet")
    for name, table in (("residues", result.residues), ("atoms", result.atoms)):
        read = pandas.read_parquet(tmp_path / f"{name}.parquet")
        assert list(read) == list(table) and read["sas"].tolist() == pytest.approx(table["sas"].tolist(), nan_ok=True)


def test_gemmi_reads_the_areas(pdb, tmp_path):
    gemmi = pytest.importorskip("gemmi")
    result = eses.measure(pdb)
    for name, accuracy in (("areas.pdb", 0.006), ("areas.cif", 0.00006)):
        result.save(tmp_path / name)
        model = gemmi.read_structure(str(tmp_path / name))[0]
        values = [atom.b_iso for chain in model for residue in chain for atom in residue]
        np.testing.assert_allclose(values, result.atoms["sas"], atol=accuracy)


def test_wide_numbers_are_refused(pdb, tmp_path):
    result = eses.measure(pdb)
    big = eses.measure(pdb, probe_radius=50)
    with pytest.raises(ValueError, match=r"value \d+\.\d\d is too wide for a PDB file; save a .cif file"):
        big.save(tmp_path / "bad.pdb", level="chain")
    assert not (tmp_path / "bad.pdb").exists()
    big.save(tmp_path / "good.cif", level="chain")
    for name, column, level, message in (("a.xyz", "sas", "atom", "suffix must be .pdb"),
                                         ("a.pdb", "sas", "all", "level must"),
                                         ("a.pdb", "chain", "atom", "column must be one of radius, ses, sas, not"),
                                         ("a.pdb", "element", "atom", "column must be one of radius, ses, sas, not"),
                                         ("a.pdb", "name", "atom", "column must be one of radius, ses, sas, not")):
        with pytest.raises(ValueError, match=message):
            result.save(tmp_path / name, column, level)
    for name in ("a.pdb", "a.csv.gz"):
        with pytest.raises(ValueError, match=f"{name}: the suffix of a table must be .csv or .parquet"):
            result.atoms.save(tmp_path / name)


def test_only_chosen_surfaces_are_measured(pdb):
    both, sas = eses.measure(pdb), eses.measure(pdb, surfaces="sas")
    assert sas.sas_area == pytest.approx(both.sas_area, rel=1e-12) and both.vdw_area is None
    assert np.isnan([sas.ses_area, sas.ses_volume]).all() and np.isnan(sas.atoms["ses"]).all()
    for table, whole in ((sas.residues, both.residues), (sas.chains, both.chains)):
        assert np.isnan(table["ses"]).all()
        np.testing.assert_allclose(table["sas"], whole["sas"], rtol=1e-9)
    assert np.isnan(eses.measure(pdb, surfaces=["sas"], report=[0, 1]).ses_area)
    assert repr(sas).startswith("<eses_blocks.Measurement: SAS area") and "SES" not in sas._repr_html_()
    assert eses.measure(pdb, surfaces=("sas", "vdw")).vdw_area == eses.measure(pdb, surfaces="all").vdw_area > 0
    for wrong in ("sasa", (), ["sas", "x"]):
        with pytest.raises(ValueError, match="surfaces must be ses, sas, vdw or all"):
            eses.measure(pdb, surfaces=wrong)
    with pytest.raises(ValueError, match="solvent excluded surface"):
        eses.measure(pdb, surfaces="sas", derivatives=True)


def test_results_pickle_and_show_themselves(pdb):
    result = eses.measure(pdb, report="//A", derivatives=True, van_der_waals=True)
    again = pickle.loads(pickle.dumps(result))
    assert again.ses_area == result.ses_area and again.vdw_area == result.vdw_area
    np.testing.assert_array_equal(again.residues["sas"], result.residues["sas"])
    assert not again.atoms["sas"].flags.writeable
    assert again.derivatives.sas_area.centers.shape == (12, 3)
    assert result.cavities() == [] and repr(result).startswith("<eses_blocks.Measurement: SES area")
    page = result._repr_html_()
    assert "protor" in page and "doi:10.1006" in page and "11 atoms" in page
    assert "<table>" in result.residues._repr_html_()
    assert repr(result.molecule) == "<eses_blocks.Molecule: 12 atoms, 2 altloc left out, 1 water left out, <radii: protor, 1 guessed>>"


def test_tables_become_frames(pdb):
    pytest.importorskip("pandas")
    frame = eses.measure(pdb).residues.to_pandas()
    assert list(frame.columns)[:4] == ["chain", "residue_number", "icode", "residue"] and len(frame) == 3


def test_residues_agree_with_the_program(pdb, run_program, tmp_path):
    run_program("measure", pdb, "--write", "residues", "-o", tmp_path)
    [path] = tmp_path.glob("*.residues.csv")
    rows = list(csv.DictReader(path.read_text().splitlines()))
    residues = eses.measure(pdb).residues
    assert [float(row["sas_area"]) for row in rows] == pytest.approx(residues["sas"], abs=1e-6)
    assert [float(row["relative_sas_area"] or "nan") for row in rows] == pytest.approx(
        residues["relative_sas"], abs=1e-6, nan_ok=True)
