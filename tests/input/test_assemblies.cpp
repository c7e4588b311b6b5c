// Tests of biological assemblies of PDB and mmCIF files.

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "catch.hpp"
#include "support/structures.hpp"

namespace eses::detail::test {

TEST_CASE("an assembly has copies with names of their own", "[structure]") {
  StructureOptions options;
  options.assembly = "1";
  const AtomFile one = read_structure(crystal), file = read_structure(crystal, options);
  REQUIRE(file.atoms.size() == 2 * one.atoms.size());
  CHECK(file.structure->operators == 2);
  CHECK(file.structure->assembly == "1");
  std::map<std::string, int> chains;
  for (const auto& label : file.labels) ++chains[label.chain];
  CHECK(chains == std::map<std::string, int>{{"A", 556}, {"A-2", 556}});
  // The second operator of the entry is a rotation, (-x, y, z) -> (y, x, -z) of P 43 21 2 or a
  // similar one. It keeps distances.
  const std::size_t n = one.atoms.size();
  for (std::size_t i = 1; i < n; ++i) {
    const auto distance = [&](std::size_t a, std::size_t b) {
      const Vec3 d = file.atoms[a].center - file.atoms[b].center;
      return std::sqrt(dot(d, d));
    };
    CHECK(std::fabs(distance(0, i) - distance(n, n + i)) < 1e-3);
    CHECK(file.lines[i] == file.lines[n + i]);
    CHECK(file.atoms[i].radius == file.atoms[n + i].radius);
  }
  options.assembly = "2";
  CHECK(contains(error_of([&] { read_structure(crystal, options); }),
                 "there is no assembly \"2\" (--assembly); its assemblies are 1"));
}

TEST_CASE("an assembly of a PDB file has copies", "[structure]") {
  const std::string text =
      dimer_remarks + line_of({.x = 3, .y = 4, .z = 5}) + line_of({.chain = "B", .x = 30});
  StructureOptions options;
  options.assembly = "1";
  const AtomFile file = read_pdb(text, options);
  CHECK(names_of(file) == Names{"A ALA 1 CA", "A-2 ALA 1 CA"});
  CHECK(file.atoms.at(1).center == Vec3{-3, -4, 15});
  CHECK(read_pdb(text).atoms.size() == 2);
  CHECK(contains(pdb_error(line_of({}), options), "the file describes none"));
  // The chain B is not in the assembly.
  CHECK(file.structure->atom_records == 1);
  CHECK(file.structure->dropped_assembly == 1);
  CHECK(file.structure->dropped_chains == 0);
  std::string damaged = text;
  damaged.replace(damaged.find(" 0.000000", damaged.find("BIOMT2   2")), 9, "\t0.000000");
  CHECK(contains(pdb_error(damaged, options), "t.pdb:8: tab in column 25; "));
  CHECK(read_pdb(damaged).atoms.size() == 2);
  damaged = text;
  damaged.replace(damaged.find(" 0.000000", damaged.find("BIOMT2   2")), 9, " O.000000");
  CHECK(pdb_error(damaged, options) ==
        "t.pdb:8: expected a number for the operator in columns 24 to 33, found \"O.000000\"");
  const std::size_t cut = text.find("10.00000");
  CHECK(pdb_error(text.substr(0, cut) + text.substr(cut + 8), options) ==
        "t.pdb:9: expected a number for the operator in columns 59 to 68, found \"\"");
  CHECK(read_pdb(damaged).atoms.size() == 2);
}

TEST_CASE("the report has the assemblies that differ from the atoms of the file", "[structure]") {
  const auto others = [](const AtomFile& file) {
    std::vector<std::string> texts;
    for (const auto& [id, operators, atoms] : file.structure->other_assemblies)
      texts.push_back(fmt::format("{} {} {}", id, operators, atoms));
    return texts;
  };
  const std::string a = line_of({.x = 3}), b = line_of({.chain = "B", .x = 30});
  CHECK(others(read_pdb(dimer_remarks + a)) == Names{"1 2 1"});
  CHECK(others(read_pdb(dimer_remarks + a + b)) == Names{"1 2 1"});
  CHECK(others(read_pdb(a + b)).empty());
  const std::string identity =
      dimer_remarks.substr(0, dimer_remarks.find("REMARK 350   BIOMT1   2"));
  CHECK(others(read_pdb(identity + a)).empty());
  CHECK(others(read_pdb(identity + a + b)) == Names{"1 1 1"});
  StructureOptions options;
  options.chains = {"A"};
  CHECK(others(read_pdb(identity + a + b, options)).empty());
  options.chains = {"B"};
  CHECK(others(read_pdb(identity + a + b, options)).empty());
  options.chains = {};
  options.assembly = "1";
  CHECK(others(read_pdb(dimer_remarks + a, options)).empty());
  std::string list = dimer_remarks;
  list.replace(list.find("MOLECULE: 1") + 10, 1, "3, 4");
  CHECK(others(read_pdb(list + a)) == Names{"3 2 1"});

  CHECK(others(read_structure(crystal)) == Names{"1 2 556"});
  CHECK(others(read_mmcif(text_with_assembly("(1-3)(T)"))) == Names{"X 3 2"});
  CHECK(others(read_mmcif(text_with_assembly("1"))).empty());
  CHECK(others(read_mmcif(text_with_assembly("1", "B"))) == Names{"X 1 1"});
  CHECK(others(read_mmcif(text_with_assembly("1,undefined"))).empty());
}

TEST_CASE("operator expressions of mmCIF files are expanded", "[structure]") {
  StructureOptions options;
  options.assembly = "X";
  using Centers = std::vector<Vec3>;
  const auto centers = [&](const std::string& expression, const std::string& chains = "A") {
    Centers result;
    for (const Atom& atom : read_mmcif(text_with_assembly(expression, chains), options).atoms)
      result.push_back(atom.center);
    return result;
  };
  CHECK(centers("1") == Centers{{11, 2, 3}});
  CHECK(centers("(2)") == Centers{{21, 2, 3}});
  CHECK(centers("3,1") == Centers{{31, 2, 3}, {11, 2, 3}});
  CHECK(centers("(1-2,T)") == Centers{{11, 2, 3}, {21, 2, 3}, {101, 2, 3}});
  CHECK(centers("1, 3", "\"A, B\"") == Centers{{11, 2, 3}, {14, 5, 6}, {31, 2, 3}, {34, 5, 6}});
  // In products, the operators on the right are applied first: R turns x to y and y to -x.
  CHECK(centers("(R)(1)") == Centers{{-2, 11, 3}});
  CHECK(centers("(1)(R)") == Centers{{8, 1, 3}});
  CHECK(centers("(T)(1-3)(R)") == Centers{{108, 1, 3}, {118, 1, 3}, {128, 1, 3}});
  CHECK(centers("(T,1)(2,3)") == Centers{{121, 2, 3}, {131, 2, 3}, {31, 2, 3}, {41, 2, 3}});
  // The nine products are five different translations, by 20, 30, 40, 50 and 60 angstrom.
  const AtomFile file = read_mmcif(text_with_assembly("(1-3)(1-3)"), options);
  CHECK(file.atoms.size() == 18);
  CHECK(file.structure->operators == 5);
}

TEST_CASE("invalid operator expressions of mmCIF files are refused", "[structure]") {
  StructureOptions options;
  options.assembly = "X";
  const auto error = [&](const std::string& expression) {
    return error_of([&] { read_mmcif(text_with_assembly(expression), options); });
  };
  // The table of expressions begins in line 25.
  const auto message = [](const std::string& expression, const std::string& what) {
    return "t.cif:25: the operator expression \"" + expression + "\" " + what;
  };
  CHECK(error("1,4") ==
        message("1,4", "has the operator \"4\", which _pdbx_struct_oper_list lacks"));
  CHECK(error("()") == message("()", "has the operator \"\", which _pdbx_struct_oper_list lacks"));
  CHECK(error("1-") ==
        message("1-", "has the operator \"1-\", which _pdbx_struct_oper_list lacks"));
  CHECK(error("(1-3") == message("(1-3", "has no closing parenthesis"));
  CHECK(error("3-1") == message("3-1", "has the invalid range \"3-1\""));
  CHECK(error("1-4000000000") == message("1-4000000000", "has the invalid range \"1-4000000000\""));
  CHECK(error("bad") == message("bad", "has the operator \"bad\", whose matrix is not numeric"));
  std::string product;
  for (int i = 0; i < 9; ++i) product += "(1-3)";
  CHECK(error(product) == "t.cif:25: the assembly has more than 10000 operators");
  // Other assemblies do not matter.
  CHECK(read_mmcif(text_with_assembly("bad")).atoms.size() == 2);
  options.assembly = "7";
  CHECK(error("1") ==
        "t.cif: there is no assembly \"7\" (--assembly); its assemblies are X, other");
}

namespace {

/// Returns REMARK 350 with one assembly of the chain A by operators that are translations along x.
std::string remarks_of(const std::string& ids, const std::vector<double>& translations,
                       const std::string& chains = "A") {
  std::string text = "REMARK 350 BIOMOLECULE: " + ids +
                     "\nREMARK 350 APPLY THE FOLLOWING TO CHAINS: " + chains + "\n";
  int number = 0;
  for (const double x : translations) {
    ++number;
    text += fmt::format("REMARK 350   BIOMT1{:>4}  1.000000  0.000000  0.000000     {:10.5f}\n",
                        number, x);
    text += fmt::format("REMARK 350   BIOMT2{:>4}  0.000000  1.000000  0.000000        0.00000\n",
                        number);
    text += fmt::format("REMARK 350   BIOMT3{:>4}  0.000000  0.000000  1.000000        0.00000\n",
                        number);
  }
  return text;
}

}  // namespace

TEST_CASE("atoms that an assembly does not contain are counted as left out", "[structure]") {
  const std::string text =
      remarks_of("1", {0, 50}, "A, C") + line_of({.x = 3}) + line_of({.name = " CB ", .x = 4}) +
      line_of({.record = "HETATM", .residue = "LIG", .chain = "B", .number = "   2 ", .x = 20}) +
      line_of({.chain = "B", .x = 30}) +
      line_of({.record = "HETATM",
               .name = " O  ",
               .residue = "HOH",
               .chain = "B",
               .number = " 100 ",
               .x = 40,
               .element = " O"}) +
      line_of({.chain = "C", .x = 10});
  StructureOptions options;
  options.assembly = "1";
  options.with_waters = true;
  const auto report = [&] { return *read_pdb(text, options).structure; };
  CHECK(report().atom_records == 3);
  CHECK(report().hetatm_records == 0);
  CHECK(report().waters == 0);
  CHECK(report().dropped_assembly == 3);
  options.chains = {"A", "B"};
  CHECK(report().atom_records == 2);
  CHECK(report().dropped_chains == 1);
  CHECK(report().dropped_assembly == 3);
  options.with_waters = options.with_hetatm = false;
  CHECK(report().dropped_assembly == 1);
  CHECK(report().dropped_waters == 1);
  CHECK(report().dropped_hetatm == 1);
  options.chains = {"B"};
  CHECK(pdb_error(text, options) ==
        "t.pdb: assembly 1 contains none of the selected atoms; left out: 3 of other chains, 1 of "
        "water (--waters keeps them), 1 of HETATM records, 1 not in the assembly");
  options.select = "(XYZ)";
  CHECK(contains(pdb_error(text, options), "no atoms left of 6; left out: "));
  // In mmCIF files, assemblies are lists of subchains.
  options = {};
  options.assembly = "X";
  const AtomFile file = read_mmcif(text_with_assembly("1-2", "B"), options);
  CHECK(names_of(file) == Names{"B ALA 1 CA", "B-2 ALA 1 CA"});
  CHECK(file.structure->atom_records == 1);
  CHECK(file.structure->dropped_assembly == 1);
}

TEST_CASE("equal operators of an assembly count once", "[structure]") {
  StructureOptions options;
  options.assembly = "1";
  // Two lists of chains have the same two operators, and the second one has another one.
  const std::string first = remarks_of("1", {0, 50});
  std::string second = remarks_of("1", {0, 50, 100}, "B");
  second.erase(0, second.find('\n') + 1);
  const AtomFile file =
      read_pdb(first + second + line_of({.x = 3}) + line_of({.chain = "B", .x = 30}), options);
  CHECK(file.atoms.size() == 5);
  CHECK(file.structure->operators == 3);
  options.assembly = "X";
  CHECK(read_mmcif(text_with_assembly("1,2,1"), options).structure->operators == 2);
}

TEST_CASE("assemblies with an incomplete description are refused with the cause", "[structure]") {
  StructureOptions options;
  options.assembly = "1";
  const std::string atoms = line_of({}) + line_of({.chain = "B"});
  const std::string start = "t.pdb: assembly 1 has no atoms: REMARK 350 has no ";
  const std::string remarks = remarks_of("1", {0});
  CHECK(pdb_error(remarks.substr(0, remarks.find("REMARK 350   BIOMT1")) + atoms, options) ==
        start + "operator for its chains");
  CHECK(contains(pdb_error(remarks.substr(0, remarks.find("REMARK 350   BIOMT3")) + atoms, options),
                 ": expected the record BIOMT3 of an operator"));
  std::string without_second = remarks;
  const std::size_t second = remarks.find("REMARK 350   BIOMT2");
  without_second.erase(second, remarks.find('\n', second) + 1 - second);
  CHECK(contains(pdb_error(without_second + atoms, options),
                 ": expected the record BIOMT2 of an operator, found BIOMT3"));
  std::string mixed = remarks;
  mixed[second + 22] = '7';
  CHECK(contains(pdb_error(mixed + atoms, options),
                 ": expected a row of operator 1, found one of operator 7"));
  const std::string last = remarks.substr(remarks.find("REMARK 350   BIOMT1"), 70);
  CHECK(contains(pdb_error(remarks + atoms + last.substr(0, last.find('\n') + 1), options),
                 ": expected the record BIOMT2 of an operator"));
  CHECK(pdb_error("REMARK 350 BIOMOLECULE: 1\n" + atoms, options) ==
        start + "list of chains for it");
  CHECK(pdb_error(remarks_of("1", {0}, "") + atoms, options) == start + "list of chains for it");
  options.assembly = "X";
  CHECK(error_of([&] { read_mmcif(text_with_assembly("1", "?"), options); }) ==
        "t.cif: assembly X has no atoms: _pdbx_struct_assembly_gen.asym_id_list has no chains for "
        "it");
  std::string text = text_with_assembly("1");
  text.replace(text.find("X \"1\""), 5, "X ?  ");
  CHECK(error_of([&] { read_mmcif(text, options); }) ==
        "t.cif:25: the operator expression (oper_expression) is missing");
}

TEST_CASE("PDB: one of several assemblies with the same description is built", "[structure]") {
  const std::string text = remarks_of("1, 2", {0, 50}) +
                           remarks_of("10,11, 12, 13, 14, 15, 16, 17, 18", {0}) + line_of({.x = 3});
  StructureOptions options;
  const auto count = [&](const std::string& id) {
    options.assembly = id;
    const AtomFile file = read_pdb(text, options);
    CHECK(file.structure->assembly == id);
    return file.atoms.size();
  };
  for (const std::string id : {"1", "2", "1, 2"}) CHECK(count(id) == 2);
  for (const std::string id : {"10", "11", "16", "18"}) CHECK(count(id) == 1);
  options.assembly = "3";
  CHECK(pdb_error(text, options) ==
        "t.pdb: there is no assembly \"3\" (--assembly); its assemblies are 1, 2, 10,11, 12, 13, "
        "14, 15, 16, 17, 18");
}

TEST_CASE("the number of operators of an assembly is limited", "[structure]") {
  StructureOptions options;
  options.assembly = "1";
  // The third list of chains exceeds the limit of 10,000 operators.
  std::string text = remarks_of("1", std::vector<double>(4000));
  std::string further = remarks_of("1", std::vector<double>(4000), "B");
  further.erase(0, further.find('\n') + 1);
  CHECK(read_pdb(text + further + line_of({}), options).atoms.size() == 4000);
  CHECK(pdb_error(text + further + further + line_of({}), options) ==
        "t.pdb: the assembly has more than 10000 operators");
  options.assembly = "X";
  const auto error = [&](const std::string& cif) {
    return error_of([&] { read_mmcif(cif, options); });
  };
  const std::string message = "t.cif:25: the assembly has more than 10000 operators";
  std::string operators;
  for (int i = 0; i < 5000; ++i) operators += operators.empty() ? "1" : ",1";
  CHECK(error(text_with_assembly(operators)).empty());
  CHECK(error(text_with_assembly(operators + "," + operators)).empty());
  CHECK(error(text_with_assembly(operators + "," + operators + ",1")) == message);
  std::string rows = text_with_assembly(operators);
  rows.replace(rows.find("other (undefined)"), 17, "X \"" + operators + ",1\"");
  CHECK(error(rows) == message);
}

TEST_CASE("an ion on an axis of symmetry is read once", "[structure]") {
  std::string remarks = dimer_remarks;
  remarks.replace(remarks.rfind("10.00000"), 8, " 0.00000");
  const std::string text = remarks + line_of({.x = 3, .y = 4, .z = 5}) +
                           line_of({.record = "HETATM",
                                    .name = "ZN  ",
                                    .residue = " ZN",
                                    .number = " 900 ",
                                    .z = 7,
                                    .element = "ZN"});
  StructureOptions options;
  options.assembly = "1";
  const AtomFile file = read_pdb(text, options);
  CHECK(file.atoms.size() == 3);
  CHECK(file.structure->dropped_images == 1);
}

}  // namespace eses::detail::test
