// Tests of the radii of atoms of PDB and mmCIF files. The references are FreeSASA, MSMS and the
// articles on the radii.

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "eses/error.hpp"
#include "eses/radii.hpp"
#include "eses/residue_areas.hpp"
#include "input/radii_set.hpp"
#include "support/structures.hpp"
#include "support/temporary_directory.hpp"

namespace eses::detail::test {
namespace {

bool has_freesasa() { return std::system("freesasa --version >/dev/null 2>&1") == 0; }

/// Returns the radii that FreeSASA assigns with options, by the columns of the coordinates.
std::map<std::string, double> freesasa_radii(const fs::path& pdb, const std::string& options) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(
      popen(fmt::format("freesasa --shrake-rupley --resolution=1 --hetatm --format=pdb {} '{}' "
                        "2>/dev/null",
                        options, pdb.string())
                .c_str(),
            "r"),
      pclose);
  std::map<std::string, double> radii;
  std::array<char, 512> line{};
  while (fgets(line.data(), line.size(), pipe.get()) != nullptr) {
    const std::string record = line.data();
    if (record.starts_with("ATOM") || record.starts_with("HETATM"))
      radii[record.substr(30, 24)] = std::stod(record.substr(54, 6));
  }
  return radii;
}

/// Compares a set, atom by atom, with FreeSASA's table, which has a title and so many atoms.
void compare_with_table(const std::string& set, const std::string& title, int count) {
  const std::string text = text_of(freesasa_data + set + ".config");
  const auto file = parse_radii_set(text, set);
  CHECK(file.name == title);
  CHECK(file.is_united);
  const auto named = named_radii_set(title).value();
  CHECK(named.name == set);
  CHECK(named.is_united);
  std::istringstream stream(text.substr(text.find("\natoms:") + 7));
  int atoms = 0;
  for (std::string line; std::getline(stream, line);) {
    std::istringstream fields(line.substr(0, line.find('#')));
    std::string residue, atom, type;
    if (!(fields >> residue >> atom >> type)) continue;
    ++atoms;
    const std::string element = atom == "SE" ? "Se" : atom.substr(0, 1);
    const AtomIdentity identity{residue, atom, element};
    const auto expected = file.find(identity), found = named.find(identity);
    INFO(set << ": " << line);
    REQUIRE(expected);
    REQUIRE(found);
    CHECK(found->radius == expected->radius);
    CHECK_FALSE(found->by_element);
    const std::vector<AtomLabel> label{
        {"A", residue, "1", atom, element, named.class_of(identity)}};
    const std::vector<bool> is_polar = find_polar_atoms(std::vector<Atom>(1), label);
    CHECK(is_polar.front() == (file.class_of(identity) == AtomClass::polar));
  }
  CHECK(atoms == count);
}

/// Compares the radii of a set with those that FreeSASA assigns with options, on structures of
/// Debian packages.
void compare_with_freesasa(const std::string& set, const std::string& freesasa_options) {
  std::vector<fs::path> files;
  for (const std::string& folder :
       {freesasa_data + "test-data/", biopython_data, std::string("/usr/share/pymol/data/demo/")})
    if (fs::is_directory(folder))
      for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
  const TemporaryDirectory directory;
  int compared = 0;
  for (const fs::path& path : files) {
    if (!path.filename().string().ends_with(".pdb") &&
        !path.filename().string().ends_with(".pdb.gz"))
      continue;
    const fs::path plain = directory.path() / "plain.pdb";
    std::ofstream(plain) << text_of(path);
    const std::map<std::string, double> expected = freesasa_radii(plain, freesasa_options);
    if (expected.empty()) continue;  // the file has only a header
    StructureOptions options;
    options.radii = set;
    options.with_waters = true;
    const AtomFile ours = read_structure(path, options);
    const Names names = names_of(ours);
    std::size_t found = 0;
    for (std::size_t i = 0; i < ours.atoms.size(); ++i) {
      const auto one = expected.find(columns_of(ours.atoms[i].center));
      // FreeSASA takes the first alternate location, not the one of the highest occupancy.
      if (one == expected.end()) continue;
      ++found;
      // A carbon atom of a_structure.pdb has no element, and its name CA begins in the column of
      // calcium, for which FreeSASA takes it.
      if (one->first == "  -0.189   5.321  14.250") continue;
      INFO(set << ": " << path << ": " << names[i]);
      // FreeSASA's table of NACCESS has only the selenium of selenomethionine.
      if (set == "naccess" && one->second == 1.70 && contains(names[i], "MSE")) {
        CHECK(ours.atoms[i].radius == 1.87);
        continue;
      }
      CHECK(ours.atoms[i].radius == one->second);
    }
    INFO(path);
    if (ours.structure->dropped_altlocs == 0) CHECK(found == expected.size());
    ++compared;
  }
  CHECK(compared >= 4);
}

}  // namespace

