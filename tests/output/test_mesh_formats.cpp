/// Tests of the formats of meshes: MSMS's pair of files, PLY as text, and VTP, beside the others.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "eses/error.hpp"
#include "output/mesh_format.hpp"
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

/// Returns every format with the name of a file.
const std::vector<MeshOptions> all_formats{{"a.ply"}, {"a.ply", MeshColor::none, true},
                                           {"a.obj"}, {"a.obj", MeshColor::patch},
                                           {"a.off"}, {"a.vert"},
                                           {"a.vtp"}, {"a.stl"},
                                           {"a.glb"}, {"a.glb", MeshColor::patch}};

std::string name_of(const MeshOptions& choice) {
  return choice.file.string() + (choice.is_ascii ? " as text" : "") +
         (choice.color == MeshColor::none ? "" : " with colours");
}

struct FormatRun {
  Mesh mesh;
  std::string bytes;  // contents of all files of the mesh
  Summary summary;
  RunPlan plan;
};

FormatRun run_format(const Molecule& molecule, const Parameters& parameters, MeshOptions choice) {
  const TemporaryDirectory directory;
  choice.file = directory.path() / choice.file;
  Outputs outputs = Outputs::none();
  outputs.mesh = choice;
  FormatRun result;
  result.plan = make_plan(molecule, parameters, outputs);
  result.summary = run(molecule, result.plan.parameters, outputs, directory.path());
  result.mesh = read_mesh(choice.file);
  for (const fs::path& file : mesh_files(choice)) result.bytes += read_bytes(file);
  return result;
}

/// Converts sRGB to a linear intensity (IEC 61966-2-1), both as 0 to 255.
int linear_of(int srgb) {
  const double value = srgb / 255.0;
  return static_cast<int>(std::lround(
      255 * (value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4))));
}

double distance_from(const Vec3& point, const Atom& atom) {
  return norm(point - atom.center) - atom.radius;
}

std::string header_of(const mesh::MeshFormatter& text, const MeshCounts& counts) {
  std::string header;
  BufferedText part([&](std::string_view passed) { header += passed; });
  text.append_header(part, counts, {});
  text.append_face_header(part, counts);
  part.flush();
  return header;
}

std::set<std::string> names_in(const fs::path& directory) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(directory))
    names.insert(entry.path().filename().string());
  return names;
}

}  // namespace

TEST_CASE("mesh formats: every format has the same mesh", "[mesh]") {
  const Molecule molecule(make_chain(40, 3));
  const Mesh expected = run_format(molecule, {}, {"a.ply"}).mesh;
  REQUIRE(!expected.triangles.empty());
  for (const MeshOptions& choice : all_formats) {
    INFO(name_of(choice));
    const auto [mesh, bytes, summary, plan] = run_format(molecule, {}, choice);
    CHECK(summary.bytes_written == bytes.size());
    if (choice.file == "a.stl") {
      // Each triangle has its own corners, in single precision, and its own normal.
      REQUIRE(mesh.triangles.size() == expected.triangles.size());
      for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        std::array<Vec3, 3> corners{};
        for (std::size_t i = 0; i < 3; ++i) {
          corners[i] = expected.positions[expected.triangles[t][i]];
          REQUIRE(norm(mesh.positions[mesh.triangles[t][i]] - corners[i]) < 1e-5);
        }
        const Vec3 across = cross(corners[1] - corners[0], corners[2] - corners[0]);
        REQUIRE(norm(norm(across) * mesh.normals[t] - across) < 1e-6);
      }
      continue;
    }
    CHECK(mesh.triangles == expected.triangles);
    REQUIRE(mesh.positions.size() == expected.positions.size());
    const double tolerance = choice.file == "a.glb" ? 1e-5 : 1e-10;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v)
      REQUIRE(norm(mesh.positions[v] - expected.positions[v]) < tolerance);
    REQUIRE(mesh.colors.size() ==
            (choice.color == MeshColor::none ? 0 : expected.positions.size()));
    for (std::size_t v = 0; v < mesh.colors.size(); ++v) {
      const mesh::Color color = mesh::patch_color(static_cast<std::uint8_t>(expected.patches[v]));
      for (std::size_t part = 0; part < 3; ++part)
        CHECK(mesh.colors[v][part] ==
              (choice.file == "a.glb" ? linear_of(color[part]) : color[part]));
    }
    if (!mesh.normals.empty()) {
      REQUIRE(mesh.normals.size() == expected.normals.size());
      for (std::size_t v = 0; v < mesh.normals.size(); ++v)
        REQUIRE(norm(mesh.normals[v] - expected.normals[v]) < 1e-6);
    }
    if (!mesh.patches.empty()) CHECK(mesh.patches == expected.patches);
    if (choice.file != "a.vert" && !mesh.atoms.empty()) CHECK(mesh.atoms == expected.atoms);
  }
}

