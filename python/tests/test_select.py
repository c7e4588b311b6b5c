"""Selections of atoms: the same texts choose the same atoms of files and of objects of other libraries."""

import pickle
import re
import warnings

import numpy as np
import pytest

import eses_blocks as eses
from conftest import DATA, PDB

pytestmark = pytest.mark.usefixtures("needs_gemmi")

LIGAND = """\
HETATM   17  C1  STI C   1      30.000   2.134  -3.504  1.00  0.00           C
HETATM   18  O1  STI C   1      31.400   2.134  -3.504  1.00  0.00           O
HETATM   19  C1  GOL C   2      30.000   8.134  -3.504  1.00  0.00           C
HETATM   20  O1  GOL C   2      31.400   8.134  -3.504  1.00  0.00           O
"""
TEXT = "".join(line + "\n" for line in PDB.splitlines() if line[16:17] != "A" and line != "END") + LIGAND + "END\n"


@pytest.fixture(name="path")
def fixture_path(tmp_path):
    path = tmp_path / "ligands.pdb"
    path.write_text(TEXT)
    return path


def opened(library, path):
    """Returns the molecule as an object of a library."""
    if library == "path":
        return path
    if library == "Atoms":
        return eses.read_atoms(path)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        if library == "gemmi":
            return pytest.importorskip("gemmi").read_structure(str(path))
        if library == "Bio":
            return pytest.importorskip("Bio.PDB").PDBParser(QUIET=True).get_structure("x", str(path))
        if library == "biotite":
            return pytest.importorskip("biotite.structure.io.pdb").PDBFile.read(str(path)).get_structure(
                altloc="occupancy", model=1)
        if library == "parmed":
            return pytest.importorskip("parmed").load_file(str(path))
        if library == "openmm":
            return pytest.importorskip("openmm.app").PDBFile(str(path))
        if library == "rdkit":
            return pytest.importorskip("rdkit.Chem").MolFromPDBFile(str(path), sanitize=False)
        if library == "MDAnalysis":
            return pytest.importorskip("MDAnalysis").Universe(str(path))
        if library == "mdtraj":
            return pytest.importorskip("mdtraj").load(str(path), no_boxchk=True)
        prody = pytest.importorskip("prody")
        prody.confProDy(verbosity="none")
        return prody.parsePDB(str(path), altloc="B")


def reported(result):
    """Returns the names of the reported residues."""
    return result.residues["residue"].tolist()


SYNTAX_OF_GEMMI = ["path", "Atoms", "gemmi", "Bio", "biotite", "parmed", "openmm"]
OWN_SYNTAX = ["MDAnalysis", "mdtraj", "prody"]


@pytest.mark.parametrize("library", SYNTAX_OF_GEMMI)
@pytest.mark.parametrize(("text", "residues"), [
    ("//A/10", ["ALA"]), ("//A/10.A", ["SER"]), ("//C", ["STI", "GOL"]), ("(STI,ZN)", ["ZN", "STI"]),
    ("//*//[O]", ["ALA", "SER", "STI", "GOL"]), ("//A/10-11/CA", ["ALA", "SER"]), (";polymer", ["ALA", "SER"]),
    ("A", ["ALA", "SER"]), ("A+B", ["ALA", "SER", "ZN"]), ("B, C", ["ZN", "STI", "GOL"]),
    ("ligand:STI", ["STI"]), ("ligand", ["STI", "GOL"]), ("ligand:C/2", ["GOL"]), ("ligand:C/STI", ["STI"]),
    ("ligand:A/10A", ["SER"]), ("10", ["ALA"]), ("!A", ["ZN", "STI", "GOL"])])
def test_texts_choose_the_same_atoms(path, library, text, residues):
    molecule = opened(library, path)
    assert reported(eses.measure(molecule, report=text)) == residues
    assert reported(eses.measure(molecule, select=text)) == residues
    if residues != ["ALA", "SER", "STI", "GOL"]:
        assert eses.interface(molecule, text).first == text
    eses.Surface(molecule).cavities(at="B" if text == "ligand" else text)