TEST_CASE("radii: those of three sets are those of FreeSASA's tables, atom by atom",
          "[structure][radii]") {
  if (!fs::exists(freesasa_data + "protor.config")) SKIP("freesasa is not installed");
  compare_with_table("protor", "ProtOr", 506);
  compare_with_table("naccess", "NACCESS", 203);
  compare_with_table("oons", "OONS", 136);
}

TEST_CASE("naccess and oons: the radii are those of the articles", "[structure][radii]") {
  using Case = std::tuple<std::string, std::string, double, double>;
  const std::vector<Case> cases{
      {"ALA", "C", 1.76, 1.55},   {"ALA", "CB", 1.87, 2.00},  {"PHE", "CZ", 1.76, 1.75},
      {"LYS", "NZ", 1.50, 1.55},  {"ASN", "ND2", 1.65, 1.55}, {"SER", "OG", 1.40, 1.40},
      {"CYS", "SG", 1.85, 2.00},  {"DG", "C8", 1.80, 1.75},   {"DG", "N7", 1.60, 1.55},
      {"DG", "P", 1.90, 1.80},    {"MSE", "CE", 1.87, 2.00},  {"PRO", "CB", 1.87, 1.75},
      {"HIE", "CD2", 1.76, 1.75}, {"DG", "O1P", 1.40, 1.40},  {"LIG", "CA", 1.87, 2.00}};
  const auto naccess = *named_radii_set("naccess"), oons = *named_radii_set("oons");
  for (const auto& [residue, atom, of_naccess, of_oons] : cases) {
    INFO(residue << " " << atom);
    const std::string element = atom.substr(0, 1);
    const AtomIdentity identity{residue, atom, element};
    CHECK(naccess.find(identity).value().radius == of_naccess);
    CHECK(oons.find(identity).value().radius == of_oons);
    CHECK_FALSE(oons.find(identity).value().by_element);
  }
  for (const RadiiSet& set : {naccess, oons}) {
    const auto calcium = set.find({"CA", "CA", "Ca"});
    REQUIRE(calcium);
    CHECK(calcium->by_element);
    CHECK(calcium->radius == 2.31);
    CHECK(set.find({"LIG", "CX", "C"}).value().by_element);
  }
}

TEST_CASE("protor: the radii of atom types are those of the article", "[structure][radii]") {
  // Tsai et al. (1999), table 2, whose name for the set is ProtOr.
  const auto set = named_radii_set("ProtOr").value();
  const auto radius = [&](std::string_view residue, std::string_view atom) {
    return set.find({residue, atom, "X"}).value().radius;
  };
  CHECK(radius("ALA", "C") == 1.61);
  CHECK(radius("PHE", "CZ") == 1.76);
  CHECK(radius("LEU", "CD1") == 1.88);
  CHECK(radius("LYS", "NZ") == 1.64);
  CHECK(radius("GLY", "O") == 1.42);
  CHECK(radius("SER", "OG") == 1.46);
  CHECK(radius("CYS", "SG") == 1.77);
  CHECK_FALSE(set.find({"ALA", "XX", "X"}));
  const auto zinc = set.find({"ZN", "ZN", "Zn"});
  REQUIRE(zinc);
  CHECK(zinc->by_element);
  CHECK(zinc->radius == 1.39);
}

