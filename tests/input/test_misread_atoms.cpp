// Tests of files that programs of the field write and that are easily misread: coarse-grained
// models, elements in wrong columns, segments, nanometres, and PQR files with other columns.

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "catch.hpp"
#include "eses/radii.hpp"
#include "eses/surface.hpp"
#include "input/radii_tables.hpp"
#include "input/text_fields.hpp"
#include "support/structures.hpp"

namespace eses::detail::test {
namespace {

/// Returns the text of records without elements, such as ` BB  ALA A   1 `, 10 angstrom apart.
std::string records_of(const std::vector<std::string>& names, const std::string& record = "ATOM") {
  std::string text;
  double x = 0;
  for (const std::string& name : names)
    text += fmt::format("{:<6}{:>5} {}   {:8.3f}{:8.3f}{:8.3f}{:6.2f}{:6.2f}\n", record, 1, name,
                        x += 10, 0., 0., 1., 0.);
  return text;
}

/// Returns the number of atoms with a diagnostic.
std::uint64_t count_of(DiagnosticKind kind, const std::vector<Diagnostic>& diagnostics) {
  for (const Diagnostic& diagnostic : diagnostics)
    if (diagnostic.kind == kind) return diagnostic.count;
  return 0;
}

AtomFile read_pqr(const std::string& text) { return parse_atoms(text, AtomFormat::pqr, "t.pqr"); }

std::string pqr_error(const std::string& text) {
  return error_of([&] { read_pqr(text); });
}

}  // namespace

TEST_CASE("coarse-grained amino acids and nucleotides give a warning", "[structure][cli]") {
  const auto foreign = [](const std::vector<std::string>& names) {
    return count_of(DiagnosticKind::foreign_residue, read_bondi(records_of(names)).diagnostics);
  };
  CHECK(foreign({" BB  ALA A   1 ", " BB  TRP A   2 ", " SC1 TRP A   2 "}) == 2);
  CHECK(foreign({" CA  ALA A   1 ", " CB  ALA A   1 ", " CEN ALA A   1 "}) == 1);
  CHECK(foreign({" CB  LYS A   1 ", " CG  LYS A   1 "}) == 1);
  CHECK(foreign({" BB1  DA A   1 ", " SC1  DA A   1 "}) == 1);
  // Names of force fields, old files, and ends of chains are right. Ligands have any names.
  CHECK(foreign({" N   HSD A   1 ", " CA  HSD A   1 ", " ND1 HSD A   1 ", " OT1 HSD A   1 "}) == 0);
  CHECK(foreign({" N   ILE A   1 ", " CD  ILE A   1 ", " OXT ILE A   1 ", " HA  ILE A   1 "}) == 0);
  CHECK(foreign({" P    DA A   1 ", " O1P  DA A   1 ", " C1*  DA A   1 ", " N9   DA A   1 "}) == 0);
  CHECK(foreign({" CA  NHIEA   1 ", " CB  NHIEA   1 ", " SC1 LIG A   2 "}) == 0);
  CHECK(foreign({" CA  ALA A   1 ", " CA  GLY A   2 "}) == 0);
  // A selection of side chains has lost its backbone by the user's wish.
  StructureOptions select;
  select.select = "CG[C]";
  const std::string whole = records_of({" N   LYS A   1 ", " CB  LYS A   1 ", " CG  LYS A   1 "});
  CHECK(count_of(DiagnosticKind::foreign_residue, read_pdb(whole, select).diagnostics) == 0);

  const Sandbox sandbox;
  write_file(sandbox.directory() / "cg.pdb",
             records_of({" BB  ALA A   1 ", " BB  LYS A   2 ", " SC1 LYS A   2 "}));
  write_file(sandbox.directory() / "beads.cfg",
             "types:\nB 2.6 apolar\natoms:\nANY BB B\nANY SC1 B\n");
  const Outcome strict = sandbox.run({"cg.pdb", "--radii", "bondi", "--write", "none", "--strict"});
  CHECK(strict.code == 1);
  CHECK(contains(strict.err,
                 "cg.pdb: 2 residues are no amino acids, nucleotides or water of their names: they "
                 "have other atoms or no backbone, as in coarse-grained models; their elements and "
                 "radii are guesses: lines 1, A/ALA 1/BB; 2, A/LYS 2/BB\n"));
  // Radii for the beads are no guesses.
  CHECK(sandbox.run({"cg.pdb", "--radii", "beads.cfg", "--write", "none"}).err.empty());
}

TEST_CASE("ions are alone in their residues", "[structure]") {
  CHECK(elements_of(read_bondi(records_of({" NA+ ION     1 ", " CL- ION     2 ", " CA+ ION     3 ",
                                           " MG+ ION     4 "}))) == Names{"Na", "Cl", "Ca", "Mg"});
  CHECK(elements_of(read_bondi(records_of({" NA  SOD     1 ", " CL  CLA     2 ", " CA  CAL     3 ",
                                           " K   POT     4 "}))) == Names{"Na", "Cl", "Ca", "K"});
  CHECK(elements_of(read_bondi(records_of({" CL- LIG     1 ", " NA+ LIG     2 "}))) ==
        Names{"Cl", "Na"});
  // Programs that derive elements from names write these ones.
  std::string text;
  for (const auto& [name, residue, element] :
       std::vector<std::tuple<std::string, std::string, std::string>>{{" ZN ", " ZN", " N"},
                                                                      {" POT", "POT", " P"},
                                                                      {" CLA", "CLA", " C"},
                                                                      {" CA ", " CA", " C"},
                                                                      {" CA ", "ALA", " C"}})
    text += line_of({.name = name,
                     .residue = residue,
                     .number = fmt::format("{:4} ", text.size() / 81),
                     .x = static_cast<double>(text.size()),
                     .element = element});
  CHECK(elements_of(read_bondi(text)) == Names{"Zn", "K", "Cl", "Ca", "C"});
  // Several atoms of a residue are none.
  CHECK(elements_of(read_bondi(records_of({" CA  CAL     1 ", " CB  CAL     1 "}))) ==
        Names{"C", "C"});
}

TEST_CASE("halogens, silicon and selenium of ligands", "[structure][cli]") {
  const std::string ligand = records_of({" C1  IND     1 ", " CL  IND     1 ", " CL1 IND     1 ",
                                         " BR1 IND     1 ", " BR  IND     1 ", " SI1 IND     1 ",
                                         " SE1 IND     1 ", " CLA IND     1 ", "CL12 IND     1 "});
  CHECK(elements_of(read_bondi(ligand)) ==
        Names{"C", "Cl", "Cl", "Br", "Br", "Si", "Se", "C", "Cl"});
  // The element column wins.
  CHECK(elements_of(read_bondi(line_of({.name = " CL1", .residue = "LIG"}))) == Names{"C"});

  const Sandbox sandbox;
  write_file(sandbox.directory() / "ligand.pdb", ligand);
  CHECK(
      contains(sandbox.run({"ligand.pdb", "--dry-run"}).out,
               "\nelements: 9 atoms by name, not by the file (IND C1: C, IND CL: Cl, IND CL1: Cl, "
               "IND BR1: Br, IND BR: Br, IND SI1: Si, IND SE1: Se, IND CLA: C, ...); --json lists "
               "all\n"));
  check_json(sandbox, sandbox.run({"ligand.pdb", "--dry-run", "--json"}).out,
             "[s['element'] for s in r['structure']['elements_by_name']][:3]", "['C', 'Cl', 'Cl']");
  write_file(sandbox.directory() / "whole.pdb", line_of({}));
  CHECK_FALSE(contains(sandbox.run({"whole.pdb", "--dry-run"}).out, "elements:"));
}

TEST_CASE("elements beside their columns are read", "[structure]") {
  const auto element = [](const std::string& name, const std::string& end) {
    std::string line = line_of({.name = name, .residue = "LIG"}).substr(0, 66);
    line.resize(80 - end.size(), ' ');
    return read_bondi(line + end + "\n").labels.at(0).element;
  };
  CHECK(element(" C1 ", "C ") == "C");      // column 79
  CHECK(element("Cl1 ", "Cl ") == "Cl");    // columns 78 and 79
  CHECK(element(" CL3", "Cl") == "Cl");     // columns 79 and 80
  CHECK(element(" BR1", "BR   ") == "Br");  // columns 76 and 77
  CHECK(element(" N1 ", " N1+") == "N");
  CHECK(element("CL1 ", "CL1-") == "Cl");
  CHECK(element(" C1 ", " C  ") == "C");
  // Such a letter in column 76 is no segment, which would be a residue of its own.
  const std::string record = line_of({.name = "BR1 ", .residue = "LIG"}).substr(0, 66);
  const std::string carbon = line_of({.name = " C1 ", .residue = "LIG", .x = 3}).substr(0, 66);
  const AtomFile shifted = read_bondi(record + "         BR\n" + carbon + "          C\n");
  CHECK(names_of(shifted) == Names{"A LIG 1 BR1", "A LIG 1 C1"});
  // The first letter of an element, two columns too far to the right.
  CHECK(element(" CL1", "          C") == "Cl");
  CHECK(element(" BR2", "          B") == "Br");
  CHECK(element(" C1 ", "          C") == "C");
  // The name says nothing.
  CHECK(element(" X1 ", "Cl ") == "Cl");
  CHECK(element(" L1 ", "CL ") == "Cl");
  CHECK(element(" C1 ", "Cl ") == "Cl");
  CHECK(element(" X1 ", "BR   ") == "Br");
  CHECK(element(" X1 ", "C ") == "C");
  // Types of atoms, of AutoDock and Amber, are no elements.
  CHECK(element(" N1 ", "NA ") == "N");
  CHECK(element(" C1 ", "CA ") == "C");
  // Segments and line numbers are no elements.
  CHECK(element(" C1 ", "PROA    ") == "C");
  CHECK(element(" C1 ", "1HPV 168") == "C");
}

TEST_CASE("elements in the columns of segments are elements", "[structure]") {
  for (const std::size_t column : {72U, 73U, 74U}) {
    INFO(column);
    const auto record = [column](const std::string& name, double x, const std::string& element) {
      std::string line = line_of({.name = name, .residue = "LIG", .x = x}).substr(0, 66);
      line.resize(column, ' ');
      return line + element + "\n";
    };
    const AtomFile file = read_bondi(record(" C1 ", 0, "C") + record("CL1 ", 3, "CL") +
                                     record(" N1 ", 6, "N") + record(" C2 ", 9, "C"));
    CHECK(elements_of(file) == Names{"C", "Cl", "N", "C"});
    CHECK(names_of(file) == Names{"A LIG 1 C1", "A LIG 1 CL1", "A LIG 1 N1", "A LIG 1 C2"});
    // A segment has the same name for atoms of all elements.
    CHECK(read_bondi(record(" C1 ", 0, "C") + record(" N1 ", 3, "C")).labels.at(1).element == "N");
  }
  std::string blank = line_of({.name = " C1 ", .chain = " "}).substr(0, 66) + "      C\n";
  CHECK(names_of(read_bondi(blank)) == Names{"C ALA 1 C1"});
}

TEST_CASE("beads of water are neither tungsten nor atoms", "[structure][cli]") {
  const std::string beads =
      records_of({" W   W       1 ", "W    W       2 ", " WF  WF      3 ", " W   PW      4 ",
                  " WP  PW      4 ", " WM  PW      4 ", " SW  SW      5 ", " TW  TW      6 "});
  StructureOptions waters;
  waters.with_waters = true;
  waters.radii = "bondi";
  const AtomFile file = read_pdb(beads, waters);
  CHECK(elements_of(file) == Names(8, "O"));
  CHECK(count_of(DiagnosticKind::foreign_residue, file.diagnostics) == 6);
  // They are left out as other waters. The element column of a file decides.
  CHECK(contains(pdb_error(beads), "left out: 8 of water (--waters keeps them)"));
  const AtomFile metal = read_bondi(line_of({.name = " W  ", .residue = "W", .element = " W"}));
  CHECK(elements_of(metal) == Names{"W"});
  CHECK(metal.diagnostics.empty());
  const Sandbox sandbox;
  write_file(sandbox.directory() / "w.pdb", beads);
  const Outcome strict = sandbox.run({"w.pdb", "--waters", "--write", "none", "--strict"});
  CHECK(strict.code == 1);
  CHECK(
      contains(strict.err, "w.pdb: 6 residues are no amino acids, nucleotides or water of their"));
}

TEST_CASE("ions of Amber and SIRAH, and ions in small letters and with signs", "[structure]") {
  const AtomFile file = read_bondi(
      records_of({"NA   Na+    1 ", " CA  Ca+2   2 ", "C0   C0     3 ", " NaW NaW    4 ",
                  " ClW ClW    5 ", " CaX CaX    6 ", " NA   NA+   7 ", "ZN   ZN2+   8 "}));
  CHECK(elements_of(file) == Names{"Na", "Ca", "Ca", "Na", "Cl", "Ca", "Na", "Zn"});
  CHECK(file.labels[6].residue == "NA+");
  CHECK(file.labels[7].residue == "ZN2+");
  CHECK(file.labels[7].chain.empty());
  // Water of SIRAH is no tungsten.
  CHECK(contains(pdb_error(records_of({" WN1 WT4 A   1 ", " WP1 WT4 A   1 "})),
                 "left out: 2 of water (--waters keeps them)"));
}

TEST_CASE("records in small letters have the elements of those in capitals", "[structure]") {
  const std::vector<std::string> names{" N   ALA A   1 ", " CA  ALA A   1 ", " CL1 LIG A   2 ",
                                       "CA    CA A   3 ", " OG  SER a   4 "};
  const AtomFile file = read_bondi(lower_case(records_of(names)));
  CHECK(elements_of(file) == elements_of(read_bondi(records_of(names))));
  CHECK(elements_of(file) == Names{"N", "C", "Cl", "Ca", "O"});
  CHECK(file.structure->guessed_elements.size() == 2);
  CHECK(
      read_pdb(lower_case(records_of({" N   ALA A   1 ", " CB  ALA A   1 "}))).diagnostics.empty());
}

TEST_CASE("amino acids of GROMACS with four letters, and thymidine of old files", "[structure]") {
  const AtomFile file =
      read_pdb(records_of({" CB  LYSHA   1 ", " CG  LYSHA   1 ", " CA  ALA A   2 "}));
  CHECK(count_of(DiagnosticKind::foreign_residue, file.diagnostics) == 1);
  CHECK(file.structure->guessed_elements.empty());
  const auto radius_of = [](const std::string& name) {
    return read_pdb(records_of({name})).atoms.at(0).radius;
  };
  CHECK(radius_of(" O1P   T A   1 ") == radius_of(" OP1  DT A   1 "));
}

TEST_CASE("coordinates in their columns that are no numbers", "[structure]") {
  for (const std::string text : {"     nan", "********", "   0,000"}) {
    std::string line = line_of({.x = 1, .y = 2, .z = 3});
    CHECK(pdb_error(line.replace(30, 8, text)) ==
          fmt::format("t.pdb:1: expected a number for x in columns 31 to 38, found \"{}\"",
                      text.substr(text.find_first_not_of(' '))));
  }
}

TEST_CASE("dummy atoms of ligands are no deuterium", "[structure]") {
  CHECK(contains(pdb_error(records_of({" C1  LIG     1 ", " DU  LIG     1 ", " DU2 LIG     1 "})),
                 "2 atoms are without a radius in the set protor: LIG DU, LIG DU2"));
  StructureOptions known;
  known.unknown_radius = 1;
  CHECK(read_pdb(records_of({" C1  LIG     1 ", " DU  LIG     1 "}), known).atoms.size() == 2);
  CHECK(read_pdb(records_of({" C1  LIG     1 ", " D1  LIG     1 "})).atoms.size() == 1);
  const std::string deuterium = line_of({.name = " DU ", .residue = "LIG", .element = " D"});
  CHECK(read_pdb(line_of({}) + deuterium).atoms.size() == 1);
}

TEST_CASE("names that CHARMM shares with other molecules", "[structure]") {
  const auto radii_of = [](const std::vector<std::string>& names) {
    const AtomFile file = read_pdb(records_of(names));
    CHECK(file.diagnostics.empty());
    std::vector<double> radii;
    for (const Atom& atom : file.atoms) radii.push_back(atom.radius);
    return radii;
  };
  // CG of homoserine is aliphatic, and has the radius of its element.
  const double carbon = *freesasa_element_radius("C");
  CHECK(radii_of({" N   HSE A   1 ", " CG  HSE A   1 ", " OD  HSE A   1 "}).at(1) == carbon);
  CHECK(radii_of({" N   HSE A   1 ", " CG  HSE A   1 ", " ND1 HSE A   1 "}).at(1) == 1.61);
  // Nucleotides of CHARMM; GUA is also glutaric acid.
  CHECK(radii_of({" O1P GUA A   1 ", " C1' GUA A   1 ", " C4  GUA A   1 ", " N9  GUA A   1 "}) ==
        radii_of({" OP1   G A   1 ", " C1'   G A   1 ", " C4    G A   1 ", " N9    G A   1 "}));
  CHECK(radii_of({" C1' THY A   1 ", " C5M THY A   1 "}) ==
        radii_of({" C1'  DT A   1 ", " C7   DT A   1 "}));
  CHECK(radii_of({" C1  GUA A   1 ", " C4  GUA A   1 "}) == std::vector{carbon, carbon});
  // A selection does not make another molecule of a residue.
  StructureOptions select;
  select.select = "[C]";
  const AtomFile ring =
      read_pdb(records_of({" N   HSE A   1 ", " CG  HSE A   1 ", " ND1 HSE A   1 "}), select);
  REQUIRE(ring.atoms.size() == 1);
  CHECK(ring.atoms[0].radius == 1.61);

  const std::vector<AtomLabel> labels{{"A", "HSE", "1", "CG", "C"},
                                      {"A", "HSE", "1", "ND1", "N"},
                                      {"A", "HSE", "2", "CG", "C"},
                                      {"A", "HSE", "2", "OD", "O"}};
  const NamedRadii found = find_radii(labels, "protor");
  CHECK(found.atoms[0].radius == 1.61);
  CHECK(found.atoms[2].radius == carbon);
}

TEST_CASE("radii in place of occupancies are all known", "[structure]") {
  StructureOptions options;
  options.radii = "occupancy";
  options.unknown_radius = 1.5;
  CHECK_THROWS_WITH(read_pdb(line_of({.occupancy = 1.7}), options),
                    "the radii 'occupancy' are known for all atoms; omit the unknown radius");
}

TEST_CASE("PDBQT files of other names are recognised", "[structure][cli]") {
  const std::string atom = line_of({.name = " OG ", .residue = "SER"}).substr(0, 66);
  const std::string text = "REMARK  ligand\nROOT\n" + atom + "    -0.398 OA\n" +
                           line_of({.x = 9}).substr(0, 66) + "     0.126 NA\nENDROOT\nTORSDOF 0\n";
  CHECK(pdb_error(text) ==
        "t.pdb: AutoDock PDBQT files are not read; convert it with `obabel -ipdbqt t.pdb -O "
        "t.converted.pdb`, or read it with --format pdb");
  const Sandbox sandbox;
  write_file(sandbox.directory() / "q.pdb", text);
  CHECK(sandbox.run({"q.pdb", "--dry-run"}).code == 1);
  // The user knows better. NA is the type of an acceptor and not sodium.
  const Outcome forced = sandbox.run({"q.pdb", "--format", "pdb", "--radii", "bondi", "--dry-run"});
  CHECK(forced.code == 0);
  CHECK(contains(forced.out, "2 atoms"));
  CHECK_FALSE(contains(forced.out, "Na"));
}

TEST_CASE("coordinates in nanometres give one warning", "[cli]") {
  std::string text;
  for (int i = 0; i < 12; ++i) text += fmt::format("{} {} 0 1.7\n", 0.15 * i, 0.1 * (i % 2));
  const Sandbox sandbox;
  write_file(sandbox.directory() / "nm.xyzr", text);
  for (const std::string command : {"surface", "measure"}) {
    Arguments arguments{"nm.xyzr"};
    if (command == "measure")
      arguments.insert(arguments.begin(), command);
    else
      arguments.insert(arguments.end(), {"--write", "none"});
    const Outcome outcome = sandbox.run(arguments);
    INFO(command);
    CHECK(outcome.code == 0);
    CHECK(contains(outcome.err,
                   "nm.xyzr: 12 atoms are within 0.45 angstrom of their nearest "
                   "neighbours, but their radii are in angstrom; coordinates look "
                   "like nanometres; multiply them by 10: lines 1, 2, 3, 4, 5 and "
                   "7 more\n"));
    CHECK(std::count(outcome.err.begin(), outcome.err.end(), '\n') == 1);
  }
  // A trace of C-alpha atoms has longer steps than bonds.
  std::vector<Atom> trace;
  for (int i = 0; i < 9; ++i) trace.push_back({{0.38 * i, 0.1 * (i % 2), 0}, 1.9});
  const Surface of_trace(trace, SurfaceOptions{});
  REQUIRE(of_trace.diagnostics().size() == 1);
  CHECK(of_trace.diagnostics()[0].kind == DiagnosticKind::nanometre_coordinates);
  // Two of five atoms that are close are another warning.
  const Surface few({{{0, 0, 0}, 1.7},
                     {{0.2, 0, 0}, 1.7},
                     {{9, 0, 0}, 1.7},
                     {{18, 0, 0}, 1.7},
                     {{27, 0, 0}, 1.7}},
                    SurfaceOptions{});
  REQUIRE(few.diagnostics().size() == 1);
  CHECK(few.diagnostics()[0].kind == DiagnosticKind::close);
}

TEST_CASE("PQR: residue names and chains run together as in PDB files", "[structure][pqr]") {
  const auto name = [](const std::string& columns) {
    return names_of(read_pqr("ATOM      1  N   " + columns +
                             "   1.000   2.000   3.000  0.16  1.62           N\n"))
        .at(0);
  };
  CHECK(name("MET A   1    ") == "A MET 1 N");
  CHECK(name("POPEE 474    ") == "E POPE 474 N");
  CHECK(name("POPE0 522    ") == "0 POPE 522 N");
  CHECK(name("POPE  532    ") == " POPE 532 N");
  CHECK(name("ALAAB   1    ") == "AB ALA 1 N");
  // A name of four letters may begin in column 19, where chains have no name.
  CHECK(name(" NALA 192    ") == " NALA 192 N");
  // Numbers may run together in other columns than those of PDB files.
  const AtomFile joined = read_pqr(
      "ATOM      1  N    NALA   192     -51.730-160.850  81.990   0.141   1.550\n"
      "ATOM      3  HB1  NALA  1192     -52.140-159.700  78.880   0.030   1.20\n");
  CHECK(names_of(joined) == Names{" NALA 192 N", " NALA 1192 HB1"});
  CHECK(joined.atoms.at(1).center == Vec3{-52.14, -159.7, 78.88});
  const std::string shifted =
      "ATOM      1  N    NALA 192       1.000   2.000   3.000  1.00  0.00\n";
  CHECK(names_of(read_pdb(shifted)) == Names{" NALA 192 N"});
}

TEST_CASE("mmCIF: residues without numbers are residues each", "[structure]") {
  const std::string head =
      "data_x\nloop_\n_atom_site.group_PDB\n_atom_site.type_symbol\n_atom_site.label_atom_id\n"
      "_atom_site.label_alt_id\n_atom_site.label_comp_id\n_atom_site.label_asym_id\n"
      "_atom_site.label_seq_id\n_atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\n"
      "_atom_site.occupancy\n";
  const auto row = [](int x, const std::string& names, double occupancy) {
    return fmt::format("{} {} 0 0 {}\n", names, x, occupancy);
  };
  const AtomFile file =
      read_mmcif(head + row(10, "ATOM C CA . ALA A 7", 1) + row(20, "HETATM ZN ZN . ZN B .", 1) +
                 row(30, "HETATM ZN ZN . ZN B .", 1) + row(40, "HETATM C C1 A LIG C .", 0.4) +
                 row(50, "HETATM C C1 B LIG C .", 0.6) + row(60, "HETATM C C1 A LIG C .", 0.6) +
                 row(70, "HETATM C C1 B LIG C .", 0.4) + row(80, "HETATM C C1 . LIG C .", 1) +
                 row(90, "HETATM C C2 . LIG C .", 1));
  CHECK(names_of(file) == Names{"A ALA 7 CA", "B ZN 8 ZN", "B ZN 9 ZN", "C LIG 10 C1",
                                "C LIG 11 C1", "C LIG 12 C1", "C LIG 12 C2"});
  REQUIRE(file.atoms.size() == 7);
  CHECK(file.atoms[3].center.x == 50);
  CHECK(file.atoms[4].center.x == 60);
}

TEST_CASE("mmCIF: atoms without an element have that of their name", "[structure]") {
  const std::string text =
      "data_x\nloop_\n_atom_site.type_symbol\n_atom_site.label_atom_id\n_atom_site.label_comp_id\n"
      "_atom_site.label_asym_id\n_atom_site.auth_seq_id\n_atom_site.Cartn_x\n_atom_site.Cartn_y\n"
      "_atom_site.Cartn_z\n"
      "? N ALA A 52 1 2 3\n. CA ALA A 52 2.4 2 3\n? CL1 LIG B 1 9 0 0\n. ZN ZN C 1 19 0 0\n";
  CHECK(elements_of(read_mmcif(text)) == Names{"N", "C", "Cl", "Zn"});
  // Names tell the unknown elements of amino acids, but not those of ligands.
  const std::string head = text.substr(0, text.find("? N ALA"));
  CHECK(elements_of(read_mmcif(head + "X SE MSE A 52 1 2 3\n")) == Names{"Se"});
  CHECK_THROWS_AS(read_mmcif(head + "X C1 LIG A 52 1 2 3\n"), Error);
}

TEST_CASE("PDB: segments are chains where chains are blank or the same", "[structure][cli]") {
  const auto record = [](double x, const std::string& name, char chain, int number,
                         const std::string& segment) {
    std::string line = line_of({.name = name,
                                .chain = std::string(1, chain),
                                .number = fmt::format("{:4} ", number),
                                .x = x});
    line.replace(72, 4, segment);
    return line;
  };
  const std::string blank = record(10, " N  ", ' ', 1, "A   ") +
                            record(20, " CA ", ' ', 1, "A   ") +
                            record(30, " N  ", ' ', 1, "B   ") + record(40, " CA ", ' ', 1, "B   ");
  CHECK(names_of(read_pdb(blank)) == Names{"A ALA 1 N", "A ALA 1 CA", "B ALA 1 N", "B ALA 1 CA"});
  StructureOptions chain_b;
  chain_b.chains = {"B"};
  CHECK(read_pdb(blank, chain_b).atoms.size() == 2);
  CHECK(
      names_of(read_pdb(record(50, " N  ", 'P', 1, "PROA") + record(60, " N  ", 'P', 1, "PROB"))) ==
      Names{"PROA ALA 1 N", "PROB ALA 1 N"});
  // One segment in a chain adds nothing. Old files have entry and line number there.
  CHECK(names_of(read_pdb(record(70, " N  ", 'A', 1, "PROA") +
                          record(80, " N  ", 'B', 1, "PROB"))) == Names{"A ALA 1 N", "B ALA 1 N"});
  std::string old = line_of({.chain = " "});
  old.replace(72, 8, "1CRN  70");
  CHECK(names_of(read_pdb(old)) == Names{" ALA 1 CA"});

  const Sandbox sandbox;
  write_file(sandbox.directory() / "s.pdb", blank);
  CHECK(contains(sandbox.run({"s.pdb", "--dry-run"}).out,
                 "\nnote: chains are named by the segments in columns 73 to 76: A, B\n"));
  const Outcome parts = sandbox.run({"measure", "s.pdb", "--parts", "chains"});
  CHECK(parts.code == 0);
}

TEST_CASE("PQR: charges of 1 and 0 with radii are no PDB file", "[structure][pqr][cli]") {
  const auto record = [](double charge, double radius, double x = 0) {
    return fmt::format("ATOM      1  I   ION     1    {:8.3f}{:8.3f}{:8.3f}{:6.2f}{:6.2f}\n", x, 0.,
                       0., charge, radius);
  };
  CHECK(read_pqr(record(1, 3)).atoms.at(0).radius == 3);
  CHECK(read_pqr(record(1, 1.15) + record(1, 1.49, 9)).atoms.size() == 2);
  const std::string refusal = "this is a PDB file";
  CHECK(contains(pqr_error(record(1, 20.5) + record(1, 31, 9)), refusal));
  CHECK(contains(pqr_error(record(1, 0) + record(1, 0, 9)), refusal));
  // `gmx editconf -mead` names the columns.
  CHECK(read_pqr("REMARK    The B-factors in this file hold atomic radii\n"
                 "REMARK    The occupancy in this file hold atomic charges\n" +
                 record(1, 4.5))
            .atoms.size() == 1);
  // The user's choice always wins, also over the header of a PDB file.
  const Sandbox sandbox;
  write_file(sandbox.directory() / "b.pqr", "HEADER    x\n" + record(1, 20.5));
  CHECK(sandbox.run({"b.pqr", "--dry-run"}).code == 1);
  CHECK(sandbox.run({"b.pqr", "--dry-run", "--format", "pqr"}).code == 0);
  CHECK(sandbox.run({"measure", "b.pqr", "--format", "pqr"}).code == 0);
  write_file(sandbox.directory() / "b.pdb", record(-0.5, 1.7) + record(-0.5, 1.7, 9));
  CHECK(sandbox.run({"b.pdb", "--dry-run", "--radii", "bondi"}).code == 1);
  CHECK(sandbox.run({"b.pdb", "--dry-run", "--radii", "bondi", "--format", "pdb"}).code == 0);
}

TEST_CASE("PDB: dummy atoms at 9999 are left out", "[structure][cli]") {
  const PdbAtom dummy{.name = " CB ", .x = 9999, .y = 9999, .z = 9999, .occupancy = 0};
  const std::string text = line_of({}) + line_of({.name = " N  ", .x = 1.5}) + line_of(dummy);
  CHECK(names_of(read_pdb(text)) == Names{"A ALA 1 CA", "A ALA 1 N"});
  PdbAtom occupied = dummy;
  occupied.occupancy = 1;
  CHECK(read_pdb(line_of({}) + line_of(occupied)).atoms.size() == 2);
  CHECK(contains(pdb_error(line_of(dummy)), "1 dummies of occupancy 0 at 9999"));
  const Sandbox sandbox;
  write_file(sandbox.directory() / "d.pdb", text);
  CHECK(contains(sandbox.run({"d.pdb", "--dry-run"}).out,
                 "left out: 1 dummy atom of occupancy 0 at 9999\n"));
}

TEST_CASE("PQR: swapped columns are named", "[structure][pqr]") {
  const auto record = [](double first, double second) {
    return fmt::format("ATOM      1  N   ALA     1       1.000   2.000   3.000{:8.4f}{:8.4f}\n",
                       first, second);
  };
  CHECK(pqr_error("REMARK  atom radii in columns 55-62\nREMARK  atom charges in columns 63-70\n" +
                  record(1.55, 0.141)) ==
        "t.pqr:2: the remarks name the column of the radius before that of the charge; PQR files "
        "have x y z charge radius; swap the columns");
  CHECK(contains(pqr_error(record(1.5, -0.572)),
                 "must not be negative, found \"-0.5720\"; charge and radius seem to be swapped; "
                 "write the charge before the radius"));
  CHECK(read_pqr("REMARK  charges in columns 55-62\nREMARK  radii in columns 63-70\n" +
                 record(-0.5, 1.5))
            .atoms.size() == 1);
}

TEST_CASE("PQR: text behind the radius is called text", "[structure][pqr]") {
  CHECK(pqr_error("ATOM      1  N   MET     1      27.340  24.430   2.614 -0.3000 1.8500      "
                  "PROA\n") ==
        "t.pqr:1: text \"PROA\" after the radius, expected x y z charge radius at the end; remove "
        "the text");
  const std::string record = "ATOM 1 N MET 1 27.340 24.430 2.614 -0.3000 1.8500  ";
  for (const std::string text :
       {"N PROA", "N C", "N1+ water", "PROA N  ", "chain 2", "HB 1.5 to 27"})
    CHECK(contains(pqr_error(record + text + "\n"),
                   "t.pqr:1: text \"" + text.substr(0, text.find("  ")) + "\" after the radius"));
  CHECK(contains(pqr_error("ATOM 1 N MET 1 27.340 24.430 2.614 -0.3000 x PROA\n"), "a number"));
}

TEST_CASE("PDB: why fields are not in their columns", "[structure]") {
  const std::string record = "ATOM      1  N   MET A   1      27.340  24.430   2.614  1.00  9.67\n";
  std::string wide = record;
  wide.replace(6, 5, "100000");
  CHECK(contains(pdb_error(wide),
                 "found \"0  24.43\"; the serial number is too wide and shifts the columns; "
                 "renumber the atoms"));
  for (const std::string text : {"ATOM 1 N MET A 1 27.340 24.430 2.614 1.00 9.67\n",
                                 "ATOM 1 N MET A 1 27.34012345 24.43012345 2.61412345 1.00 9.67\n"})
    CHECK(contains(pdb_error(text),
                   "; its fields are separated by blanks, but PDB records have fixed columns"));
  CHECK(contains(pdb_error(record.substr(0, 50) + "\n"),
                 "the record ends before its coordinates; the file seems to be damaged"));
}

TEST_CASE("UNK is also the name of ligands", "[structure]") {
  for (const std::string record : {"ATOM", "HETATM"}) {
    const AtomFile file = read_bondi(records_of({" C1  UNK     1 ", " CL2 UNK     1 "}, record));
    CHECK(file.diagnostics.empty());
    CHECK(elements_of(file) == Names{"C", "Cl"});
  }
}

TEST_CASE("names in small letters have radii by name", "[structure]") {
  const AtomFile file = read_pdb(records_of({" ca  ala A   1 ", " n   ala A   1 "}));
  REQUIRE(file.structure);
  CHECK(file.structure->by_element.empty());
  CHECK(file.atoms[0].radius == read_pdb(records_of({" CA  ALA A   1 "})).atoms[0].radius);
}

TEST_CASE("records of unknown names with coordinates give a warning", "[structure][pqr][cli]") {
  const std::string good =
      "ATOM      2  CA  ALA A   1       2.400   2.000   3.000  0.0960  1.7000\n";
  std::string bad = good;
  bad.replace(0, 4, "ATAM");
  const Sandbox sandbox;
  write_file(sandbox.directory() / "a.pqr", "REMARK x\n" + bad + good + "CONECT    1    2\n");
  write_file(sandbox.directory() / "a.pdb",
             line_of({.record = "HETATM", .residue = "LIG", .x = 9}) + "ATAM" +
                 line_of({}).substr(4) + "SIGATM" + line_of({}).substr(6));
  const std::string message =
      ": 1 line has coordinates, but its record name is neither ATOM nor HETATM; it is not read: "
      "line 2\n";
  for (const std::string file : {"a.pqr", "a.pdb"}) {
    INFO(file);
    CHECK(sandbox.run({file, "--write", "none"}).err == "eses-blocks: warning: " + file + message);
    CHECK(sandbox.run({"measure", file}).err == "eses-blocks: warning: " + file + message);
    CHECK(sandbox.run({file, "--write", "none", "--strict"}).code == 1);
  }
  write_file(sandbox.directory() / "b.pdb",
             "HETATX" + line_of({}).substr(6) + "HETERO" + line_of({}).substr(6) + "ATOMS " +
                 line_of({}).substr(6) + "atom  " + line_of({.x = 9}).substr(6) + "HETAT100000" +
                 line_of({.x = 19}).substr(11));
  CHECK(contains(sandbox.run({"b.pdb", "--write", "none"}).err,
                 "3 lines have coordinates, but their record names are neither ATOM nor HETATM; "
                 "they are not read: lines 1, 2, 3\n"));
  check_json(sandbox, sandbox.run({"a.pqr", "--dry-run", "--json"}).out,
             "r['diagnostics'][0]['first'][0]['line'], r['diagnostics'][0]['first'][0]['atom']",
             "(2, None)");
}

}  // namespace eses::detail::test