def atom_line(serial, record, name, residue, chain, number, x, y):
    return (f"{record:<6}{serial:5d}  {name:<3} {residue:>3} {chain}{number:4d}    {x:8.3f}{y:8.3f}{0:8.3f}  1.00  0.00"
            f"          {name[0]:>2}\n")


@pytest.mark.parametrize("ligands_last", [False, True])
def test_modified_residues_of_a_chain_are_no_ligands(tmp_path, ligands_last):
    """The ligands, a free amino acid and more waters than residues have the name of the chain, as in the PDB."""
    backbone = (("N", 0.0, 0.0), ("CA", 1.45, 0.0), ("C", 2.0, 1.4), ("O", 1.2, 2.4))
    parts = []
    for chain, y in (("A", 0.0), ("B", 30.0)):
        parts.append([(record, name, residue, chain, number, 3.3 * number + dx, y + dy)
                      for number, residue, record in ((1, "ALA", "ATOM"), (2, "CSO", "HETATM"), (3, "SER", "ATOM"), (4, "XYZ", "HETATM"),
                                                      (5, "ALA", "ATOM")) for name, dx, dy in backbone])
        parts.append([("HETATM", name, "STI", chain, 201, x, y + 8) for name, x in (("C1", 0.0), ("C2", 1.5), ("O1", 2.7))]
                     + [("HETATM", name, "GLU", chain, 202, 20 + dx, y + 8 + dy) for name, dx, dy in backbone]
                     + [("HETATM", "O", "HOH", chain, 300 + k, 3.0 * k, y + 15) for k in range(40)])
    order = (0, 2, 1, 3) if ligands_last else (0, 1, 2, 3)
    rows = [row for k in order for row in parts[k]]
    path = tmp_path / "modified.pdb"
    path.write_text("".join(atom_line(serial, *row) for serial, row in enumerate(rows, 1)) + "END\n")
    gemmi = pytest.importorskip("gemmi")
    for molecule in (path, eses.read_atoms(path), gemmi.read_structure(str(path)), gemmi.read_structure(str(path))[0]):
        for arguments in ({"report": "ligand"}, {"select": "ligand"}, {"report": ";!polymer"} if molecule is not path else {}):
            if arguments:
                found = eses.measure(molecule, **arguments).residues
                assert list(zip(found["chain"], found["residue"])) == [("A", "STI"), ("B", "STI")]
        assert reported(eses.measure(molecule, report="ligand:B/202")) == ["GLU"]


def test_select_of_files_takes_masks_and_pqr_files(path):
    residues = reported(eses.measure(path, select=range(5)))
    assert residues == reported(eses.measure(eses.read_atoms(path), select=range(5))) == ["ALA"]
    atoms = eses.read_atoms(DATA / "fas2.pqr")
    for text in ("(THR)", "ligand:THR", "550", atoms.labels.residue == "THR"):
        chosen = eses.measure(DATA / "fas2.pqr", select=text)
        assert chosen.sas_area == eses.measure(atoms, select=text).sas_area
        assert chosen.left_out.keys() == {"selection"}
    xyzr = DATA / "1ubq.xyzr"
    assert len(eses.measure(xyzr, select=[0, 1]).molecule.kept) == 2
    with pytest.raises(ValueError, match="select: the atoms have no names of chains and residues; give a mask"):
        eses.measure(xyzr, select="A")


@pytest.mark.parametrize("library", ["gemmi", "Bio", "biotite", "MDAnalysis", "prody", "mdtraj"])
def test_parts_of_objects_are_selections(path, library):
    """Parts choose the atoms at their positions, also of the file and of objects of other libraries."""
    molecule = opened(library, path)
    part = {"gemmi": lambda: molecule[0]["C"][0], "Bio": lambda: list(molecule[0]["C"])[0],
            "biotite": lambda: molecule[molecule.res_name == "STI"],
            "MDAnalysis": lambda: molecule.select_atoms("resname STI"),
            "prody": lambda: molecule.select("resname STI"),
            "mdtraj": lambda: molecule.atom_slice(molecule.topology.select("resname STI"))}[library]()
    others = [opened(other, path) for other in OWN_SYNTAX if other != library]
    for found in (molecule, path, *others):
        assert reported(eses.measure(found, report=part)) == ["STI"]
        assert reported(eses.measure(found, select=part)) == ["STI"]
        assert eses.interface(found, part).first == "2 atoms"
    with pytest.raises(ValueError, match="report: 2 of 2 atoms of the given .* are not at the positions of atoms"):
        eses.measure(([[500, 0, 0]], [1.5]), report=part)