TEST_CASE("mesh formats: the bytes do not depend on threads and block size", "[mesh]") {
  const Molecule molecule(make_chain(120, 20180102));
  for (const MeshOptions& choice : all_formats) {
    Parameters parameters;
    parameters.threads = 1;
    const std::string reference = run_format(molecule, parameters, choice).bytes;
    REQUIRE(reference.size() > 10000);
    for (const auto& [threads, block_size] :
         {std::pair(1, 2), std::pair(3, 9), std::pair(2, 33), std::pair(4, 1000)}) {
      INFO(name_of(choice) << ", " << threads << " threads, block size " << block_size);
      parameters.threads = threads;
      parameters.block_size = block_size;
      const bool same = run_format(molecule, parameters, choice).bytes == reference;
      CHECK(same);
    }
  }
}

TEST_CASE("mesh formats: the sizes of files are estimated", "[mesh]") {
  const Molecule molecule(make_chain(200, 5));
  for (const MeshOptions& choice : all_formats) {
    const FormatRun result = run_format(molecule, {}, choice);
    const double ratio =
        static_cast<double>(result.plan.files.mesh) / static_cast<double>(result.bytes.size());
    INFO(name_of(choice) << ": " << ratio);
    CHECK(ratio > 0.7);
    CHECK(ratio < 1.75);
    const bool has_one_section = choice.file == "a.vert" || choice.file == "a.stl";
    CHECK((result.plan.files.mesh_scratch == 0) == has_one_section);
  }
}

TEST_CASE("mesh formats: the header's length does not depend on the counts", "[mesh]") {
  const std::vector<AtomLabel> residues(200);
  const std::span<const AtomLabel> labels(residues);
  for (const MeshFormat format :
       {MeshFormat::ascii_ply, MeshFormat::msms, MeshFormat::vtp, MeshFormat::stl, MeshFormat::glb})
    for (const MeshColor color : {MeshColor::none, MeshColor::patch}) {
      const mesh::MeshFormatter text(format, color,
                                     {.has_groups = true,
                                      .chains = labels.first(3),
                                      .residues = labels,
                                      .atom_count = 1000,
                                      .probe_radius = 1.4,
                                      .density = 9.375,
                                      .grid = {}});
      const std::uint64_t expected = header_of(text, {0, 0}).size();
      for (const std::uint64_t count : {1ULL, 99ULL, 2147483647ULL, 99999999999ULL})
        CHECK(header_of(text, {count, 2 * count}).size() == expected);
    }
}

