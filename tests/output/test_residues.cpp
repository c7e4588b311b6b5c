// Tests of the tables of residues, chains and atoms.

#include <filesystem>
#include <numbers>
#include <numeric>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "eses/error.hpp"
#include "eses/read_atoms.hpp"
#include "output/area_formats.hpp"
#include "output/area_tables.hpp"
#include "support/eses_files.hpp"
#include "support/run.hpp"
#include "support/temporary_directory.hpp"

namespace eses::detail::test {
namespace {

AtomLabel label(const char* chain, const char* number, const char* residue) {
  return {chain, residue, number, "CA", "C"};
}

std::string tables_of(const std::vector<AtomLabel>& labels, const std::vector<double>& areas) {
  std::string text;
  BufferedText table([&text](std::string_view part) { text += part; });
  append_residues(table, residue_runs(labels), areas);
  append_chains(table, residue_runs(labels), areas);
  table.flush();
  return text;
}

std::vector<std::vector<std::string>> rows_of(const std::filesystem::path& path) {
  std::istringstream stream(read_bytes(path));
  std::vector<std::vector<std::string>> rows;
  for (std::string line; std::getline(stream, line);) {
    std::istringstream fields(line);
    rows.emplace_back();
    for (std::string text; std::getline(fields, text, ',');) rows.back().push_back(text);
  }
  return rows;
}

}  // namespace

TEST_CASE("a residue is a run of atoms, a chain all atoms with its label", "[residues]") {
  const std::vector<AtomLabel> labels{label("A", "1", "ALA"),  label("A", "1", "ALA"),
                                      label("A", "1A", "ALA"), label("B", "1", "ALA"),
                                      label("B", "1", "GLY"),  label("A", "1", "ALA")};
  CHECK(tables_of(labels, {1, 2, 4, 8, 16, 32.5}) ==
        "chain,residue_number,residue,atoms,area\n"
        "A,1,ALA,2,3.000000\n"
        "A,1A,ALA,1,4.000000\n"
        "B,1,ALA,1,8.000000\n"
        "B,1,GLY,1,16.000000\n"
        "A,1,ALA,1,32.500000\n"
        "chain,residues,atoms,area\n"
        "A,3,4,39.500000\n"
        "B,2,2,24.000000\n");
}

TEST_CASE("missing labels and labels with commas and quotes are written as CSV", "[residues]") {
  CHECK(tables_of({label("", "1", "A,B"), label("\"", "", "X\"Y")}, {1, 2}) ==
        "chain,residue_number,residue,atoms,area\n"
        ",1,\"A,B\",1,1.000000\n"
        "\"\"\"\",,\"X\"\"Y\",1,2.000000\n"
        "chain,residues,atoms,area\n"
        ",1,1,1.000000\n"
        "\"\"\"\",1,1,2.000000\n");
}

TEST_CASE("the tables of a PQR file add up to its atoms' areas", "[residues]") {
  const AtomFile input = read_atoms(ESES_DATA "/mache.pqr");
  const TemporaryDirectory directory;
  Parameters parameters;
  grid_options(parameters).spacing = 0.8;
  Outputs outputs{.box = true, .grid = false, .edges = false, .areas = true, .residues = true};
  const Molecule molecule(input.atoms, input.labels);
  const Summary summary = run(molecule, parameters, outputs, directory.path());

  std::vector<double> areas;
  std::istringstream lines(read_bytes(directory.path() / "partition_area.txt"));
  std::size_t atom = 0;
  for (double area = 0; lines >> atom >> area;) areas.push_back(area);
  REQUIRE(areas.size() == input.atoms.size());

  const auto residues = rows_of(directory.path() / "residue_area.csv");
  const auto chains = rows_of(directory.path() / "chain_area.csv");
  REQUIRE(residues.size() > 500);
  std::size_t first = 0;
  for (std::size_t r = 1; r < residues.size(); ++r) {
    const auto count = std::stoul(residues[r].at(3));
    double area = 0;
    for (std::size_t a = first; a < first + count; ++a) {
      area += areas.at(a);
      CHECK(input.labels[a].residue == residues[r][2]);
      CHECK(input.labels[a].residue_number == residues[r][1]);
    }
    CHECK(std::stod(residues[r].at(4)) == Catch::Approx(area).margin(1e-5));
    first += count;
  }
  CHECK(first == areas.size());
  double total = 0;
  std::size_t residue_count = 0;
  for (std::size_t c = 1; c < chains.size(); ++c) {
    residue_count += std::stoul(chains[c].at(1));
    total += std::stod(chains[c].at(3));
  }
  CHECK(residue_count + 1 == residues.size());
  CHECK(total == Catch::Approx(summary.area));
  CHECK(summary.convex_area + summary.saddle_area + summary.concave_area ==
        Catch::Approx(summary.area));
  CHECK(summary.bytes_written ==
        std::filesystem::file_size(directory.path() / "bounding_box.txt") +
            std::filesystem::file_size(directory.path() / "partition_area.txt") +
            std::filesystem::file_size(directory.path() / "residue_area.csv") +
            std::filesystem::file_size(directory.path() / "chain_area.csv"));
}

TEST_CASE("a line of the table of atoms has the names as CSV", "[residues]") {
  std::string text;
  BufferedText table([&text](std::string_view part) { text += part; });
  append_atom_header(table);
  append_atom(table, 1, {"A", "LIG", "52A", "CL1", "Cl"}, 1.75, 12.5);
  append_atom(table, 2, {"A,B", "X\"Y", "-1", "C'", ""}, 2, 0);
  append_atom(table, 3, {}, 0.1, 1e6);
  table.flush();
  CHECK(text ==
        "serial,name,residue,residue_number,chain,element,radius,area\n"
        "1,CL1,LIG,52A,A,Cl,1.75,12.500000\n"
        "2,C',\"X\"\"Y\",-1,\"A,B\",,2,0.000000\n"
        "3,,,,,,0.1,1000000.000000\n");
}

TEST_CASE("the table of atoms has the names, radii and areas of all atoms", "[residues]") {
  const AtomFile input = read_atoms(ESES_DATA "/fas2.pqr");
  Outputs outputs = Outputs::none();
  outputs.atoms = true;
  std::string first;
  for (const auto& [block_size, threads] : {std::pair(64, 1), std::pair(9, 3)}) {
    const TemporaryDirectory directory;
    const Molecule molecule(input.atoms, input.labels);
    const RunPlan plan = make_plan(
        molecule,
        {.grid = GridOptions{.spacing = 0.8}, .block_size = block_size, .threads = threads},
        outputs);
    const Summary summary = run(molecule, plan.parameters, outputs, directory.path());
    const auto rows = rows_of(directory.path() / "atoms.csv");
    REQUIRE(rows.size() == input.atoms.size() + 1);
    for (std::size_t i = 0; i < input.atoms.size(); ++i) {
      const auto& row = rows[i + 1];
      const AtomLabel& label = input.labels[i];
      REQUIRE(row.size() == 8);
      CHECK(row[0] == std::to_string(i + 1));
      CHECK(row[1] == label.atom_name);
      CHECK(row[2] == label.residue);
      CHECK(row[3] == label.residue_number);
      CHECK(row[4] == label.chain);
      CHECK(row[5] == label.atom_name.substr(0, 1));  // this protein has only H, C, N, O and S
      CHECK(std::stod(row[6]) == input.atoms[i].radius);
      CHECK(std::stod(row[7]) == Catch::Approx(summary.atom_areas[i]).margin(1e-6));
    }
    CHECK(summary.bytes_written == std::filesystem::file_size(directory.path() / "atoms.csv"));
    const std::string bytes = read_bytes(directory.path() / "atoms.csv");
    if (first.empty()) first = bytes;
    CHECK(bytes == first);
  }
}

TEST_CASE("names in tables of CIF files are quoted", "[residues]") {
  const auto name_of = [](const std::string& name) {
    const std::vector<Atom> atoms{{{}, 1}};
    const std::vector<AtomLabel> labels{{"A", "LIG", "1", name, "C"}};
    eses::AtomAreas areas;
    areas.sas = {1};
    std::string text;
    BufferedText table([&text](std::string_view part) { text += part; });
    append_cif({.atoms = atoms,
                .labels = labels,
                .file_indices = {},
                .areas = areas,
                .gradients = {},
                .cavities = {},
                .pieces = {},
                .pockets = {}},
               table);
    table.flush();
    const std::string start = "\nHETATM 1 C ", end = " . LIG A . ";
    const std::size_t begin = text.find(start) + start.size();
    return text.substr(begin, text.find(end) - begin);
  };
  CHECK(name_of("CA") == "CA");
  CHECK(name_of("O5'") == "\"O5'\"");
  CHECK(name_of("A B") == "\"A B\"");
  CHECK(name_of("A\"B") == "'A\"B'");
  CHECK(name_of("A'\"B") == "'A'\"B'");
  CHECK(name_of("A' \"B") == "\"A' \"B\"");
  CHECK(name_of("A' B\" C") == "\n;A' B\" C\n;");
  CHECK(name_of("A\tB") == "\n;A\tB\n;");
  CHECK(name_of("A\nB") == "\n;A\nB\n;");
  for (const std::string name : {"C\xc3\xa9", "A\n;B", "A\rB"}) {
    INFO(name);
    CHECK_THROWS_AS(name_of(name), Error);
  }
}

TEST_CASE("the table of atoms without labels has empty names", "[residues]") {
  const TemporaryDirectory directory;
  // The areas of spheres that are far from each other are 4 pi r^2.
  const std::vector<Atom> atoms{{{0, 0, 0}, 1.5}, {{20, 0, 0}, 2}};
  Outputs outputs = Outputs::none();
  outputs.atoms = true;
  run(atoms, {.grid = GridOptions{.spacing = 0.1, .margin = 0.2}}, outputs, directory.path());
  const auto rows = rows_of(directory.path() / "atoms.csv");
  REQUIRE(rows.size() == 3);
  for (std::size_t i = 0; i < atoms.size(); ++i) {
    const auto& row = rows[i + 1];
    CHECK(std::vector(row.begin(), row.end() - 2) ==
          std::vector<std::string>{std::to_string(i + 1), "", "", "", "", ""});
    CHECK(std::stod(row[6]) == atoms[i].radius);
    CHECK(std::stod(row[7]) ==
          Catch::Approx(4 * std::numbers::pi * atoms[i].radius * atoms[i].radius).epsilon(0.01));
  }
}

TEST_CASE("without labels there are no areas by residue", "[residues]") {
  const TemporaryDirectory directory;
  const std::vector<Atom> atoms{{{0, 0, 0}, 1.5}};
  Outputs outputs;
  outputs.residues = true;
  CHECK_THROWS_AS(run(atoms, {}, outputs, directory.path()), std::invalid_argument);
  CHECK(std::filesystem::is_empty(directory.path()));
}

}  // namespace eses::detail::test