TEST_CASE("bondi: the radii are those of the articles", "[structure][radii]") {
  const auto set = named_radii_set("bondi").value();
  CHECK_FALSE(set.is_united);
  const std::vector<std::pair<std::string, double>> expected{
      {"H", 1.20},  {"C", 1.70},  {"N", 1.55},  {"O", 1.52},  {"F", 1.47},  {"P", 1.80},
      {"S", 1.80},  {"Cl", 1.75}, {"I", 1.98},  {"Zn", 1.39}, {"Cu", 1.40},  // Bondi (1964)
      {"B", 1.92},  {"Al", 1.84}, {"Ca", 2.31}, {"Cs", 3.43},  // Mantina et al. (2009)
      {"Fe", 2.44}, {"Mn", 2.45}, {"Mo", 2.45}, {"Gd", 2.83},  // Alvarez (2013)
      {"D", 1.20}};
  for (const auto& [element, radius] : expected) {
    INFO(element);
    const auto found = set.find({"LIG", "X1", element});
    REQUIRE(found);
    CHECK(found->radius == radius);
    CHECK_FALSE(found->by_element);
  }
  CHECK_FALSE(set.find({"LIG", "X1", "X"}));
  CHECK_FALSE(set.find({"LIG", "X1", "Pm"}));
}

TEST_CASE("msms: united atoms of amino acids have Connolly's radii", "[structure][radii]") {
  // Connolly's united radii; OG of serine has a hydrogen, ND1 of histidine has none.
  const auto set = named_radii_set("msms").value();
  CHECK(set.is_united);
  const std::vector<std::tuple<std::string, std::string, double>> expected{
      {"ALA", "N", 1.70},   {"ALA", "CA", 2.00},  {"ALA", "C", 1.74},   {"ALA", "O", 1.40},
      {"ALA", "OXT", 1.40}, {"ARG", "CZ", 1.74},  {"ARG", "NH1", 1.80}, {"ARG", "NE", 1.70},
      {"ASN", "CG", 1.74},  {"ASN", "ND2", 1.80}, {"GLN", "CD", 1.74},  {"LYS", "CD", 2.00},
      {"HIS", "ND1", 1.54}, {"HIS", "NE2", 1.70}, {"HIS", "CE1", 1.86}, {"LYS", "NZ", 2.00},
      {"MET", "SD", 1.80},  {"PHE", "CG", 1.74},  {"PHE", "CZ", 1.86},  {"SER", "OG", 1.60},
      {"TRP", "CD2", 1.74}, {"TRP", "CH2", 1.86}, {"TYR", "OH", 1.60},  {"VAL", "CG1", 2.00},
      {"HOH", "O", 1.60},   {"DA", "P", 1.80},    {"MSE", "SE", 2.15},  {"ZN", "ZN", 1.40}};
  for (const auto& [residue, atom, radius] : expected) {
    INFO(residue << " " << atom);
    const auto found = set.find({residue, atom, "X"});
    REQUIRE(found);
    CHECK(found->radius == radius);
  }
  CHECK(set.find({"ALA", "HA", "H", true}).value().radius == 1.20);
  CHECK_FALSE(set.find({"XE", "XE", "X"}));
}

TEST_CASE("msms: the atoms of 1A8O are those of MSMS", "[structure][radii]") {
  // Biopython's tests contain the output of pdb_to_xyzr of MSMS.
  const fs::path reference = biopython_data + "1A8O.xyzr.gz";
  if (!fs::exists(reference)) SKIP("python-biopython-doc is not installed");
  StructureOptions options;
  options.radii = "msms";
  options.with_waters = true;
  const AtomFile ours = read_structure(biopython_data + "1A8O.pdb.gz", options);
  const AtomFile theirs = parse_atoms(text_of(reference), AtomFormat::xyzr, "1A8O.xyzr");
  REQUIRE(ours.atoms.size() == theirs.atoms.size());
  const Names names = names_of(ours);
  for (std::size_t i = 0; i < ours.atoms.size(); ++i) {
    INFO(names[i]);
    CHECK(ours.atoms[i].center == theirs.atoms[i].center);
    CHECK(ours.atoms[i].radius == theirs.atoms[i].radius);
  }
}

TEST_CASE("radii: FreeSASA assigns the same radii", "[structure][radii][freesasa]") {
  if (!has_freesasa()) SKIP("freesasa is not installed");
  compare_with_freesasa("protor", "--radii=protor");
  compare_with_freesasa("naccess", "--radii=naccess");
  compare_with_freesasa("oons", "--config-file=" + freesasa_data + "oons.config");
}

