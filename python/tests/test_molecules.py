"""Molecules of files, texts, arrays and other libraries: the same atoms give the same areas, in the
order of the object. Libraries that are missing are skipped."""

import gzip
import io
import sys
import warnings

import numpy as np
import pytest

import eses_blocks as eses
from conftest import DATA, KEPT, PDB

pytestmark = pytest.mark.usefixtures("needs_gemmi")


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
