// Tests of `eses-blocks msms` and of the scripts of MSMS. Expected values are closed forms of
// spheres, the areas of `eses-blocks measure`, and files of MSMS in the documentation of Biopython.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "eses/measure.hpp"
#include "eses/read_atoms.hpp"
#include "input/read_structure.hpp"
#include "mesh/shells.hpp"
#include "support/atom_sets.hpp"
#include "support/sandbox.hpp"

namespace fs = std::filesystem;

namespace eses::detail::test {
namespace {

constexpr double pi = std::numbers::pi;

using Fields = std::vector<std::string>;

/// Lines of a text as fields that blanks separate.
std::vector<Fields> lines_of(const std::string& text) {
  std::vector<Fields> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    std::istringstream fields(line);
    auto& list = lines.emplace_back();
    for (std::string field; fields >> field;) list.push_back(field);
  }
  return lines;
}

/// The numbers in the lines of a table after the line `heading` and a second line.
std::vector<Fields> table_after(const std::string& text, const std::string& heading) {
  const std::size_t start = text.find(heading);
  if (start == std::string::npos) return {};
  std::vector<Fields> lines = lines_of(text.substr(start));
  lines.erase(lines.begin(), lines.begin() + 2);
  const auto end = std::find_if(lines.begin(), lines.end(), [](const Fields& line) {
    return line.empty() || line[0].find_first_not_of("0123456789") != std::string::npos;
  });
  lines.erase(end, lines.end());
  return lines;
}

/// A pair of files NAME.vert and NAME.face.
struct Pair {
  std::vector<Fields> vertices, triangles, vertex_header, triangle_header;

  explicit Pair(const fs::path& name, std::size_t header = 3)
      : vertices(lines_of(read_file(name.string() + ".vert"))),
        triangles(lines_of(read_file(name.string() + ".face"))) {
    vertex_header = take(vertices, header);
    triangle_header = take(triangles, header);
  }

  Vec3 position(std::size_t vertex) const {
    const Fields& line = vertices.at(vertex);
    return {std::stod(line[0]), std::stod(line[1]), std::stod(line[2])};
  }

  /// Enclosed volume. Checks that the mesh is closed and that all vertices are used.
  double volume() const {
    std::set<std::pair<std::size_t, std::size_t>> edges;
    std::set<std::size_t> used;
    double sum = 0;
    for (const Fields& line : triangles) {
      REQUIRE(line.size() == 5);
      std::array<std::size_t, 3> corner{};
      for (std::size_t i = 0; i < 3; ++i) corner[i] = std::stoul(line[i]) - 1;
      for (std::size_t i = 0; i < 3; ++i) {
        CHECK(edges.insert({corner[i], corner[(i + 1) % 3]}).second);
        used.insert(corner[i]);
      }
      sum += dot(position(corner[0]), cross(position(corner[1]), position(corner[2]))) / 6;
    }
    CHECK(std::all_of(edges.begin(), edges.end(), [&](const auto& edge) {
      return edges.contains({edge.second, edge.first});
    }));
    CHECK(used.size() == vertices.size());
    return sum;
  }

 private:
  static std::vector<Fields> take(std::vector<Fields>& lines, std::size_t count) {
    const auto end = lines.begin() + static_cast<std::ptrdiff_t>(std::min(count, lines.size()));
    std::vector<Fields> taken(lines.begin(), end);
    lines.erase(lines.begin(), end);
    return taken;
  }
};

/// Points that are spread evenly over a sphere around the origin.
std::string hollow_ball(int count, double distance, double radius) {
  std::string text;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2.0 * i + 1) / count, rho = std::sqrt(1 - z * z);
    const double angle = pi * (3 - std::sqrt(5.0)) * i;  // the golden angle
    text += fmt::format("{:.6f}\t{:.6f}\t{:.6f}\t{}\n", distance * rho * std::cos(angle),
                        distance * rho * std::sin(angle), distance * z, radius);
  }
  return text;
}

}  // namespace

