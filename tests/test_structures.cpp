// Tests of PDB and mmCIF files: records that are read and left out, and the radii of atoms. The
// references are the wwPDB's formats, FreeSASA, MSMS and the articles on the radii.

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "eses/error.hpp"
#include "eses/read_atoms.hpp"
#include "input/other_formats.hpp"
#include "input/radii_set.hpp"
#include "support/sandbox.hpp"
#include "support/temporary_directory.hpp"

namespace fs = std::filesystem;

namespace {

using eses::AtomFile;
using eses::AtomFormat;
using eses::HydrogenChoice;
using eses::ReadOptions;
using eses::StructureOptions;
using eses::detail::test::TemporaryDirectory;

const std::string freesasa_data = "/usr/share/freesasa/";
const std::string biopython_data = "/usr/share/doc/python-biopython-doc/Tests/PDB/";
const std::string crystal = ESES_TEST_DATA "/1a8o.cif.gz";

/// A record of a PDB file.
struct PdbAtom {
  std::string record = "ATOM", name = " CA ";
  char altloc = ' ';
  std::string residue = "ALA", chain = "A", number = "   1 ";
  double x = 0, y = 0, z = 0, occupancy = 1;
  std::string element = " C";
};

std::string line_of(const PdbAtom& a) {
  return fmt::format(
      "{:<6}{:>5} {}{}{:>3} {}{}   {:8.3f}{:8.3f}{:8.3f}{:6.2f}{:6.2f}          {}\n", a.record, 1,
      a.name, a.altloc, a.residue, a.chain, a.number, a.x, a.y, a.z, a.occupancy, 20.0, a.element);
}

AtomFile read_pdb(std::string_view text, const StructureOptions& options = {}) {
  return eses::parse_atoms(text, AtomFormat::pdb, "t.pdb", options);
}

AtomFile read_mmcif(std::string_view text, const StructureOptions& options = {}) {
  return eses::parse_atoms(text, AtomFormat::mmcif, "t.cif", options);
}

AtomFile read_file(const fs::path& path, const StructureOptions& options = {}) {
  ReadOptions all;
  all.structure = options;
  return eses::read_atoms(path, all);
}

std::string error_of(const auto& action) {
  try {
    action();
  } catch (const eses::Error& error) {
    return error.what();
  }
  return "";
}

std::string pdb_error(std::string_view text, const StructureOptions& options = {}) {
  return error_of([&] { read_pdb(text, options); });
}

bool contains(const std::string& text, std::string_view part) {
  return text.find(part) != std::string::npos;
}

/// Returns the label of each atom, such as `A ALA 1 CA`.
std::vector<std::string> names_of(const AtomFile& file) {
  std::vector<std::string> names;
  for (const auto& [chain, residue, number, name, element] : file.labels)
    names.push_back(fmt::format("{} {} {} {}", chain, residue, number, name));
  return names;
}

using Names = std::vector<std::string>;

const std::string mmcif_head = R"(data_TEST
loop_
_atom_site.group_PDB
_atom_site.id
_atom_site.type_symbol
_atom_site.label_atom_id
_atom_site.label_alt_id
_atom_site.label_comp_id
_atom_site.label_asym_id
_atom_site.label_entity_id
_atom_site.label_seq_id
_atom_site.pdbx_PDB_ins_code
_atom_site.Cartn_x
_atom_site.Cartn_y
_atom_site.Cartn_z
_atom_site.occupancy
_atom_site.B_iso_or_equiv
_atom_site.auth_seq_id
_atom_site.auth_asym_id
_atom_site.pdbx_PDB_model_num
)";

/// Returns the text of a gzipped or plain file.
std::string text_of(const fs::path& path) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(
      popen(fmt::format("gzip -dcf '{}'", path.string()).c_str(), "r"), pclose);
  std::string text;
  std::array<char, 65536> buffer{};
  for (std::size_t count = 0; (count = fread(buffer.data(), 1, buffer.size(), pipe.get())) > 0;)
    text.append(buffer.data(), count);
  return text;
}

bool has_freesasa() { return std::system("freesasa --version >/dev/null 2>&1") == 0; }

