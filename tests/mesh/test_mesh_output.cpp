/// Tests of the files of meshes.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "eses/error.hpp"
#include "mesh/vertex.hpp"
#include "output/mesh_formatter.hpp"
#include "support/atom_sets.hpp"
#include "support/eses_files.hpp"
#include "support/mesh_files.hpp"
#include "support/run.hpp"
#include "support/sandbox.hpp"
#include "support/temporary_directory.hpp"

namespace eses::detail::test {
namespace {

namespace fs = std::filesystem;

std::string bytes_of_mesh(const std::vector<Atom>& atoms, const Parameters& parameters,
                          MeshOptions choice) {
  const TemporaryDirectory directory;
  choice.file = directory.path() / choice.file;
  Outputs none = Outputs::none();
  none.mesh = choice;
  run(atoms, parameters, none, directory.path());
  return read_bytes(choice.file);
}

}  // namespace

TEST_CASE("mesh: the size of the file is estimated", "[mesh]") {
  const std::vector<Atom> atoms = make_chain(200, 5);
  for (const char* name : {"a.ply", "a.obj", "a.off"}) {
    Outputs outputs;
    outputs.mesh = MeshOptions{name};
    const RunPlan plan = make_plan(atoms, {}, outputs);
    const double ratio = static_cast<double>(plan.files.mesh) /
                         static_cast<double>(bytes_of_mesh(atoms, {}, *outputs.mesh).size());
    INFO(name << ": " << ratio);
    CHECK(ratio > 0.7);
    CHECK(ratio < 1.75);
    CHECK(plan.files.output() ==
          plan.files.box + plan.files.grid + plan.files.edges + plan.files.areas + plan.files.mesh);
  }
}

TEST_CASE("mesh: the bytes do not depend on threads and block size", "[mesh]") {
  const std::vector<Atom> atoms = make_chain(120, 20180102);
  for (const char* name : {"a.ply", "a.obj", "a.off"}) {
    Parameters parameters;
    parameters.threads = 1;
    parameters.block_size = 64;
    const MeshOptions choice{name};
    const std::string reference = bytes_of_mesh(atoms, parameters, choice);
    REQUIRE(reference.size() > 10000);
    for (const int threads : {1, 3})
      for (const std::int64_t block_size : {2, 9, 33, 1000}) {
        INFO(name << ", " << threads << " threads, block size " << block_size);
        parameters.threads = threads;
        parameters.block_size = block_size;
        const bool same = bytes_of_mesh(atoms, parameters, choice) == reference;
        CHECK(same);
      }
  }
}

TEST_CASE("mesh: all formats have the same vertices and triangles", "[mesh]") {
  const std::vector<Atom> atoms = make_chain(30, 3);
  const TemporaryDirectory directory;
  std::vector<Mesh> meshes;
  for (const char* name : {"a.ply", "a.obj", "a.off"}) {
    Outputs outputs = Outputs::none();
    outputs.mesh = MeshOptions{directory.path() / name};
    const Summary summary = run(atoms, {}, outputs, directory.path());
    CHECK(summary.bytes_written == fs::file_size(directory.path() / name));
    meshes.push_back(read_mesh(directory.path() / name));
  }
  const Mesh& ply = meshes[0];
  REQUIRE(!ply.triangles.empty());
  for (const Mesh& other : meshes) {
    CHECK(other.triangles == ply.triangles);
    REQUIRE(other.positions.size() == ply.positions.size());
    for (std::size_t v = 0; v < ply.positions.size(); ++v)
      REQUIRE(norm(other.positions[v] - ply.positions[v]) < 1e-10);
  }
  REQUIRE(meshes[1].normals.size() == ply.normals.size());
  for (std::size_t v = 0; v < ply.normals.size(); ++v)
    REQUIRE(norm(meshes[1].normals[v] - ply.normals[v]) < 1e-6);
}

TEST_CASE("mesh: chains, residues and colours are those of the atoms", "[mesh]") {
  const Molecule molecule = make_two_chains();
  const std::vector<std::uint32_t> chains{0, 0, 1, 0}, residues{0, 0, 1, 2};
  const TemporaryDirectory directory;
  const auto mesh_in = [&](MeshColor color) {
    Outputs outputs;
    outputs.mesh = MeshOptions{directory.path() / "a.ply", color};
    run(molecule, {}, outputs, directory.path());
    return read_mesh(directory.path() / "a.ply");
  };
  const Mesh mesh = mesh_in(MeshColor::chain);
  REQUIRE(mesh.chains.size() == mesh.positions.size());
  REQUIRE(mesh.colors.size() == mesh.positions.size());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    REQUIRE(mesh.chains[v] == chains[mesh.atoms[v]]);
    REQUIRE(mesh.residues[v] == residues[mesh.atoms[v]]);
  }
  for (const char* comment : {"chain 0 B", "chain 1 A", "residue 0 ALA 52A B", "residue 1 GLY 1 A",
                              "residue 2 GLY 53 B"}) {
    INFO(comment);
    CHECK(std::count(mesh.comments.begin(), mesh.comments.end(), comment) == 1);
  }
  const auto colours_by = [](const Mesh& coloured, const auto& values) {
    std::map<std::int64_t, std::set<std::array<int, 3>>> seen;
    for (std::size_t v = 0; v < coloured.colors.size(); ++v)
      seen[values[v]].insert(coloured.colors[v]);
    std::set<std::array<int, 3>> all;
    for (const auto& [value, colors] : seen) {
      CHECK(colors.size() == 1);
      all.insert(colors.begin(), colors.end());
    }
    CHECK(all.size() == seen.size());
    return seen.size();
  };
  CHECK(colours_by(mesh, mesh.chains) == 2);
  const Mesh by_atom = mesh_in(MeshColor::atom), by_patch = mesh_in(MeshColor::patch);
  CHECK(colours_by(by_atom, by_atom.atoms) == 4);
  CHECK(colours_by(by_patch, by_patch.patches) >= 2);
}