TEST_CASE("msms: a sphere has its vertices, areas and messages", "[msms]") {
  const Sandbox box;
  // Without a suffix, and with tabs between the columns, as Biopython writes it.
  write_file(box.directory() / "ball", " 1.000\t 2.000\t-3.000\t3.00\n");
  const double probe = 1.5, area = 4 * pi * 9, sas = 4 * pi * (3 + probe) * (3 + probe);
  const Outcome done = box.run({"msms", "-if", "ball", "-of", "out/m", "-af", "out/m"});
  REQUIRE(done.code == 0);
  CHECK(done.err.empty());
  CHECK(contains(done.out, "\nMSMS terminated normally\n"));
  CHECK(contains(done.out, "INPUT  ball 1 spheres 0 collision only, radii  3.000 to  3.000\n"));
  CHECK(contains(done.out, "PARAM  Probe_radius  1.500 density  1.000 hdensity  3.000\n"));
  const auto analytical = table_after(done.out, "ANALYTICAL SURFACE AREA :");
  REQUIRE(analytical.size() == 1);
  CHECK(analytical[0] == Fields{"0", "1.500", "0.000", "0.000", fmt::format("{:.3f}", area),
                                fmt::format("{:.3f}", area), fmt::format("{:.3f}", sas)});
  const Pair mesh(box.directory() / "out/m");
  CHECK(mesh.vertex_header[2] == Fields{std::to_string(mesh.vertices.size()), "1", "1.00", "1.50"});
  CHECK(mesh.triangle_header[2] ==
        Fields{std::to_string(mesh.triangles.size()), "1", "1.00", "1.50"});
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Fields& line = mesh.vertices[i];
    REQUIRE(line.size() == 9);
    const Vec3 normal{std::stod(line[3]), std::stod(line[4]), std::stod(line[5])};
    CHECK(norm(mesh.position(i) - Vec3{1, 2, -3} - 3 * normal) < 1e-9);
    CHECK(Fields(line.begin() + 6, line.end()) == Fields{"0", "1", "3"});
  }
  const auto numerical = table_after(done.out, "NUMERICAL VOLUMES AND AREA");
  REQUIRE(numerical.size() == 1);
  CHECK(std::stod(numerical[0][2]) == Catch::Approx(mesh.volume()).margin(1e-3));
  CHECK(contains(done.out, fmt::format("    Total ses_volume: {:9.3f}\n", mesh.volume())));
  const auto areas = lines_of(read_file(box.directory() / "out/m.area"));
  REQUIRE(areas.size() == 2);
  CHECK(areas[0] == Fields{"Atom#", "ses_0", "sas_0"});
  CHECK(areas[1] == Fields{"0", fmt::format("{:.6f}", area), fmt::format("{:.6f}", sas)});
}

TEST_CASE("msms: the number of vertices follows from the density", "[msms]") {
  const Sandbox box;
  write_file(box.directory() / "ball.xyzr", "0 0 0 20\n");
  for (const double density : {1.0, 3.0, 10.0}) {
    INFO(density);
    REQUIRE(
        box.run({"msms", "-if", "ball.xyzr", "-of", "m", "-density", fmt::format("{}", density)})
            .code == 0);
    const double found = static_cast<double>(Pair(box.directory() / "m").vertices.size());
    CHECK(found / (4 * pi * 400) == Catch::Approx(density).epsilon(0.03));
  }
}

