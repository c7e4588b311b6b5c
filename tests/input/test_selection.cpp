// Tests of the choice of models, alternate locations, chains and atoms of PDB and mmCIF files.

#include <fmt/format.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "support/sandbox.hpp"
#include "support/structures.hpp"

namespace eses::detail::test {

TEST_CASE("PDB: the first or the chosen model is read", "[structure]") {
  const auto model = [](int number, double x) {
    return fmt::format("MODEL {:8}\n", number) + line_of({.x = x}) + "ENDMDL\n";
  };
  const std::string text = model(3, 1) + model(4, 2);
  CHECK(read_pdb(text).atoms.at(0).center.x == 1);
  CHECK(read_pdb(text).structure->models == 2);
  CHECK(read_pdb(text).structure->model == "3");
  StructureOptions options;
  options.model = 4;
  CHECK(read_pdb(text, options).atoms.at(0).center.x == 2);
  CHECK(read_pdb(text, options).lines.at(0) == 5);
  options.model = 5;
  CHECK(pdb_error(text, options) ==
        "t.pdb: there is no model 5 (--model); the file has 2 models, from 3 to 4");
  const std::string second = "MODEL        3\nENDMDL\n" + model(4, 2);
  CHECK(pdb_error(second) == "t.pdb: model 3 has no atoms; choose another one with --model N");
  options.model = 4;
  CHECK(read_pdb(second, options).atoms.at(0).center.x == 2);
}

TEST_CASE("alternate locations are chosen by residue", "[structure]") {
  const std::string text = line_of({.name = " N  ", .element = " N"}) +
                           line_of({.altloc = 'A', .x = 1, .occupancy = 0.4}) +
                           line_of({.altloc = 'B', .x = 2, .occupancy = 0.6}) +
                           line_of({.name = " CB ", .altloc = 'A', .x = 3, .occupancy = 0.55}) +
                           line_of({.name = " CB ", .altloc = 'B', .x = 4, .occupancy = 0.45}) +
                           line_of({.name = " C  ", .altloc = 'A', .x = 5, .occupancy = 0.2}) +
                           line_of({.name = " C  ", .altloc = 'B', .x = 6, .occupancy = 0.8});
  // B has the higher mean occupancy, although CB has the higher one in A.
  AtomFile file = read_pdb(text);
  CHECK(file.lines == std::vector<std::uint64_t>{1, 3, 5, 7});
  CHECK(file.structure->dropped_altlocs == 3);
  StructureOptions options;
  options.altloc = "A";
  CHECK(read_pdb(text, options).lines == std::vector<std::uint64_t>{1, 2, 4, 6});
  options.altloc = "C";
  CHECK(pdb_error(text, options) == "t.pdb: no atom has the alternate location C (--altloc)");
  // With equal occupancies the first location is chosen.
  const std::string equal = line_of({.altloc = 'B', .x = 1, .occupancy = 0.5}) +
                            line_of({.altloc = 'A', .x = 2, .occupancy = 0.5});
  CHECK(read_pdb(equal).atoms.at(0).center.x == 2);
}

TEST_CASE("the mean occupancy of a location counts the atoms that other options keep",
          "[structure]") {
  const auto atom = [](const std::string& name, char altloc, double occupancy,
                       std::string element) {
    return line_of({.name = name,
                    .altloc = altloc,
                    .x = altloc == 'A' ? 0.0 : 1.0,
                    .occupancy = occupancy,
                    .element = std::move(element)});
  };
  // The mean of A is 0.6 without and 0.35 with its hydrogen, that of B is 0.4.
  const std::string text =
      atom(" CA ", 'A', 0.6, " C") + atom(" CA ", 'B', 0.4, " C") + atom(" HA ", 'A', 0.1, " H");
  StructureOptions options;
  CHECK(read_pdb(text, options).atoms.at(0).center.x == 0);
  options.hydrogens = HydrogenChoice::keep;
  CHECK(read_pdb(text, options).atoms.at(0).center.x == 1);
  options.select = "CA[C]";
  CHECK(read_pdb(text, options).atoms.at(0).center.x == 0);
}

TEST_CASE("one of several residues at a place is read", "[structure]") {
  const std::string text =
      line_of({.altloc = 'A', .residue = "SER", .occupancy = 0.3}) +
      line_of({.name = " OG ", .altloc = 'A', .residue = "SER", .x = 3, .occupancy = 0.3}) +
      line_of({.altloc = 'B', .residue = "THR", .x = 0.1, .occupancy = 0.7}) +
      line_of({.name = " OG1", .altloc = 'B', .residue = "THR", .x = 3, .occupancy = 0.7});
  CHECK(names_of(read_pdb(text)) == Names{"A THR 1 CA", "A THR 1 OG1"});
  StructureOptions options;
  options.altloc = "A";
  CHECK(names_of(read_pdb(text, options)) == Names{"A SER 1 CA", "A SER 1 OG"});
}

TEST_CASE("an atom without the chosen location keeps its location of highest occupancy",
          "[structure]") {
  const std::string text = line_of({.altloc = 'A', .occupancy = 0.9}) +
                           line_of({.altloc = 'B', .x = 1, .occupancy = 0.1}) +
                           line_of({.name = " CB ", .altloc = 'C', .x = 2, .occupancy = 0.2}) +
                           line_of({.name = " CB ", .altloc = 'D', .x = 3, .occupancy = 0.3});
  CHECK(read_pdb(text).lines == std::vector<std::uint64_t>{1, 4});
}

TEST_CASE("waters, ligands, hydrogens and chains are read as the options say", "[structure]") {
  const std::string text = mixed_text();
  AtomFile file = read_pdb(text);
  CHECK(file.lines == std::vector<std::uint64_t>{1, 3, 4});
  CHECK(file.structure->atom_records == 2);
  CHECK(file.structure->hetatm_records == 1);
  CHECK(file.structure->dropped_waters == 1);
  CHECK(file.structure->dropped_hydrogens == 1);
  REQUIRE(file.structure->by_element.size() == 1);
  CHECK(file.structure->by_element[0].atom_name == "C1");

  for (const std::string water : {"hoh", "Wat", "dod"})
    CHECK(read_pdb(
              line_of({}) +
              line_of(
                  {.record = "HETATM", .name = " O  ", .residue = water, .x = 9, .element = " O"}))
              .structure->dropped_waters == 1);

  StructureOptions options;
  options.with_waters = true;
  CHECK(read_pdb(text, options).lines == std::vector<std::uint64_t>{1, 3, 4, 5});
  options = {};
  options.with_hetatm = false;
  CHECK(read_pdb(text, options).lines == std::vector<std::uint64_t>{1, 3});
  options = {};
  options.hydrogens = HydrogenChoice::keep;
  CHECK(read_pdb(text, options).lines == std::vector<std::uint64_t>{1, 2, 3, 4});
  options = {};
  options.radii = "bondi";
  CHECK(read_pdb(text, options).lines == std::vector<std::uint64_t>{1, 2, 3, 4});
  options.hydrogens = HydrogenChoice::drop;
  CHECK(read_pdb(text, options).lines == std::vector<std::uint64_t>{1, 3, 4});
  options = {};
  options.chains = {"B"};
  file = read_pdb(text, options);
  CHECK(file.lines == std::vector<std::uint64_t>{3, 4});
  CHECK(file.structure->dropped_chains == 2);
  options.chains = {"A", "C"};
  CHECK(pdb_error(text, options) ==
        "t.pdb: there is no chain \"C\" (--chains); its chains are A, B");
  const std::string nameless = line_of({.chain = " "});
  CHECK(pdb_error(nameless, options) ==
        "t.pdb: there is no chain \"A\" (--chains); its atoms have no chain names");
  CHECK(pdb_error(nameless + line_of({.chain = "B", .x = 9}), options) ==
        "t.pdb: there is no chain \"A\" (--chains); its chains are B; other atoms have no chain "
        "name");
}

TEST_CASE("selections in gemmi's syntax choose atoms", "[structure]") {
  const std::string text = mixed_text();
  StructureOptions options;
  options.select = "/1/B";
  CHECK(read_pdb(text, options).lines == std::vector<std::uint64_t>{3, 4});
  CHECK(read_pdb(text, options).structure->dropped_selection == 2);
  options.select = "(LIG)";
  CHECK(read_pdb(text, options).lines == std::vector<std::uint64_t>{4});
  options.select = "CA[C]";
  CHECK(read_pdb(text, options).lines == std::vector<std::uint64_t>{1, 3});
  for (const auto& [word, expected] :
       std::vector<std::pair<std::string, std::vector<std::uint64_t>>>{{"A+B", {1, 3, 4}},
                                                                       {"B, A", {1, 3, 4}},
                                                                       {"ligand:LIG", {4}},
                                                                       {"ligand:ALA", {1, 3}},
                                                                       {"ligand:(LIG)", {4}},
                                                                       {"ligand://B", {3, 4}}}) {
    INFO(word);
    options.select = word;
    CHECK(read_pdb(text, options).lines == expected);
  }
  for (const auto& [word, message] : std::vector<std::pair<std::string, std::string>>{
           {"A,Z", "selection: no atoms of chain Z; its chains are A, B"},
           {"ligand:lig",
            "selection: no atoms of residue lig; the residues are LIG, HOH, ALA; did you mean "
            "LIG?"},
           {"ligand:HEM", "selection: no atoms of residue HEM; the residues are LIG, HOH, ALA"},
           {"ligand:A/lig", "did you mean B/LIG?"},
           {"ligand:", "selection: no atoms of ligand:; its chains are A, B"},
           {"//Z", "selection: no atoms of //Z; its chains are A, B"},
           {"ligand:(HEM)", "selection: no atoms of (HEM); its chains are A, B"}}) {
    INFO(word);
    options.select = word;
    CHECK(pdb_error(text, options).ends_with(message));
  }
  options.select = "//[";
  CHECK(contains(pdb_error(text, options), "selection: invalid selection syntax"));
  // A keyword of another program is no selection, although a chain may have the name of a word.
  for (const std::string word : {"resi", "resi 10", "chain A", "protein"}) {
    options.select = word;
    CHECK(
        pdb_error(text, options) ==
        fmt::format("t.pdb: selection: invalid selection syntax, expected the name of a chain or a "
                    "selection such as //A/10-20, found \"{}\"; its chains are A, B",
                    word));
  }
  options.select = "//A";
  const std::vector<std::uint64_t> lines = read_pdb(text, options).lines;
  options.select = "A";
  CHECK(read_pdb(text, options).lines == lines);
  options.select = "/2/A";
  CHECK(contains(pdb_error(text, options), "use --model 2"));
  options.select = "//B";
  options.chains = {"A"};
  CHECK(contains(pdb_error(text, options), "t.pdb: no atoms left of 5; left out: "));
}

TEST_CASE("all ligands are selected by one word", "[structure]") {
  const auto ligand = [](const char* name, const char* number, const char* atom, double x,
                         const char* element, char altloc = ' ') {
    return line_of({.record = "HETATM",
                    .name = atom,
                    .altloc = altloc,
                    .residue = name,
                    .number = number,
                    .x = x,
                    .element = element});
  };
  // Two locations of an ion are no ligand.
  const std::string text = line_of({}) + ligand("STI", "   7 ", " C1 ", 9, " C") +
                           ligand("STI", "   7 ", " O1 ", 10, " O") +
                           ligand(" CL", "   8 ", "CL  ", 20, "CL", 'A') +
                           ligand(" CL", "   8 ", "CL  ", 21, "CL", 'B');
  StructureOptions options;
  options.select = "ligand";
  CHECK(read_pdb(text, options).lines == std::vector<std::uint64_t>{2, 3});
  CHECK(read_pdb(text, options).structure->dropped_selection == 3);
}

TEST_CASE("alternative residues need not be neighbours", "[structure]") {
  const std::string text =
      line_of({.altloc = 'A', .residue = "SER", .number = "   7 ", .occupancy = 0.4}) +
      line_of({.chain = "B", .x = 20}) +
      line_of({.record = "HETATM",
               .altloc = 'B',
               .residue = "SEP",
               .number = "   7 ",
               .x = 0.1,
               .occupancy = 0.6});
  CHECK(names_of(read_pdb(text)) == Names{"B ALA 1 CA", "A SEP 7 CA"});
  StructureOptions options;
  options.altloc = "A";
  CHECK(names_of(read_pdb(text, options)) == Names{"A SER 7 CA", "B ALA 1 CA"});
}

TEST_CASE("a location without a letter is an alternative to one with a letter", "[structure]") {
  const std::string text =
      line_of({.occupancy = 0.6}) + line_of({.altloc = 'B', .x = 0.5, .occupancy = 0.4});
  const AtomFile file = read_pdb(text);
  REQUIRE(file.atoms.size() == 1);
  CHECK(file.atoms[0].center.x == 0);
  CHECK(file.structure->dropped_altlocs == 1);
  StructureOptions options;
  options.altloc = "B";
  CHECK(read_pdb(text, options).atoms.at(0).center.x == 0.5);
}

TEST_CASE("alternate locations of two segments are chosen separately", "[structure]") {
  const auto atom = [](const std::string& segment, char altloc, double occupancy, double x) {
    std::string line = line_of({.altloc = altloc, .x = x, .occupancy = occupancy});
    return line.replace(72, 4, segment);
  };
  const AtomFile file = read_pdb(atom("AAAA", 'A', 0.3, 1) + atom("AAAA", 'B', 0.7, 2) +
                                 atom("BBBB", 'A', 0.9, 11) + atom("BBBB", 'B', 0.1, 12));
  REQUIRE(file.atoms.size() == 2);
  CHECK(file.atoms[0].center.x == 2);
  CHECK(file.atoms[1].center.x == 11);
}

TEST_CASE("a selection of one residue is no range", "[structure]") {
  std::string text;
  for (const char* number : {"   1 ", "   2 ", "   3 "}) text += line_of({.number = number});
  const auto lines = [&](const std::string& selection) {
    StructureOptions options;
    options.select = selection;
    return read_pdb(text, options).lines;
  };
  using Lines = std::vector<std::uint64_t>;
  for (const char* single : {"//A/2", "A/2", "/1/A/2/CA", "//*/2(ALA)"}) {
    INFO(single);
    CHECK(lines(single) == Lines{2});
  }
  CHECK(lines("//A/2-") == Lines{2, 3});
  CHECK(lines("//A/2-3") == Lines{2, 3});
  CHECK(lines("//A") == Lines{1, 2, 3});
}

TEST_CASE("selections are parts of a complex", "[structure]") {
  const Sandbox sandbox;
  write_file(sandbox.directory() / "t.pdb", line_of({.number = "   1 ", .x = 0}) +
                                                line_of({.number = "   2 ", .x = 3}) +
                                                line_of({.number = "   3 ", .x = 6}));
  const Outcome by_selection =
      sandbox.run({"interface", "t.pdb", "--groups", "//A/1", "//A/2-3", "--json"});
  REQUIRE(by_selection.code == 0);
  check_json(sandbox, by_selection.out,
             "[r['interfaces'][0][s]['name'] for s in ('first', 'second')]",
             "['//A/1', '//A/2-3']");
  check_json(sandbox, by_selection.out,
             "[a['residue_number'] for a in r['interfaces'][0]['second']['residues']]", "['2']");
  const Outcome overlap = sandbox.run({"measure", "t.pdb", "--parts", "//A/1-2|//A/2-3"});
  CHECK(overlap.code == 1);
  CHECK(contains(overlap.err,
                 "t.pdb: the atom in line 2 belongs to two parts of --parts: //A/1-2 and //A/2-3"));
  const Outcome stream =
      sandbox.run({"interface", "-", "--format", "pdb", "--groups", "//A/1", "A"}, "< t.pdb");
  CHECK(contains(stream.err, "<stdin>: selections (--groups) read the file twice; give its name"));
}

}  // namespace eses::detail::test
