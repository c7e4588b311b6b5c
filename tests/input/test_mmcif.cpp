// Tests of mmCIF files. The reference is the wwPDB's format.

#include <fmt/ranges.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include "catch.hpp"
#include "support/structures.hpp"
#include "support/temporary_directory.hpp"

namespace eses::detail::test {

TEST_CASE("mmCIF: atoms have their labels and lines", "[structure]") {
  const std::string text = mmcif_head +
                           "ATOM 1 C CA . ALA A 1 1 ? 1.5 0 0 1.0 20 52 X 1\n"
                           "ATOM 2 O O . ALA A 1 1\n? 0 0 2 1.0 20 52 X 1\n"
                           "HETATM 3 ZN ZN . ZN B 2 . A 5 5 5 1.0 20 900 X 1\n#\n";
  const AtomFile file = read_mmcif(text);
  CHECK(names_of(file) == Names{"X ALA 52 CA", "X ALA 52 O", "X ZN 900A ZN"});
  // The head has 20 lines; the second atom takes two.
  CHECK(file.lines == std::vector<std::uint64_t>{21, 22, 24});
  CHECK(file.atoms.at(2).radius == 1.39);
  std::string crlf;
  for (const char c : text) crlf += c == '\n' ? "\r\n" : std::string(1, c);
  CHECK(names_of(read_mmcif(crlf)) == names_of(file));
  CHECK(read_mmcif(crlf).lines == file.lines);
}

TEST_CASE("mmCIF: damaged files are refused", "[structure]") {
  const auto error = [](const std::string& text) { return error_of([&] { read_mmcif(text); }); };
  const std::string row = "ATOM 1 C CA . ALA A 1 1 ? 1.5 0 0 1.0 20 52 X 1\n";
  CHECK(contains(error(mmcif_head + row + "ATOM 2 C\n"),
                 "t.cif:2: wrong number of values in the loop"));
  CHECK(contains(error(mmcif_head + row + "'unterminated\n"), "t.cif:22: unterminated"));
  CHECK(contains(error(mmcif_head + "ATOM 1 C CA . ALA A 1 1 ? 1e7 0 0 1.0 20 52 X 1\n"),
                 "t.cif:21: expected coordinates of at most 1000000 angstrom"));
  CHECK(error("data_x\n_cell.length_a 3\n") ==
        "t.cif: no atoms found; the file has no _atom_site table");
  const std::string whole = text_of(crystal);
  for (const double part : {0.1, 0.5, 0.7}) {
    const auto length = static_cast<std::size_t>(part * static_cast<double>(whole.size()));
    CHECK_FALSE(error(whole.substr(0, length)).empty());
  }
}

TEST_CASE("mmCIF: the likely cause of a syntax error is in the message", "[structure]") {
  const auto error = [](const std::string& text) { return error_of([&] { read_mmcif(text); }); };
  const std::string row = "ATOM 1 C CA . ALA A 1 1 ? 1.5 0 0 1.0 20 52 X 1\n";
  const std::string advice =
      "; quote values that begin with _, # or $, or with the reserved words data_, loop_, global_, "
      "save_ or stop_";
  CHECK(error("data_x\n_struct.title data_of_x\n") == "t.cif:2: unexpected \"data_of_x\"" + advice);
  CHECK(error("data_x\n_struct.title A structure\n") ==
        "t.cif:2: unexpected \"structure\"" + advice);
  // The residue name $A ends the table.
  CHECK(error(mmcif_head + row + "ATOM 2 C CA . $A A 1 1 ? 1.5 0 0 1.0 20 52 X 1\n") ==
        "t.cif:22: unexpected \"$A\"" + advice);
  const std::string characters = "; quote values with characters other than printable ASCII";
  CHECK(error("data_x\n_struct.title caf\xc3\xa9\n") ==
        "t.cif:2: unexpected character \"\\xc3\"" + characters);
  CHECK(error(mmcif_head + row + "ATOM 2 C C\xe9 . ALA A 1 1 ? 1.5 0 0 1.0 20 52 X 1\n") ==
        "t.cif:22: unexpected character \"\\xe9\"" + characters);
  CHECK(error("data_x\n_struct.title") == "t.cif:2: unexpected end of the file");
  CHECK(read_mmcif(mmcif_head + row + "_struct.title 'data_of_caf\xc3\xa9'\n").atoms.size() == 1);
}

TEST_CASE("faults of tables and records that are not used do not matter", "[structure]") {
  const std::string row = "ATOM 1 C CA . ALA A 1 1 ? 1.5 0 0 1.0 20 52 X 1\n";
  const std::vector<std::string> unused_tables{
      "_entity_poly_seq.entity_id 1\n_entity_poly_seq.num x\n",
      "_refine.pdbx_refine_id X\n_refine.ls_number_reflns_obs 99999999999\n",
      "_refine.details\n",
      "_refine.details x\n_refine.details y\n",
      "loop_\n_refine.a\n_refine.b\n1 2 3\n",
      "_pdbx_struct_oper_list.id\n",
      "save_x\n_refine.details\nsave_\nsave_x\n_refine.details\nsave_\n",
      "data_y\n_entity.id 1\n_entity.id\n_atom_site_fract_x 1\n",
      "data_y\ndata_Y\n"};
  const std::string atoms = mmcif_head + row;
  for (const std::string& unused : unused_tables) {
    INFO(unused);
    CHECK(read_mmcif(atoms + unused).lines == std::vector<std::uint64_t>{21});
    CHECK(read_mmcif(fmt::format("data_z\n{}{}", unused, atoms)).atoms.size() == 1);
  }
  // A save frame may define the tags of atoms.
  const std::string frame = mmcif_head.substr(mmcif_head.find('\n') + 1);
  CHECK(read_mmcif("data_z\nsave_x\n" + frame + row + "save_\n" + frame + row).lines ==
        std::vector<std::uint64_t>{43});
  CHECK(read_pdb("ANISOU    1  CA  ALA A   1     1000   1000   1000      0      0      0\n" +
                 line_of({}) + "REMARK   3\nSHEET\n")
            .atoms.size() == 1);
}

TEST_CASE("mmCIF: data blocks and tags must not be ambiguous", "[structure]") {
  const auto error = [](const std::string& text) { return error_of([&] { read_mmcif(text); }); };
  const std::string row = "ATOM 1 C CA . ALA A 1 1 ? 1.5 0 0 1.0 20 52 X 1\n";
  const std::string other = "data_OTHER" + mmcif_head.substr(mmcif_head.find('\n'));
  CHECK(error(mmcif_head + row + other + row) ==
        "t.cif:23: the data blocks \"TEST\" and \"OTHER\" both have atoms; keep one of them");
  CHECK(error(mmcif_head + row + "data_test\n_cell.length_a 3\n") ==
        "t.cif: there are two data blocks \"test\"; remove or rename one of them");
  CHECK(error(mmcif_head + row + "_entity.id 1\n_entity.id 2\n") ==
        "t.cif:23: duplicate tag _entity.id");
  CHECK(error("data_x\nloop_\n_atom_site.id\n_Atom_site.ID\n1 1\n") ==
        "t.cif:2: duplicate tag _Atom_site.ID");
  CHECK(error(mmcif_head + row + "_entity.id\n") == "t.cif:22: _entity.id has no value");
  CHECK(error(mmcif_head + row + "loop_\n_entity.id\n_entity.type\n1 polymer 2\n") ==
        "t.cif:22: wrong number of values in the loop");
  CHECK(error(mmcif_head + row + "_atom_site.details x\n") ==
        "t.cif:2: the _atom_site table is in several parts; join them");
  StructureOptions options;
  options.assembly = "1";
  CHECK(error_of([&] { read_mmcif(mmcif_head + row + "_pdbx_struct_oper_list.id\n", options); }) ==
        "t.cif:22: _pdbx_struct_oper_list.id has no value");
  // Restraints may come before or after the atoms.
  const std::string restraints = "data_restraints\n_cell.length_a 3\n";
  CHECK(read_mmcif(mmcif_head + row + restraints).lines == std::vector<std::uint64_t>{21});
  CHECK(read_mmcif(restraints + mmcif_head + row).lines == std::vector<std::uint64_t>{23});
}

TEST_CASE("mmCIF: files without atoms are refused by their content", "[structure]") {
  const auto error = [](const std::string& text) { return error_of([&] { read_mmcif(text); }); };
  for (const std::string text : {"", "\n", " \t\r\n\n", "# a comment\n"}) {
    INFO(text);
    CHECK(error(text) == "t.cif: no atoms found; the file has no data block");
  }
  CHECK(error("data_x\n") == "t.cif: no atoms found; the file has no _atom_site table");
  CHECK(error("data_x\nloop_\n_atom_site_label\n_atom_site_fract_x\nC1 0.5\n") ==
        "t.cif: no atoms found; the coordinates are fractional (_atom_site_fract_x), as in CIF "
        "files of small molecules; convert it with `obabel t.cif -O t.pdb`");
  CHECK(error("data_ALA\n_chem_comp.id ALA\nloop_\n_chem_comp_atom.comp_id\n"
              "_chem_comp_atom.atom_id\nALA N\n") ==
        "t.cif: no atoms found; this is the definition of a chemical component "
        "(_chem_comp_atom); convert it with `gemmi convert t.cif t.pdb`");
  const TemporaryDirectory directory;
  const fs::path path = directory.path() / "empty.cif";
  std::ofstream(path) << "";
  REQUIRE(std::system(fmt::format("gzip '{}'", path.string()).c_str()) == 0);
  const std::string packed = path.string() + ".gz";
  CHECK(error_of([&] { read_structure(packed); }) ==
        packed + ": no atoms found; the file has no data block");
}

namespace {

/// Returns a table of atoms with these columns and rows.
std::string atom_table(const std::vector<std::string>& columns, const std::string& rows) {
  std::string text = "data_TEST\nloop_\n";
  for (const std::string& column : columns) text += "_atom_site." + column + "\n";
  return text + rows;
}

}  // namespace

TEST_CASE("mmCIF: numbers outside the range of integers are refused or not used", "[structure]") {
  const auto error = [](const std::string& text) { return error_of([&] { read_mmcif(text); }); };
  const std::string row = "ATOM 1 C CA . ALA A 1 1 ? 1.5 0 0 1.0 20 52 X 1\n";
  const auto with = [&](const std::string& old, const std::string& number) {
    std::string changed = row;
    changed.replace(changed.find(old) + 1, old.size() - 2, number);
    return mmcif_head + row + changed;
  };
  const auto message = [](const std::string& column) {
    return "t.cif:22: expected an integer of at most 9 digits for the residue number in "
           "_atom_site." +
           column + ", found \"99999999999\"";
  };
  CHECK(error(with(" 52 ", "99999999999")) == message("auth_seq_id"));
  CHECK(error(with(" 1 ? ", "99999999999 ?")) == message("label_seq_id"));
  CHECK(read_mmcif(with(" 52 ", "999999999")).atoms.size() == 2);
  const std::vector<std::string> columns{
      "type_symbol", "label_atom_id", "label_comp_id",      "auth_seq_id",       "Cartn_x",
      "Cartn_y",     "Cartn_z",       "pdbx_formal_charge", "pdbx_tls_group_id", "ccp4_hd_mixture"};
  const std::string rows = "H H ALA 7 1 2 3 99999999999 99999999999 0.5\n";
  StructureOptions options;
  options.hydrogens = HydrogenChoice::keep;
  CHECK(read_mmcif(atom_table(columns, rows), options).atoms.size() == 1);
}

TEST_CASE("mmCIF: values of the authors that are unknown are those of the label", "[structure]") {
  const std::vector<std::string> columns{"type_symbol",   "auth_atom_id",  "label_atom_id",
                                         "auth_comp_id",  "label_comp_id", "auth_asym_id",
                                         "label_asym_id", "auth_seq_id",   "label_seq_id",
                                         "Cartn_x",       "Cartn_y",       "Cartn_z"};
  CHECK(names_of(read_mmcif(atom_table(columns,
                                       "C ? CA ? ALA ? A ? 5 0 0 0\nC . CB . ALA . A . 5 2 0 0\n"
                                       "N N1 N LYS ALA B A 7 6 9 0 0\n"))) ==
        Names{"A ALA 5 CA", "A ALA 5 CB", "B LYS 7 N1"});
}

TEST_CASE("mmCIF: without a column of elements they follow from the names", "[structure]") {
  const AtomFile file = read_mmcif(
      atom_table({"label_atom_id", "label_comp_id", "auth_seq_id", "Cartn_x", "Cartn_y", "Cartn_z"},
                 "CA ALA 1 0 0 0\nCA CA 2 9 0 0\n"));
  REQUIRE(file.labels.size() == 2);
  CHECK(file.labels[0].element == "C");
  CHECK(file.labels[1].element == "Ca");
}

TEST_CASE("mmCIF: invalid values are refused with their line and column", "[structure]") {
  const auto row_with = [](std::size_t column, const std::string& value) {
    std::vector<std::string> values{"ATOM", "1", "C", "CA", ".",   "ALA", "A",  "1", "1",
                                    "?",    "1", "2", "3",  "1.0", "20",  "52", "X", "1"};
    values[column] = value;
    return fmt::format("{}\n", fmt::join(values, " "));
  };
  struct Fault {
    std::size_t column;
    std::string name, value, expected;
  };
  const std::string number = "an integer of at most 9 digits for the residue number";
  for (const Fault& fault :
       std::vector<Fault>{{10, "Cartn_x", "abc", "a number for x"},
                          {11, "Cartn_y", "?", "a number for y"},
                          {12, "Cartn_z", ".", "a number for z"},
                          {12, "Cartn_z", "1.5x", "a number for z"},
                          {12, "Cartn_z", "nan", "a number for z"},
                          {12, "Cartn_z", "inf", "a number for z"},
                          {12, "Cartn_z", "''", "a number for z"},
                          {13, "occupancy", "full", "a number for the occupancy"},
                          {14, "B_iso_or_equiv", "high", "a number for the B-factor"},
                          {15, "auth_seq_id", "1.5", number},
                          {15, "auth_seq_id", "A", number},
                          {15, "auth_seq_id", "15AB", number},
                          {15, "auth_seq_id", "1234567890", number},
                          {15, "auth_seq_id", "+-5", number},
                          {8, "label_seq_id", "15A", number},
                          {4, "label_alt_id", "AB", "one character for the alternate location"},
                          {9, "pdbx_PDB_ins_code", "AB", "one character for the insertion code"}}) {
    INFO(fault.name << ' ' << fault.value);
    const std::string rows = row_with(0, "ATOM") + row_with(fault.column, fault.value);
    CHECK(error_of([&] { read_mmcif(mmcif_head + rows); }) ==
          fmt::format("t.cif:22: expected {} in _atom_site.{}, found \"{}\"", fault.expected,
                      fault.name, fault.value));
  }
  // The two insertion codes of a row must be equal.
  std::string row = row_with(15, "15A");
  CHECK(names_of(read_mmcif(mmcif_head + row)) == Names{"X ALA 15A CA"});
  row.replace(row.find('?'), 1, "A");
  CHECK(names_of(read_mmcif(mmcif_head + row)) == Names{"X ALA 15A CA"});
  row.replace(row.find("A 1 2"), 1, "B");
  CHECK(error_of([&] { read_mmcif(mmcif_head + row); }) ==
        "t.cif:21: expected the insertion code B in _atom_site.auth_seq_id, found \"15A\"");
}

TEST_CASE("mmCIF: values may be quoted, and some may be unknown", "[structure]") {
  const AtomFile quoted = read_mmcif(mmcif_head +
                                     "'ATOM' '1' 'C' 'CA' . 'ALA' 'A' '1' '1' ? '1.5' \"-2\" "
                                     "'+3.25(4)' '1.0' '20' '-52' 'X' '1'\n"
                                     "ATOM 2 O \"O5'\" . ALA A 1 1 ? 0 0 9 1.0 20 -52 X 1\n");
  CHECK(names_of(quoted) == Names{"X ALA -52 CA", "X ALA -52 O5'"});
  CHECK(quoted.atoms.at(0).center == Vec3{1.5, -2, 3.25});
  CHECK(quoted.structure->models == 1);
  const std::string unknown = mmcif_head + "ATOM 1 C CA ? ALA A ? ? ? 1 2 3 ? ? ? ? ?\n";
  CHECK(names_of(read_mmcif(unknown)) == Names{"A ALA 1 CA"});
  CHECK(read_mmcif(unknown).structure->model == "1");
  StructureOptions options;
  options.select = ";q=1;b=0";
  CHECK(read_mmcif(unknown, options).atoms.size() == 1);
  options.select = ";b<30";
  CHECK(read_mmcif(mmcif_head + "ATOM 1 C CA ? ALA A ? ? ? 1 2 3 1 20 7 A 1\n"
                                "ATOM 1 C CA ? ALA A ? ? ? 1 2 9 1 40 8 A 1\n",
                   options)
            .lines == std::vector<std::uint64_t>{21});
}

TEST_CASE("mmCIF: the rows of a residue may be anywhere in its chain", "[structure]") {
  // Each residue has one atom with two alternate locations, in rows that are far from each other.
  // Only one residue with both locations gives one atom.
  constexpr int residues = 5000;
  std::string rows;
  Names expected;
  for (const std::string altloc : {"A", "B"})
    for (int i = 0; i < residues; ++i) {
      const int k = altloc == "A" ? i * 3719 % residues : residues - 1 - i;
      const std::string name = k % 4 < 2 ? "ALA" : "GLY", code = k % 2 == 0 ? "?" : "X";
      rows += fmt::format("ATOM 1 C CA {} {} A 1 1 {} {} {} 0 {} 20 {} A 1\n", altloc, name, code,
                          10 * k, altloc == "A" ? 0 : 1, altloc == "A" ? 0.4 : 0.6, k / 4);
      if (altloc == "B")
        expected.push_back(fmt::format("A {} {}{} CA", name, k / 4, k % 2 == 0 ? "" : "X"));
    }
  const AtomFile file = read_mmcif(mmcif_head + rows);
  CHECK(names_of(file) == expected);
  CHECK(file.structure->dropped_altlocs == residues);
  for (std::size_t i = 0; i < file.lines.size(); ++i) CHECK(file.lines[i] == 21 + residues + i);
}

TEST_CASE("mmCIF: the rows of a model may be anywhere in the table", "[structure]") {
  std::string rows;
  for (int i = 0; i < 6; ++i)
    rows += fmt::format("ATOM 1 C CA . ALA A 1 1 ? {} 0 0 1 20 {} A {}\n", 10 * i, i, 3 - i % 3);
  const AtomFile first = read_mmcif(mmcif_head + rows);
  CHECK(first.structure->model == "3");
  CHECK(first.structure->models == 3);
  CHECK(first.lines == std::vector<std::uint64_t>{21, 24});
  StructureOptions options;
  options.model = 1;
  CHECK(read_mmcif(mmcif_head + rows, options).lines == std::vector<std::uint64_t>{23, 26});
}

TEST_CASE("mmCIF: entities give the kinds of residues", "[structure]") {
  // The kinds contradict the rules for chains without entities, by which several residues are a
  // polymer and a single one is not.
  const std::string atoms = mmcif_head +
                            "ATOM 1 C CA . ALA A 1 1 ? 0 0 0 1 20 1 X 1\n"
                            "HETATM 2 C C1 . LIG B 2 . ? 9 0 0 1 20 2 X 1\n"
                            "HETATM 3 C C1 . LIG B 2 . ? 9 9 0 1 20 3 X 1\n";
  const std::string entities = "loop_\n_entity.id\n_entity.type\n1 polymer\n2 non-polymer\n";
  const std::string subchains = "loop_\n_struct_asym.id\n_struct_asym.entity_id\n";
  StructureOptions options;
  options.select = ";polymer";
  CHECK(names_of(read_mmcif(atoms + entities, options)) == Names{"X ALA 1 CA"});
  CHECK(names_of(read_mmcif(atoms + entities + subchains + "A 1\nB 2\n", options)) ==
        Names{"X ALA 1 CA"});
  CHECK(names_of(read_mmcif(atoms + entities + subchains + "A 2\nB 1\n", options)) ==
        Names{"X LIG 2 C1", "X LIG 3 C1"});
}

TEST_CASE("mmCIF: without group_PDB the residue name tells HETATM records", "[structure]") {
  const std::vector<std::string> columns{"type_symbol", "label_atom_id", "label_comp_id",
                                         "auth_seq_id", "Cartn_x",       "Cartn_y",
                                         "Cartn_z",     "auth_asym_id",  "group_PDB"};
  std::vector<std::string> without_group = columns;
  without_group.back() = "details";
  std::string rows;
  int number = 0;
  for (const std::string name : {"ALA", "MSE", "DA", "U", "HEM", "ZN", "HOH"}) {
    rows += fmt::format("C CA {} {} {} 0 0 A ?\n", name, number, 10 * number);
    ++number;
  }
  StructureOptions options;
  options.with_hetatm = false;
  options.unknown_radius = 1;
  for (const std::vector<std::string>& names : {columns, without_group}) {
    const AtomFile file = read_mmcif(atom_table(names, rows), options);
    CHECK(names_of(file) == Names{"A ALA 0 CA", "A DA 2 CA", "A U 3 CA"});
    CHECK(file.structure->dropped_hetatm == 3);
    CHECK(file.structure->dropped_waters == 1);
  }
  std::string known = rows;
  for (std::size_t at = 0; (at = known.find('?')) != std::string::npos;)
    known.replace(at, 1, "ATOM");
  CHECK(read_mmcif(atom_table(columns, known), options).structure->atom_records == 6);
}

TEST_CASE("molecules with the same name and number are not alternatives", "[structure]") {
  // Numbers begin again after 9999.
  const std::string first = line_of({.record = "HETATM", .residue = "LIG"});
  const std::string second =
      line_of({.record = "HETATM", .altloc = 'A', .residue = "LIG", .x = 9, .occupancy = 0.6}) +
      line_of({.record = "HETATM", .altloc = 'B', .residue = "LIG", .x = 9.5, .occupancy = 0.4});
  const AtomFile file =
      read_pdb(first + first.substr(0, 30) + "       5" + first.substr(38) + second);
  REQUIRE(file.atoms.size() == 3);
  CHECK(file.atoms[2].center.x == 9);
  std::string waters;
  for (int i = 0; i < 3; ++i)
    waters += line_of(
        {.name = " OW ", .residue = "SOL", .x = static_cast<double>(20 + 5 * i), .element = " O"});
  CHECK(read_pdb(first + waters).atoms.size() == 1);
  // Numbers begin again in an mmCIF file, too.
  const std::vector<std::string> columns{"type_symbol", "label_atom_id", "label_comp_id",
                                         "auth_seq_id", "label_alt_id",  "Cartn_x",
                                         "Cartn_y",     "Cartn_z"};
  CHECK(read_mmcif(atom_table(columns,
                              "C C1 LIG 1 . 0 0 0\nC C1 LIG 1 . 5 0 0\nC C1 LIG 1 A 9 0 0\n"
                              "C C1 LIG 1 B 9.5 0 0\nO OW SOL 2 . 20 0 0\nO OW SOL 2 . 25 0 0\n"))
            .atoms.size() == 3);
}

TEST_CASE("a polymer may have several parts", "[structure]") {
  StructureOptions options;
  options.select = ";polymer";
  const std::string part = line_of({}), next = line_of({.number = "   9 ", .x = 9});
  const std::string ligand = line_of({.record = "HETATM", .residue = "LIG", .x = 20});
  CHECK(read_pdb(part + "TER\n" + next + "TER\n" + ligand, options).atoms.size() == 2);
  // In mmCIF the entity of a residue decides.
  const std::vector<std::string> columns{"type_symbol", "label_atom_id",   "label_comp_id",
                                         "auth_seq_id", "label_entity_id", "label_asym_id",
                                         "Cartn_x",     "Cartn_y",         "Cartn_z"};
  CHECK(read_mmcif(atom_table(columns,
                              "C CA ALA 1 1 A 0 0 0\nC CA ALA 2 1 A 4 0 0\nC C1 LIG 3 2 A 9 0 0\n"
                              "loop_\n_entity.id\n_entity.type\n1 polymer\n2 non-polymer\n"),
                   options)
            .atoms.size() == 2);
}

TEST_CASE("mmCIF: chains have the names of the authors or those of the PDB", "[structure]") {
  const std::string text = mmcif_head +
                           "ATOM 1 C CA . ALA A 1 1 ? 1 2 3 1.0 20 1 H 1\n"
                           "HETATM 2 ZN ZN . ZN B 2 . ? 9 2 3 1.0 20 2 H 1\n"
                           "ATOM 3 C CA . ALA C 1 1 ? 19 2 3 1.0 20 1 L 1\n";
  StructureOptions options;
  const AtomFile auth = read_mmcif(text, options);
  CHECK(names_of(auth) == Names{"H ALA 1 CA", "H ZN 2 ZN", "L ALA 1 CA"});
  const std::vector<ChainName> both{{"H", "A"}, {"H", "B"}, {"L", "C"}};
  CHECK(auth.structure->chains == both);
  options.chain_names = ChainNames::label;
  const AtomFile label = read_mmcif(text, options);
  CHECK(names_of(label) == Names{"A ALA 1 CA", "B ZN 2 ZN", "C ALA 1 CA"});
  CHECK(label.structure->chains == both);
  options.chains = {"B"};
  CHECK(names_of(read_mmcif(text, options)) == Names{"B ZN 2 ZN"});
  options.chains = {"H"};
  CHECK(contains(error_of([&] { read_mmcif(text, options); }), "its chains are A, B, C"));
  options.chains = {};
  options.select = "//C";
  CHECK(names_of(read_mmcif(text, options)) == Names{"C ALA 1 CA"});
  CHECK(contains(pdb_error(line_of({}), options), "PDB files have no chain names label_asym_id"));
  // Operators of assemblies apply to the names of the PDB, whatever the names of the chains.
  options.select = {};
  options.assembly = "X";
  std::string assembly = text_with_assembly("1,2", "B");
  assembly.replace(assembly.find("1 B 1\n"), 6, "1 Q 1\n");
  CHECK(names_of(read_mmcif(assembly, options)) == Names{"B ALA 1 CA", "B-2 ALA 1 CA"});
  const std::string without =
      atom_table({"type_symbol", "label_atom_id", "label_comp_id", "label_seq_id", "auth_asym_id",
                  "Cartn_x", "Cartn_y", "Cartn_z"},
                 "C CA ALA 7 B 1 2 3\n");
  CHECK(read_mmcif(without).structure->chains.empty());
  options.assembly = {};
  CHECK(contains(error_of([&] { read_mmcif(without, options); }),
                 "the _atom_site table lacks the column label_asym_id"));
}

TEST_CASE("mmCIF: partial charges are a column or a table of their own", "[structure]") {
  const std::string first = "ATOM 1 N N . ALA A 1 1 ? 0 0 0 1.0 20 1 A 1",
                    second = "ATOM 2 C CA . ALA A 1 1 ? 1.5 0 0 1.0 20 1 A 1",
                    water = "HETATM 9 O O . HOH B 2 . ? 5 5 5 1.0 20 7 A 1";
  const std::string rows = first + "\n" + second + "\n" + water + "\n#\n";
  CHECK(read_mmcif(mmcif_head + rows).charges.empty());
  const std::string table =
      "loop_\n_sb_ncbr_partial_atomic_charges.type_id\n"
      "_sb_ncbr_partial_atomic_charges.atom_id\n"
      "_sb_ncbr_partial_atomic_charges.charge\n";
  // The ids are those of the atoms, in any order; of several sets, the first one is read.
  const AtomFile by_id = read_mmcif(mmcif_head + rows + table + "1 2 0.25\n1 1 -0.5\n2 1 3\n");
  CHECK(by_id.charges == std::vector<double>{-0.5, 0.25});
  const AtomFile lacking = read_mmcif(mmcif_head + rows + table + "1 2 0.25\n");
  CHECK(std::isnan(lacking.charges.at(0)));
  CHECK(lacking.charges.at(1) == 0.25);
  const AtomFile by_column =
      read_mmcif(mmcif_head + "_atom_site.partial_charge\n" + first + " -1e-1\n" + second + " ?\n" +
                 water + " 9\n" + table + "1 1 3\n");
  CHECK(by_column.charges.at(0) == -0.1);
  CHECK(std::isnan(by_column.charges.at(1)));
  CHECK(by_column.charges.size() == 2);
  const AtomFile in_one_line = read_mmcif(mmcif_head + "_atom_site.partial_charge\n" + first +
                                          " -1e-1 " + second + " 0.5\n" + water + " 9\n");
  CHECK(in_one_line.charges == std::vector<double>{-0.1, 0.5});
}

TEST_CASE("mmCIF: columns that programs leave out have defaults", "[structure]") {
  // PyMOL does not write auth_seq_id.
  const std::vector<std::string> columns{"type_symbol",  "label_atom_id", "label_comp_id",
                                         "label_seq_id", "auth_asym_id",  "Cartn_x",
                                         "Cartn_y",      "Cartn_z",       "pdbx_PDB_ins_code"};
  const std::string rows = "C CA ALA 7 B 1 2 3 ?\nO O ALA 8 C 4 5 6 A\n";
  const AtomFile file = read_mmcif(atom_table(columns, rows));
  CHECK(names_of(file) == Names{"B ALA 7 CA", "C ALA 8A O"});
  CHECK(file.lines == std::vector<std::uint64_t>{12, 13});
  REQUIRE(file.atoms.size() == 2);
  CHECK(file.atoms[0].center == Vec3{1, 2, 3});
  CHECK(file.atoms[0].radius == 1.88);
  CHECK(file.atoms[1].radius == 1.42);
  // Occupancies of 1 and no alternate locations.
  StructureOptions options;
  options.select = ";q=1";
  CHECK(read_mmcif(atom_table(columns, rows), options).atoms.size() == 2);
  for (std::size_t i = 0; i < 8; ++i) {
    if (columns[i] == "auth_asym_id" || columns[i] == "type_symbol") continue;
    std::vector<std::string> other = columns;
    other[i] = "details";
    INFO(columns[i]);
    const std::string missing = columns[i] == "label_seq_id" ? "auth_seq_id" : columns[i];
    CHECK(error_of([&] { read_mmcif(atom_table(other, rows)); }) ==
          "t.cif: the _atom_site table lacks the column " + missing);
  }
  // Without labels and entities, the kind of a residue follows from its name.
  for (const std::string name : {"label_asym_id", "auth_asym_id"}) {
    std::vector<std::string> names = columns;
    names[4] = name;
    StructureOptions polymer;
    polymer.select = ";polymer";
    polymer.with_waters = true;
    std::string rows_of_chain;
    for (int number = 1; number <= 6; ++number)
      rows_of_chain += fmt::format("C CA ALA {} B {} 0 0 ?\n", number, 4 * number);
    rows_of_chain += "C C1 LIG 7 B 9 9 9 ?\nO O HOH 8 B 1 9 9 ?\n";
    INFO(name);
    const AtomFile chain = read_mmcif(atom_table(names, rows_of_chain), polymer);
    CHECK(chain.atoms.size() == 6);
    CHECK(chain.structure->dropped_selection == 2);
  }
  // A chain without any name is one chain.
  std::vector<std::string> other = columns;
  other[4] = "details";
  CHECK(names_of(read_mmcif(atom_table(other, rows))) == Names{" ALA 7 CA", " ALA 8A O"});
  // A table of one atom need not be a loop.
  const std::string pairs =
      "data_TEST\n_atom_site.type_symbol C\n_atom_site.label_atom_id CA\n"
      "_atom_site.label_comp_id ALA\n_atom_site.label_seq_id 7\n_atom_site.auth_asym_id B\n"
      "_atom_site.Cartn_x 1\n_atom_site.Cartn_y 2\n_atom_site.Cartn_z 3\n";
  CHECK(names_of(read_mmcif(pairs)) == Names{"B ALA 7 CA"});
  CHECK(read_mmcif(pairs).lines == std::vector<std::uint64_t>{2});
  CHECK(read_mmcif(pairs + "_atom_site.id 77\n").lines == std::vector<std::uint64_t>{10});
}

TEST_CASE("mmCIF: a file of PyMOL has the atoms of the entry", "[structure]") {
  const fs::path path = biopython_data + "7CFN_aligned.cif.gz";
  if (!fs::exists(path)) SKIP("python-biopython-doc is not installed");
  const AtomFile aligned = read_structure(path),
                 entry = read_structure(biopython_data + "7CFN.cif.gz");
  // PyMOL has moved the atoms.
  const Names names = names_of(aligned), expected = names_of(entry);
  CHECK(std::multiset<std::string>(names.begin(), names.end()) ==
        std::multiset<std::string>(expected.begin(), expected.end()));
  CHECK(names.size() > 5000);
}

TEST_CASE("mmCIF: a crystal structure with modified residues is read", "[structure]") {
  // The C-terminal domain of a capsid protein: 70 residues, four of them selenomethionine.
  const AtomFile file = read_structure(crystal);
  CHECK(file.atoms.size() == 556);
  CHECK(file.structure->atom_records == 556);
  CHECK(file.structure->dropped_waters == 88);
  CHECK(file.structure->by_element.empty());
  std::set<std::string> residues;
  for (const auto& label : file.labels) residues.insert(label.residue_number);
  CHECK(residues.size() == 70);
}

TEST_CASE("PDB and mmCIF files of an entry have the same atoms", "[structure]") {
  if (!fs::is_directory(biopython_data)) SKIP("python-biopython-doc is not installed");
  for (const std::string entry : {"1A8O", "1LCD", "2BEG", "2XHE"}) {
    INFO(entry);
    const AtomFile pdb = read_structure(biopython_data + entry + ".pdb.gz");
    const AtomFile mmcif = read_structure(biopython_data + entry + ".cif.gz");
    std::multiset<std::string> in_pdb, in_mmcif;
    const auto add = [](const AtomFile& file, std::multiset<std::string>& texts) {
      const Names names = names_of(file);
      for (std::size_t i = 0; i < names.size(); ++i)
        texts.insert(fmt::format("{} {} {}", names[i], columns_of(file.atoms[i].center),
                                 file.atoms[i].radius));
    };
    add(pdb, in_pdb);
    add(mmcif, in_mmcif);
    CHECK(in_pdb == in_mmcif);
  }
}

}  // namespace eses::detail::test