TEST_CASE("msms: vertices have their closest spheres, and triangles have no small angles",
          "[msms]") {
  const Sandbox box;
  const std::vector<Atom> atoms = make_chain(60, 4);
  std::string text;
  for (const auto& [center, radius] : atoms)
    text += fmt::format("{:.17g} {:.17g} {:.17g} {:.17g}\n", center.x, center.y, center.z, radius);
  write_file(box.directory() / "chain", text);
  REQUIRE(box.run({"msms", "-if", "chain", "-of", "m", "-density", "10"}).code == 0);
  const Pair mesh(box.directory() / "m");
  CHECK(mesh.volume() > 0);
  const double probe_radius = 1.5;
  std::set<std::size_t> counts;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Fields& line = mesh.vertices[v];
    const Vec3 point = mesh.position(v),
               probe = point + probe_radius *
                                   Vec3{std::stod(line[3]), std::stod(line[4]), std::stod(line[5])};
    std::vector<double> touched;  // distances of the vertex from the spheres that the probe touches
    for (const Atom& atom : atoms) {
      const double gap = norm(probe - atom.center) - atom.radius - probe_radius;
      REQUIRE(gap > -1e-9);
      if (gap < 1e-9) touched.push_back(norm(point - atom.center) - atom.radius);
    }
    const Atom& closest = atoms.at(std::stoul(line[7]) - 1);
    REQUIRE_FALSE(touched.empty());
    REQUIRE(norm(point - closest.center) - closest.radius ==
            Catch::Approx(*std::min_element(touched.begin(), touched.end())).margin(1e-9));
    counts.insert(touched.size());
    REQUIRE(line[8] == (touched.size() == 1 ? "3" : touched.size() == 2 ? "1" : "2"));
  }
  CHECK(counts == std::set<std::size_t>{1, 2, 3});
  std::size_t small = 0;
  for (const Fields& line : mesh.triangles) {
    std::array<Vec3, 3> t;
    for (std::size_t i = 0; i < 3; ++i) t[i] = mesh.position(std::stoul(line[i]) - 1);
    double smallest = pi;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 u = t[(i + 1) % 3] - t[i], v = t[(i + 2) % 3] - t[i];
      smallest = std::min(smallest, std::atan2(norm(cross(u, v)), dot(u, v)));
    }
    if (smallest < pi / 9) ++small;
  }
  // A mesh of marching cubes has about a quarter.
  CHECK(static_cast<double>(small) < 0.005 * static_cast<double>(mesh.triangles.size()));
}

TEST_CASE("msms: names of atoms are in vertices and areas", "[msms]") {
  const Sandbox box;
  const std::string spheres =
      "0 0 0 1.7{0} A_1_N\n3 0 0 1.7{0} A_2_C\n# comment\n\n9 0 0 1.2{0} H\n";
  write_file(box.directory() / "flag.xyzrn", fmt::format(fmt::runtime(spheres), " 1"));
  write_file(box.directory() / "plain.xyzrn", fmt::format(fmt::runtime(spheres), ""));
  for (const std::string name : {"flag", "plain"}) {
    INFO(name);
    // The call of MaSIF.
    const Outcome done = box.run({"msms", "-density", "3.0", "-hdensity", "3.0", "-probe", "1.5",
                                  "-noh", "-if", name + ".xyzrn", "-of", name, "-af", name});
    REQUIRE(done.code == 0);
    CHECK(done.err.empty());
    CHECK(contains(done.out, "    1 spheres ignored, radius = 1.2\n"));
    const Pair mesh(box.directory() / name);
    std::set<std::pair<std::string, std::string>> atoms;
    for (const Fields& line : mesh.vertices) {
      REQUIRE(line.size() == 10);
      atoms.insert({line[7], line[9]});
    }
    CHECK(atoms == std::set<std::pair<std::string, std::string>>{{"1", "A_1_N"}, {"2", "A_2_C"}});
    const auto areas = lines_of(read_file(box.directory() / (name + ".area")));
    REQUIRE(areas.size() == 4);
    const Surface two(std::vector<Atom>{{{0, 0, 0}, 1.7}, {{3, 0, 0}, 1.7}}, {.probe_radius = 1.5});
    const Measures exact = measure(two);
    CHECK(areas[1] == Fields{"0", fmt::format("{:.6f}", exact.ses_area / 2),
                             fmt::format("{:.6f}", exact.sas_area / 2), "A_1_N"});
    CHECK(areas[3] == Fields{"2", "0.000000", "0.000000", "H"});
  }
}