TEST_CASE("mesh formats: the header of MSMS has counts, density and probe radius", "[mesh]") {
  const std::vector<Atom> atoms = make_chain(40, 3);
  const FormatRun result =
      run_format(Molecule(atoms), {.grid = GridOptions{.spacing = 0.5}}, {"a.vert"});
  const auto [vertices, spheres, density, probe_radius] = result.mesh.msms_header;
  CHECK(vertices == static_cast<double>(result.summary.mesh->vertices));
  CHECK(spheres == static_cast<double>(atoms.size()));
  CHECK(density == 6);  // 1.5 / 0.5^2
  CHECK(probe_radius == 1.4);
  // The density is that of the vertices if the surface has all directions.
  CHECK(vertices / result.summary.area == Approx(density).epsilon(0.1));
}

TEST_CASE("mesh formats: the closest sphere of MSMS is the closest adjacent atom", "[mesh]") {
  const double probe_radius = Parameters().probe_radius;
  for (const std::uint64_t seed : {1U, 2U}) {
    const std::vector<Atom> atoms = make_chain(60, seed);
    const Mesh mesh =
        run_format(Molecule(atoms), {.grid = GridOptions{.spacing = 0.5}}, {"a.vert"}).mesh;
    const Mesh ply =
        run_format(Molecule(atoms), {.grid = GridOptions{.spacing = 0.5}}, {"a.ply"}).mesh;
    std::size_t not_first = 0;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      const Vec3 point = mesh.positions[v], probe = point + probe_radius * mesh.normals[v];
      double closest = std::numeric_limits<double>::infinity();
      for (const Atom& atom : atoms)
        if (std::fabs(distance_from(probe, atom) - probe_radius) < 1e-5)
          closest = std::min(closest, distance_from(point, atom));
      REQUIRE(distance_from(point, atoms[mesh.atoms[v]]) == Approx(closest).margin(1e-9));
      not_first += mesh.atoms[v] != ply.atoms[v];
    }
    CHECK(not_first > 0);
  }
}

TEST_CASE("mesh formats: the type of a triangle in MSMS is that of most corners, or toric",
          "[mesh]") {
  Parameters parameters;
  grid_options(parameters).spacing = 0.6;
  parameters.block_size = 7;
  const Mesh mesh = run_format(Molecule(make_chain(60, 9)), parameters, {"a.vert"}).mesh;
  REQUIRE(mesh.triangle_patches.size() == mesh.triangles.size());
  std::set<std::set<int>> seen;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    std::multiset<int> corners;
    for (const std::uint64_t v : mesh.triangles[t]) corners.insert(mesh.patches[v]);
    const std::set<int> kinds(corners.begin(), corners.end());
    seen.insert(kinds);
    if (kinds.size() == 3) {
      REQUIRE(mesh.triangle_patches[t] == 2);
    } else {
      REQUIRE(corners.count(mesh.triangle_patches[t]) >= 2);
    }
  }
  CHECK(seen.contains({1, 2}));
  CHECK(seen.contains({2, 3}));
}

TEST_CASE("mesh formats: either name of MSMS's pair gives both names", "[mesh]") {
  using Paths = std::vector<fs::path>;
  CHECK(mesh_files({"b/a.vert"}) == Paths{"b/a.vert", "b/a.face"});
  CHECK(mesh_files({"a.face"}) == Paths{"a.vert", "a.face"});
  CHECK(mesh_files({"a.b.VERT"}) == Paths{"a.b.VERT", "a.b.face"});
  CHECK(mesh_files({"a.Face"}) == Paths{"a.vert", "a.Face"});
  CHECK(mesh_files({"a.vtp"}) == Paths{"a.vtp"});
  CHECK(mesh_format("A.VTP") == MeshFormat::vtp);
  CHECK(mesh_format("a.vert") == MeshFormat::msms);
  CHECK(mesh_format("a.vertex") == std::nullopt);
  CHECK(required_mesh_format({"a.ply", MeshColor::none, true}) == MeshFormat::ascii_ply);
  CHECK_THROWS_AS(required_mesh_format({"a.off", MeshColor::none, true}), std::invalid_argument);
  const std::vector<Atom> atoms{{{0, 0, 0}, 1.5}};
  Outputs outputs;
  outputs.mesh = MeshOptions{"a.vtp", MeshColor::none, true};
  CHECK_THROWS_AS(make_plan(atoms, {}, outputs), std::invalid_argument);
}