TEST_CASE("a file of radii in FreeSASA's format is read", "[structure][radii]") {
  const std::string text =
      "# a comment\nname: mine\r\n\ntypes:\nC_ALI 2.00 apolar\nO 1.4 polar # oxygen\n"
      "atoms:\nANY CA C_ALI\nALA O O\nALA CA O\n";
  const auto set = parse_radii_set(text, "mine.config");
  CHECK(set.name == "mine");
  CHECK(set.is_united);
  CHECK(set.find({"GLY", "CA", "C"}).value().radius == 2.0);
  CHECK(set.class_of({"GLY", "CA", "C"}) == AtomClass::apolar);
  CHECK(set.class_of({"gly", "ca", "C"}) == AtomClass::apolar);
  CHECK(set.class_of({"ALA", "O", "O"}) == AtomClass::polar);
  CHECK(set.class_of({"GLY", "CB", "C"}) == AtomClass::none);
  CHECK(set.find({"ALA", "CA", "C"}).value().radius == 1.4);
  const auto other = parse_radii_set("types:\nC 1.8 backbone\natoms:\nANY CA C\n", "dssp.config");
  CHECK(other.find({"ALA", "CA", "C"}).value().radius == 1.8);
  CHECK(other.class_of({"ALA", "CA", "C"}) == AtomClass::none);
  CHECK(set.find({"GLY", "O", "O"}).value().by_element);
  CHECK_FALSE(parse_radii_set(text + "ALA HA O\n", "mine.config").is_united);
  const auto error = [](const std::string& bad) {
    return error_of([&] { parse_radii_set(bad, "f"); });
  };
  // FreeSASA, too, ignores text after the third field and accepts repeated entries.
  const auto repeated = parse_radii_set(
      "types:\nC 1 apolar more\nC2 1 polar\natoms:\nALA CA C more\nALA CA C2\n", "f");
  CHECK(repeated.find({"ALA", "CA", "C"}).value().radius == 1.0);
  // FreeSASA takes the first of two different radii and warns.
  CHECK(error("types:\nC 2 apolar\nO 1.4 polar\natoms:\nANY CA C\nALA CA O\nANY CA O\n") ==
        "f:7: the atom \"CA\" of \"ANY\" has another radius already, 2; remove one of the entries");
  CHECK(error("types:\nC 1000.1 apolar\n") ==
        "f:2: expected a radius from 0 to 1000 angstrom, found \"1000.1\"");
  CHECK(contains(error("types:\nC 1000 apolar\n"), "f: no atoms found"));
  CHECK(contains(error("types:\nC nan apolar\n"), "f:2: expected a radius"));
  CHECK(contains(error("types:\nC inf apolar\n"), "f:2: expected a radius"));
  CHECK(contains(error("types:\nC x apolar\n"),
                 "f:2: expected a radius from 0 to 1000 angstrom, found \"x\""));
  CHECK(contains(error("types:\nC -1 apolar\n"), "f:2: expected a radius"));
  CHECK(contains(error("types:\nC 1\n"), "f:2: expected three fields"));
  CHECK(
      contains(error("types:\nC 1 polar\nC 2 polar\n"), "f:3: the type \"C\" has another radius"));
  CHECK(contains(error("atoms:\nALA CA C\n"), "f:2: the type \"C\" has no radius"));
  CHECK(contains(error("ALA CA C\n"), "f:1: expected types:, atoms: or name:"));
  CHECK(contains(error("types:\nC 1 polar\n"), "f: no atoms found"));
  CHECK(contains(error(""), "f: no atoms found"));
}