TEST_CASE("msms: components are outer surfaces and walls of cavities", "[msms]") {
  const Sandbox box;
  write_file(box.directory() / "hollow", hollow_ball(200, 8, 1.7) + "20 0 0 2\n0 0 0 0\n");
  const Outcome all = box.run({"msms", "-if", "hollow", "-of", "m", "-af", "a.area", "-all"});
  REQUIRE(all.code == 0);
  CHECK(all.err.empty());
  CHECK(contains(all.out, "    1 spheres ignored, radius = 0\n"));
  for (const int i : {0, 1, 2})
    CHECK(contains(all.out, fmt::format("    RS component {} identified\n", i)));
  // The outer surface, the single sphere, and the wall of the cavity.
  const auto analytical = table_after(all.out, "ANALYTICAL SURFACE AREA :");
  const auto numerical = table_after(all.out, "NUMERICAL VOLUMES AND AREA");
  REQUIRE(analytical.size() == 3);
  REQUIRE(numerical.size() == 3);
  CHECK(std::stod(analytical[1][5]) == Catch::Approx(16 * pi).margin(1e-3));
  CHECK(std::stod(numerical[0][2]) > std::stod(numerical[1][2]));
  CHECK(std::stod(numerical[2][2]) < 0);
  double area = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    area += std::stod(analytical[i][5]);
    CHECK(std::stod(numerical[i][3]) / std::stod(analytical[i][5]) ==
          Catch::Approx(1).epsilon(0.15));
    const Pair mesh(box.directory() / (i == 0 ? "m" : fmt::format("m_{}", i)));
    CHECK(mesh.volume() == Catch::Approx(std::stod(numerical[i][2])).margin(1e-2));
  }
  AtomFile file = parse_atoms(hollow_ball(200, 8, 1.7) + "20 0 0 2\n");
  const Surface surface(std::move(file.atoms), {.probe_radius = 1.5});
  const Measures exact = measure(surface, {.by_atom = true});
  CHECK(area == Catch::Approx(exact.ses_area).margin(0.01));
  // The areas of an atom in all components add up to its analytical area.
  const auto rows = lines_of(read_file(box.directory() / "a.area"));
  REQUIRE(rows.size() == 203);
  CHECK(rows[0] == Fields{"Atom#", "ses_0", "sas_0", "ses_1", "sas_1", "ses_2", "sas_2"});
  for (std::size_t i = 0; i < surface.atoms().size(); ++i) {
    const Fields& row = rows[i + 1];
    REQUIRE(row.size() == 7);
    CHECK(std::stod(row[2]) + std::stod(row[4]) + std::stod(row[6]) ==
          Catch::Approx(exact.by_atom.sas[i]).margin(1e-5));
    CHECK(
        std::stod(row[1]) + std::stod(row[3]) + std::stod(row[5]) ==
        Catch::Approx(exact.by_atom.convex[i] + exact.by_atom.saddle[i] + exact.by_atom.concave[i])
            .margin(1e-5));
  }

  // The first component alone has the same files.
  const Outcome first = box.run({"msms", "-if", "hollow", "-of", "first"});
  REQUIRE(first.code == 0);
  CHECK(contains(first.err, "1 of 2 outer surfaces left out; -all_components includes them"));
  CHECK(read_file(box.directory() / "first.vert") == read_file(box.directory() / "m.vert"));
  CHECK(read_file(box.directory() / "first.face") == read_file(box.directory() / "m.face"));
  CHECK_FALSE(fs::exists(box.directory() / "first_1.vert"));

  // A component that is chosen by its atoms is the first one: of atom 7, the wall of the cavity.
  REQUIRE(box.run({"msms", "-if", "hollow", "-of", "hole", "-one_cavity", "1", "7"}).code == 0);
  CHECK(read_file(box.directory() / "hole.vert") == read_file(box.directory() / "m_2.vert"));
  REQUIRE(box.run({"msms", "-if", "hollow", "-of", "ion", "-one_cavity", "1", "200"}).code == 0);
  CHECK(read_file(box.directory() / "ion.face") == read_file(box.directory() / "m_1.face"));
  CHECK(contains(box.run({"msms", "-if", "hollow", "-one_cavity", "2", "7", "200"}).err,
                 "no component of the surface touches the atoms of -one_cavity"));
  CHECK(contains(box.run({"msms", "-if", "hollow", "-one_cavity", "1", "201"}).err,
                 "-one_cavity names atom 201, which is ignored"));
  CHECK(contains(box.run({"msms", "-if", "hollow", "-one_cavity", "1", "202"}).err,
                 "-one_cavity names atom 202, and the last one is 201"));
}