namespace {

std::string header_of(const mesh::MeshFormatter& text, const MeshCounts& counts) {
  std::string header;
  BufferedText part([&](std::string_view passed) { header += passed; });
  text.append_header(part, counts, {});
  part.flush();
  return header;
}

}  // namespace

TEST_CASE("mesh: the header's length does not depend on the counts", "[mesh]") {
  for (const MeshFormat format : {MeshFormat::ply, MeshFormat::obj, MeshFormat::off}) {
    const mesh::MeshFormatter text(format, MeshColor::none, {});
    const std::uint64_t expected = header_of(text, {0, 0}).size();
    for (const std::uint64_t count : {1ULL, 99ULL, 2147483647ULL, 99999999999ULL})
      CHECK(header_of(text, {count, 2 * count}).size() == expected);
  }
}

TEST_CASE("mesh: the counts of an OFF file are separated by single blanks", "[mesh]") {
  // The format allows any white space, but meshio splits the stripped line at each blank.
  const mesh::MeshFormatter text(MeshFormat::off, MeshColor::none, {});
  for (const std::uint64_t count : {1ULL, 99ULL, 2147483647ULL}) {
    const std::string header = header_of(text, {count, 2 * count});
    const std::string begin = fmt::format("OFF\n{} {} 0", count, 2 * count);
    INFO(header);
    REQUIRE(header.rfind(begin, 0) == 0);
    CHECK(header.find_first_not_of(' ', begin.size()) == header.size() - 1);
    CHECK(header.back() == '\n');
  }
}