def test_parts_may_have_atoms_that_files_leave_out(path):
    hydrogen = "ATOM     30  HA  ALA A  10      11.000   6.900  -7.300  1.00  0.00           H\n"
    path.write_text(TEXT.replace("TER", hydrogen + "TER", 1))
    model = opened("gemmi", path)[0]
    assert reported(eses.measure(path, report=model["A"])) == ["ALA", "SER"]
    assert reported(eses.measure(path, report=model["B"])) == ["ZN"]
    with pytest.raises(ValueError, match="report: 1 of 1 atoms of the given Residue are not at"):
        eses.measure(path, report=model["B"][1])  # a water
    model["A"][0][0].pos.x += 1
    with pytest.raises(ValueError, match="report: 1 of .* atoms of the given Chain are not at"):
        eses.measure(path, report=model["A"])


def test_surfaces_of_molecules_have_names(path):
    surface = eses.Surface(path)
    assert reported(eses.measure(surface, report="ligand")) == ["STI", "GOL"]
    assert reported(eses.measure(surface, select="B")) == ["ZN"]
    assert eses.measure(surface).polar == eses.measure(path).polar
    assert eses.interface(surface, "ligand:STI").sas_area == eses.interface(path, "ligand:STI").sas_area
    chosen = eses.Surface(path, select="//C")
    assert eses.measure(chosen).atoms["residue"].tolist() == ["STI", "STI", "GOL", "GOL"]


@pytest.mark.parametrize("radii", ["protor", "bondi"])
def test_atoms_of_files_have_their_set_of_radii(path, radii):
    path.write_text(TEXT.replace("STI", "XYZ"))  # a ligand that no set names
    expected, found = (eses.measure(*given).radii for given in ((path, radii), (eses.read_atoms(path, radii=radii),)))
    assert found.name == expected.name == radii and found.source == expected.source
    assert found.guessed.tolist() == expected.guessed.tolist()
    assert (len(found.guessed) > 0) == (radii == "protor")


def test_residues_of_mdanalysis_are_not_indices_of_atoms(path):
    universe = opened("MDAnalysis", path)
    assert reported(eses.measure(universe, report=universe.residues[-1])) == reported(
        eses.measure(universe, report=universe.residues[-1].atoms))
    other = opened("MDAnalysis", path)
    with pytest.raises(ValueError, match="report: the atoms are those of another universe"):
        eses.measure(universe, report=other.atoms[:1])


@pytest.mark.parametrize(("library", "text", "hint"), [
    ("MDAnalysis", "//A/10", "the syntax of MDAnalysis, such as 'resid 57 and name CA', and not gemmi's$"),
    ("mdtraj", "//A/10", "the syntax of MDTraj, such as 'resSeq 57 and name CA', and not gemmi's$"),
    ("prody", "//A/10", "the syntax of ProDy, such as 'resnum 57 and name CA', and not gemmi's$"),
    ("gemmi", "resname ALA", "; selections have gemmi's syntax, such as //A/57/CA, .HEM. or ;polymer$"),
    ("biotite", "protein", "; selections have gemmi's syntax, such as //A/57/CA, .HEM. or ;polymer$")])
def test_messages_name_the_language(path, library, text, hint):
    for argument in ("report", "select"):
        with pytest.raises(ValueError, match=f"(?s)^{argument}: .*{hint}"):
            eses.measure(opened(library, path), **{argument: text})