/// Returns the radii that FreeSASA assigns, by the columns of the coordinates.
std::map<std::string, double> freesasa_radii(const fs::path& pdb) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(
      popen(fmt::format(
                "freesasa --shrake-rupley --resolution=1 --hetatm --format=pdb '{}' 2>/dev/null",
                pdb.string())
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

std::string columns_of(const eses::Vec3& at) {
  return fmt::format("{:8.3f}{:8.3f}{:8.3f}", at.x, at.y, at.z);
}

}  // namespace

// ---------------------------------------------------------------------------------------- radii

TEST_CASE("protor: the radii are those of FreeSASA's table, atom by atom", "[structure][radii]") {
  const fs::path path = freesasa_data + "protor.config";
  if (!fs::exists(path)) SKIP("freesasa is not installed");
  const std::string text = text_of(path);
  const auto file = eses::detail::parse_radii_set(text, "protor.config");
  CHECK(file.name == "ProtOr");
  CHECK(file.is_united);
  const auto named = eses::detail::named_radii_set("protor").value();
  std::istringstream stream(text.substr(text.find("\natoms:") + 7));
  int atoms = 0;
  for (std::string line; std::getline(stream, line);) {
    std::istringstream fields(line.substr(0, line.find('#')));
    std::string residue, atom, type;
    if (!(fields >> residue >> atom >> type)) continue;
    ++atoms;
    const eses::detail::AtomIdentity identity{residue, atom, "X"};
    const auto expected = file.find(identity), found = named.find(identity);
    INFO(line);
    REQUIRE(expected);
    REQUIRE(found);
    CHECK(found->radius == expected->radius);
    CHECK_FALSE(found->by_element);
  }
  CHECK(atoms == 506);
}

TEST_CASE("protor: the radii of atom types are those of the article", "[structure][radii]") {
  // Tsai et al. (1999), table 2, whose name for the set is ProtOr.
  const auto set = eses::detail::named_radii_set("ProtOr").value();
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
  const auto set = eses::detail::named_radii_set("bondi").value();
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
  const auto set = eses::detail::named_radii_set("msms").value();
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
  const AtomFile ours = read_file(biopython_data + "1A8O.pdb.gz", options);
  const AtomFile theirs = eses::parse_atoms(text_of(reference), AtomFormat::xyzr, "1A8O.xyzr");
  REQUIRE(ours.atoms.size() == theirs.atoms.size());
  const Names names = names_of(ours);
  for (std::size_t i = 0; i < ours.atoms.size(); ++i) {
    INFO(names[i]);
    CHECK(ours.atoms[i].center == theirs.atoms[i].center);
    CHECK(ours.atoms[i].radius == theirs.atoms[i].radius);
  }
}

TEST_CASE("protor: FreeSASA assigns the same radii", "[structure][radii][freesasa]") {
  if (!has_freesasa()) SKIP("freesasa is not installed");
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
    const std::map<std::string, double> expected = freesasa_radii(plain);
    if (expected.empty()) continue;  // the file has only a header
    StructureOptions options;
    options.with_waters = true;
    const AtomFile ours = read_file(path, options);
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
      INFO(path << ": " << names[i]);
      CHECK(ours.atoms[i].radius == one->second);
    }
    INFO(path);
    if (ours.structure->dropped_altlocs == 0) CHECK(found == expected.size());
    ++compared;
  }
  CHECK(compared >= 4);
}