TEST_CASE("msms: options choose what is written", "[msms]") {
  const Sandbox box;
  write_file(box.directory() / "two", "0 0 0 1.7\n3 0 0 1.7\n");
  const Outcome bare = box.run({"msms", "-if", "two", "-of", "bare", "-no_header", "-no_area"});
  REQUIRE(bare.code == 0);
  CHECK_FALSE(contains(bare.out, "ANALYTICAL"));
  REQUIRE(
      box.run({"msms", "-if", "two", "-of", "full", "-no_rest", "-no_rest_on_pbr", "-free"}).code ==
      0);
  const Pair full(box.directory() / "full"), without(box.directory() / "bare", 0);
  CHECK(without.vertices == full.vertices);
  CHECK(without.triangles == full.triangles);
  const Outcome analytical = box.run({"msms", "-if", "two", "-of", "none", "-surface", "ases"});
  REQUIRE(analytical.code == 0);
  CHECK_FALSE(contains(analytical.out, "NUMERICAL"));
  CHECK_FALSE(fs::exists(box.directory() / "none.vert"));
  // Called by the name of a link, and from standard input.
  fs::create_symlink(ESES_BINARY, box.directory() / "eses-msms");
  CHECK(shell(fmt::format("cd {} && ./eses-msms -if - -of link < two > link.txt",
                          shell_quoted(box.directory().string()))) == 0);
  CHECK(read_file(box.directory() / "link.vert") == read_file(box.directory() / "full.vert"));
}

TEST_CASE("msms: errors name their cause", "[msms]") {
  const Sandbox box;
  write_file(box.directory() / "two", "0 0 0 1.7\n3 0 0 1.7\n");
  write_file(box.directory() / "mixed", "0 0 0 1.7 1 N\n3 0 0 1.7\n");
  write_file(box.directory() / "zero", "0 0 0 0\n3 0 0 1.2\n");
  write_file(box.directory() / "bad", "0 0 0 1.7\n3 0 x 1.7\n");
  check_usage_error(box, {"msms"}, "no input file; give it with -if");
  check_usage_error(box, {"msms", "-if"}, "-if needs a value");
  check_usage_error(box, {"msms", "-if", "two", "-color", "red"}, "unknown option '-color'");
  check_usage_error(box, {"msms", "two"}, "unexpected argument 'two'");
  check_usage_error(box, {"msms", "-if", "two", "-dens", "0"},
                    "-density is '0', expected a number from 1e-6 to 1e6");
  check_usage_error(box, {"msms", "-if", "two", "-probe", "abc"},
                    "-probe_radius is 'abc', expected a number from 0.01 to 1000, in angstrom");
  check_usage_error(box, {"msms", "-if", "two", "-surface", "sas"},
                    "-surface is 'sas', expected tses or ases");
  for (const std::string name : {"-socketName", "-socketPort", "-xdr", "-sinetd"})
    check_usage_error(box, {"msms", name},
                      name + " is refused, because there is no server; read a file with -if");
  check_usage_error(box, {"msms", "-if", "two", "-one_cavity", "4", "1"},
                    "-one_cavity is '4', expected a whole number from 1 to 3");
  check_usage_error(box, {"msms", "-if", "two", "-all", "-one_cavity", "1", "1"},
                    "-all_components and -one_cavity exclude each other; use only one of them");
  check_usage_error(box, {"msms", "-if", "two", "-af", "a", "-no_area"},
                    "-af needs the analytical areas, which -no_area leaves out");
  const auto error_of = [&](const Arguments& arguments) {
    const Outcome outcome = box.run(arguments);
    CHECK(outcome.code == 1);
    return outcome.err;
  };
  CHECK(error_of({"msms", "-if", "missing"}) ==
        "eses-blocks: error: cannot open missing: No such file or directory\n");
  CHECK(contains(error_of({"msms", "-if", "bad"}), "bad:2: field 3 (z): expected a number"));
  CHECK(
      contains(error_of({"msms", "-if", "mixed"}),
               "mixed:2: the sphere has no name, unlike the first one; name all spheres or none"));
  CHECK(contains(error_of({"msms", "-if", "zero", "-noh"}),
                 "zero: all 2 spheres are ignored: 1 of radius 0, 1 of radius 1.2"));
  write_file(box.directory() / "far", "0 0 0 0.01\n5000 5000 5000 0.01\n");
  CHECK(contains(error_of({"msms", "-if", "far", "-density", "0.001"}),
                 "no triangles at -density 0.001, as the spheres are too small; use a higher "
                 "density, or -surface ases"));
  CHECK(contains(error_of({"msms", "-if", "two", "-of", "two/m"}), "two"));
}

