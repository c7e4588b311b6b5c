"""Interfaces have the differences of the areas of their parts."""

import csv
import math

import numpy as np
import pytest

import eses_blocks as eses

RADIUS, PROBE, DISTANCE = 1.7, 1.4, 3.0
LOST = 2 * math.pi * (RADIUS + PROBE) * (RADIUS + PROBE - DISTANCE / 2)  # a cap of the SAS sphere
COMPLEX = "".join(
    f"ATOM  {serial:5} {name:4} {residue} {chain}{serial:4}    {x:8.3f}   0.000   0.000  0.00 {RADIUS:.2f}\n"
    for serial, name, residue, chain, x in ((1, " N", "ALA", "A", 0), (2, " C1", "HEM", "B", DISTANCE),
                                            (3, " CA", "GLY", "C", 50)))


@pytest.fixture(name="path")
def fixture_path(tmp_path):
    path = tmp_path / "dimer.pqr"
    path.write_text(COMPLEX)
    return path


def test_two_spheres_lose_a_cap_each():
    found = eses.interface(([[0, 0, 0], [DISTANCE, 0, 0]], [RADIUS] * 2), [0])
    assert found.sas_lost == pytest.approx((LOST, LOST))
    assert found.sas_area == pytest.approx(LOST)
    assert found.atoms["index"].tolist() == [0, 1] and found.atoms["side"].tolist() == [0, 1]


def test_chains_that_touch(path):
    found = eses.interfaces(path)
    assert [(each.first, each.second) for each in found] == [("A", "B")]
    assert found[0].polar == pytest.approx(LOST / 2) and found[0].apolar == pytest.approx(LOST / 2)
    assert found.table["sas_area"] == pytest.approx([LOST])
    assert found[0].residues["residue"].tolist() == ["ALA", "HEM"]
    assert repr(found) == f"<eses_blocks.Interfaces: 1; SAS interface areas: A and B {LOST:.6g}>"
    assert "dimer" not in repr(found) and "A and B" in repr(found[0])
    assert len(found[:0]) == 0


@pytest.mark.parametrize("parts", [("A", "ligand:HEM"), ("ligand:HEM", "A")])
def test_chains_are_without_the_ligands_of_the_other_part(path, parts):
    path.write_text(COMPLEX.replace("HEM B", "HEM A"))
    found = eses.interface(path, *parts)
    assert found.sas_lost == pytest.approx((LOST, LOST))
    assert sorted(found.residues["residue"]) == ["ALA", "HEM"]


def test_parts_that_do_not_touch_lose_nothing(path):
    found = eses.interface(path, "A+B", "C")
    assert found.sas_lost == found.ses_lost == (0, 0)
    assert len(found.residues) == len(found.atoms) == 0


def test_tables_without_interfaces_have_all_columns(path):
    found, without = eses.interfaces(path), eses.interfaces(path, area_cutoff=1e6)
    assert len(without) == len(without.table) == len(without.residues) == len(without.atoms) == 0
    for name in ("table", "residues", "atoms"):
        of_some, of_none = getattr(found, name), getattr(without, name)
        assert of_none.keys() == of_some.keys()
        assert [of_none[key].dtype.kind for key in of_none] == [of_some[key].dtype.kind for key in of_some]


def test_random_atoms_have_the_differences_of_areas():
    random = np.random.default_rng(49)
    centers, radii = random.uniform(0, 12, (90, 3)), random.uniform(1.2, 2, 90)
    first = np.arange(90) % 3 == 0
    found = eses.interface((centers, radii), first, ~first)
    together, one, other = (eses.measure((centers[mask], radii[mask])) for mask in (first | True, first, ~first))
    for name in ("sas", "ses"):
        area = name + "_area"
        lost = getattr(one, area) + getattr(other, area) - getattr(together, area)
        assert 2 * getattr(found, area) == pytest.approx(lost, rel=1e-10)
        assert found.atoms[name + "_lost"].sum() == pytest.approx(lost, rel=1e-10)


def test_saved_areas(path, tmp_path):
    found = eses.interface(path, "A", "B")
    found.save(tmp_path / "buried.pdb")
    lines = [line for line in (tmp_path / "buried.pdb").read_text().splitlines() if line.startswith(("ATOM", "HETATM"))]
    assert [float(line[60:66]) for line in lines] == pytest.approx([LOST, LOST, 0], abs=0.005)
    found.save(tmp_path / "buried.csv")
    rows = list(csv.DictReader((tmp_path / "buried.csv").open()))
    assert float(rows[1]["sas_lost"]) == pytest.approx(LOST)
    with pytest.raises(ValueError, match="suffix"):
        found.save(tmp_path / "buried.txt")
    with pytest.raises(ValueError, match="column"):
        found.save(tmp_path / "buried.pdb", "sas")


