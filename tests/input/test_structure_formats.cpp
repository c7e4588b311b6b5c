// Tests of the recognition of formats and encodings, and of files that are damaged or not read.

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <ios>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>

#include "catch.hpp"
#include "input/other_formats.hpp"
#include "support/structures.hpp"
#include "support/temporary_directory.hpp"

namespace eses::detail::test {

TEST_CASE("suffixes and contents decide how structures are read", "[structure]") {
  const TemporaryDirectory directory;
  const std::string text = line_of({});
  for (const std::string name : {"a.pdb", "a.ent", "A.PDB", "a.pdb1", "a.PDB12"}) {
    std::ofstream(directory.path() / name) << text;
    CHECK(read_structure(directory.path() / name).atoms.size() == 1);
  }
  const std::string cif = text_of(crystal);
  for (const std::string name : {"a.cif", "a.mmcif", "a.mcif", "a.pdbx"}) {
    std::ofstream(directory.path() / name) << cif;
    CHECK(read_structure(directory.path() / name).atoms.size() == 556);
  }
  CHECK(error_of([&] { read_pdb(cif); }) ==
        "t.pdb: this is an mmCIF file; read it with --format mmcif");
  CHECK(error_of([&] { read_mmcif("HEADER    X\n" + text); }) ==
        "t.cif: this is a PDB file; read it with --format pdb");
  CHECK(error_of([&] { parse_atoms(cif, AtomFormat::xyzr, "t"); }) ==
        "t: this is an mmCIF file; read it with --format mmcif");
  CHECK(error_of([&] { parse_atoms("HEADER    X\n" + text, AtomFormat::xyzr, "t"); }) ==
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
    CHECK(contains(error_of([&] { read_structure(write(name)); }),
                   name + ": 2 models, which are the copies of an assembly in files of this "
                          "suffix; read one with --model N, or build the assembly from the "
                          "entry's PDB or mmCIF file with --assembly ID"));
  const fs::path path = write("1abc.pdb2");
  REQUIRE(std::system(fmt::format("gzip -k '{}'", path.string()).c_str()) == 0);
  CHECK(contains(error_of([&] { read_structure(path.string() + ".gz"); }), ".pdb2.gz: 2 models"));
  StructureOptions options;
  options.model = 2;
  CHECK(read_structure(path, options).atoms.at(0).center.x == 2);
  // Models of other files are usual, and names of texts have no meaning.
  CHECK(read_structure(write("1abc.pdb")).atoms.size() == 1);
  CHECK(parse_atoms(text, AtomFormat::pdb, "1abc.pdb1").atoms.size() == 1);
  // The suffix .pdb and a letter is none of these.
  CHECK(contains(error_of([&] { read_structure(write("1abc.pdb1x")); }), "expected a number"));
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
  CHECK(error_of([&] { parse_atoms(mark + cif, AtomFormat::xyzr, "t"); }) ==
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

TEST_CASE("damaged gzip files are refused", "[structure]") {
  const TemporaryDirectory directory;
  std::ifstream stream(crystal, std::ios::binary);
  const std::string packed{std::istreambuf_iterator<char>(stream), {}};
  const fs::path path = directory.path() / "cut.cif.gz";
  std::ofstream(path, std::ios::binary) << packed.substr(0, packed.size() / 2);
  CHECK(contains(error_of([&] { read_structure(path); }), "the compressed data ends too early"));
  std::string damaged = packed;
  for (std::size_t i = damaged.size() / 2; i < damaged.size() / 2 + 8; ++i) damaged[i] = '\xff';
  std::ofstream(path, std::ios::binary) << damaged;
  CHECK(contains(error_of([&] { read_structure(path); }), "the compressed data is damaged"));
}

TEST_CASE("compressed files other than gzip are refused by name", "[structure]") {
  const TemporaryDirectory directory;
  const auto error = [&](const std::string& name, std::string_view bytes) {
    const fs::path path = directory.path() / name;
    std::ofstream(path, std::ios::binary) << bytes;
    const std::string message = error_of([&] { read_structure(path); });
    return message.substr(std::min(message.size(), directory.path().string().size() + 1));
  };
  const auto advice = [&](const std::string& name, const std::string& command) {
    return fmt::format("a.{} files are not read; decompress the file, for example with `{} {}`",
                       name, command,
                       (directory.path() / ("a." + name.substr(0, name.find(':')))).string());
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
  for (const std::string options : {"-cf", "-czf"}) {
    const std::string folder = directory.path().string();
    std::ofstream(directory.path() / "1.pdb") << line_of({});
    REQUIRE(std::system(
                fmt::format("tar {1} '{0}/all.pdb' -C '{0}' 1.pdb", folder, options).c_str()) == 0);
    CHECK(error_of([&] { read_structure(directory.path() / "all.pdb"); }) ==
          fmt::format(
              "{0}/all.pdb: tar archives are not read; unpack it with `tar -xf {0}/all.pdb`, and "
              "choose a file of it",
              folder));
  }
  for (const std::string program : {"bzip2", "xz", "zstd"}) {
    if (std::system(fmt::format("command -v {} >/dev/null", program).c_str()) != 0) continue;
    INFO(program);
    const fs::path plain = directory.path() / "b.pdb", packed = directory.path() / "b.packed";
    std::ofstream(plain) << line_of({});
    REQUIRE(std::system(fmt::format("{} -c '{}' > '{}'", program, plain.string(), packed.string())
                            .c_str()) == 0);
    CHECK(contains(error_of([&] { read_structure(packed); }), "files are not read; decompress"));
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
  const std::string message = error_of([&] { read_atoms(path, options); });
  CHECK(contains(message, "reading the file exceeds the memory limit of 1 MiB"));
}

TEST_CASE("formats that are not read are refused with a command that converts them",
          "[structure]") {
  const auto by_suffix = [](const std::string& name) {
    return error_of([&] { refuse_other_suffix(name); });
  };
  CHECK(by_suffix("a.mol2") ==
        "a.mol2: Tripos MOL2 files are not read; convert it with `obabel a.mol2 -O a.pdb`, or use "
        "`eses.measure` in Python, which reads it with RDKit (doc/molecules.md)");
  CHECK(by_suffix("-x 1.mol2") ==
        "-x 1.mol2: Tripos MOL2 files are not read; convert it with `obabel './-x 1.mol2' -O './-x "
        "1.pdb'`, or use `eses.measure` in Python, which reads it with RDKit (doc/molecules.md)");
  for (const std::string name : {"a.SDF.gz", "a.mol", "a.sd"}) {
    CHECK(contains(by_suffix(name), "`obabel " + name + " -O a.pdb`"));
    CHECK(contains(by_suffix(name), "or use `eses.measure` in Python, which reads it with RDKit"));
  }
  CHECK(contains(by_suffix("a.bcif"), "or use `eses.measure` in Python"));
  CHECK(contains(by_suffix("a.gro"), "gmx editconf"));
  CHECK(contains(by_suffix("a.xtc"), "gmx trjconv"));
  CHECK(contains(by_suffix("a.prmtop"), "ambpdb"));
  CHECK(contains(by_suffix("a.json"), "gemmi convert"));
  for (const std::string name : {"a.nc", "a.ncrst", "a.NCDF"})
    CHECK(contains(by_suffix(name),
                   ": Amber NetCDF files are not read; write the first frame with "
                   "`cpptraj -p TOPOLOGY.prmtop -y " +
                       name + " -ya '1 1' -x a.pdb`"));
  CHECK(contains(by_suffix("a.rst"), "Amber restart"));
  CHECK(contains(by_suffix("a.top"), "GROMACS or Amber topology"));
  CHECK(contains(by_suffix("a.pse"), "`pymol -cq a.pse -d 'save a.pdb'`"));
  CHECK(contains(by_suffix("a.cxs"), "`chimerax --nogui --exit --cmd"));
  CHECK(contains(by_suffix("a.h5"), "HDF5"));
  CHECK(contains(by_suffix("a.h5md"), "mdconvert"));
  for (const std::string name : {"a.xyz", "a.pdbqt", "a.dcd", "a.trr", "a.psf", "a.mmtf", "a.bcif",
                                 "a.mol", "a.crd", "a.mae", "a.rsa", "a.xml.gz"})
    CHECK(contains(by_suffix(name), "files are not read"));
  for (const std::string name : {"a", "a.xyzr", "a.pqr", "a.pdb", "a.cif", "a.txt", "-"})
    CHECK(by_suffix(name).empty());

  // Files of another suffix are not overwritten, and Open Babel needs their format.
  CHECK(error_of([] { parse_atoms("@<TRIPOS>MOLECULE\nx\n", AtomFormat::xyzr, "a.pdb"); }) ==
        "a.pdb: Tripos MOL2 files are not read; convert it with `obabel -imol2 a.pdb -O "
        "a.converted.pdb`");
  const TemporaryDirectory directory;
  const std::string mol2 = (directory.path() / "a.mol2").string(),
                    stem = (directory.path() / "a").string();
  CHECK(contains(by_suffix(mol2), "-O " + stem + ".pdb`"));
  write_file(stem + ".pdb", "");
  CHECK(contains(by_suffix(mol2), "-O " + stem + ".converted.pdb`"));
  write_file(stem + ".converted.pdb", "");
  CHECK(contains(by_suffix(mol2), "-O " + stem + ".converted.converted.pdb`"));
  // Inputs of commands exist.
  write_file(stem + ".inpcrd", "");
  CHECK(contains(by_suffix(stem + ".prmtop"), "-c " + stem + ".inpcrd -pqr > " + stem + ".pqr`"));
  const auto by_content = [](std::string_view text) {
    return error_of([&] { parse_atoms(text, AtomFormat::xyzr, "t"); });
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
  CHECK(contains(by_content("<?xml version=\"1.0\"?>\n<PDBx:datablock datablockName=\"1CRN\">\n"),
                 "PDBML"));
  CHECK(contains(by_content("REM  FreeSASA 2.1.2\nREM  Chains: A\nREM RES _ NUM      All-atoms\n"),
                 "NACCESS or FreeSASA area files are not read; it has no coordinates"));
  CHECK(contains(by_content("\xde\x01\xabmmtfVersion\xa3"), "MMTF"));
  CHECK(contains(by_content("\x83\xa7"
                            "encoder\xa3"),
                 "BinaryCIF"));
  // A format that the user gives is used.
  const fs::path path = directory.path() / "spheres.xyz";
  std::ofstream(path) << "0 0 0 1\n";
  CHECK(contains(error_of([&] { read_atoms(path); }), "XYZ files are not read"));
  CHECK(read_atoms(path, {.format = AtomFormat::xyzr}).atoms.size() == 1);
}

}  // namespace eses::detail::test