TEST_CASE("radii: ions have Shannon's radii of six neighbours", "[radii]") {
  const std::array<std::tuple<const char*, const char*, const char*, double>, 19> ions{
      {{"NA", "NA", "Na", 1.02},
       {"K", "K", "K", 1.38},
       {"MG", "MG", "Mg", 0.72},
       {"CA", "CA", "Ca", 1.00},
       {"ZN", "ZN", "Zn", 0.74},
       {"FE", "FE", "Fe", 0.645},
       {"FE2", "FE", "Fe", 0.78},
       {"CU1", "CU", "Cu", 0.77},
       {"CU", "CU", "Cu", 0.73},
       {"CU3", "CU", "Cu", 0.54},
       {"PT", "PT", "Pt", 0.80},
       {"PT4", "PT", "Pt", 0.625},
       {"IR", "IR", "Ir", 0.625},
       {"6MO", "MO", "Mo", 0.59},
       {"3CO", "CO", "Co", 0.545},
       {"CL", "CL", "Cl", 1.81},
       {"IOD", "I", "I", 2.20},
       {"Na+", "Na+", "Na", 1.02},
       {"SOD", "SOD", "Na", 1.02}}};
  for (const char* base : {"protor", "bondi", "msms", "naccess", "oons"}) {
    const RadiiSet plain = *named_radii_set(base);
    const RadiiSet set = *named_radii_set(std::string(base) + "+shannon");
    CHECK(set.name == std::string(base) + "+shannon");
    CHECK(set.is_united == plain.is_united);
    for (const auto& [residue, atom, element, radius] : ions) {
      INFO(base << ' ' << residue);
      const FoundRadius found = set.find({residue, atom, element, false}).value();
      CHECK(found.radius == radius);
      CHECK_FALSE(found.by_element);
    }
    // Iron of heme, a carbon of a protein, and an element without a radius.
    for (const AtomIdentity& other :
         {AtomIdentity{"HEM", "FE", "Fe"}, AtomIdentity{"ALA", "CA", "C"},
          AtomIdentity{"MO", "MO", "Mo"}})
      CHECK(set.find(other).value().radius == plain.find(other).value().radius);
  }
  for (const char* name : {"occupancy+shannon", "shannon", "+shannon", "bondi+shannon+shannon"})
    CHECK_FALSE(named_radii_set(name));
  StructureOptions options;
  options.radii = "Bondi+Shanon";
  CHECK(pdb_error(line_of({}), options).ends_with("; did you mean bondi+shannon?"));
  options.radii = "shannon";
  CHECK(pdb_error(line_of({}), options).ends_with("; did you mean protor+shannon?"));
  const TemporaryDirectory directory;
  const std::string file = (directory.path() / "own.radii").string();
  std::ofstream(file) << "types:\nC 1.9 apolar\natoms:\nALA CA C\nZN ZN C\n";
  const RadiiSet own = find_radii_set(file + "+Shannon");
  CHECK(own.name == "unnamed+shannon");
  CHECK(own.is_from_file);
  CHECK(own.find({"ALA", "CA", "C"}).value().radius == 1.9);
  CHECK(own.find({"ZN", "ZN", "Zn"}).value().radius == 0.74);
  CHECK(find_radii_set(file).find({"ZN", "ZN", "Zn"}).value().radius == 1.9);
  CHECK(radii_file(file + "+shannon") == file);
  std::ofstream(file + "+shannon") << "types:\nC 1.8 apolar\natoms:\nALA CA C\n";
  CHECK(find_radii_set(file + "+shannon").find({"ALA", "CA", "C"}).value().radius == 1.8);
  for (const char* name : {"protor+ccd", "ProtOr+shannon+CCD"}) {
    options.radii = name;
    CHECK(pdb_error(line_of({}), options).find("radii: +ccd needs the Chemical Component") == 0);
  }
}

TEST_CASE("radii: a name or a file is accepted, and other text refused", "[structure][radii]") {
  const std::string text = line_of({});
  StructureOptions options;
  options.radii = "bondy";
  CHECK(contains(pdb_error(text, options),
                 "radii: expected protor, bondi, msms, naccess, oons, one of them with +shannon, "
                 "occupancy, or a file"));
  CHECK(pdb_error(text, options).ends_with("; did you mean bondi?"));
  options.radii = "OOSN";
  CHECK(pdb_error(text, options).ends_with("; did you mean oons?"));
  options.radii = "far/from/all.config";
  CHECK_FALSE(contains(pdb_error(text, options), "did you mean"));
  options.radii = std::string(300, 'A');  // longer than the name of a file can be
  CHECK(contains(pdb_error(text, options),
                 "radii: expected protor, bondi, msms, naccess, oons, one of them with +shannon, "
                 "occupancy, or a file"));
  const TemporaryDirectory directory;
  const fs::path file = directory.path() / "my.config";
  std::ofstream(file) << "types:\nT 3.5 apolar\natoms:\nANY CA T\n";
  options.radii = file.string();
  CHECK(read_pdb(text, options).atoms.at(0).radius == 3.5);
  std::ofstream(file) << "nonsense\n";
  CHECK(contains(pdb_error(text, options), file.string() + ":1: expected types:"));
}