@pytest.mark.parametrize(("options", "message"), [
    ({"select": "protein"}, 'selection: invalid selection syntax, expected .*, found "protein"; its chains are A, B, C$'),
    ({"select": "A+D"}, "selection: no atoms of chain D; its chains are A, B, C$"),
    ({"select": "ligand:HEM"}, "selection: no atoms of residue HEM; the residues are "),
    ({"chains": ["D"]}, r"there is no chain \"D\" \(chains=\)"), ({"model": 7}, r"there is no model 7 \(model=\)"),
    ({"select": "/2/A"}, "the selection names model 2, but model .* is read; use model=2$"),
    ({"select": "//*//[O]", "radii": "bondi", "chains": ["B"]}, r"of water \(waters=True keeps them\)|1 not selected")])
def test_messages_about_files_name_arguments(path, options, message):
    for call in (eses.measure, eses.Surface, eses.read_atoms):
        with pytest.raises(ValueError, match=message):
            call(path, **options)


def test_messages_keep_the_name_of_the_file(path):
    other = path.with_name("a--model 1--waters--unknown-radius.pdb")
    path.rename(other)
    for options, message in (({"model": 7}, "there is no model 7 (model=)"), ({"chains": ["D"]}, 'there is no chain "D" (chains=)')):
        with pytest.raises(ValueError) as error:
            eses.read_atoms(other, **options)
        assert str(error.value).startswith(f"{other}: {message}")


@pytest.mark.parametrize("library", OWN_SYNTAX)
def test_other_libraries_keep_their_syntax(path, library):
    molecule = opened(library, path)
    assert reported(eses.measure(molecule, report="name CA")) == ["ALA", "SER"]
    assert reported(eses.measure(molecule, report="ligand:STI")) == ["STI"]
    assert reported(eses.measure(molecule, report="ligand")) == ["STI", "GOL"]
    with pytest.raises(ValueError, match="^report: "):
        eses.measure(molecule, report="//A/10")


@pytest.mark.parametrize("library", ["path", "Atoms", "gemmi", "Bio", "MDAnalysis", "prody"])
def test_selections_of_gemmi_are_those_of_their_text(path, library):
    gemmi, molecule = pytest.importorskip("gemmi"), opened(library, path)
    assert reported(eses.measure(molecule, report=gemmi.Selection("(STI)"))) == ["STI"]
    assert reported(eses.measure(molecule, select=gemmi.Selection("(STI)"))) == ["STI"]
    first, second, missing = (gemmi.Selection(text) for text in ("(ALA,SER)", "(ZN)", "(HEM)"))
    found = eses.interface(molecule, first, second)
    assert (found.first, found.second) == (first.str(), second.str()) and found.sas_area > 0
    with pytest.raises(ValueError, match=f"^report: .*no atoms .*{re.escape(missing.str())}'?; (the|its) chains are A"):
        eses.measure(molecule, report=missing)


def test_a_whole_structure_gives_the_areas_of_the_file(path):
    whole = eses.measure(path)
    for library in SYNTAX_OF_GEMMI[1:]:
        part = eses.measure(opened(library, path), report="//A")
        assert part.sas_area == pytest.approx(whole.chains["sas"][0], rel=1e-6), library
        assert part.ses_volume == pytest.approx(whole.ses_volume, rel=1e-6), library


@pytest.mark.parametrize("library", ["Atoms", "gemmi", "Bio", "biotite", "MDAnalysis", "prody"])
def test_select_leaves_other_atoms_out(path, library):
    text = {"MDAnalysis": "segid A or chainID A", "prody": "chain A"}.get(library, "//A")
    found = eses.measure(opened(library, path), select=text)
    expected = eses.measure(path, select="//A")
    assert found.sas_area == pytest.approx(expected.sas_area, rel=1e-6)
    assert found.left_out["selection"] >= 5 and np.isnan(found.atoms["sas"][-1])
    assert eses.measure(opened(library, path), select="").left_out.get("selection") is None
    with pytest.raises(ValueError, match="^select: no atoms in "):
        eses.measure(opened(library, path), select="name XX" if library in OWN_SYNTAX else "//A//XX")
    with pytest.raises(TypeError, match="chains: only PDB, mmCIF and PQR files have these arguments$"):
        eses.measure(opened(library, path), select=text, chains=["A"])