TEST_CASE("mesh: invalid outputs are refused", "[mesh]") {
  CHECK_NOTHROW(mesh::require_vertex_count(2147483647));
  CHECK_THROWS_AS(mesh::require_vertex_count(2147483648), Error);
  const std::vector<Atom> atoms{{{0, 0, 0}, 1.5}};
  Outputs outputs;
  outputs.mesh = MeshOptions{"a.xyz"};
  CHECK_THROWS_AS(make_plan(atoms, {}, outputs), std::invalid_argument);
  outputs.mesh = MeshOptions{"a.ply", MeshColor::chain};
  CHECK_THROWS_AS(make_plan(atoms, {}, outputs), std::invalid_argument);
  for (const char* name : {"a.ply", "b/a.PLY", "a.b.Ply"})
    CHECK(mesh_format(name) == MeshFormat::ply);
  CHECK(mesh_format("a.ply/b") == std::nullopt);
}

TEST_CASE("mesh: the program writes only the mesh at the given path", "[mesh][cli]") {
  const Sandbox sandbox;
  const auto names_in = [&](const char* below) {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(sandbox.directory() / below))
      names.insert(entry.path().filename().string());
    return names;
  };
  const Outcome outcome =
      sandbox.run({"pair.xyzr", "--mesh", "meshes/a.ply", "-o", "out", "--color", "atom"});
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  CHECK(names_in("meshes") == std::set<std::string>{"a.ply"});
  CHECK(names_in("out").size() == 4);
  CHECK(contains(outcome.out, " to out (bounding_box.txt"));
  CHECK(contains(outcome.out, " and to meshes/a.ply\n"));
  const Mesh mesh = read_mesh(sandbox.directory() / "meshes/a.ply");
  CHECK(contains(outcome.out, "mesh: " + std::to_string(mesh.positions.size()) + " vertices, " +
                                  std::to_string(mesh.triangles.size()) + " triangles\n"));

  // The mesh is written into the directory of the other files, named by different paths, and alone.
  CHECK(sandbox.run({"pair.xyzr", "--mesh", "./out/../out/b.obj", "-o", "out"}).code == 0);
  CHECK(names_in("out").size() == 5);
  CHECK(sandbox.run({"pair.xyzr", "--mesh", "alone/c.off", "--write", "none"}).code == 0);
  CHECK(names_in("alone") == std::set<std::string>{"c.off"});
  CHECK(sandbox.files().empty());
}

TEST_CASE("mesh: the JSON report and the plan have the mesh", "[mesh][cli]") {
  const Sandbox sandbox;
  const Outcome outcome = sandbox.run({"pair.xyzr", "--mesh", "a.ply", "--json"});
  REQUIRE(outcome.code == 0);
  check_json(sandbox, outcome.out, "r['mesh']['file']", "'a.ply'");
  check_json(sandbox, outcome.out, "r['mesh']['triangles'] == 2 * r['mesh']['vertices'] - 4",
             "True");
  check_json(sandbox, outcome.out, "r['mesh']['vertices'] == r['crossings']['total']", "True");
  check_json(sandbox, outcome.out, "r['plan']['mesh_file_bytes'] > 10000", "True");
  check_json(sandbox, outcome.out, "0 < r['plan']['scratch_bytes'] < r['plan']['mesh_file_bytes']",
             "True");
  check_json(sandbox, outcome.out, "r['output']['files'][-2:]", "['partition_area.txt', 'a.ply']");
  check_json(sandbox,
             sandbox.run({"pair.xyzr", "--mesh", "out/a.ply", "--json", "-o", "./out"}).out,
             "r['output']['files'][-1]", "'a.ply'");
  const Outcome elsewhere =
      sandbox.run({"pair.xyzr", "--mesh", "far/a.ply", "--json", "--write", "none", "-o", "out"});
  check_json(sandbox, elsewhere.out, "r['output']['files']",
             "['" + (sandbox.directory() / "far/a.ply").string() + "']");
  check_json(sandbox, sandbox.run({"pair.xyzr", "--json", "-q"}).out, "r['mesh']", "None");
  const Outcome plan = sandbox.run({"pair.xyzr", "--mesh", "b.ply", "--dry-run"});
  CHECK(contains(plan.out, "the mesh about "));
  CHECK_FALSE(fs::exists(sandbox.directory() / "b.ply"));
}

