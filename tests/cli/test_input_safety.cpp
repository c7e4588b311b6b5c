// Tests of the real program: its input stays, and only regular files are replaced.

#include <fmt/format.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "input/read_structure.hpp"
#include "support/sandbox.hpp"

namespace fs = std::filesystem;
using namespace eses::detail::test;

TEST_CASE("a run does not overwrite its input", "[cli]") {
  const Sandbox sandbox;
  const std::string atoms = "0 0 0 1.5\n";
  for (const std::string name : {"grid_info.txt", "a.obj"}) {
    write_file(sandbox.directory() / name, atoms);
    const Outcome outcome = sandbox.run({name, "--mesh", "a.obj"});
    CHECK(outcome.code == 1);
    CHECK(contains(outcome.err, name + " is the input, and would be overwritten"));
    CHECK(read_file(sandbox.directory() / name) == atoms);
    fs::remove(sandbox.directory() / name);
  }
}

TEST_CASE("a build without gemmi refuses PDB and mmCIF files", "[cli]") {
  if (!eses::detail::gemmi_version().empty()) SKIP("this build has gemmi");
  const Sandbox sandbox;
  for (const std::string name : {"a.pdb", "a.cif"}) {
    write_file(sandbox.directory() / name, "data_x\n");
    const Outcome outcome = sandbox.run({name});
    CHECK(outcome.code == 1);
    CHECK(outcome.err ==
          "eses-blocks: error: " + name +
              ": this build reads xyzr and PQR; for PDB and mmCIF install gemmi-dev and "
              "tao-pegtl-dev (libgemmi-dev in later releases of Debian and Ubuntu) and build "
              "eses-blocks again\n");
    CHECK_FALSE(fs::exists(sandbox.directory() / "bounding_box.txt"));
  }
}

TEST_CASE("a run does not overwrite any file that it reads", "[cli]") {
  if (eses::detail::gemmi_version().empty()) SKIP("this build has no gemmi");
  const Sandbox sandbox;
  const fs::path root = sandbox.directory();
  write_file(root / "atom.pdb",
             "ATOM      1  CA  ALA A   1       0.000   0.000   0.000  1.00  0.00           C\n");
  const std::string radii = "types:\nC 1.9 apolar\natoms:\nANY CA C\n";
  write_file(root / "my.dx", radii);
  fs::create_hard_link(root / "my.dx", root / "hard.dx");
  fs::create_symlink("my.dx", root / "soft.dx");
  fs::create_symlink("my.dx", root / "mesh.obj");
  for (const auto& [read, written] : {std::pair("my.dx", Arguments{"--inside", "my.dx"}),
                                      std::pair("my.dx", Arguments{"--inside", "hard.dx"}),
                                      std::pair("soft.dx", Arguments{"--inside", "my.dx"}),
                                      std::pair("hard.dx", Arguments{"--mesh", "mesh.obj"})}) {
    Arguments arguments{"atom.pdb", "--radii", read};
    arguments.insert(arguments.end(), written.begin(), written.end());
    const Outcome outcome = sandbox.run(arguments);
    INFO(outcome.err);
    CHECK(outcome.code == 1);
    CHECK(contains(outcome.err, "is the file of --radii, and would be overwritten"));
    CHECK(read_file(root / "my.dx") == radii);
  }
  CHECK(sandbox.run({"atom.pdb", "--radii", "my.dx", "-q"}).code == 0);
}

TEST_CASE("a run does not overwrite its standard input", "[cli]") {
  const Sandbox sandbox;
  const std::string atoms = "0 0 0 1.5\n";
  write_file(sandbox.directory() / "a.obj", atoms);
  const Outcome outcome = sandbox.run({"-", "--mesh", "a.obj"}, "<a.obj");
  CHECK(outcome.code == 1);
  CHECK(contains(outcome.err, "a.obj is the input, and would be overwritten"));
  CHECK(read_file(sandbox.directory() / "a.obj") == atoms);
}

