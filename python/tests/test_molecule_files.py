"""Molecules of PDB and mmCIF files: names of chains, models, and atoms that are left out."""

import gzip
import importlib.util
import io
import pickle

import numpy as np
import pytest

import eses_blocks as eses
from conftest import DATA, PDB

pytestmark = pytest.mark.usefixtures("needs_gemmi")

MMCIF = """\
data_x
loop_
_atom_site.group_PDB
_atom_site.id
_atom_site.type_symbol
_atom_site.label_atom_id
_atom_site.label_comp_id
_atom_site.label_asym_id
_atom_site.label_seq_id
_atom_site.label_alt_id
_atom_site.occupancy
_atom_site.B_iso_or_equiv
_atom_site.Cartn_x
_atom_site.Cartn_y
_atom_site.Cartn_z
_atom_site.auth_seq_id
_atom_site.auth_asym_id
_atom_site.pdbx_PDB_ins_code
ATOM   1 N N     GLY A 1 . 1 0 0.0 0.0 0.0 10 H ?
ATOM   2 C CA    GLY A 1 . 1 0 1.5 0.0 0.0 10 H ?
ATOM   3 N N     GLY A 2 . 1 0 4.0 0.0 0.0 10 H A
ATOM   4 C 'CA'  GLY A 2 . 1 0 5.5 0.0 0.0 10 H A
HETATM 5 O "O2'" GOL B . . 1 0 9.0 0.0 0.0 99 H ?
HETATM 6 O O     HOH C . . 1 0 9.0 9.0 0.0 50 H ?
"""


def test_label_chains_of_mmcif_files(tmp_path):
    path = tmp_path / "label.cif.gz"
    path.write_bytes(gzip.compress(MMCIF.encode()))
    for found in (path, str(path), MMCIF, io.BytesIO(MMCIF.encode())):
        result = eses.measure(found)
        assert result.atoms["chain"].tolist() == ["H"] * 5
        assert result.atoms["label_chain"].tolist() == list("AAAAB")
        residues = result.residues
        assert residues["label_chain"].tolist() == list("AAB") and residues["icode"].tolist() == ["", "A", ""]
        assert pickle.loads(pickle.dumps(result)).atoms["label_chain"].tolist() == list("AAAAB")
    assert eses.measure(MMCIF, select="(GOL)").atoms["label_chain"].tolist() == ["B"]
    assert "label_chain" not in eses.measure(MMCIF.replace("label_asym_id", "other")).atoms
    # The rows of a wrapped loop are not lines.
    assert "label_chain" not in eses.measure(MMCIF.replace("10 H A\n", "\n10 H A\n")).atoms
    assert "label_chain" not in eses.measure(PDB).atoms


def test_chain_names_are_chosen(tmp_path):
    path = tmp_path / "label.cif"
    path.write_text(MMCIF)
    for found in (path, MMCIF):
        result = eses.measure(found, chain_names="label")
        assert result.atoms["chain"].tolist() == list("AAAAB")
        assert result.residues["auth_chain"].tolist() == list("HHH") and "label_chain" not in result.residues
        assert result.chains["chain"].tolist() == ["A", "B"]
        assert eses.measure(found, chain_names="label", chains=["B"]).atoms["name"].tolist() == ["O2'"]
    assert eses.read_atoms(path, chain_names="label").labels.chain.tolist() == list("AAAAB")
    assert eses.read_atoms(path).labels.chain.tolist() == list("HHHHH")
    with pytest.raises(ValueError, match="chain_names must be 'auth' or 'label', not 'both'"):
        eses.read_atoms(path, chain_names="both")
    with pytest.raises(ValueError, match="PDB files have no chain names label_asym_id"):
        eses.measure(PDB, chain_names="label")


def test_radii_in_place_of_occupancies():
    text = "ATOM      1  CA  ALA A   1       0.000   0.000   0.000  2.25  0.00           C\n"
    result = eses.measure(text, radii="occupancy")
    assert result.sas_area == pytest.approx(4 * np.pi * 3.65**2)
    assert result.radii.source == "the input file" and len(result.radii.guessed) == 0
    gemmi = pytest.importorskip("gemmi")
    with pytest.raises(ValueError, match="needs a PDB or mmCIF file"):
        eses.measure(gemmi.read_pdb_string(text), radii="occupancy")


def test_gemmi_residues_without_numbers():
    gemmi = pytest.importorskip("gemmi")
    chain = gemmi.Chain("A")
    residue = gemmi.Residue()
    residue.name = "ZN"
    residue.add_atom(gemmi.Atom())
    residue[0].name, residue[0].element = "ZN", gemmi.Element("Zn")
    chain.add_residue(residue)
    assert chain[0].seqid.num is None
    assert eses.measure(chain).residues["residue_number"].tolist() == [0]