def test_cutoffs_and_tables_of_all_interfaces(path, tmp_path):
    """The areas of all interfaces add up by atom."""
    row = COMPLEX + "ATOM      4  CA  GLY D   4       3.000   3.000   0.000  0.00 1.70\n"
    path.write_text(row)
    found = eses.interfaces(path)
    assert len(found) == 3 and len(found.residues) == len(found.atoms) == 6
    assert set(zip(found.residues["first"], found.residues["second"])) == {("A", "B"), ("A", "D"), ("B", "D")}
    smallest = found[-1].sas_area
    assert len(eses.interfaces(path, area_cutoff=smallest)) == 3
    assert len(eses.interfaces(path, area_cutoff=smallest + 1e-6)) == 2
    assert len(eses.interfaces(path, residue_cutoff=smallest + 1e-6).residues) == 4
    assert len(eses.interface(path, "A", "B", residue_cutoff=LOST + 1).residues) == 0
    for call, name in ((eses.interfaces, "area_cutoff"), (eses.interfaces, "residue_cutoff"),
                       (lambda molecule, **cutoff: eses.interface(molecule, "A", **cutoff), "residue_cutoff")):
        for value in (-1, np.nan, np.inf):
            with pytest.raises(ValueError, match=f"^{name} must be finite and not negative, not {value}$"):
                call(path, **{name: value})
    found.save(tmp_path / "buried.pdb")
    lines = [line for line in (tmp_path / "buried.pdb").read_text().splitlines() if line.startswith(("ATOM", "HETATM"))]
    sums = np.zeros(4)
    np.add.at(sums, found.atoms["index"], found.atoms["sas_lost"])
    assert [float(line[60:66]) for line in lines] == pytest.approx(sums, abs=0.005)
    for level, table in (("interface", found.table), ("residue", found.residues), ("atom", found.atoms)):
        found.save(tmp_path / "buried.csv", level=level)
        rows = list(csv.DictReader((tmp_path / "buried.csv").open()))
        assert len(rows) == len(table) and list(rows[0]) == table.keys()
    with pytest.raises(ValueError, match="level must be one of interface, residue, atom"):
        found.save(tmp_path / "buried.csv", level="chain")
    with pytest.raises(ValueError, match="there are no interfaces"):
        eses.interfaces(([[0, 0, 0]], [1]))[:0].__class__([]).save(tmp_path / "none.pdb")
    assert found[0].molecule.set.name == "file"


def test_models_of_a_file(path):
    """Each model is measured by itself: those that are farther apart bury less."""
    path.write_text("".join(f"MODEL     {number:4}\n{COMPLEX.replace(f'{DISTANCE:8.3f}', f'{distance:8.3f}')}ENDMDL\n"
                            for number, distance in ((2, 3.5), (4, DISTANCE), (9, 20))))
    alone = [eses.interfaces(path, model=number) for number in (2, 4, 9)]
    found = eses.interfaces(path, models="all", area_cutoff=1)
    assert [len(each) for each in found] == [1, 1, 0]
    assert [each.table["sas_area"].tolist() for each in found] == [each.table["sas_area"].tolist() for each in alone]
    assert found[1][0].sas_area == pytest.approx(LOST) and found[0][0].sas_area < LOST - 1
    pairs = eses.interface(path, "A", "B", models=[9, 4])
    assert [each.sas_area for each in pairs] == [0, found[1][0].sas_area]
    for measure in (lambda **options: eses.interfaces(path, **options), lambda **options: eses.interface(path, "A", **options)):
        with pytest.raises(TypeError, match="model or models"):
            measure(models="all", model=2)
        with pytest.raises(ValueError, match="in model 3"):
            measure(models=[3])


def test_errors_name_the_part(path):
    with pytest.raises(ValueError, match="1 atoms belong to both parts"):
        eses.interface(path, "A+B", "B")
    with pytest.raises(ValueError, match="first: no atoms are selected"):
        eses.interface(path, [])
    with pytest.raises(ValueError, match="no names of chains and residues"):
        eses.interface(([[0, 0, 0]], [1]), "X")


def test_a_ligand_is_a_side(path):
    found = eses.interface(path, "ligand:HEM", "A")
    assert found.sas_lost == pytest.approx((LOST, LOST)) and found.first == "ligand:HEM"
    assert found.residues["residue"].tolist() == ["ALA", "HEM"]
    with pytest.raises(ValueError, match="no atoms of residue STI; the residues are HEM, ALA, GLY"):
        eses.interface(path, "A", "ligand:STI")
