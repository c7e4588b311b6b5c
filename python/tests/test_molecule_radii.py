"""Radii and locations of the atoms of molecules."""

import copy
import io
import warnings

import numpy as np
import pytest

import eses_blocks as eses
from conftest import DATA, PDB
from eses_blocks._references import REFERENCES

pytestmark = pytest.mark.usefixtures("needs_gemmi")


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