TEST_CASE("msms: small spheres have triangles, and analytical areas need none", "[msms]") {
  const Sandbox box;
  write_file(box.directory() / "small", "0 0 0 0.2\n");
  const Outcome triangles = box.run({"msms", "-if", "small", "-of", "s"});
  CHECK(triangles.code == 0);
  CHECK(fs::file_size(box.directory() / "s.vert") > 200);
  write_file(box.directory() / "far", "0 0 0 0.01\n5000 5000 5000 0.01\n");
  const Outcome areas =
      box.run({"msms", "-if", "far", "-density", "0.001", "-surface", "ases", "-af", "f"});
  CHECK(areas.code == 0);
  CHECK(contains(areas.out, "0.003"));  // 2 * 4 pi 0.01^2
  CHECK(fs::exists(box.directory() / "f.area"));
}

TEST_CASE("msms: input files and links are kept, and files appear together", "[msms]") {
  const Sandbox box;
  const fs::path work = box.directory();
  const std::string spheres = "0 0 0 1.7\n3 0 0 1.7\n";
  for (const std::string suffix : {".vert", ".face", ".area"}) {
    write_file(work / ("x" + suffix), spheres);
    const Outcome outcome = box.run({"msms", "-if", "x" + suffix, "-of", "x", "-af", "x"});
    CHECK(outcome.code == 1);
    CHECK(contains(outcome.err, "x" + suffix + " is the input, and would be overwritten"));
    CHECK(read_file(work / ("x" + suffix)) == spheres);
    fs::remove(work / ("x" + suffix));
  }
  write_file(work / "two", spheres);
  write_file(work / "y_1.vert", spheres);
  CHECK(box.run({"msms", "-if", "y_1.vert", "-of", "y"}).code == 1);
  CHECK(read_file(work / "y_1.vert") == spheres);
  fs::create_hard_link(work / "two", work / "h.face");
  CHECK(box.run({"msms", "-if", "two", "-of", "h"}).code == 1);

  // Files of an earlier run with more components are removed, and others are not.
  write_file(work / "c_1.vert", "old");
  write_file(work / "c_2.face", "old");
  write_file(work / "c_1x.vert", "other");
  write_file(work / ".c.vert.1.part", "abandoned");
  CHECK(box.run({"msms", "-if", "two", "-of", "c", "-af", "c"}).code == 0);
  for (const std::string name : {"c_1.vert", "c_2.face", ".c.vert.1.part"})
    CHECK_FALSE(fs::exists(work / name));
  for (const std::string name : {"c.vert", "c.face", "c.area", "c_1x.vert"})
    CHECK(fs::exists(work / name));

  // A symbolic link stays, and a device is refused, before anything is computed or replaced.
  fs::create_directory(work / "sub");
  write_file(work / "sub" / "real.vert", "old");
  fs::create_symlink("sub/real.vert", work / "l.vert");
  CHECK(box.run({"msms", "-if", "two", "-of", "l"}).code == 0);
  CHECK(fs::is_symlink(work / "l.vert"));
  CHECK(read_file(work / "sub" / "real.vert") == read_file(work / "c.vert"));
  fs::create_symlink("/dev/null", work / "d.area");
  const Outcome device = box.run({"msms", "-if", "two", "-of", "d", "-af", "d"});
  CHECK(device.code == 1);
  CHECK(device.out.empty());
  CHECK(contains(device.err, "d.area: it is a character device"));
  CHECK_FALSE(fs::exists(work / "d.vert"));
  fs::create_directory(work / "e.face");
  write_file(work / "e.vert", "old");
  CHECK(box.run({"msms", "-if", "two", "-of", "e"}).code == 1);
  CHECK(read_file(work / "e.vert") == "old");
}

