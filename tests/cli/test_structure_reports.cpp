// Tests of the program's reports and tables for PDB and mmCIF files.

#include <fmt/format.h>

#include <string>
#include <vector>

#include "catch.hpp"
#include "support/structures.hpp"

namespace eses::detail::test {

TEST_CASE("the program reads a PDB file and reports the atoms that it leaves out",
          "[structure][cli]") {
  const Sandbox sandbox;
  write_file(sandbox.directory() / "m.pdb", mixed_text());
  const Outcome text = sandbox.run({"m.pdb", "--write", "none"});
  REQUIRE(text.code == 0);
  CHECK(contains(text.out, "input: m.pdb (3 atoms)\n"));
  CHECK(contains(text.out, "read: 2 ATOM records, 1 HETATM record\n"));
  CHECK(contains(text.out, "left out: 1 atom of water, 1 hydrogen\n"));
  CHECK(contains(text.out, "radii: protor; 1 atom by element (LIG C1 1.7)\n"));

  const Outcome json = sandbox.run({"m.pdb", "--write", "none", "--json"});
  REQUIRE(json.code == 0);
  check_json(sandbox, json.out, "r['structure']['left_out']['waters']", "1");
  check_json(sandbox, json.out, "r['structure']['read']['hetatm_records']", "1");
  check_json(sandbox, json.out, "r['structure']['radii_by_element'][0]['element']", "'C'");
  check_json(sandbox, json.out, "r['structure']['assembly']", "None");

  // The chain B is not in the assembly, and the ion is on its axis.
  write_file(
      sandbox.directory() / "dimer.pdb",
      dimer_remarks.substr(0, dimer_remarks.rfind("10.00000")) + " 0.00000\n" + line_of({.x = 3}) +
          line_of({.chain = "B", .x = 9}) +
          line_of({.record = "HETATM", .name = "ZN  ", .residue = " ZN", .z = 7, .element = "ZN"}));
  const Outcome dimer = sandbox.run({"dimer.pdb", "--assembly", "1", "--write", "none"});
  CHECK(contains(dimer.out, "read: 1 ATOM record, 1 HETATM record; assembly 1 by 2 operators\n"));
  CHECK(contains(dimer.out,
                 "left out: 1 atom not in the assembly, 1 image that coincides with an "
                 "earlier one\n"));
  const Outcome counts = sandbox.run({"dimer.pdb", "--assembly", "1", "--write", "none", "--json"});
  check_json(sandbox, counts.out, "r['structure']['left_out']['assembly']", "1");
  check_json(sandbox, counts.out, "r['structure']['left_out']['images']", "1");

  // Standard input gives the same result.
  const Outcome piped = sandbox.run({"-", "--format", "pdb", "--write", "none"}, "< m.pdb");
  CHECK(contains(piped.out, "read: 2 ATOM records, 1 HETATM record\n"));
}

TEST_CASE("structure: --like chooses atoms and radii as another program", "[structure][cli]") {
  const Sandbox sandbox;
  write_file(sandbox.directory() / "m.pdb", mixed_text());
  const auto check_choice = [&](const std::vector<std::string>& options,
                                const std::string& expected) {
    std::vector<std::string> arguments{"m.pdb", "--write", "none", "--json"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const Outcome outcome = sandbox.run(arguments);
    REQUIRE(outcome.code == 0);
    check_json(sandbox, outcome.out,
               "[r['structure']['radii'], *(r['structure']['left_out'][n] for n in "
               "('waters', 'hetatm_records', 'hydrogens'))]",
               expected);
  };
  check_choice({}, "['protor', 1, 0, 1]");
  for (const std::string program : {"freesasa", "zsasa"})
    check_choice({"--like", program}, "['protor', 1, 1, 1]");
  for (const std::string program : {"biopython", "mdtraj"})
    check_choice({"--like", program}, "['bondi', 0, 0, 0]");
  check_choice({"--like", "pymol"}, "['bondi', 1, 1, 0]");
  // Options beside it replace parts of the choice, in any order.
  check_choice({"--radii", "msms", "--like", "biopython"}, "['msms', 0, 0, 0]");
  check_choice({"--like", "pymol", "--hydrogens", "drop"}, "['bondi', 1, 1, 1]");
  check_choice({"--waters", "--like", "freesasa"}, "['protor', 0, 1, 1]");
  CHECK(contains(sandbox.run({"m.pdb", "--like", "msms"}).err,
                 "--like is 'msms', expected freesasa, biopython, mdtraj, zsasa or pymol"));
}

TEST_CASE("areas of residues and chains of PDB files are written", "[structure][cli]") {
  const Sandbox sandbox;
  write_file(sandbox.directory() / "m.pdb", mixed_text());
  REQUIRE(
      sandbox.run({"m.pdb", "--write", "residues", "--mesh", "m.ply", "--color", "chain"}).code ==
      0);
  const std::string table = read_file(sandbox.directory() / "residue_area.csv");
  CHECK(table.starts_with("chain,residue_number,residue,atoms,area\nA,1,ALA,1,"));
  CHECK(contains(table, "\nB,1,ALA,1,"));
  CHECK(contains(table, "\nB,900,LIG,1,"));
  const std::string mesh = read_file(sandbox.directory() / "m.ply");
  CHECK(contains(mesh, "comment chain 1 B\n"));
  CHECK(contains(mesh, "comment residue 2 LIG 900 B\n"));
}

TEST_CASE("the program names the assemblies of a file", "[structure][cli]") {
  const Sandbox sandbox;
  write_file(sandbox.directory() / "a.pdb", dimer_remarks + line_of({}));
  write_file(sandbox.directory() / "ab.pdb",
             dimer_remarks + line_of({}) + line_of({.chain = "B", .x = 9}));
  const std::string advice = "; build it with --assembly 1\n";
  CHECK(contains(sandbox.run({"a.pdb", "--dry-run"}).out,
                 "\nnote: assembly 1 has 2 copies" + advice));
  CHECK(contains(sandbox.run({"ab.pdb", "--dry-run"}).out,
                 "\nnote: assembly 1 has 2 copies of 1 of the 2 atoms" + advice));
  CHECK_FALSE(contains(sandbox.run({"a.pdb", "--assembly", "1", "--dry-run"}).out, "note:"));
  check_json(sandbox, sandbox.run({"a.pdb", "--dry-run", "--json"}).out,
             "r['structure']['other_assemblies']", "[{'id': '1', 'operators': 2, 'atoms': 1}]");
}

TEST_CASE("models with one atom in each residue give a warning", "[structure][cli]") {
  const auto residue = [](int number, bool is_whole) {
    const std::string text = fmt::format("{:4} ", number);
    const std::string alpha = line_of({.number = text, .x = 3.8 * number});
    const std::string beta = line_of({.name = " CB ", .number = text, .x = 3.8 * number, .y = 1.5});
    if (!is_whole) return number % 2 == 0 ? alpha : alpha + beta;
    return alpha + beta + line_of({.name = " C  ", .number = text, .x = 3.8 * number, .z = 1.5});
  };
  const auto diagnostics = [](const std::string& text) { return read_pdb(text).diagnostics; };
  const std::string trace = residue(1, false) + residue(2, false);
  const std::string ligands = line_of({.record = "HETATM", .residue = "LIG", .y = 9}) +
                              line_of({.record = "HETATM", .residue = " ZN", .y = 18});
  // Ligands and ions do not count.
  REQUIRE(diagnostics(ligands + trace + residue(3, true)).size() == 1);
  const Diagnostic found = diagnostics(ligands + trace + residue(3, true)).front();
  CHECK(found.kind == DiagnosticKind::one_atom_residue);
  CHECK_FALSE(is_usual(found.kind));
  CHECK(found.count == 2);
  REQUIRE(found.examples.size() == 2);
  CHECK(found.examples[0].atom == 2);
  CHECK(found.examples[0].other == 2);
  CHECK(diagnostics(trace + residue(3, true) + residue(4, true)).empty());
  CHECK(diagnostics(ligands).empty());
  const std::string nucleotides =
      line_of({.name = " P  ", .residue = " DA"}) +
      line_of({.name = " P  ", .residue = "  G", .number = "   2 ", .x = 6});
  CHECK(diagnostics(nucleotides).size() == 1);

  const Sandbox sandbox;
  write_file(sandbox.directory() / "trace.pdb", trace);
  const std::string message =
      "trace.pdb: 2 residues have a single atom, or CA and CB alone, as in models of C-alpha "
      "atoms; "
      "area and volume are not those of the whole molecule: lines 1, A/ALA 1/CA; 3, A/ALA 2/CA\n";
  const Outcome outcome = sandbox.run({"trace.pdb", "--write", "none"});
  CHECK(outcome.code == 0);
  CHECK(outcome.err == "eses-blocks: warning: " + message);
  const Outcome strict = sandbox.run({"trace.pdb", "--write", "none", "--strict"});
  CHECK(strict.code == 1);
  CHECK(strict.err == "eses-blocks: error: " + message);
  const Outcome json = sandbox.run({"trace.pdb", "--write", "none", "--json"});
  check_json(sandbox, json.out,
             "[(d['kind'], d['severity'], d['count'], d['first'][1]['label']) "
             "for d in r['diagnostics']]",
             "[('one_atom_residue', 'warning', 2, 'A/ALA 2/CA')]");
}

TEST_CASE("waters of PQR files give a note", "[structure][pqr][cli]") {
  const Sandbox sandbox;
  const std::string text =
      "ATOM 1 N ALA A 1 0 0 0 0.1 1.5\nATOM 2 O HOH A 2 5 0 0 -0.8 1.6\n"
      "ATOM 3 H1 HOH A 2 5 1 0 0.4 0\nATOM 4 OW SOL B 3 0 5 0 -0.8 1.6\n";
  write_file(sandbox.directory() / "wet.pqr", text);
  const AtomFile file = parse_atoms(text, AtomFormat::pqr, "t.pqr");
  REQUIRE(file.diagnostics.size() == 1);
  CHECK(file.diagnostics[0].kind == DiagnosticKind::water);
  CHECK(file.diagnostics[0].count == 3);
  REQUIRE(file.diagnostics[0].examples.size() == 3);
  CHECK(file.diagnostics[0].examples[0].atom == 1);
  CHECK(file.diagnostics[0].examples[2].atom == 3);
  CHECK(parse_atoms("ATOM 1 N ALA A 1 0 0 0 0.1 1.5\n", AtomFormat::pqr).diagnostics.empty());

  const Outcome outcome = sandbox.run({"wet.pqr", "--write", "none", "--strict"});
  CHECK(outcome.code == 0);
  CHECK(outcome.err.empty());
  CHECK(
      contains(outcome.out,
               "input: wet.pqr (4 atoms; 1 of radius 0; 3 of water, which pdb2pqr leaves out with "
               "--drop-water)\n"));
  const Outcome json = sandbox.run({"wet.pqr", "--write", "none", "--json"});
  check_json(sandbox, json.out,
             "[(d['kind'], d['severity'], d['count'], d['first'][-1]['line']) "
             "for d in r['diagnostics']]",
             "[('zero_radius', 'note', 1, 3), ('water', 'note', 3, 4)]");
}

TEST_CASE("diagnostics name the atoms of PDB files", "[structure][cli]") {
  const Sandbox sandbox;
  const std::string text =
      line_of({.number = "  33 "}) + line_of({.name = " CB ", .number = "  33 ", .x = 0.2});
  write_file(sandbox.directory() / "m.pdb", text);
  const Outcome outcome = sandbox.run({"m.pdb", "--write", "none"});
  REQUIRE(outcome.code == 0);
  CHECK(contains(outcome.err, "line 2, A/ALA 33/CB (near 1, A/ALA 33/CA)"));
  const Outcome json = sandbox.run({"m.pdb", "--write", "none", "--json"});
  check_json(sandbox, json.out, "r['diagnostics'][0]['first'][0]['label']", "'A/ALA 33/CB'");
  check_json(sandbox, json.out, "r['diagnostics'][0]['first'][0]['other_label']", "'A/ALA 33/CA'");
}

TEST_CASE("tables with chains by label_asym_id have both names", "[structure][cli]") {
  const Sandbox sandbox;
  write_file(sandbox.directory() / "m.cif", mmcif_head +
                                                "ATOM 1 C CA . ALA A 1 1 ? 1 2 3 1.0 20 1 H 1\n"
                                                "HETATM 2 ZN ZN . ZN B 2 . ? 9 2 3 1.0 20 2 H 1\n");
  const auto residues = [&](const std::string& names) {
    const Outcome outcome = sandbox.run(
        {"measure", "--surface", "sas", "m.cif", "--table", "residues", "--chain-names", names});
    REQUIRE(outcome.code == 0);
    return outcome.out;
  };
  const std::string auth = residues("auth"), label = residues("label");
  CHECK(contains(auth, "relative_sas_area\nH,1,ALA,1,"));
  CHECK(contains(label, "relative_sas_area,auth_chain\nA,1,ALA,1,"));
  CHECK(contains(label, ",H\nB,2,ZN,1,"));
  const Outcome json = sandbox.run({"measure", "--chain-names", "label", "--json", "m.cif"});
  check_json(sandbox, json.out, "r['structure']['chains'][1]", "{'auth': 'H', 'label': 'B'}");
  REQUIRE(sandbox.run({"measure", "m.cif", "--write", "cif", "--chain-names", "label"}).code == 0);
  const std::string written = read_file(sandbox.directory() / "m.areas.cif");
  CHECK(contains(written, "ZN . ZN B . . ? "));
  CHECK(contains(written, " 2 ZN H ZN 1\n"));
}

TEST_CASE("options of structure files are refused for xyzr files", "[structure][cli]") {
  const Sandbox sandbox;
  write_file(sandbox.directory() / "a.xyzr", "0 0 0 1\n");
  write_file(sandbox.directory() / "a.pqr", "ATOM 1 N ALA A 1 0 0 0 0.1 1.5\n");
  for (const std::vector<std::string>& option :
       std::vector<std::vector<std::string>>{{"--like", "pymol"},
                                             {"--radii", "bondi"},
                                             {"--unknown-radius", "1"},
                                             {"--model", "1"},
                                             {"--altloc", "A"},
                                             {"--waters"},
                                             {"--no-hetatm"},
                                             {"--hydrogens", "keep"},
                                             {"--chains", "A"},
                                             {"--select", "//A"},
                                             {"--chain-names", "label"},
                                             {"--assembly", "1"}}) {
    for (const std::string file : {"a.xyzr", "a.pqr"}) {
      std::vector<std::string> arguments{file, "--write", "none"};
      arguments.insert(arguments.end(), option.begin(), option.end());
      INFO(file << " " << option[0]);
      const Outcome outcome = sandbox.run(arguments);
      if (file == "a.pqr" && option[0] == "--model") {
        CHECK(outcome.code == 0);
        continue;
      }
      CHECK(outcome.code == 2);
      const bool is_model = option[0] == "--model";  // which also applies to PQR files
      CHECK(contains(outcome.err, fmt::format("{} needs a {}PDB or mmCIF file; {}", option[0],
                                              is_model ? "PQR, " : "", file)));
      CHECK(contains(outcome.err, "--format pqr") == is_model);
    }
  }
  for (const std::vector<std::string>& option :
       std::vector<std::vector<std::string>>{{"--unknown-radius", "-1"},
                                             {"--model", "0"},
                                             {"--altloc", "AB"},
                                             {"--chains", "A,,B"},
                                             {"--chains", "A,"},
                                             {"--hydrogens", "some"},
                                             {"--radii", ""},
                                             {"--chain-names", "both"},
                                             {"--format", "mol2"}}) {
    std::vector<std::string> arguments{"a.pdb"};
    arguments.insert(arguments.end(), option.begin(), option.end());
    INFO(option[0]);
    CHECK(sandbox.run(arguments).code == 2);
  }
}

}  // namespace eses::detail::test
