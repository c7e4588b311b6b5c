// Tests of PQR files: their recognition, models and numbers.

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "catch.hpp"
#include "input/other_formats.hpp"
#include "support/structures.hpp"
#include "support/temporary_directory.hpp"

namespace eses::detail::test {

TEST_CASE("PDB: PQR files are recognised", "[structure][pqr]") {
  const std::string message =
      "t.pdb: this is a PQR file: its records end with charge and radius instead of occupancy and "
      "B-factor; read it with --format pqr";
  for (const std::string name : {"fas2.pqr", "mache.pqr", "boxb.pqr"}) {
    INFO(name);
    CHECK(pdb_error(text_of(ESES_DATA "/" + name)) == message);
  }
  // Whitespace instead of columns.
  CHECK(pdb_error("ATOM 1 N ALA A 1 1.0 2.0 3.0 -0.3 1.5\n") == message);
  // Charge and radius in the columns of occupancy and B-factor: nearly half of the charges of a
  // protein are negative.
  const auto record = [](double charge, double radius) {
    return line_of({}).substr(0, 54) + fmt::format("{:6.2f}{:6.2f}\n", charge, radius);
  };
  CHECK(pdb_error(record(-0.3, 1.82) + record(0.33, 0.6) + record(0.02, 1.91)) == message);
  // Files of other programs have B-factors of 0, or charges as B-factors.
  CHECK(read_pdb(record(1, 0)).atoms.size() == 1);
  CHECK(read_pdb(record(1, 1.5) + record(0.5, 2)).atoms.size() == 2);
  CHECK(read_pdb(record(0, -0.3) + record(0, 0.3)).atoms.size() == 2);
}

TEST_CASE("PDB: files of other programs are not taken for PQR files", "[structure][pqr]") {
  int read = 0;
  for (const std::string& folder :
       {freesasa_data + "test-data/", biopython_data, std::string("/usr/share/pymol/data/demo/")}) {
    if (!fs::is_directory(folder)) continue;
    for (const auto& entry : fs::directory_iterator(folder)) {
      const std::string suffix = input_suffix(entry.path());
      if (suffix != ".pdb" && suffix != ".ent") continue;
      INFO(entry.path());
      const std::string error = error_of([&] { read_structure(entry.path()); });
      CHECK_FALSE(contains(error, "PQR"));
      ++read;
    }
  }
  if (read == 0) SKIP("no PDB files are installed");
  CHECK(read >= 4);
}

TEST_CASE("PQR: a file with several models needs a chosen one", "[structure][pqr]") {
  const auto model = [](int number, double x) {
    return fmt::format("MODEL        {}\nATOM 1 N ALA A 1 {} 0 0 0.1 1.5\nENDMDL\n", number, x);
  };
  const auto read = [](const std::string& text, int number = 0) {
    StructureOptions options;
    options.model = number;
    return parse_atoms(text, AtomFormat::pqr, "t.pqr", options);
  };
  CHECK(read(model(1, 0)).atoms.size() == 1);
  CHECK(read("ATOM 1 N ALA A 1 0 0 0 0.1 1.5\n", 1).atoms.size() == 1);
  const std::string two = model(1, 0) + model(2, 7);
  CHECK(error_of([&] { read(two); }) ==
        "t.pqr: 2 models, whose atoms lie on top of each other; choose one with --model N");
  CHECK(read(two, 2).atoms.at(0).center.x == 7);
  CHECK(read(two, 2).lines.at(0) == 5);
  CHECK(contains(error_of([&] { read(two, 3); }), "no ATOM or HETATM records found in model 3"));
  CHECK(contains(error_of([&] { read("MODEL x\n" + two); }), "t.pqr:1: expected the number"));
}

TEST_CASE("PQR: models are found in parts of a file", "[structure][pqr]") {
  // The text is long enough to be read in several parts.
  std::string text;
  for (int model = 1; model <= 3; ++model) {
    text += fmt::format("MODEL        {}\n", model);
    for (int i = 0; i < 10000; ++i)
      text += fmt::format("ATOM  {} N ALA A {} {} {} 0 0.1 1.5\n", i, i % 1000, i, model);
    text += "ENDMDL\n";
  }
  const TemporaryDirectory directory;
  const fs::path path = directory.path() / "models.pqr";
  std::ofstream(path) << text;
  StructureOptions options;
  options.model = 2;
  const AtomFile file = read_structure(path, options);
  REQUIRE(file.atoms.size() == 10000);
  for (const auto& atom : file.atoms) REQUIRE(atom.center.y == 2);
  CHECK(contains(error_of([&] { read_structure(path); }), "3 models"));
}

TEST_CASE("PQR: numbers behind the radius are refused", "[structure][pqr]") {
  const auto read = [](const std::string& text) {
    return parse_atoms(text, AtomFormat::pqr, "t.pqr");
  };
  const std::string expected = "t.pqr:1: more than five numbers, expected x y z charge radius";
  CHECK(
      error_of([&] { read("ATOM 1 N ALA A 1 1.0 2.0 3.0 0.1 1.5 9.5\n"); }).starts_with(expected));
  CHECK(error_of([&] { read("ATOM 1 N ALA 1 1.0 2.0 3.0 0.1 1.5 9.5\n"); }).starts_with(expected));
  // Coordinates without a decimal point.
  CHECK(error_of([&] { read("ATOM 1 N ALA A 1 1 2 3 0.1 1.5 9.5\n"); }).starts_with(expected));
  CHECK(error_of([&] { read("ATOM 1 N ALA A 1 0 0 3 1 1 9.5\n"); }).starts_with(expected));
  CHECK(read("ATOM 1 N ALA A 1 B 2.0 3 4 0.1 1.5\n").atoms.at(0).center.x == 2);
  CHECK(read("ATOM 1 N ALA 1 7 2 3 4 0.1 1.5\n").atoms.at(0).center.x == 2);
  // In columns, coordinates may run together.
  const std::string columns =
      "ATOM      1  N   ALA A   1    -100.000-100.000-100.000  0.1000 1.5000";
  CHECK(read(columns + "\n").atoms.at(0).radius == 1.5);
  CHECK(error_of([&] { read(columns + "  9.5\n"); }).starts_with(expected));
  CHECK(read("ATOM 1 N ALA A 1 1.0 2.0 3.0 0.1 1.5 N\n").atoms.at(0).radius == 1.5);
}

}  // namespace eses::detail::test