TEST_CASE("msms: names of files are checked, and other formats are named", "[msms]") {
  const Sandbox box;
  write_file(box.directory() / "two", "0 0 0 1.7\n3 0 0 1.7\n");
  check_usage_error(box, {"msms", "-if", "two", "-of", "sub/"},
                    "-of needs the name of a file, and 'sub/' is a directory; use sub/NAME");
  check_usage_error(box, {"msms", "-if", "two", "-of", "."},
                    "-of needs the name of a file, and '.' is a directory; use NAME");
  const std::string record =
      "ATOM      1  CA  ALA A   1       1.000   2.000   3.000  1.00 20.00           C\n";
  write_file(box.directory() / "a.pdb", record);
  const std::string pdb = box.run({"msms", "-if", "a.pdb"}).err;
  CHECK(pdb ==
        "eses-blocks: error: a.pdb: this is a PDB file; make spheres of it with "
        "`eses-pdb_to_xyzrn a.pdb > a.xyzrn`\n");
  write_file(box.directory() / "a.pqr", "ATOM 1 N ALA A 1 1.0 2.0 3.0 -0.3 1.5\n");
  CHECK(
      contains(box.run({"msms", "-if", "a.pqr"}).err,
               "this is a PQR file; make spheres of it with `eses-pdb_to_xyzrn a.pqr > a.xyzrn`"));
  // The columns of this file may be those of both formats, and other files are not overwritten.
  write_file(box.directory() / "b.pqr", record);
  write_file(box.directory() / "b.xyzrn", "");
  CHECK(contains(box.run({"msms", "-if", "b.pqr"}).err,
                 "b.pqr: this is a PQR file; make spheres of it with `eses-pdb_to_xyzrn b.pqr > "
                 "b.converted.xyzrn`"));
  CHECK(
      contains(box.run({"measure", "b.pqr", "--format", "xyzr"}).err, "read it with --format pqr"));
  CHECK(box.run({"pdb_to_xyzrn", "a.pqr"}).out ==
        "1.000000 2.000000 3.000000 1.500000 1 N_ALA_1\n");
}