TEST_CASE("a file of radii in FreeSASA's format is read", "[structure][radii]") {
  const std::string text =
      "# a comment\nname: mine\r\n\ntypes:\nC_ALI 2.00 apolar\nO 1.4 polar # oxygen\n"
      "atoms:\nANY CA C_ALI\nALA O O\nALA CA O\n";
  const auto set = eses::detail::parse_radii_set(text, "mine.config");
  CHECK(set.name == "mine");
  CHECK(set.is_united);
  CHECK(set.find({"GLY", "CA", "C"}).value().radius == 2.0);
  CHECK(set.find({"ALA", "CA", "C"}).value().radius == 1.4);
  CHECK(set.find({"GLY", "O", "O"}).value().by_element);
  CHECK_FALSE(eses::detail::parse_radii_set(text + "ALA HA O\n", "mine.config").is_united);
  const auto error = [](const std::string& bad) {
    return error_of([&] { eses::detail::parse_radii_set(bad, "f"); });
  };
  // FreeSASA, too, ignores text after the third field and accepts repeated entries.
  const auto repeated = eses::detail::parse_radii_set(
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
  CHECK(contains(error("types:\nC 1 odd\n"), "f:2: expected polar or apolar, found \"odd\""));
  CHECK(contains(error("types:\nC 1\n"), "f:2: expected three fields"));
  CHECK(
      contains(error("types:\nC 1 polar\nC 2 polar\n"), "f:3: the type \"C\" has another radius"));
  CHECK(contains(error("atoms:\nALA CA C\n"), "f:2: the type \"C\" has no radius"));
  CHECK(contains(error("ALA CA C\n"), "f:1: expected types:, atoms: or name:"));
  CHECK(contains(error("types:\nC 1 polar\n"), "f: no atoms found"));
  CHECK(contains(error(""), "f: no atoms found"));
}

TEST_CASE("radii: a name or a file is accepted, and other text refused", "[structure][radii]") {
  const std::string text = line_of({});
  StructureOptions options;
  options.radii = "bondy";
  CHECK(contains(pdb_error(text, options), "radii: expected protor, bondi or msms, or a file"));
  options.radii = std::string(300, 'A');  // longer than the name of a file can be
  CHECK(contains(pdb_error(text, options), "radii: expected protor, bondi or msms, or a file"));
  const TemporaryDirectory directory;
  const fs::path file = directory.path() / "my.config";
  std::ofstream(file) << "types:\nT 3.5 apolar\natoms:\nANY CA T\n";
  options.radii = file.string();
  CHECK(read_pdb(text, options).atoms.at(0).radius == 3.5);
  std::ofstream(file) << "nonsense\n";
  CHECK(contains(pdb_error(text, options), file.string() + ":1: expected types:"));
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

// ------------------------------------------------------------------------------------------ PDB

TEST_CASE("PDB: atoms have their labels and lines", "[structure]") {
  const std::string text =
      "REMARK nothing\n" + line_of({.number = "  52A", .x = 1.5}) + "TER\n" +
      line_of({.name = " O  ", .chain = "B", .number = "  -1 ", .z = -2, .element = " O"}) +
      "END\n";
  const AtomFile file = read_pdb(text);
  CHECK(names_of(file) == Names{"A ALA 52A CA", "B ALA -1 O"});
  CHECK(file.lines == std::vector<std::uint64_t>{2, 4});
  REQUIRE(file.atoms.size() == 2);
  CHECK(file.atoms[0].center == eses::Vec3{1.5, 0, 0});
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

}  // namespace

namespace {

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

namespace {

std::string mixed_text() {
  return line_of({}) + line_of({.name = " HA ", .x = 1, .element = " H"}) +
         line_of({.chain = "B", .x = 20}) +
         line_of({.record = "HETATM",
                  .name = " C1 ",
                  .residue = "LIG",
                  .chain = "B",
                  .number = " 900 ",
                  .x = 40}) +
         line_of({.record = "HETATM",
                  .name = " O  ",
                  .residue = "HOH",
                  .chain = "B",
                  .number = " 901 ",
                  .x = 60,
                  .element = " O"});
}

}  // namespace

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
  options.select = "//[";
  CHECK(contains(pdb_error(text, options), "--select: invalid selection syntax"));
  // A keyword of another program is no selection, although a chain may have the name of a word.
  for (const std::string word : {"resi", "resi 10", "chain A", "protein"}) {
    options.select = word;
    CHECK(
        pdb_error(text, options) ==
        fmt::format("t.pdb: --select: invalid selection syntax, expected the name of a chain or a "
                    "selection such as //A/10-20, found \"{}\"; its chains are A, B",
                    word));
  }
  options.select = "//A";
  const std::vector<std::uint64_t> lines = read_pdb(text, options).lines;
  options.select = "A";
  CHECK(read_pdb(text, options).lines == lines);
  options.select = "/2/A";
  CHECK(contains(pdb_error(text, options), "use --model 2"));
  options.select = "//Z";
  CHECK(contains(pdb_error(text, options), "t.pdb: no atoms left of 5; left out: 5 not selected"));
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

// ---------------------------------------------------------------------------------------- mmCIF

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
        "files of small molecules; convert it with `obabel FILE -O FILE.pdb`");
  CHECK(error("data_ALA\n_chem_comp.id ALA\nloop_\n_chem_comp_atom.comp_id\n"
              "_chem_comp_atom.atom_id\nALA N\n") ==
        "t.cif: no atoms found; this is the definition of a chemical component "
        "(_chem_comp_atom); convert it with `gemmi convert FILE FILE.pdb`");
  const TemporaryDirectory directory;
  const fs::path path = directory.path() / "empty.cif";
  std::ofstream(path) << "";
  REQUIRE(std::system(fmt::format("gzip '{}'", path.string()).c_str()) == 0);
  const std::string packed = path.string() + ".gz";
  CHECK(error_of([&] { read_file(packed); }) ==
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
  options.hydrogens = eses::HydrogenChoice::keep;
  CHECK(read_mmcif(atom_table(columns, rows), options).atoms.size() == 1);
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
  CHECK(quoted.atoms.at(0).center == eses::Vec3{1.5, -2, 3.25});
  CHECK(quoted.structure->models == 1);
  const std::string unknown = mmcif_head + "ATOM 1 C CA ? ALA A ? ? ? 1 2 3 ? ? ? ? ?\n";
  CHECK(names_of(read_mmcif(unknown)) == Names{" ALA ? CA"});
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
  // The same in mmCIF.
  const std::vector<std::string> columns{"type_symbol", "label_atom_id", "label_comp_id",
                                         "auth_seq_id", "label_alt_id",  "Cartn_x",
                                         "Cartn_y",     "Cartn_z"};
  CHECK(read_mmcif(atom_table(columns,
                              "C C1 LIG 1 . 0 0 0\nC C1 LIG 1 . 5 0 0\nC C1 LIG 1 A 9 0 0\n"
                              "C C1 LIG 1 B 9.5 0 0\nO OW SOL 2 . 20 0 0\nO OW SOL 2 . 25 0 0\n"))
            .atoms.size() == 3);
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
  CHECK(file.atoms[0].center == eses::Vec3{1, 2, 3});
  CHECK(file.atoms[0].radius == 1.88);
  CHECK(file.atoms[1].radius == 1.42);
  // Occupancies of 1 and no alternate locations.
  StructureOptions options;
  options.select = ";q=1";
  CHECK(read_mmcif(atom_table(columns, rows), options).atoms.size() == 2);
  for (std::size_t i = 0; i < 8; ++i) {
    if (columns[i] == "auth_asym_id") continue;
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
  const AtomFile aligned = read_file(path), entry = read_file(biopython_data + "7CFN.cif.gz");
  // PyMOL has moved the atoms.
  const Names names = names_of(aligned), expected = names_of(entry);
  CHECK(std::multiset<std::string>(names.begin(), names.end()) ==
        std::multiset<std::string>(expected.begin(), expected.end()));
  CHECK(names.size() > 5000);
}

TEST_CASE("mmCIF: a crystal structure with modified residues is read", "[structure]") {
  // The C-terminal domain of a capsid protein: 70 residues, four of them selenomethionine.
  const AtomFile file = read_file(crystal);
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
    const AtomFile pdb = read_file(biopython_data + entry + ".pdb.gz");
    const AtomFile mmcif = read_file(biopython_data + entry + ".cif.gz");
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

// ----------------------------------------------------------------------------------- assemblies

TEST_CASE("an assembly has copies with names of their own", "[structure]") {
  StructureOptions options;
  options.assembly = "1";
  const AtomFile one = read_file(crystal), file = read_file(crystal, options);
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
      const eses::Vec3 d = file.atoms[a].center - file.atoms[b].center;
      return std::sqrt(dot(d, d));
    };
    CHECK(std::fabs(distance(0, i) - distance(n, n + i)) < 1e-3);
    CHECK(file.lines[i] == file.lines[n + i]);
    CHECK(file.atoms[i].radius == file.atoms[n + i].radius);
  }
  options.assembly = "2";
  CHECK(contains(error_of([&] { read_file(crystal, options); }),
                 "there is no assembly \"2\" (--assembly); its assemblies are 1"));
}

namespace {

const std::string dimer_remarks =
    "REMARK 350\n"
    "REMARK 350 BIOMOLECULE: 1\n"
    "REMARK 350 APPLY THE FOLLOWING TO CHAINS: A\n"
    "REMARK 350   BIOMT1   1  1.000000  0.000000  0.000000        0.00000\n"
    "REMARK 350   BIOMT2   1  0.000000  1.000000  0.000000        0.00000\n"
    "REMARK 350   BIOMT3   1  0.000000  0.000000  1.000000        0.00000\n"
    "REMARK 350   BIOMT1   2 -1.000000  0.000000  0.000000        0.00000\n"
    "REMARK 350   BIOMT2   2  0.000000 -1.000000  0.000000        0.00000\n"
    "REMARK 350   BIOMT3   2  0.000000  0.000000  1.000000       10.00000\n";

}  // namespace

TEST_CASE("an assembly of a PDB file has copies", "[structure]") {
  const std::string text =
      dimer_remarks + line_of({.x = 3, .y = 4, .z = 5}) + line_of({.chain = "B", .x = 30});
  StructureOptions options;
  options.assembly = "1";
  const AtomFile file = read_pdb(text, options);
  CHECK(names_of(file) == Names{"A ALA 1 CA", "A-2 ALA 1 CA"});
  CHECK(file.atoms.at(1).center == eses::Vec3{-3, -4, 15});
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

namespace {

/// Returns an mmCIF text with the chain A at (1, 2, 3), the chain B at (4, 5, 6), and an assembly
/// X with an operator expression. The operator R is a rotation around the z axis, T and the
/// numbers 1 to 3 are translations along x.
std::string text_with_assembly(const std::string& expression, const std::string& chains = "A,B") {
  const auto translation = [](const std::string& name, int x) {
    return fmt::format("{} 1 0 0 {} 0 1 0 0 0 0 1 0\n", name, x);
  };
  return mmcif_head +
         "ATOM 1 C CA . ALA A 1 1 ? 1 2 3 1.0 20 1 A 1\nATOM 2 C CA . ALA B 1 1 ? 4 5 6 1.0 20 1 B "
         "1\n"
         "_pdbx_struct_assembly.id X\n"
         "_pdbx_struct_assembly.details 'icosahedral asymmetric unit'\n"
         "loop_\n_pdbx_struct_assembly_gen.assembly_id\n_pdbx_struct_assembly_gen.oper_expression\n"
         "_pdbx_struct_assembly_gen.asym_id_list\nX \"" +
         expression + "\" " + chains +
         "\nother (undefined) A\nloop_\n_pdbx_struct_oper_list.id\n"
         "_pdbx_struct_oper_list.matrix[1][1]\n_pdbx_struct_oper_list.matrix[1][2]\n"
         "_pdbx_struct_oper_list.matrix[1][3]\n_pdbx_struct_oper_list.vector[1]\n"
         "_pdbx_struct_oper_list.matrix[2][1]\n_pdbx_struct_oper_list.matrix[2][2]\n"
         "_pdbx_struct_oper_list.matrix[2][3]\n_pdbx_struct_oper_list.vector[2]\n"
         "_pdbx_struct_oper_list.matrix[3][1]\n_pdbx_struct_oper_list.matrix[3][2]\n"
         "_pdbx_struct_oper_list.matrix[3][3]\n_pdbx_struct_oper_list.vector[3]\n"
         "R 0 -1 0 0 1 0 0 0 0 0 1 0\nbad 1 0 0 ? 0 1 0 0 0 0 1 0\n" +
         translation("T", 100) + translation("1", 10) + translation("2", 20) + translation("3", 30);
}

}  // namespace

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

  CHECK(others(read_file(crystal)) == Names{"1 2 556"});
  CHECK(others(read_mmcif(text_with_assembly("(1-3)(T)"))) == Names{"X 3 2"});
  CHECK(others(read_mmcif(text_with_assembly("1"))).empty());
  CHECK(others(read_mmcif(text_with_assembly("1", "B"))) == Names{"X 1 1"});
  CHECK(others(read_mmcif(text_with_assembly("1,undefined"))).empty());
}

TEST_CASE("operator expressions of mmCIF files are expanded", "[structure]") {
  StructureOptions options;
  options.assembly = "X";
  using Centers = std::vector<eses::Vec3>;
  const auto centers = [&](const std::string& expression, const std::string& chains = "A") {
    Centers result;
    for (const eses::Atom& atom : read_mmcif(text_with_assembly(expression, chains), options).atoms)
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
        "water, 1 of HETATM records, 1 not in the assembly");
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

// --------------------------------------------------------------------------- files and formats

TEST_CASE("suffixes and contents decide how structures are read", "[structure]") {
  const TemporaryDirectory directory;
  const std::string text = line_of({});
  for (const std::string name : {"a.pdb", "a.ent", "A.PDB", "a.pdb1", "a.PDB12"}) {
    std::ofstream(directory.path() / name) << text;
    CHECK(read_file(directory.path() / name).atoms.size() == 1);
  }
  const std::string cif = text_of(crystal);
  for (const std::string name : {"a.cif", "a.mmcif", "a.mcif", "a.pdbx"}) {
    std::ofstream(directory.path() / name) << cif;
    CHECK(read_file(directory.path() / name).atoms.size() == 556);
  }
  CHECK(error_of([&] { read_pdb(cif); }) ==
        "t.pdb: this is an mmCIF file; read it with --format mmcif");
  CHECK(error_of([&] { read_mmcif("HEADER    X\n" + text); }) ==
        "t.cif: this is a PDB file; read it with --format pdb");
  CHECK(error_of([&] { eses::parse_atoms(cif, AtomFormat::xyzr, "t"); }) ==
        "t: this is an mmCIF file; read it with --format mmcif");
  CHECK(error_of([&] { eses::parse_atoms("HEADER    X\n" + text, AtomFormat::xyzr, "t"); }) ==
        "t: this is a PDB file; read it with --format pdb");
}

TEST_CASE("assembly files with several models need a chosen model", "[structure]") {
  const TemporaryDirectory directory;
  const std::string text = "MODEL        1\n" + line_of({.x = 1}) + "ENDMDL\nMODEL        2\n" +
                           line_of({.x = 2}) + "ENDMDL\n";
  const auto write = [&](const std::string& name) {
    const fs::path path = directory.path() / name;
    std::ofstream(path) << text;
    return path;
  };
  for (const std::string name : {"1abc.pdb1", "1ABC.PDB12"})
    CHECK(contains(error_of([&] { read_file(write(name)); }),
                   name + ": 2 models, which are the copies of an assembly in files of this "
                          "suffix; read one with --model N, or build the assembly from the "
                          "entry's PDB or mmCIF file with --assembly ID"));
  const fs::path path = write("1abc.pdb2");
  REQUIRE(std::system(fmt::format("gzip -k '{}'", path.string()).c_str()) == 0);
  CHECK(contains(error_of([&] { read_file(path.string() + ".gz"); }), ".pdb2.gz: 2 models"));
  StructureOptions options;
  options.model = 2;
  CHECK(read_file(path, options).atoms.at(0).center.x == 2);
  // Models of other files are usual, and names of texts have no meaning.
  CHECK(read_file(write("1abc.pdb")).atoms.size() == 1);
  CHECK(eses::parse_atoms(text, AtomFormat::pdb, "1abc.pdb1").atoms.size() == 1);
  // The suffix .pdb and a letter is none of these.
  CHECK(contains(error_of([&] { read_file(write("1abc.pdb1x")); }), "expected a number"));
}

TEST_CASE("byte order marks of structures are ignored, and other encodings are refused",
          "[structure]") {
  const std::string mark = "\xef\xbb\xbf";
  const std::string pdb = line_of({.x = 1}) + line_of({.name = " CB ", .x = 2});
  CHECK(names_of(read_pdb(mark + pdb)) == Names{"A ALA 1 CA", "A ALA 1 CB"});
  const std::string cif = text_with_assembly("1");
  CHECK(read_mmcif(mark + cif).atoms.size() == 2);
  CHECK(read_mmcif(mark + cif).lines == read_mmcif(cif).lines);
  // The format is recognised behind the mark.
  CHECK(contains(pdb_error(mark + cif), "this is an mmCIF file"));
  CHECK(error_of([&] { eses::parse_atoms(mark + cif, AtomFormat::xyzr, "t"); }) ==
        "t: this is an mmCIF file; read it with --format mmcif");
  CHECK(contains(pdb_error(mark + "ATOM  xx\n" + pdb), "t.pdb:1: "));
  using namespace std::string_view_literals;
  for (const auto& [encoding, start] : {std::pair("UTF-16"sv,
                                                  "\xff\xfe"
                                                  "A\0T\0O\0M\0"sv),
                                        {"UTF-16"sv, "\xfe\xff\0A\0T\0O\0M"sv},
                                        {"UTF-32"sv,
                                         "\xff\xfe\0\0"
                                         "A\0\0\0"sv},
                                        {"UTF-32"sv, "\0\0\xfe\xff\0\0\0A"sv}}) {
    const std::string message =
        fmt::format(":1: {} text; convert the file to UTF-8 first", encoding);
    CHECK(pdb_error(start) == "t.pdb" + message);
    CHECK(error_of([&, text = start] { read_mmcif(text); }) == "t.cif" + message);
  }
}

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
      const std::string suffix = eses::detail::input_suffix(entry.path());
      if (suffix != ".pdb" && suffix != ".ent") continue;
      INFO(entry.path());
      const std::string error = error_of([&] { read_file(entry.path()); });
      CHECK_FALSE(contains(error, "PQR"));
      ++read;
    }
  }
  if (read == 0) SKIP("no PDB files are installed");
  CHECK(read >= 4);
}