TEST_CASE("a run does not remove its input with the chunks of --resume", "[cli]") {
  const Sandbox sandbox;
  const std::string atoms = "0 0 0 1.5\n";
  fs::create_directory(sandbox.directory() / ".eses-blocks.resume");
  const std::string name = ".eses-blocks.resume/a.xyzr";
  write_file(sandbox.directory() / name, atoms);
  const Outcome outcome = sandbox.run({name});
  CHECK(outcome.code == 1);
  CHECK(contains(outcome.err, name + " is the input, and would be removed"));
  CHECK(read_file(sandbox.directory() / name) == atoms);
}

TEST_CASE("a run does not remove its input when it writes the other form of the file", "[cli]") {
  const Sandbox sandbox;
  const std::string atoms = "0 0 0 1.5\n";
  for (const auto& [name, gzip] :
       {std::pair("partition_area.txt", true), std::pair("partition_area.txt.gz", false)}) {
    write_file(sandbox.directory() / name, atoms);
    Arguments arguments{name, "--format", "xyzr"};
    if (gzip) arguments.emplace_back("--gzip");
    const Outcome outcome = sandbox.run(arguments);
    CHECK(outcome.code == 1);
    INFO(outcome.err);
    CHECK(contains(outcome.err, std::string(name) + " is the input, and would be removed, as a " +
                                    (gzip ? "gzipped" : "plain") + " file takes its place"));
    CHECK(read_file(sandbox.directory() / name) == atoms);
    // If the file is not written, its other form stays.
    arguments.insert(arguments.end(), {"--write", "edges"});
    CHECK(sandbox.run(arguments).code == 0);
    CHECK(read_file(sandbox.directory() / name) == atoms);
    fs::remove(sandbox.directory() / name);
  }
}

TEST_CASE("only regular files are replaced or removed", "[cli]") {
  const Sandbox sandbox;
  write_file(sandbox.directory() / "a.pqr", "ATOM 1 N MET A 1 0 0 0 0.5 1.5\n");
  struct Case {
    const char* name;
    Arguments arguments;
  };
  const std::vector<Case> cases{
      {"bounding_box.txt", {}},
      {"grid_info.txt", {}},
      {"intersection_info.txt.gz", {"--gzip"}},
      {"partition_area.txt", {"--gzip"}},  // the plain form would be removed
      {"partition_area.txt.gz", {}},       // the compressed form would be removed
      {"residue_area.csv", {"--write", "residues"}},
      {"chain_area.csv", {"--write", "residues"}},
      {"atoms.csv", {"--write", "atoms"}},
      {"map.dx", {"--inside", "map.dx"}},
      {"map.vti", {"--inside", "map.vti", "--resume"}},
      {"grid_info.txt", {"--resume"}}};
  const SpecialFiles special(sandbox.directory());
  const fs::path out = sandbox.directory() / "out";
  for (const auto& [name, more] : cases)
    for (const auto& [file, kind] : special.kinds) {
      fs::create_directory(out);
      fs::create_symlink(file, out / name);
      Arguments arguments{"a.pqr", "-o", "out"};
      arguments.insert(arguments.end(), more.begin(), more.end());
      INFO(Sandbox::command(arguments) << " with " << name << " that leads to " << kind);
      const Outcome outcome = sandbox.run(arguments);
      CHECK(outcome.code == 1);
      CHECK(outcome.out.empty());
      CHECK(outcome.err == fmt::format("eses-blocks: error: cannot write out/{}: it is {}, not a "
                                       "regular file; choose another name\n",
                                       name, kind));
      CHECK(std::distance(fs::directory_iterator(out), {}) == 1);
      CHECK(fs::is_symlink(out / name));
      fs::remove_all(out);
    }
  // The target of a link is not written; the new link replaces the old one.
  fs::create_directory(out);
  write_file(sandbox.directory() / "older", "older");
  fs::create_symlink("../older", out / "bounding_box.txt");
  CHECK(sandbox.run({"a.pqr", "-o", "out", "-q"}).code == 0);
  CHECK(read_file(sandbox.directory() / "older") == "older");
}