TEST_CASE("mesh: errors leave no mesh and name the path", "[mesh][cli]") {
  const Sandbox sandbox;
  const auto check = [&](const Arguments& arguments, int code, const std::string& message) {
    INFO(Sandbox::command(arguments));
    const Outcome outcome = sandbox.run(arguments);
    CHECK(outcome.code == code);
    INFO(outcome.err);
    CHECK(contains(outcome.err, message));
    CHECK(sandbox.files().empty());
  };
  check({"pair.xyzr", "--mesh", "a.stp"}, 2,
        "--mesh is 'a.stp', expected a file with the suffix .ply, .obj, .off, .vtp, .stl, .glb, "
        ".vert "
        "or .face");
  check({"pair.xyzr", "--mesh", ""}, 2, "--mesh is ''");
  check({"pair.xyzr", "--mesh"}, 2, "--mesh needs a value");
  check({"pair.xyzr", "--color", "atom"}, 2,
        "--color needs --mesh with a .ply, .obj, .vtp or .glb file");
  check({"pair.xyzr", "--mesh", "a.vert", "--color", "atom"}, 2,
        "--color needs --mesh with a .ply");
  for (const char* file : {"a.obj", "a.off", "a.vtp", "a.stl", "a.glb", "a.face"})
    check({"pair.xyzr", "--mesh", file, "--ply-ascii"}, 2,
          "--ply-ascii needs --mesh with a .ply file");
  check({"pair.xyzr", "--ply-ascii"}, 2, "--ply-ascii needs --mesh with a .ply file");
  for (const char* file : {"a.off", "a.stl"})
    check({"pair.xyzr", "--mesh", file, "--color", "atom"}, 2, "--color needs --mesh");
  check({"pair.xyzr", "--mesh", "a.ply", "--color", "red"}, 2,
        "--color is 'red', expected patch, atom, chain, potential or component");
  for (const char* file : {"pair.xyzr", "-"})
    check({file, "--mesh", "a.ply", "--color", "chain"}, 2,
          "--color chain needs a PQR, PDB or mmCIF file");
  for (const char* file : {"missing.xyzr", "missing.PQR.gz"})
    check({file, "--mesh", "a.ply", "--color", "chain"}, 1, std::string("cannot open ") + file);
  check({"missing.xyzr", "--format", "pqr", "--mesh", "a.ply", "--color", "chain"}, 1,
        "missing.xyzr");
  check({"missing.pqr", "--format", "xyzr", "--mesh", "a.ply", "--color", "chain"}, 1,
        "cannot open missing.pqr");
  check({"pair.xyzr", "--mesh", "pair.xyzr/a.ply"}, 1, "cannot write into pair.xyzr");
  fs::create_directory(sandbox.directory() / "taken.ply");
  check({"pair.xyzr", "--mesh", "taken.ply"}, 1, "taken.ply");
  fs::create_symlink("b.ply", sandbox.directory() / "a.ply");
  fs::create_symlink("a.ply", sandbox.directory() / "b.ply");
  check({"pair.xyzr", "--mesh", "a.ply"}, 1, "cannot write a.ply");
}