TEST_CASE("mesh formats: VTP and PLY as text have chains, residues and colours", "[mesh]") {
  const Molecule molecule = make_two_chains();
  const Mesh ply = run_format(molecule, {}, {"a.ply", MeshColor::chain}).mesh;
  REQUIRE(ply.chains.size() == ply.positions.size());
  for (const MeshOptions& choice :
       {MeshOptions{"a.vtp", MeshColor::chain}, MeshOptions{"a.ply", MeshColor::chain, true}}) {
    INFO(name_of(choice));
    const Mesh mesh = run_format(molecule, {}, choice).mesh;
    CHECK(mesh.atoms == ply.atoms);
    CHECK(mesh.patches == ply.patches);
    CHECK(mesh.chains == ply.chains);
    CHECK(mesh.residues == ply.residues);
    CHECK(mesh.colors == ply.colors);
    if (choice.is_ascii) {
      CHECK(mesh.comments == ply.comments);
    } else {
      CHECK(mesh.chain_names == std::vector<std::string>{"B", "A"});
      CHECK(mesh.residue_names == std::vector<std::string>{"ALA 52A B", "GLY 1 A", "GLY 53 B"});
    }
  }
}

TEST_CASE("mesh formats: names cannot end the header of a PLY file", "[mesh]") {
  const std::vector<Atom> atoms{{{0, 0, 0}, 1.5}, {{6, 0, 0}, 1.5}};
  const std::vector<AtomLabel> labels{{.chain = "A\nend_header",
                                       .residue = "GL\rY",
                                       .residue_number = "1",
                                       .atom_name = "N",
                                       .element = "N"},
                                      {.chain = "end_header",
                                       .residue = "end_headerend_header",
                                       .residue_number = "2",
                                       .atom_name = "N",
                                       .element = "N"}};
  for (const bool is_ascii : {false, true}) {
    const Mesh mesh =
        run_format(Molecule(atoms, labels), {}, {"a.ply", MeshColor::chain, is_ascii}).mesh;
    CHECK(mesh.positions.size() > 100);
    const auto has = [&](const std::string& comment) {
      return std::ranges::find(mesh.comments, comment) != mesh.comments.end();
    };
    CHECK(has("chain 0 A_end-header"));
    CHECK(has("chain 1 end-header"));
    CHECK(has("residue 0 GL_Y 1 A_end-header"));
    CHECK(has("residue 1 end-headerend-header 2 end-header"));
  }
}

TEST_CASE("mesh formats: a mesh without triangles is a complete file", "[mesh]") {
  // In a region far from the molecule's surface the mesh is empty, but its file is complete.
  const std::vector<Atom> atoms{{{0, 0, 0}, 1.5}};
  Parameters parameters;
  grid_options(parameters).margin = 3;
  parameters.part = Box{{-4.4, -4.4, -4.4}, {-3.5, -3.5, -3.5}};
  for (const MeshOptions& choice : all_formats) {
    INFO(name_of(choice));
    const FormatRun result = run_format(Molecule(atoms), parameters, choice);
    CHECK(result.mesh.positions.empty());
    CHECK(result.mesh.triangles.empty());
  }
}

// --- the program --------------------------------------------------------------------------------

