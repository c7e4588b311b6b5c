"""Tables, reports and files of the areas of molecules."""

import csv
import pickle

import numpy as np
import pytest

import eses_blocks as eses
from conftest import PDB
from eses_blocks._references import REFERENCES

pytestmark = pytest.mark.usefixtures("needs_gemmi")


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