def test_select_leaves_out_atoms_without_a_radius():
    columns = eses.adaptors.Columns(centers=[[0, 0, 0], [9, 0, 0]], elements=["C", "Xx"], names=["CA", "X"],
                                    residues=["ALA", "DUM"], chains=["A", "A"], numbers=[1, 2])
    kind = type("Molecule", (), {"__module__": "mylibrary"})
    eses.adaptors.ADAPTORS["mylibrary"] = lambda found, frame: columns
    try:
        with pytest.raises(ValueError, match="without a radius"):
            eses.measure(kind())
        assert eses.measure(kind(), select="(ALA)").radii.name == "protor"
    finally:
        del eses.adaptors.ADAPTORS["mylibrary"]


def test_interfaces_of_objects(path):
    expected = eses.interface(path, "//A", "//B")
    for library in ("gemmi", "Bio", "biotite", "Atoms"):
        for first, second in (("//A", "//B"), ("A", "B"), ("A", "(ZN)"), (";polymer", "ligand:ZN")):
            found = eses.interface(opened(library, path), first, second)
            assert found.sas_lost == pytest.approx(expected.sas_lost, abs=1e-3)
    assert eses.interface(path, "ligand").first == "ligand"


@pytest.mark.parametrize(("text", "message"), [
    ("//A/999", r"^report: no atoms in '//A/999'; the chains are A \(residues 10 to 10\), B \(residues 1 to 2\), C"),
    ("D", r"^report: no chain 'D'; the chains are A \(residues 10 to 10\)"),
    ("A+D", "^report: no chain 'D'; "),
    ("STI", "no chain 'STI'; .*; residue STI is ligand:STI$"),
    ("ligand:HEM", "^report: no atoms of residue HEM; the residues are ZN, HOH, STI, GOL, ALA, SER"),
    ("protein", "^report: no chain 'protein'; the chains are A"),
    ("//A/x[", "^report: invalid selection syntax"),
    ("/1/A", "^report: .*models cannot be selected here"),
    ("//A//:B", "^report: .*alternate locations cannot be selected here"),
    (";b<20", "^report: .*occupancies and B-factors cannot be selected here"),
    ("", "^report: no chain ''"),
])
def test_errors_name_what_is_wrong_and_what_exists(path, text, message):
    for library in ("gemmi", "biotite"):
        with pytest.raises(ValueError, match=message):
            eses.measure(opened(library, path), report=text)


def test_digits_are_residues_or_an_unknown_chain(path):
    for library in ("path", "Atoms", "gemmi", "MDAnalysis"):
        with pytest.raises(ValueError, match=r"^report: no .*'99'; the chains are A \(residues 10 to 10\)"):
            eses.measure(opened(library, path), report="99")
    with pytest.raises(ValueError, match="no chain '10'; .*; selections have the syntax of MDAnalysis, such as 'resid 57 and name CA'$"):
        eses.measure(opened("MDAnalysis", path), report="10")
    assert reported(eses.measure(path, report="10")) == ["ALA"]


def test_errors_of_other_arguments(path):
    for report, error, message in ((3.5, TypeError, "must be a selection, a mask or indices"),
                                   ([0.5], TypeError, "must be a selection"), ({}, TypeError, "must be a selection"),
                                   ([], ValueError, "report: no atoms are selected"),
                                   ([-99], ValueError, "out of bounds")):
        with pytest.raises(error, match=message):
            eses.measure(path, report=report)
    for report in ("//A", "ligand:STI"):
        with pytest.raises(ValueError, match="report: "):
            eses.measure(([[0, 0, 0]], [1.5]), report=report)


