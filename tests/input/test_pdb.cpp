// Tests of PDB files: records, elements and names. The reference is the wwPDB's format.

#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "catch.hpp"
#include "support/structures.hpp"

namespace eses::detail::test {

TEST_CASE("PDB: coordinates may have the exponent letters of C and Fortran", "[structure]") {
  for (const std::string x : {"  1.5E+1", "  1.5D+1", " +15.000"}) {
    std::string text = line_of({});
    text.replace(30, x.size(), x);
    CHECK(read_pdb(text).atoms.at(0).center == Vec3{15, 0, 0});
  }
}

TEST_CASE("PDB: atoms have their labels and lines", "[structure]") {
  const std::string text =
      "REMARK nothing\n" + line_of({.number = "  52A", .x = 1.5}) + "TER\n" +
      line_of({.name = " O  ", .chain = "B", .number = "  -1 ", .z = -2, .element = " O"}) +
      "END\n";
  const AtomFile file = read_pdb(text);
  CHECK(names_of(file) == Names{"A ALA 52A CA", "B ALA -1 O"});
  CHECK(file.lines == std::vector<std::uint64_t>{2, 4});
  REQUIRE(file.atoms.size() == 2);
  CHECK(file.atoms[0].center == Vec3{1.5, 0, 0});
  CHECK(file.atoms[0].radius == 1.88);
  CHECK(file.atoms[1].radius == 1.42);
  REQUIRE(file.structure);
  CHECK(file.structure->radii == "protor");
  CHECK(file.structure->atom_records == 2);
}

TEST_CASE("PDB: line ends do not matter", "[structure]") {
  std::string text = "REMARK\n" + line_of({}) + line_of({.name = " CB ", .x = 2}), crlf;
  for (const char c : text) crlf += c == '\n' ? "\r\n" : std::string(1, c);
  const AtomFile file = read_pdb(text), other = read_pdb(crlf);
  CHECK(names_of(file) == names_of(other));
  CHECK(file.lines == other.lines);
  // Records may end after the coordinates.
  const AtomFile cut = read_pdb(line_of({}).substr(0, 54) + "\r\n");
  CHECK(cut.atoms.at(0).radius == 1.88);
}

TEST_CASE("PDB: atoms keep the order of the file", "[structure]") {
  // The second atom of residue 1 comes after residue 2.
  const std::string text =
      line_of({}) + line_of({.number = "   2 ", .x = 5}) + line_of({.name = " CB ", .x = 9});
  CHECK(read_pdb(text).lines == std::vector<std::uint64_t>{1, 2, 3});
}

TEST_CASE("PDB: damaged records are named", "[structure]") {
  const std::string good = line_of({});
  CHECK(pdb_error(good + good.substr(0, 40) + "\n") ==
        "t.pdb:2: the record ends before its coordinates; the file seems to be damaged");
  std::string bad = good;
  bad.replace(38, 8, "   abc  ");
  CHECK(pdb_error(good + bad) ==
        "t.pdb:2: expected a number for y in columns 39 to 46, found \"abc\"");
  bad.replace(38, 8, "     nan");
  CHECK(contains(pdb_error(bad), "expected a number for y"));
  bad.replace(38, 8, "        ");
  CHECK(contains(pdb_error(bad), "expected a number for y"));
  CHECK(pdb_error("") == "t.pdb: no ATOM or HETATM records found; 0 lines read");
  CHECK(pdb_error("REMARK\nEND\nMASTER\n") ==
        "t.pdb: no ATOM or HETATM records found; 3 lines read");
  CHECK(pdb_error(std::string("\0\1\2\xff", 4)) ==
        "t.pdb:1: the line has a NUL character; the file seems to be damaged");
  CHECK(pdb_error("MODEL        1\n" + good + "MODEL        1\n") ==
        "t.pdb:3: there are two models 1; give them different numbers");
  CHECK(pdb_error("MODEL        x\n" + good) ==
        "t.pdb:1: expected the number of the model, found \"x\"");
  CHECK(pdb_error(good.substr(0, 78) + "\r" + good) ==
        "t.pdb:1: carriage return inside the line; expected LF or CRLF line ends");
}

TEST_CASE("PDB: tabs in the columns of a record are refused", "[structure]") {
  const std::string good = line_of({.x = 1, .y = 2, .z = 3});
  const std::string advice =
      "; fields of PDB records have fixed columns; replace the tabs by blanks";
  // Without the refusal, these coordinates would be 0, 0 and 1.
  const std::string tabs = "ATOM\t1\tCA\tALA\tA\t1\t      11.000  12.000  13.000  1.00 20.00\n";
  StructureOptions options;
  options.unknown_radius = 1;
  CHECK(pdb_error(good + tabs, options) == "t.pdb:2: tab in column 5" + advice);
  std::string one = good;
  one.replace(54, 2, "\t ");
  CHECK(pdb_error(one) == "t.pdb:1: tab in column 55" + advice);
  std::string hetatm = line_of({.record = "HETATM"});
  hetatm[26] = '\t';
  CHECK(pdb_error(good + hetatm) == "t.pdb:2: tab in column 27" + advice);
  // In these places a tab does not shift any field.
  const std::string short_record = good.substr(0, 66);
  CHECK(
      read_pdb("REMARK\tmade by hand\n" + short_record + "\t\n" + good.substr(0, 78) + "  \tnote\n")
          .atoms.size() == 2);
}

TEST_CASE("PDB: atoms after an END record are refused", "[structure]") {
  // `cat receptor.pdb ligand.pdb` gives such a file.
  const std::string atom = line_of({}), other = line_of({.record = "HETATM", .x = 9});
  const std::string message =
      "t.pdb:2: atoms follow an END record; remove the record, or put each model between MODEL and "
      "ENDMDL, without END";
  CHECK(pdb_error(atom + "END\n" + atom) == message);
  CHECK(pdb_error(atom + "END   \r\nREMARK\n\n" + other) == message);
  CHECK(pdb_error(atom + "END\nMODEL        2\n" + atom + "ENDMDL\n") == message);
  CHECK(pdb_error(atom + "END\n" + atom.substr(0, 20)) == message);
  CHECK(read_pdb(atom + "END\nCONECT    1    2\n\n   \nEND\nMASTER\n").atoms.size() == 1);
  CHECK(pdb_error(atom + std::string("\0\n", 2) + atom) ==
        "t.pdb:2: the line has a NUL character; the file seems to be damaged");
  // gemmi would take the text behind a NUL in a long line for a line of its own.
  const std::string long_line = "REMARK" + std::string(200, 'x') + std::string("\0", 1) + "x\n";
  CHECK(pdb_error(long_line + atom) ==
        "t.pdb:1: the line has a NUL character; the file seems to be damaged");
  CHECK(read_pdb(atom + std::string("\0\0\n\0", 4)).atoms.size() == 1);
}

TEST_CASE("PDB: columns with another meaning in old files are ignored", "[structure]") {
  // Old files have the entry and the number of the line where newer ones have elements and charges.
  std::string old = line_of({}).substr(0, 66) + "      1HPV 168\n";
  CHECK(read_pdb(old).atoms.at(0).radius == 1.88);
  StructureOptions bondi;
  bondi.radii = "bondi";
  // These names do not begin in the column of their element.
  for (const auto& [name, element] : std::map<std::string, double>{
           {"CA  ", 1.70}, {"HG  ", 1.20}, {"NE  ", 1.55}, {"1HB ", 1.20}, {"OD1 ", 1.52}}) {
    std::string text = line_of({.name = name}).substr(0, 66) + "\n";
    INFO(name);
    CHECK(read_pdb(text, bondi).atoms.at(0).radius == element);
  }
  const std::string mercury =
      line_of({.record = "HETATM", .name = "HG  ", .residue = " HG"}).substr(0, 66) + "\n";
  CHECK(read_pdb(mercury, bondi).atoms.at(0).radius == 1.55);
}

namespace {

/// Returns the record of an atom without an element.
std::string without_element(const PdbAtom& atom) { return line_of(atom).substr(0, 66) + "\n"; }

/// Returns the element that the reader derives for an atom without one. Other atoms of the file
/// have the name columns `other_name`.
std::string derived_element(const std::string& name, const std::string& residue,
                            const std::string& other_name = " C1 ") {
  StructureOptions options;
  options.hydrogens = HydrogenChoice::keep;
  options.unknown_radius = 1;
  const std::string text =
      without_element({.record = "HETATM", .name = name, .residue = residue}) +
      without_element({.record = "HETATM", .name = other_name, .residue = "LIG", .x = 9});
  const AtomFile file = read_pdb(text, options);
  for (const auto& sources : {file.structure->by_element, file.structure->unknown})
    for (const auto& source : sources)
      if (source.residue != "LIG" || source.atom_name != "C1") return source.element;
  return "none";
}

}  // namespace

TEST_CASE("PDB: ions have the element of their name in any column", "[structure]") {
  const std::vector<std::tuple<std::string, std::string, std::string>> expected{
      {" Na+", "Na+", "Na"}, {" Cl-", "Cl-", "Cl"}, {" K+ ", " K+", "K"},  {" SOD", "SOD", "Na"},
      {" CLA", "CLA", "Cl"}, {"SOD ", "SOD", "Na"}, {" POT", "POT", "K"},  {" CAL", "CAL", "Ca"},
      {" CES", "CES", "Cs"}, {" LIT", "LIT", "Li"}, {" RUB", "RUB", "Rb"}, {" BAR", "BAR", "Ba"},
      {" CAD", "CAD", "Cd"}, {" CL ", " CL", "Cl"}, {" NA ", " NA", "Na"}, {" CA ", " CA", "Ca"},
      {" ZN ", " ZN", "Zn"}, {"MG  ", " MG", "Mg"}, {"CO  ", "3CO", "Co"}, {"FE  ", "FE2", "Fe"}};
  for (const auto& [name, residue, element] : expected) {
    INFO(name << ' ' << residue);
    CHECK(derived_element(name, residue) == element);
  }
}

TEST_CASE("PDB: metals and halogens of ligands are not the elements of their first letter",
          "[structure]") {
  // In a file with aligned names.
  CHECK(derived_element("HG  ", "MMC") == "Hg");
  CHECK(derived_element(" HG1", "MMC") == "H");
  CHECK(derived_element("HG11", "LIG") == "H");
  CHECK(derived_element("HO2 ", "LIG") == "H");
  CHECK(derived_element(" Cl1", "LIG") == "Cl");
  CHECK(derived_element(" Br1", "LIG") == "Br");
  CHECK(derived_element(" Ca1", "LIG") == "C");
  CHECK(derived_element(" Co ", "LIG") == "Co");
  CHECK(derived_element(" Zn1", "LIG") == "Zn");
  CHECK(derived_element(" FE ", "HEM") == "Fe");
  CHECK(derived_element("CU1 ", "CUA") == "Cu");
  // In a file whose names all begin in the first column.
  for (const std::string name : {"CLAA", "CL1 ", "BRAB", "FE  ", "CU1 ", "NI  ", "SI1 ", "PT1 "}) {
    INFO(name);
    std::string element = name.substr(0, 2);
    element[1] = static_cast<char>(element[1] - 'A' + 'a');
    CHECK(derived_element(name, "LIG", "C1  ") == element);
  }
  CHECK(derived_element("CA  ", "LIG", "C1  ") == "C");
  CHECK(derived_element("HG  ", "LIG", "C1  ") == "H");
  const std::string water = without_element({.record = "HETATM", .name = " O  ", .residue = "HOH"});
  StructureOptions keep;
  keep.with_waters = true;
  keep.radii = "bondi";
  const std::string carbon =
      without_element({.record = "HETATM", .name = "CA  ", .residue = "LIG", .x = 9});
  CHECK(read_pdb(carbon + water, keep).atoms.at(0).radius == 1.70);
  StructureOptions bondi;
  bondi.radii = "bondi";
  const std::string selenium = without_element({.name = " SE ", .residue = "MSE"});
  CHECK(read_pdb(selenium, bondi).atoms.at(0).radius == 1.90);
}

TEST_CASE("PDB: residue names may have four letters", "[structure]") {
  const auto names = [](const std::vector<std::string>& residues_and_chains,
                        const StructureOptions& options = {}) {
    std::string text;
    for (const std::string& columns : residues_and_chains) {
      std::string line = line_of({.x = static_cast<double>(text.size())});
      text += line.replace(17, 5, columns);
    }
    return names_of(read_pdb(text, options));
  };
  CHECK(names({"NALAA", "ALA A", "CARGA"}) == Names{"A NALA 1 CA", "A ALA 1 CA", "A CARG 1 CA"});
  CHECK(names({"POPCM", "ALA A"}) == Names{"M POPC 1 CA", "A ALA 1 CA"});
  CHECK(names({"NALA "}) == Names{" NALA 1 CA"});
  StructureOptions chain_a;
  chain_a.chains = {"A"};
  CHECK(names({"NALAA", "ALA A", "CARGA"}, chain_a).size() == 3);
  // Chain names may have two letters, too.
  CHECK(names({"ALAAB", "LIGAC"}) == Names{"AB ALA 1 CA", "AC LIG 1 CA"});
  CHECK(names({"NLEUA", "ALAUA"}) == Names{"UA NLE 1 CA", "UA ALA 1 CA"});
  CHECK(names({"  AAB", "PARAB"}) == Names{"AB A 1 CA", "AB PAR 1 CA"});
  CHECK(names({"NAGAB"}) == Names{"AB NAG 1 CA"});
  CHECK(names({"HISDA", "NALAA"}) == Names{"A HISD 1 CA", "A NALA 1 CA"});
  CHECK(names({"POPCA", "POPEA"}) == Names{"A POPC 1 CA", "A POPE 1 CA"});
  CHECK(names({"NLEUA", "ALA A"}) == Names{"A NLEU 1 CA", "A ALA 1 CA"});
  StructureOptions bondi;
  bondi.radii = "bondi";
  std::string arginine = without_element({.name = "CA  "});
  arginine.replace(17, 5, "NARGA");
  CHECK(read_pdb(arginine, bondi).atoms.at(0).radius == 1.70);
}

TEST_CASE("PDB: MODEL records may have any number and lack an end", "[structure]") {
  const auto text_of_models = [](const std::vector<std::string>& records) {
    std::string text;
    for (const std::string& record : records)
      text += record + "\n" + line_of({.x = static_cast<double>(text.size())});
    return text;
  };
  const std::string text =
      text_of_models({"MODEL      100", "MODEL      1000", "MODEL 7", "MODEL    10001"});
  for (const int number : {100, 1000, 7, 10001}) {
    INFO(number);
    StructureOptions options;
    options.model = number;
    const AtomFile file = read_pdb(text, options);
    CHECK(file.structure->models == 4);
    CHECK(file.structure->model == std::to_string(number));
    CHECK(file.atoms.size() == 1);
  }
  CHECK(read_pdb(text_of_models({"REMARK    5   5", "MODEL"})).structure->model == "1");
  CHECK(read_pdb(text_of_models({"MODEL1", "MODEL2"})).structure->models == 2);
}

TEST_CASE("PDB: many blank lines take linear time", "[structure]") {
  // In quadratic time this would take an hour.
  const std::string blank(1000000, '\n');
  CHECK(read_pdb(line_of({}) + blank + line_of({.x = 9})).atoms.size() == 2);
}

TEST_CASE("PDB: long lines count as one line", "[structure]") {
  std::string atom = without_element({});
  atom.insert(atom.size() - 1, 132 - atom.size(), ' ');
  CHECK(read_pdb(atom + atom).lines == std::vector<std::uint64_t>{1, 2});
}

TEST_CASE("PDB: atoms without an occupancy count as occupied", "[structure]") {
  StructureOptions options;
  options.select = ";q>0.5";
  CHECK(read_pdb(line_of({}).substr(0, 54) + "\n", options).atoms.size() == 1);
  std::string blank = line_of({});
  blank.replace(54, 6, "      ");
  CHECK(read_pdb(blank, options).atoms.size() == 1);
}

TEST_CASE("waters have the names of programs of molecular dynamics", "[structure]") {
  const auto atoms = [](const std::string& columns, const std::string& name,
                        const std::string& element) {
    std::string line = line_of({.name = name, .element = element});
    line.replace(17, 5, columns);
    return read_pdb(line + line_of({.number = "   2 ", .x = 9})).atoms.size();
  };
  for (const std::string columns :
       {"HOH A", "WAT A", "SOL A", "TIP3W", "TIP A", "SPC A", "OPC A"}) {
    INFO(columns);
    CHECK(atoms(columns, " OW ", " O") == 1);
  }
  const auto oxygen = [](char altloc) {
    return line_of(
        {.name = " OW ", .altloc = altloc, .residue = "SOL", .occupancy = 0.5, .element = " O"});
  };
  CHECK(read_pdb(line_of({.x = 9}) + oxygen('A') + oxygen('B')).atoms.size() == 1);
  // OPC is also the name of a lipid.
  CHECK(atoms("OPC A", " C1 ", " C") == 2);
}

TEST_CASE("PDB: amino acids in names of force fields have no metals", "[structure]") {
  StructureOptions bondi;
  bondi.radii = "bondi";
  const double carbon = 1.70, nitrogen = 1.55, oxygen = 1.52, sulfur = 1.80;
  const std::vector<std::tuple<std::string, std::string, double>> expected{
      {"HIE", "CA  ", carbon}, {"HIP", "CD2 ", carbon},   {"HID", "ND1 ", nitrogen},
      {"HSD", "CE1 ", carbon}, {"HSE", "NE2 ", nitrogen}, {"HSP", "CA  ", carbon},
      {"CYX", "CA  ", carbon}, {"CYM", "SG  ", sulfur},   {"ASH", "OD1 ", oxygen},
      {"GLH", "CD  ", carbon}, {"LYN", "CE  ", carbon},   {"NME", "CA  ", carbon},
      {"ACE", "CH3 ", carbon}, {"ARN", "NE  ", nitrogen}, {"DA5", "OP1 ", oxygen},
      {"ALA", "CA  ", carbon}};
  for (const auto& [residue, name, radius] : expected) {
    INFO(residue << " " << name);
    // The ion shows that the names of the file are not all misaligned.
    const std::string text =
        without_element({.name = name, .residue = residue}) +
        without_element({.record = "HETATM", .name = " O  ", .residue = "HOH", .x = 9});
    const AtomFile file = read_pdb(text, bondi);
    REQUIRE(file.atoms.size() == 1);
    CHECK(file.atoms[0].radius == radius);
  }
}

TEST_CASE("PDB: the names of ligands may be left-aligned", "[structure]") {
  StructureOptions bondi;
  bondi.radii = "bondi";
  const auto radius = [&](const std::string& name, const std::string& residue,
                          const std::string& other) {
    const std::string text =
        without_element({.record = "HETATM", .name = name, .residue = residue, .number = "   1 "}) +
        without_element({.record = "HETATM", .name = other, .residue = "LIG", .x = 5});
    return read_pdb(text, bondi).atoms.at(0).radius;
  };
  const double carbon = 1.70, nitrogen = 1.55, calcium = 2.31, sodium = 2.27, iron = 2.44;
  CHECK(radius("CA  ", "LIG", "N   ") == carbon);
  CHECK(radius("CAB ", "LIG", "N   ") == carbon);
  CHECK(radius("NA  ", "LIG", "N   ") == nitrogen);
  CHECK(radius("CL1 ", "LIG", "N   ") == 1.75);
  CHECK(radius("BR  ", "LIG", "N   ") == 1.83);
  CHECK(radius("FE  ", "HEM", "N   ") == iron);
  // Ions have the name of their residue.
  CHECK(radius("CA  ", " CA", "N   ") == calcium);
  CHECK(radius("NA  ", " NA", "N   ") == sodium);
  CHECK(radius("FE  ", "FE2", "N   ") == iron);
  // In a file with aligned names the column decides.
  CHECK(radius("CA  ", "LIG", " N  ") == calcium);
  CHECK(radius(" CA ", "LIG", " N  ") == carbon);
}

}  // namespace eses::detail::test