TEST_CASE("radii: those in place of occupancies are read as they are written",
          "[structure][radii]") {
  StructureOptions options;
  options.radii = "occupancy";
  const std::string text =
      line_of({.occupancy = 1.88}) +
      line_of({.name = " HA ", .number = "   2 ", .x = 9, .occupancy = 1.2, .element = " H"}) +
      line_of({.record = "HETATM", .name = " CA ", .residue = "XYZ", .x = 20, .occupancy = 0});
  const AtomFile file = read_pdb(text, options);
  REQUIRE(file.atoms.size() == 3);
  CHECK(file.atoms[0].radius == 1.88);
  CHECK(file.atoms[1].radius == 1.2);
  CHECK(file.atoms[2].radius == 0);
  CHECK(file.structure->radii == "occupancy");
  CHECK(file.structure->by_element.empty());
  CHECK(pdb_error(line_of({.occupancy = -1}), options) ==
        "t.pdb:1: expected a radius from 0 to 1000 angstrom in place of the occupancy, found -1");
  CHECK(pdb_error(line_of({}), options) ==
        "t.pdb: no atom has an occupancy above 1, so they are no radii; choose a set of radii");
  std::string blank = line_of({});
  blank.replace(54, 6, "      ");
  CHECK(contains(pdb_error(blank, options),
                 "t.pdb:1: expected a number for the radius in columns 55 to 60, found \"\""));
  const std::string row = "ATOM 1 C CA . ALA A 1 1 ? 1 2 3 {} 20 1 A 1\n";
  CHECK(read_mmcif(mmcif_head + fmt::format(fmt::runtime(row), "1.234"), options)
            .atoms.at(0)
            .radius == 1.234);
  CHECK(contains(
      error_of([&] { read_mmcif(mmcif_head + fmt::format(fmt::runtime(row), "?"), options); }),
      "expected a number for the radius in _atom_site.occupancy"));
  const std::vector<AtomLabel> labels{{"A", "ALA", "1", "CA", "C"}};
  CHECK(contains(error_of([&] { find_radii(labels, "occupancy"); }), "needs a PDB or mmCIF file"));
}

TEST_CASE("atoms without a radius are named", "[structure][radii]") {
  const std::string text = line_of({}) + line_of({.record = "HETATM",
                                                  .name = " X1 ",
                                                  .residue = "UNX",
                                                  .number = "   2 ",
                                                  .x = 9,
                                                  .element = " X"});
  CHECK(pdb_error(text).starts_with(
      "t.pdb:2: 1 atom is without a radius in the set protor: UNX X1;"));
  StructureOptions options;
  options.unknown_radius = 1.25;
  const AtomFile file = read_pdb(text, options);
  REQUIRE(file.atoms.size() == 2);
  CHECK(file.atoms[1].radius == 1.25);
  REQUIRE(file.structure->unknown.size() == 1);
  CHECK(file.structure->unknown[0].residue == "UNX");
  CHECK(file.structure->unknown[0].radius == 1.25);
}