def test_pockets_of_a_ligand(tmp_path):
    """The pocket of a ligand in a box of atoms that is open above is that around its balls."""
    spots = [(x, y, z) for x in range(0, 22, 3) for y in range(0, 22, 3) for z in range(0, 16, 3)
             if not (6 < x < 15 and 6 < y < 15 and z > 3)]
    lines = [f"ATOM  {k + 1:5}  CA  ALA A{k + 1:4}    {x:8.3f}{y:8.3f}{z:8.3f}  1.00  0.00           C"
             for k, (x, y, z) in enumerate(spots)]
    lines += [f"HETATM{len(spots) + 1 + k:5}  C{k + 1}  LIG B   1    {10.5 + k:8.3f}{10.5:8.3f}{9.0:8.3f}  1.00  0.00           C"
              for k in range(2)]
    path = tmp_path / "box.pdb"
    path.write_text("\n".join(lines) + "\nEND\n")
    atoms = eses.read_atoms(path)
    count = len(spots)
    expected = eses.Surface(atoms.centers[:count], atoms.radii[:count]).pockets(
        4.0, balls=(atoms.centers[count:], atoms.radii[count:]))
    assert len(expected) == 1
    surfaces = [eses.Surface(path), eses.measure(path).surface, eses.Surface(atoms)]
    for surface in surfaces:
        for text in ("ligand:LIG", "ligand"):
            found = surface.pockets(4.0, at=text)
            assert len(found) == 1 and found[0]["volume"] == expected[0]["volume"]
            assert found[0]["atoms"].tolist() == expected[0]["atoms"].tolist()
    again = pickle.loads(pickle.dumps(surfaces[0]))
    assert [each["volume"] for each in again.pockets(4.0, at="ligand:LIG")] == [expected[0]["volume"]]
    structure = opened("gemmi", path)
    ligand = structure[0]["B"]
    without = eses.Surface(structure, select="//A")
    for surface in (*surfaces, without, again):
        found = surface.pockets(4.0, at=ligand)
        assert [each["volume"] for each in found] == pytest.approx([expected[0]["volume"]], rel=1e-6)
    is_ligand = atoms.labels.residue == "LIG"
    assert surfaces[0].pockets(4.0, at=structure[0]["A"][117]) == surfaces[0].pockets(4.0, at="//A/118") == []
    assert len(surfaces[2].cavities(at=~is_ligand)) == len(surfaces[2].cavities(at="A"))
    mask = np.flatnonzero(atoms.labels.residue_number == "118")
    empty = eses.measure(path, select="//A").surface
    expected = [each["volume"] for each in empty.pockets(4.0, atoms=mask)]
    for at in ("//A/118", pytest.importorskip("gemmi").Selection("//A/118")):
        assert expected and [each["volume"] for each in empty.pockets(4.0, at=at)] == expected
        assert surfaces[0].cavities(at=at) == []
    assert surfaces[0].cavities(at="ligand:LIG") == []
    with pytest.raises(ValueError, match="at: no atoms of residue STI; the residues are LIG, ALA"):
        surfaces[0].pockets(at="ligand:STI")
    with pytest.raises(ValueError, match="no atoms besides .ligand."):
        eses.Surface(eses.read_atoms(path, select="//B")).pockets(at="ligand")
    with pytest.raises(ValueError, match="cannot be combined"):
        surfaces[0].pockets(at="ligand", atoms=[0])
    with pytest.raises(ValueError, match="the surface has no names of atoms"):
        eses.Surface(atoms.centers, atoms.radii).pockets(at="ligand:LIG")
    path.unlink()  # surfaces do not read their file again
    assert [each["volume"] for each in empty.pockets(4.0, at="//A/118")] == expected
    assert surfaces[0].pockets(4.0, at="//A/118") == []


def test_pockets_of_a_ligand_do_not_repeat_warnings_of_the_surface(path):
    path.write_text(TEXT.replace("11.639   6.071  -5.147", "11.104   6.134  -6.504"))
    with pytest.warns(UserWarning):
        surface = eses.Surface(path)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        surface.pockets(3.0, at="ligand:ZN")


def test_names_of_pqr_files():
    result = eses.measure(DATA / "fas2.pqr", report="(THR)")
    assert set(reported(result)) == {"THR"} and pickle.loads(pickle.dumps(result)).sas_area == result.sas_area