TEST_CASE("msms: pdb_to_xyzr prints the spheres that MSMS's script prints", "[msms]") {
  if (eses::detail::gemmi_version().empty()) SKIP("this build has no gemmi");
  const std::string folder = "/usr/share/doc/python-biopython-doc/Tests/PDB/";
  if (!fs::exists(folder + "1A8O.xyzr.gz")) SKIP("python-biopython-doc is not installed");
  const Sandbox box;
  const Outcome spheres = box.run({"pdb_to_xyzr", folder + "1A8O.pdb.gz"});
  REQUIRE(spheres.code == 0);
  REQUIRE(shell(fmt::format("zcat {}1A8O.xyzr.gz > {}/expected", folder,
                            shell_quoted(box.directory().string()))) == 0);
  CHECK(spheres.out == read_file(box.directory() / "expected"));
  const Outcome from_pipe = box.run({"pdb_to_xyzr"}, "< " + folder + "1A8O.pdb.gz");
  CHECK(from_pipe.out == spheres.out);
  const Outcome named = box.run({"pdb_to_xyzrn", folder + "1A8O.pdb.gz"});
  REQUIRE(named.code == 0);
  CHECK(named.out.starts_with("19.594000 32.367000 28.012000 1.700000 1 N_MSE_151\n"));
  write_file(box.directory() / "named", named.out);
  write_file(box.directory() / "plain", spheres.out);
  // Both describe the same spheres.
  REQUIRE(box.run({"msms", "-if", "named", "-of", "named", "-all"}).code == 0);
  REQUIRE(box.run({"msms", "-if", "plain", "-of", "plain", "-all"}).code == 0);
  CHECK(read_file(box.directory() / "named.face") == read_file(box.directory() / "plain.face"));
}

TEST_CASE("msms: pdb_to_xyzr names atoms without a radius", "[msms]") {
  if (eses::detail::gemmi_version().empty()) SKIP("this build has no gemmi");
  const Sandbox box;
  write_file(box.directory() / "a.pdb",
             "HETATM    1  Q   XYZ A   1       1.000   2.000   3.000  1.00  0.00           X  \n");
  const Outcome refused = box.run({"pdb_to_xyzr", "a.pdb"});
  CHECK(refused.code == 1);
  CHECK(contains(refused.err, "XYZ"));
  const Outcome done = box.run({"pdb_to_xyzr", "a.pdb", "--unknown-radius", "0.01"});
  CHECK(done.out == "   1.000    2.000    3.000 0.01\n");
  check_usage_error(box, {"pdb_to_xyzr", "a.pdb", "b.pdb"},
                    "unexpected argument 'b.pdb' after FILE");
}

TEST_CASE("shells: components of a mesh are ordered", "[msms]") {
  // Tetrahedra of different sizes; the third one is inside out.
  std::vector<Vec3> vertices;
  std::vector<mesh::Triangle> triangles;
  const auto add = [&](double x, double size, bool is_cavity) {
    const std::uint64_t first = vertices.size();
    vertices.insert(vertices.end(), {{x, 0, 0}, {x + size, 0, 0}, {x, size, 0}, {x, 0, size}});
    for (mesh::Triangle corners : {mesh::Triangle{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}) {
      if (is_cavity) std::swap(corners[0], corners[1]);
      for (std::uint64_t& corner : corners) corner += first;
      triangles.push_back(corners);
    }
  };
  add(0, 1, false);
  add(10, 2, false);
  add(20, 3, true);
  add(30, 1, false);
  const mesh::Shells shells = mesh::find_shells(vertices, triangles);
  REQUIRE(shells.all.size() == 4);
  const double expected[] = {8.0 / 6, 1.0 / 6, 1.0 / 6, -27.0 / 6};
  for (std::size_t i = 0; i < 4; ++i) {
    CHECK(shells.all[i].volume == Catch::Approx(expected[i]));
    CHECK(shells.all[i].vertex_count == 4);
    CHECK(shells.all[i].triangle_count == 4);
  }
  CHECK(shells.all[0].area == Catch::Approx(4 * (1.5 + std::sqrt(3.0) / 2)));
  CHECK(shells.of_vertex[0] == 1);
  CHECK(shells.of_vertex[4] == 0);
  CHECK(shells.of_vertex[8] == 3);
  CHECK(shells.of_vertex[12] == 2);
}

}  // namespace eses::detail::test