TEST_CASE("mesh formats: the program writes both files of MSMS for either", "[mesh][cli]") {
  const Sandbox sandbox;
  const Outcome outcome = sandbox.run({"pair.xyzr", "--mesh", "one/a.vert", "--json", "-o", "out"});
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  CHECK(names_in(sandbox.directory() / "one") == std::set<std::string>{"a.vert", "a.face"});
  check_json(sandbox, outcome.out, "r['output']['files'][-2:]",
             fmt::format("['{0}/one/a.vert', '{0}/one/a.face']", sandbox.directory().string()));
  check_json(sandbox, outcome.out, "r['plan']['scratch_bytes']", "0");
  const Outcome other = sandbox.run({"pair.xyzr", "--mesh", "two/b.face", "--write", "none"});
  REQUIRE(other.code == 0);
  CHECK(contains(other.out, " to two/b.vert and to two/b.face\n"));
  for (const char* suffix : {".vert", ".face"})
    CHECK(read_file(sandbox.directory() / "one" / (std::string("a") + suffix)) ==
          read_file(sandbox.directory() / "two" / (std::string("b") + suffix)));
}

TEST_CASE("mesh formats: either both files of MSMS are written or none", "[mesh][cli]") {
  const Sandbox sandbox;
  fs::create_directory(sandbox.directory() / "taken.face");
  for (const char* more : {"-q", "--dry-run"}) {
    const Outcome outcome = sandbox.run({"pair.xyzr", "--mesh", "taken.vert", more});
    CHECK(outcome.code == 1);
    CHECK(contains(outcome.err, "cannot write taken.face: it is a directory"));
  }
  fs::create_symlink("same", sandbox.directory() / "a.vert");
  fs::create_symlink("./same", sandbox.directory() / "a.face");
  const Outcome same = sandbox.run({"pair.xyzr", "--mesh", "a.vert"});
  CHECK(same.code == 1);
  CHECK(contains(same.err, "two of the files would be the same one: ./"));
  fs::create_symlink("grid_info.txt", sandbox.directory() / "b.face");
  CHECK(contains(sandbox.run({"pair.xyzr", "--mesh", "b.vert"}).err,
                 "two of the files would be the same one"));
  fs::create_symlink("nowhere/x", sandbox.directory() / "c.face");
  CHECK(contains(sandbox.run({"pair.xyzr", "--mesh", "c.vert"}).err,
                 "cannot write c.face: it is a symbolic link into "));
  CHECK(sandbox.files().empty());
  for (const char* name : {"taken.vert", "b.vert", "c.vert"})
    CHECK_FALSE(fs::exists(sandbox.directory() / name));
}

TEST_CASE("mesh formats: links to the files of MSMS stay", "[mesh][cli]") {
  const Sandbox sandbox;
  fs::create_directory(sandbox.directory() / "far");
  fs::create_symlink("far/points", sandbox.directory() / "a.vert");
  fs::create_symlink("triangles", sandbox.directory() / "a.face");
  REQUIRE(sandbox.run({"pair.xyzr", "--write", "none", "--mesh", "a.vert"}).code == 0);
  REQUIRE(sandbox.run({"pair.xyzr", "--write", "none", "--mesh", "b.vert"}).code == 0);
  CHECK(fs::is_symlink(sandbox.directory() / "a.vert"));
  CHECK(fs::is_symlink(sandbox.directory() / "a.face"));
  CHECK(read_file(sandbox.directory() / "far/points") == read_file(sandbox.directory() / "b.vert"));
  CHECK(read_file(sandbox.directory() / "triangles") == read_file(sandbox.directory() / "b.face"));
}

TEST_CASE("mesh formats: --ply-ascii writes PLY as text", "[mesh][cli]") {
  const Sandbox sandbox;
  REQUIRE(sandbox
              .run({"pair.xyzr", "--write", "none", "--mesh", "a.ply", "--ply-ascii", "--color",
                    "atom"})
              .code == 0);
  const std::string text = read_file(sandbox.directory() / "a.ply");
  CHECK(text.starts_with("ply\nformat ascii 1.0\n"));
  CHECK(std::all_of(text.begin(), text.end(),
                    [](char c) { return c == '\n' || (c >= ' ' && c <= '~'); }));
  CHECK(!read_mesh(sandbox.directory() / "a.ply").colors.empty());
}

}  // namespace eses::detail::test