def test_label_chains_of_gemmi():
    gemmi = pytest.importorskip("gemmi")
    structure = gemmi.make_structure_from_block(gemmi.cif.read_string(MMCIF).sole_block())
    assert eses.measure(structure).residues["label_chain"].tolist() == list("AAB")


def test_radii_of_ligands_follow_from_their_bonds():
    text = "".join(f"HETATM{i:5d}  {name:3} GOL A   1    {4.0 * i:8.3f}   0.000   0.000  1.00  0.00           {name[0]}\n"
                   for i, name in enumerate(("C1", "O1", "C2", "C9"), 1))
    if importlib.util.find_spec("biotite") is None:
        with pytest.raises(ImportError, match="needs biotite"):
            eses.measure(text, radii="protor+ccd")
        return
    by_element, by_bonds = eses.measure(text), eses.measure(text, radii="protor+ccd")
    assert by_element.radii.guessed.tolist() == [0, 1, 2, 3]
    # A methylene and a hydroxyl group and a methine; glycerol has no fourth atom of this name.
    assert by_bonds.atoms["radius"][:3].tolist() == [1.88, 1.46, 1.88]
    assert by_bonds.atoms["radius"][3] == by_element.atoms["radius"][3]
    assert by_bonds.radii.guessed.tolist() == [3] and "Biotite" in by_bonds.radii.source
    assert by_bonds.radii.name == "protor+ccd"
    # Atoms that the set names keep their radii.
    assert eses.measure(PDB, radii="protor+ccd").sas_area == eses.measure(PDB).sas_area


def models_text():
    """Three models of a few atoms that move."""
    atoms = [line for line in PDB.splitlines(True) if line.startswith(("ATOM", "HETATM"))]
    return "".join(f"MODEL     {number:4}\n" + "".join(f"{line[:30]}{float(line[30:38]) * (1 + number / 50):8.3f}{line[38:]}"
                                                        for line in atoms) + "ENDMDL\n" for number in (1, 2, 7))


def test_models_of_a_file(tmp_path):
    path = tmp_path / "nmr.pdb"
    path.write_text(models_text())
    expected = [eses.measure(path, model=number, unknown_radius=1.5).sas_area for number in (1, 2, 7)]
    assert len(set(expected)) == 3
    found = eses.measure(path, models="all", unknown_radius=1.5)
    assert [each.sas_area for each in found] == expected
    assert [each.notes for each in found] == [(f"model {number}; the file has 3 models",) for number in (1, 2, 7)]
    assert [each.sas_area for each in eses.measure(str(path), models=[7, 1], unknown_radius=1.5)] == expected[::-2]
    assert [each.sas_area for each in eses.measure(path, models=np.array([7, 1]), unknown_radius=1.5)] == expected[::-2]
    assert [each.sas_area for each in eses.measure(models_text(), models=iter((2,)), unknown_radius=1.5)] == expected[1:2]
    with open(path, "rb") as opened:
        assert [each.sas_area for each in eses.measure(opened, models="all", unknown_radius=1.5)] == expected
    with pytest.raises(ValueError, match="models must be 'all' or numbers, not 'first'"):
        eses.measure(path, models="first")
    with pytest.raises(TypeError, match="model or models"):
        eses.measure(path, models="all", model=1)
    with pytest.raises(TypeError, match="only PDB, mmCIF and PQR files have models; use frame="):
        eses.measure(([[0, 0, 0]], [1]), models="all")
    with open(path, "rb") as opened, pytest.raises(ValueError, match="nmr.pdb: there is no model 3"):
        eses.measure(opened, models=[3])
    with pytest.raises(ValueError, match="nmr.pdb: there is no model 3"):
        eses.measure(path, models=[3])
    with pytest.raises(ValueError, match="nmr.pdb was read, and would be overwritten"):
        found[1].save(path)


def test_models_of_an_mmcif_file():
    rows = "".join(f"ATOM {model * 10 + k} C CA ALA A 1 {k} {3.0 * k * model} 0 0 1 {model}\n"
                   for model in (1, 4) for k in (1, 2))
    columns = ("group_PDB id type_symbol label_atom_id label_comp_id label_asym_id label_entity_id label_seq_id Cartn_x Cartn_y "
               "Cartn_z occupancy pdbx_PDB_model_num").split()
    text = "data_x\nloop_\n" + "".join(f"_atom_site.{name}\n" for name in columns) + rows + "#\n"
    found = eses.measure(text, models="all")
    assert [each.sas_area for each in found] == [eses.measure(text, model=number).sas_area for number in (1, 4)]
    assert found[0].sas_area != found[1].sas_area


def test_atoms_that_a_file_leaves_out_are_counted():
    water = "HETATM   90  O   HOH A  90      40.000   2.000   3.000  1.00  0.00           O\n"
    text = "".join(line for line in PDB.splitlines(True) if line.startswith("ATOM")) + water
    found = eses.measure(text)
    assert found.left_out["water"] == 1
    assert found.left_out == found.molecule.left_out
    assert "water" not in eses.measure(text, waters=True).left_out
    atoms = eses.read_atoms(io.StringIO(text), format="pdb")
    assert pickle.loads(pickle.dumps(atoms)).left_out == atoms.left_out and atoms.left_out["water"] == 1