TEST_CASE("damaged gzip files are refused", "[structure]") {
  const TemporaryDirectory directory;
  std::ifstream stream(crystal, std::ios::binary);
  const std::string packed{std::istreambuf_iterator<char>(stream), {}};
  const fs::path path = directory.path() / "cut.cif.gz";
  std::ofstream(path, std::ios::binary) << packed.substr(0, packed.size() / 2);
  CHECK(contains(error_of([&] { read_file(path); }), "the compressed data ends too early"));
  std::string damaged = packed;
  for (std::size_t i = damaged.size() / 2; i < damaged.size() / 2 + 8; ++i) damaged[i] = '\xff';
  std::ofstream(path, std::ios::binary) << damaged;
  CHECK(contains(error_of([&] { read_file(path); }), "the compressed data is damaged"));
}

TEST_CASE("compressed files other than gzip are refused by name", "[structure]") {
  const TemporaryDirectory directory;
  const auto error = [&](const std::string& name, std::string_view bytes) {
    const fs::path path = directory.path() / name;
    std::ofstream(path, std::ios::binary) << bytes;
    const std::string message = error_of([&] { read_file(path); });
    return message.substr(std::min(message.size(), directory.path().string().size() + 1));
  };
  const auto advice = [](const std::string& name, const std::string& command) {
    return fmt::format("a.{} files are not read; decompress the file, for example with `{} FILE`",
                       name, command);
  };
  using namespace std::string_view_literals;
  // The first bytes that the programs write.
  CHECK(error("a.pdb", "BZh91AY&SY\x12\x34") == advice("pdb: bzip2", "bzip2 -d"));
  CHECK(error("a.bz2", "BZh11AY&SY\x12\x34") == advice("bz2: bzip2", "bzip2 -d"));
  CHECK(error("a.cif", "\xfd\x37zXZ\0\0\x04"sv) == advice("cif: xz", "xz -d"));
  CHECK(error("a.zst", "\x28\xb5\x2f\xfd\x04\x88") == advice("zst: Zstandard", "zstd -d"));
  CHECK(error("a.pqr", "PK\x03\x04\x14\0"sv) == advice("pqr: ZIP", "unzip"));
  // Other text and short files are unchanged.
  CHECK(error("a.xyzr", "BZhello\n") ==
        "a.xyzr:1: field 1 (x): expected a number, found \"BZhello\"");
  CHECK(error("a.xyzr", "BZh") == "a.xyzr:1: field 1 (x): expected a number, found \"BZh\"");
  CHECK(error("a.xyzr", "0 0 0 1").empty());
  for (const std::string program : {"bzip2", "xz", "zstd"}) {
    if (std::system(fmt::format("command -v {} >/dev/null", program).c_str()) != 0) continue;
    INFO(program);
    const fs::path plain = directory.path() / "b.pdb", packed = directory.path() / "b.packed";
    std::ofstream(plain) << line_of({});
    REQUIRE(std::system(fmt::format("{} -c '{}' > '{}'", program, plain.string(), packed.string())
                            .c_str()) == 0);
    CHECK(contains(error_of([&] { read_file(packed); }), "files are not read; decompress"));
  }
}