TEST_CASE("names of force fields have the radii of the standard residues", "[structure][radii]") {
  using Case = std::tuple<std::string, std::string, std::string, std::string>;
  const std::vector<Case> cases{
      {"HIE", "CD2", "HIS", "CD2"}, {"HSD", "CA", "HIS", "CA"},  {"HSE", "ND1", "HIS", "ND1"},
      {"HSP", "CE1", "HIS", "CE1"}, {"HID", "O", "HIS", "O"},    {"HIP", "CB", "HIS", "CB"},
      {"CYX", "SG", "CYS", "SG"},   {"CYM", "CB", "CYS", "CB"},  {"CYS2", "SG", "CYS", "SG"},
      {"ASH", "OD2", "ASP", "OD2"}, {"ASPP", "CG", "ASP", "CG"}, {"GLH", "OE1", "GLU", "OE1"},
      {"LYN", "NZ", "LYS", "NZ"},   {"NHIE", "CA", "HIS", "CA"}, {"CALA", "OXT", "ALA", "OXT"},
      {"hie", "ca", "HIS", "CA"},   {"ALA", "OT1", "ALA", "O"},  {"GLY", "OC2", "GLY", "OXT"},
      {"ILE", "CD", "ILE", "CD1"},  {"DA5", "C8", "DA", "C8"},   {"DT", "C5M", "DT", "C7"},
      {"RU3", "O2'", "U", "O2'"},   {"DG", "O1P", "DG", "OP1"},  {"DG", "C1*", "DG", "C1'"},
      {"ARN", "CZ", "ARG", "CZ"},   {"HISE", "CG", "HIS", "CG"}, {"TYM", "OH", "TYR", "OH"}};
  const RadiiSet file = parse_radii_set(
      "types:\nA 1.11 polar\nB 1.22 polar\natoms:\nHIS CD2 A\nHIE CD2 B\nHIS CA A\nANY CA B\n"
      "ANY OXT B\nANY O A\n",
      "radii");
  const RadiiSet protor = *named_radii_set("protor");
  for (const auto& [residue, atom, same_residue, same_atom] : cases) {
    CAPTURE(residue, atom);
    const auto found = protor.find({residue, atom, "C"});
    const auto expected = protor.find({same_residue, same_atom, "C"});
    REQUIRE(found);
    CHECK_FALSE(found->by_element);
    CHECK(found->radius == expected->radius);
  }
  CHECK(file.find({"HIE", "CD2", "C"})->radius == 1.22);
  CHECK(file.find({"HSD", "CD2", "C"})->radius == 1.11);
  CHECK(file.find({"HSD", "CA", "C"})->radius == 1.11);
  CHECK(file.find({"CYX", "CA", "C"})->radius == 1.22);
  CHECK(file.find({"ALA", "OT2", "O"})->radius == 1.22);
  // Other residues have atoms of these names, too.
  CHECK(file.find({"GOL", "O1", "O"})->by_element);
  CHECK(protor.find({"GOL", "O1", "O"})->by_element);
  CHECK(max_sas_area("HSD") == max_sas_area("HIS"));
  CHECK(max_sas_area("NCYX") == max_sas_area("CYS"));
  // Homoserine has the name of a histidine.
  const std::vector<AtomLabel> histidine{{"", "HSE", "1", "CA"}, {"", "HSE", "1", "NE2"}},
      homoserine{{"", "HSE", "1", "CA"}, {"", "HSE", "1", "OD"}};
  CHECK(max_sas_area(histidine) == max_sas_area("HIS"));
  CHECK(max_sas_area(homoserine) == std::nullopt);
  CHECK(max_sas_area(std::span<const AtomLabel>()) == std::nullopt);
  for (const auto& [residue, same] : {std::pair("MSE", "MET"), std::pair("SEC", "CYS"),
                                      std::pair("DTR", "TRP"), std::pair("MED", "MET")})
    CHECK(max_sas_area(residue) == max_sas_area(same));
  for (const char* modified : {"SEP", "HYP", "DA", "HEM"})
    CHECK(max_sas_area(modified) == std::nullopt);
  // A nucleotide of Amber has the name of D-glutamine.
  const std::vector<AtomLabel> glutamine{{"", "DGN", "1", "CA"}, {"", "DGN", "1", "CD"}},
      guanosine{{"", "DGN", "1", "C1'"}, {"", "DGN", "1", "N9"}};
  CHECK(max_sas_area(glutamine) == max_sas_area("GLN"));
  CHECK(max_sas_area(guanosine) == std::nullopt);
}

TEST_CASE("find_radii: radii of named atoms, and what was guessed", "[radii]") {
  const std::vector<AtomLabel> atoms{
      {.chain = "A", .residue = "ALA", .residue_number = "1", .atom_name = "CA", .element = "C"},
      {.chain = "A", .residue = "ZN", .residue_number = "2", .atom_name = "ZN", .element = "Zn"},
      {.chain = "A", .residue = "SER", .residue_number = "3", .atom_name = "OG"},
      {.chain = "A", .residue = "ALA", .residue_number = "4", .atom_name = "D", .element = "D"},
      {.chain = "A", .residue = "UNX", .residue_number = "5", .atom_name = "?1"}};
  const NamedRadii found = find_radii(atoms);
  CHECK(found.set == "protor");
  CHECK(found.are_united);
  REQUIRE(found.atoms.size() == 5);
  CHECK(found.atoms[0].radius == 1.88);
  CHECK_FALSE(found.atoms[0].is_by_element);
  CHECK(found.atoms[1].is_by_element);
  CHECK(found.atoms[2].radius == 1.46);
  CHECK(found.atoms[2].element == "O");
  CHECK(found.atoms[2].is_element_by_name);
  CHECK(found.atoms[3].element == "H");
  CHECK(std::isnan(found.atoms[4].radius));
  CHECK_FALSE(find_radii(atoms, "bondi").are_united);
  CHECK_THROWS_AS(find_radii(atoms, "bondy"), Error);
}

}  // namespace eses::detail::test