@pytest.mark.parametrize("suffix", ["xyzr", "pqr"])
def test_options_of_structures_are_refused_for_files_without(tmp_path, suffix):
    path = tmp_path / f"atom.{suffix}"
    path.write_text("0 0 0 1.5\n" if suffix == "xyzr" else "ATOM 1 C LIG 1 0 0 0 0 1.5\n")
    for options in ({"chain_names": "label"}, {"radii": "occupancy"}, {"chains": ["A"]}):
        for found in (path, path.read_text()):
            with pytest.raises(ValueError, match=f"needs a PDB or mmCIF file; .* is read as {suffix}"):
                eses.measure(found, format=suffix, **options)
    assert eses.measure(path, chain_names="auth").sas_area == pytest.approx(4 * np.pi * 2.9**2)


def test_selections_need_names_that_exist(tmp_path):
    """They would choose all atoms of PQR and xyzr files if the file were read again with them."""
    pqr, xyzr = tmp_path / "a.pqr", tmp_path / "a.xyzr"
    pqr.write_text("ATOM 1 C ALA A 1 0 0 0 0.5 1.7\nATOM 2 C ALA B 1 4 0 0 0.5 1.7\n")
    xyzr.write_text("0 0 0 1.7\n4 0 0 1.7\n")
    for found in (xyzr, xyzr.read_bytes()):
        for selection in ("A", "//A", "no such"):
            with pytest.raises(ValueError, match="report: the atoms have no names"):
                eses.measure(found, report=selection)
    whole = eses.measure(pqr).sas_area
    for found, options in ((pqr, {}), (pqr.read_text(), {"format": "pqr"})):
        assert eses.measure(found, report="A", **options).sas_area == pytest.approx(whole / 2)
        with pytest.raises(ValueError, match="report: no chain 'no such'"):
            eses.measure(found, report="no such", **options)
    assert eses.interface(pqr, "A", "B").sas_area > 0
    with pytest.raises(ValueError, match="no chain 'C'"):
        eses.interface(pqr, "A", "C")
    with pytest.raises(ValueError, match="the atoms have no names"):
        eses.interface(xyzr, "A", "B")


def test_notes_tell_of_models_and_assemblies(tmp_path):
    """Notes are those of the report of the program."""
    path = tmp_path / "one.pdb"
    path.write_text(PDB)
    models = tmp_path / "models.pdb"
    models.write_text("".join(f"MODEL     {number:4}\n{PDB.replace('END', 'ENDMDL')}" for number in (3, 4)) + "END\n")
    result = eses.measure(models)
    assert result.notes == ("model 3 was read, and the file has 2 models; choose another with model=, or models='all'",)
    assert "model 3 was read" in repr(result) and "model 3 was read" in result._repr_html_()
    assert pickle.loads(pickle.dumps(result)).notes == result.notes and eses.measure(path).notes == ()
    assert eses.measure(DATA.parent / "tests" / "data" / "1a8o.cif.gz").notes == (
        "assembly 1 has 2 copies; build it with assembly='1'",)


def test_polar_atoms_are_those_of_the_set(tmp_path):
    """Classes are those of FreeSASA's configuration files; objects, files and copies of atoms have the same."""
    path = tmp_path / "classes.pdb"
    path.write_text("".join(
        f"ATOM  {serial:5} {name:4} {residue} A{serial:4}    {9 * serial:8.3f}   0.000   0.000  1.00  0.00          {element:>2}\n"
        for serial, (name, residue, element) in enumerate(
            [(" C  ", "ALA", "C"), (" CA ", "ALA", "C"), (" SD ", "MET", "S"), (" CG ", "ASP", "C"), (" O  ", "ALA", "O")], 1)))
    mine = tmp_path / "mine.config"
    mine.write_text("types:\nCP 1.7 polar\nOA 1.5 apolar\natoms:\nANY CA CP\nANY O OA\n")
    for radii, expected in (("protor", [2, 4]), ("naccess", [4]), ("oons", [0, 2, 3, 4]), (mine, [1, 2])):
        for found in (eses.measure(path, radii), eses.measure(eses.read_atoms(path, radii=radii)),
                      eses.measure(pickle.loads(pickle.dumps(eses.read_atoms(path, radii=radii))))):
            assert np.flatnonzero(found.atoms["is_polar"]).tolist() == expected
            assert found.polar == pytest.approx(found.atoms["sas"][expected].sum())
    gemmi = pytest.importorskip("gemmi")
    assert eses.measure(gemmi.read_structure(str(path)), "oons").atoms["is_polar"].tolist() == [True, False, True, True, True]