TEST_CASE("reading structures keeps the limit of memory", "[structure]") {
  std::string text;
  for (int i = 0; i < 200000; ++i) text += line_of({.x = i * 0.01, .y = i * 0.001});
  const TemporaryDirectory directory;
  const fs::path path = directory.path() / "big.pdb";
  std::ofstream(path) << text;
  ReadOptions options;
  options.max_memory = 1 << 20;
  const std::string message = error_of([&] { eses::read_atoms(path, options); });
  CHECK(contains(message, "reading the file exceeds the memory limit of 1 MiB"));
}

TEST_CASE("formats that are not read are refused with a command that converts them",
          "[structure]") {
  const auto by_suffix = [](const std::string& name) {
    return error_of([&] { eses::detail::refuse_other_suffix(name); });
  };
  CHECK(by_suffix("a.mol2") ==
        "a.mol2: Tripos MOL2 files are not read; convert it with `obabel FILE -O FILE.pdb`");
  CHECK(contains(by_suffix("a.SDF.gz"), "obabel"));
  CHECK(contains(by_suffix("a.gro"), "gmx editconf"));
  CHECK(contains(by_suffix("a.xtc"), "gmx trjconv"));
  CHECK(contains(by_suffix("a.prmtop"), "ambpdb"));
  CHECK(contains(by_suffix("a.json"), "gemmi convert"));
  for (const std::string name : {"a.nc", "a.ncrst", "a.NCDF"})
    CHECK(contains(by_suffix(name),
                   ": Amber NetCDF files are not read; write the first frame with "
                   "`cpptraj -p TOPOLOGY.prmtop -y FILE -ya '1 1' -x FILE.pdb`"));
  CHECK(contains(by_suffix("a.rst"), "Amber restart"));
  CHECK(contains(by_suffix("a.top"), "GROMACS or Amber topology"));
  CHECK(contains(by_suffix("a.pse"), "`pymol -cq FILE -d 'save FILE.pdb'`"));
  CHECK(contains(by_suffix("a.cxs"), "`chimerax --nogui --exit --cmd"));
  CHECK(contains(by_suffix("a.h5"), "HDF5"));
  CHECK(contains(by_suffix("a.h5md"), "mdconvert"));
  for (const std::string name : {"a.xyz", "a.pdbqt", "a.dcd", "a.trr", "a.psf", "a.mmtf", "a.bcif",
                                 "a.mol", "a.crd", "a.mae"})
    CHECK(contains(by_suffix(name), "files are not read"));
  for (const std::string name : {"a", "a.xyzr", "a.pqr", "a.pdb", "a.cif", "a.txt", "-"})
    CHECK(by_suffix(name).empty());

  const auto by_content = [](std::string_view text) {
    return error_of([&] { eses::parse_atoms(text, AtomFormat::xyzr, "t"); });
  };
  CHECK(contains(by_content("# made by\n@<TRIPOS>MOLECULE\nx\n"), "t: Tripos MOL2"));
  CHECK(
      contains(by_content("water\n  obabel\n\n  3  2  0  0  0  0  0  0  0  0999 V2000\n"), "MDL"));
  CHECK(contains(by_content("%VERSION  VERSION_STAMP = V0001.000\n"), "Amber"));
  CHECK(contains(by_content("PSF CMAP\n\n"), "CHARMM PSF"));
  CHECK(contains(by_content("{\"data_1ABC\": {"), "mmJSON"));
  CHECK(contains(by_content(std::string_view("\x54\0\0\0CORD\0\0", 10)), "DCD"));
  CHECK(contains(by_content(std::string_view("\0\0\x07\xcb\0\0", 6)), "GROMACS trajectory"));
  CHECK(contains(by_content("CDF\1\0\0"), "Amber NetCDF"));
  CHECK(contains(by_content("CDF\2\0\0"), "Amber NetCDF"));
  CHECK(contains(by_content("\x89HDF\r\n\x1a\n"), "HDF5"));
  CHECK(contains(by_content("\xde\x01\xabmmtfVersion\xa3"), "MMTF"));
  CHECK(contains(by_content("\x83\xa7"
                            "encoder\xa3"),
                 "BinaryCIF"));
  // A format that the user gives is used.
  const TemporaryDirectory directory;
  const fs::path path = directory.path() / "spheres.xyz";
  std::ofstream(path) << "0 0 0 1\n";
  CHECK(contains(error_of([&] { eses::read_atoms(path); }), "XYZ files are not read"));
  CHECK(eses::read_atoms(path, {.format = AtomFormat::xyzr}).atoms.size() == 1);
}

