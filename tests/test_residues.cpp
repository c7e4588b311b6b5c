// Tests of the areas of residues and chains: tables with sums of the atoms' areas.

#include <filesystem>
#include <numeric>
#include <sstream>
#include <string>
#include <vector>

#include "catch.hpp"
#include "eses/error.hpp"
#include "eses/read_atoms.hpp"
#include "output/area_table_writer.hpp"
#include "support/eses_files.hpp"
#include "support/run.hpp"
#include "support/temporary_directory.hpp"

namespace eses::detail::test {
namespace {

AtomLabel label(const char* chain, const char* number, const char* residue) {
  return {chain, residue, number, "CA"};
}

std::string tables_of(const std::vector<AtomLabel>& labels, const std::vector<double>& areas) {
  std::string text;
  const TextSink sink = [&text](std::string_view piece) { text += piece; };
  BufferedText residues(sink);
  AreaTables tables;
  append_residue_header(residues);
  add_residues(tables, residue_runs(labels), areas, residues);
  end_residues(tables, residues);
  residues.flush();
  write_chain_table(tables.chains.chains(), sink);
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
  parameters.spacing = 0.8;
  Outputs outputs{.box = true, .grid = false, .edges = false, .areas = true, .residues = true};
  const Plan plan = make_plan(input.atoms, parameters, outputs);
  const Summary summary =
      run({input.atoms, input.labels}, plan.parameters, outputs, directory.path());

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

TEST_CASE("without labels there are no areas by residue", "[residues]") {
  const TemporaryDirectory directory;
  const std::vector<Atom> atoms{{{0, 0, 0}, 1.5}};
  Outputs outputs;
  outputs.residues = true;
  CHECK_THROWS_AS(run(atoms, {}, outputs, directory.path()), Error);
  CHECK(std::filesystem::is_empty(directory.path()));
}

}  // namespace eses::detail::test