TEST_CASE("mesh: only a regular file is replaced", "[mesh][cli]") {
  const Sandbox sandbox;
  const SpecialFiles special(sandbox.directory());
  for (const auto& [file, kind] : special.kinds) {
    for (const bool is_link : {false, true}) {
      const fs::path mesh = sandbox.directory() / "a.ply";
      if (is_link) {
        fs::create_symlink(file, sandbox.directory() / "b.ply");
        fs::create_symlink("b.ply", mesh);
      } else if (file.parent_path() == sandbox.directory()) {
        fs::rename(file, mesh);
      } else {
        continue;
      }
      for (const char* more : {"-q", "--dry-run", "--resume"}) {
        INFO(kind << (is_link ? " by links " : " ") << more);
        const Outcome outcome =
            sandbox.run({"pair.xyzr", "--write", "none", "--mesh", "a.ply", more});
        CHECK(outcome.code == 1);
        CHECK(outcome.out.empty());
        CHECK(outcome.err == "eses-blocks: error: cannot write a.ply: it is " + kind +
                                 ", not a regular file; choose another name\n");
        CHECK(fs::is_symlink(fs::symlink_status(mesh)) == is_link);
        CHECK_FALSE(fs::is_regular_file(mesh));
      }
      if (is_link) {
        fs::remove(mesh);
        fs::remove(sandbox.directory() / "b.ply");
      } else {
        fs::rename(mesh, file);
      }
    }
  }
}

TEST_CASE("mesh: a symbolic link stays, and its target is written", "[mesh][cli]") {
  const Sandbox sandbox;
  fs::create_directory(sandbox.directory() / "far");
  const auto link = [&](const char* name, const char* target) {
    fs::create_symlink(target, sandbox.directory() / name);
  };
  link("a.ply", "far/b.ply");
  link("far/b.ply", "../c.ply");  // a target that does not exist yet
  link("d.ply", (sandbox.directory() / "far/data.with.any.name").c_str());
  REQUIRE(sandbox.run({"pair.xyzr", "--write", "none", "--mesh", "plain.ply"}).code == 0);
  const std::string mesh = read_file(sandbox.directory() / "plain.ply");
  for (const auto& [name, target] : {std::pair("a.ply", "c.ply"), std::pair("a.ply", "c.ply"),
                                     std::pair("d.ply", "far/data.with.any.name")}) {
    INFO(name);
    const Outcome outcome = sandbox.run({"pair.xyzr", "--write", "none", "--mesh", name});
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    CHECK(fs::is_symlink(sandbox.directory() / name));
    CHECK(fs::is_symlink(sandbox.directory() / "far/b.ply"));
    CHECK(fs::is_regular_file(fs::symlink_status(sandbox.directory() / target)));
    CHECK(read_file(sandbox.directory() / target) == mesh);
  }
}

TEST_CASE("mesh: a dry run refuses paths that cannot be written, and creates none", "[mesh][cli]") {
  const Sandbox sandbox;
  fs::create_directories(sandbox.directory() / "taken.ply");
  fs::create_directories(sandbox.directory() / "out/map.dx");
  const std::string long_name = std::string(252, 'a') + ".ply";
  for (const Arguments& arguments :
       {Arguments{"--mesh", "pair.xyzr/a.ply"}, Arguments{"--mesh", "pair.xyzr/b/a.ply"},
        Arguments{"--mesh", "taken.ply"}, Arguments{"--mesh", long_name},
        Arguments{"--inside", "a.vti", "-o", "pair.xyzr/out"},
        Arguments{"--inside", "map.dx", "-o", "out"}, Arguments{"-o", "pair.xyzr"}}) {
    Arguments run{"pair.xyzr"};
    run.insert(run.end(), arguments.begin(), arguments.end());
    INFO(Sandbox::command(run));
    const Outcome refused = sandbox.run(run);
    run.emplace_back("--dry-run");
    const Outcome dry = sandbox.run(run);
    CHECK(refused.code == 1);
    CHECK(dry.code == 1);
    CHECK(dry.err == refused.err);
    CHECK(dry.out.empty());
  }
  const Outcome good = sandbox.run({"pair.xyzr", "--mesh", "new/place/a.ply", "-o", "other/new",
                                    "--inside", "m.dx", "--dry-run"});
  CHECK(good.code == 0);
  CHECK_FALSE(fs::exists(sandbox.directory() / "new"));
  CHECK_FALSE(fs::exists(sandbox.directory() / "other"));
}

}  // namespace eses::detail::test