// ------------------------------------------------------------------------------------------ PQR

TEST_CASE("PQR: a file with several models needs a chosen one", "[structure][pqr]") {
  const auto model = [](int number, double x) {
    return fmt::format("MODEL        {}\nATOM 1 N ALA A 1 {} 0 0 0.1 1.5\nENDMDL\n", number, x);
  };
  const auto read = [](const std::string& text, int number = 0) {
    StructureOptions options;
    options.model = number;
    return eses::parse_atoms(text, AtomFormat::pqr, "t.pqr", options);
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
  const AtomFile file = read_file(path, options);
  REQUIRE(file.atoms.size() == 10000);
  for (const auto& atom : file.atoms) REQUIRE(atom.center.y == 2);
  CHECK(contains(error_of([&] { read_file(path); }), "3 models"));
}

TEST_CASE("PQR: numbers behind the radius are refused", "[structure][pqr]") {
  const auto read = [](const std::string& text) {
    return eses::parse_atoms(text, AtomFormat::pqr, "t.pqr");
  };
  const std::string expected = "t.pqr:1: more than five numbers, expected x y z charge radius";
  CHECK(
      error_of([&] { read("ATOM 1 N ALA A 1 1.0 2.0 3.0 0.1 1.5 9.5\n"); }).starts_with(expected));
  CHECK(error_of([&] { read("ATOM 1 N ALA 1 1.0 2.0 3.0 0.1 1.5 9.5\n"); }).starts_with(expected));
  // In columns, coordinates may run together.
  const std::string columns =
      "ATOM      1  N   ALA A   1    -100.000-100.000-100.000  0.1000 1.5000";
  CHECK(read(columns + "\n").atoms.at(0).radius == 1.5);
  CHECK(error_of([&] { read(columns + "  9.5\n"); }).starts_with(expected));
  CHECK(read("ATOM 1 N ALA A 1 1.0 2.0 3.0 0.1 1.5 N\n").atoms.at(0).radius == 1.5);
}

// ----------------------------------------------------------------------------------- the program

using eses::detail::test::check_json;
using eses::detail::test::Outcome;
using eses::detail::test::Sandbox;

TEST_CASE("the program reads a PDB file and reports the atoms that it leaves out",
          "[structure][cli]") {
  const Sandbox sandbox;
  eses::detail::test::write_file(sandbox.directory() / "m.pdb", mixed_text());
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
  eses::detail::test::write_file(
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

TEST_CASE("areas of residues and chains of PDB files are written", "[structure][cli]") {
  const Sandbox sandbox;
  eses::detail::test::write_file(sandbox.directory() / "m.pdb", mixed_text());
  REQUIRE(
      sandbox.run({"m.pdb", "--write", "residues", "--mesh", "m.ply", "--color", "chain"}).code ==
      0);
  const std::string table = eses::detail::test::read_file(sandbox.directory() / "residue_area.csv");
  CHECK(table.starts_with("chain,residue_number,residue,atoms,area\nA,1,ALA,1,"));
  CHECK(contains(table, "\nB,1,ALA,1,"));
  CHECK(contains(table, "\nB,900,LIG,1,"));
  const std::string mesh = eses::detail::test::read_file(sandbox.directory() / "m.ply");
  CHECK(contains(mesh, "comment chain 1 B\n"));
  CHECK(contains(mesh, "comment residue 2 LIG 900 B\n"));
}

TEST_CASE("the program names the assemblies of a file", "[structure][cli]") {
  const Sandbox sandbox;
  eses::detail::test::write_file(sandbox.directory() / "a.pdb", dimer_remarks + line_of({}));
  eses::detail::test::write_file(sandbox.directory() / "ab.pdb",
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
    return is_whole ? alpha + line_of({.name = " CB ", .number = text, .x = 3.8 * number, .y = 1.5})
                    : alpha;
  };
  const auto diagnostics = [](const std::string& text) { return read_pdb(text).diagnostics; };
  const std::string trace = residue(1, false) + residue(2, false);
  const std::string ligands = line_of({.record = "HETATM", .residue = "LIG", .y = 9}) +
                              line_of({.record = "HETATM", .residue = " ZN", .y = 18});
  // Ligands and ions do not count.
  REQUIRE(diagnostics(ligands + trace + residue(3, true)).size() == 1);
  const eses::Diagnostic found = diagnostics(ligands + trace + residue(3, true)).front();
  CHECK(found.kind == eses::DiagnosticKind::one_atom_residue);
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
  eses::detail::test::write_file(sandbox.directory() / "trace.pdb", trace);
  const std::string message =
      "trace.pdb: 2 residues have a single atom, as in models of C-alpha atoms; area and volume "
      "are "
      "not those of the whole molecule: lines 1, A/ALA 1/CA; 2, A/ALA 2/CA\n";
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
  eses::detail::test::write_file(sandbox.directory() / "wet.pqr", text);
  const AtomFile file = eses::parse_atoms(text, AtomFormat::pqr, "t.pqr");
  REQUIRE(file.diagnostics.size() == 1);
  CHECK(file.diagnostics[0].kind == eses::DiagnosticKind::water);
  CHECK(file.diagnostics[0].count == 3);
  REQUIRE(file.diagnostics[0].examples.size() == 3);
  CHECK(file.diagnostics[0].examples[0].atom == 1);
  CHECK(file.diagnostics[0].examples[2].atom == 3);
  CHECK(eses::parse_atoms("ATOM 1 N ALA A 1 0 0 0 0.1 1.5\n", AtomFormat::pqr).diagnostics.empty());

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
  eses::detail::test::write_file(sandbox.directory() / "m.pdb", text);
  const Outcome outcome = sandbox.run({"m.pdb", "--write", "none"});
  REQUIRE(outcome.code == 0);
  CHECK(contains(outcome.err, "line 2, A/ALA 33/CB (near 1, A/ALA 33/CA)"));
  const Outcome json = sandbox.run({"m.pdb", "--write", "none", "--json"});
  check_json(sandbox, json.out, "r['diagnostics'][0]['first'][0]['label']", "'A/ALA 33/CB'");
  check_json(sandbox, json.out, "r['diagnostics'][0]['first'][0]['other_label']", "'A/ALA 33/CA'");
}

TEST_CASE("options of structure files are refused for xyzr files", "[structure][cli]") {
  const Sandbox sandbox;
  eses::detail::test::write_file(sandbox.directory() / "a.xyzr", "0 0 0 1\n");
  eses::detail::test::write_file(sandbox.directory() / "a.pqr", "ATOM 1 N ALA A 1 0 0 0 0.1 1.5\n");
  for (const std::vector<std::string>& option :
       std::vector<std::vector<std::string>>{{"--radii", "bondi"},
                                             {"--unknown-radius", "1"},
                                             {"--model", "1"},
                                             {"--altloc", "A"},
                                             {"--waters"},
                                             {"--no-hetatm"},
                                             {"--hydrogens", "keep"},
                                             {"--chains", "A"},
                                             {"--select", "//A"},
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
                                             {"--hydrogens", "some"},
                                             {"--radii", ""},
                                             {"--format", "mol2"}}) {
    std::vector<std::string> arguments{"a.pdb"};
    arguments.insert(arguments.end(), option.begin(), option.end());
    INFO(option[0]);
    CHECK(sandbox.run(arguments).code == 2);
  }
}
