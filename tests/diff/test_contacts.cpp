// Tests of comparing directories: atoms of the same contact, and the order of edges.

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "diff/contact.hpp"
#include "diff/ordered_edges.hpp"
#include "support/atom_sets.hpp"
#include "support/diff_pair.hpp"
#include "support/eses_files.hpp"
#include "support/sandbox.hpp"
#include "support/temporary_directory.hpp"

namespace fs = std::filesystem;

namespace eses::detail::test {
namespace {

/// Lets concave edges on the square name atoms 1, 2 and 3 instead of 0, 1 and 2, and moves their
/// shares of the area. Returns the number of these edges.
std::size_t name_other_atoms(std::map<std::string, Lines>& files) {
  const std::vector<Atom> atoms = square_and_one();
  const double spacing = GridOptions{}.spacing;
  std::size_t renamed = 0;
  for (std::size_t i = 0; i < files[edges_name].size(); ++i) {
    const Crossing& crossing = run_files().values.crossings[i];
    if (crossing.atoms != std::vector<std::int64_t>{0, 1, 2}) continue;
    ++renamed;
    Fields fields = fields_of(files[edges_name][i]);
    fields[12] = "3";
    files[edges_name][i] = line_of(fields);
    double along_axis = 0;
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (crossing.inside[axis] != crossing.outside[axis]) along_axis = crossing.normal[axis];
    const double area = spacing * spacing * std::fabs(along_axis);
    for (const auto& [first, sign] : {std::pair<std::size_t, double>{0, -1}, {1, 1}}) {
      double sum = 0;
      std::array<double, 3> weights{};
      for (std::size_t q = 0; q < 3; ++q) {
        const Atom& atom = atoms[first + q];
        weights[q] = 1 / (norm(crossing.point - atom.center) - atom.radius);
        sum += weights[q];
      }
      for (std::size_t q = 0; q < 3; ++q)
        add_to_field(files[areas_name][first + q], 1, sign * area * weights[q] / sum);
    }
  }
  return renamed;
}

}  // namespace

TEST_CASE("diff: any three atoms of a probe that touches four are the same contact", "[diff]") {
  Pair pair;
  const std::size_t renamed = name_other_atoms(pair.b);
  REQUIRE(renamed > 3);
  const Outcome outcome = pair.diff();
  CHECK(outcome.code == 0);
  CHECK(contains(outcome.out,
                 fmt::format("  atoms: {} edges with different atoms touched by the same probe; "
                             "no difference\n",
                             renamed)));
  CHECK(contains(outcome.out, "\n  area, corrected for these edges: at most "));
  CHECK(contains(outcome.out, "\nthe same, with a tolerance of 1e-06\n"));
  check_json(pair.sandbox, pair.diff({"--json"}).out,
             "r['intersection_info']['found']['same_contact'], "
             "r['partition_area']['found']['area']['largest'] > 0.01, "
             "r['partition_area']['found']['corrected_area']['largest'] < 1e-9",
             fmt::format("({}, True, True)", renamed));
}

TEST_CASE("diff: shares of the wrong atoms are a difference", "[diff]") {
  Pair pair;
  name_other_atoms(pair.b);
  pair.b[areas_name] = run_files().lines.at(areas_name);
  const Outcome outcome = pair.diff();
  CHECK(outcome.code == 1);
  CHECK(contains(outcome.out, "\npartition_area.txt: different\n"));
  CHECK(contains(outcome.out, "\n  area: no difference\n"));
  CHECK(contains(outcome.out, "\n  area, corrected for these edges: 4 atoms above the "));
}

TEST_CASE("diff: an atom that the probe does not touch is a difference", "[diff]") {
  Pair pair;
  const std::size_t renamed = name_other_atoms(pair.b);
  Lines& lines = pair.b[edges_name];
  const auto found = std::find_if(lines.begin(), lines.end(), [](const std::string& line) {
    const Fields fields = fields_of(line);
    return fields.size() == 15 && fields[12] == "3";
  });
  REQUIRE(found != lines.end());
  Fields fields = fields_of(*found);
  fields[12] = std::to_string(lone_atom);
  *found = line_of(fields);
  const Outcome outcome = pair.diff();
  CHECK(outcome.code == 1);
  CHECK(
      contains(outcome.out,
               fmt::format("  atoms: 1 edge with different atoms:\n    {}: 0 1 2 in A, 1 2 4 in B\n"
                           "  atoms: {} edges with different atoms touched by the same probe",
                           place_of(*found), renamed - 1)));
  // The same atoms at another place are not the same contact.
  pair.b = run_files().lines;
  name_other_atoms(pair.b);
  for (std::string& line : pair.b[edges_name])
    if (const Fields f = fields_of(line); f.size() == 15 && f[12] == "3")
      add_to_field(line, 6, 1e-3);
  CHECK(
      contains(pair.diff().out, fmt::format("  atoms: {} edges with different atoms; ", renamed)));
}

TEST_CASE("diff: spheres are found from convex edges, and contacts from spheres", "[diff]") {
  Random random(3);
  const double probe_radius = 1.4;
  // A probe at the origin touches four spheres.
  ContactSpheres spheres;
  std::vector<Atom> touched;
  for (AtomIndex atom = 0; atom < 4; ++atom) {
    const double radius = random.uniform(1, 2);
    const Vec3 center =
        (radius + probe_radius) * normalized({random.uniform(-1, 1), random.uniform(-1, 1), 1});
    CHECK_FALSE(spheres.sphere(atom));
    for (int i = 0; i < 5; ++i) {
      eses::Crossing edge;
      edge.normal =
          normalized({random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
      edge.position = center + radius * edge.normal;
      edge.atoms = {atom};
      edge.atom_count = 1;
      spheres.add_convex(edge);
      CHECK(spheres.sphere(atom).has_value() == (i > 0));
    }
    touched.push_back(spheres.sphere(atom).value());
    CHECK(norm(touched.back().center - center) < 1e-12);
    CHECK(std::fabs(touched.back().radius - radius) < 1e-12);
  }
  eses::Crossing edge;
  edge.position = {0, 0, probe_radius};
  edge.normal = {0, 0, -1};
  CHECK(touches_all(edge, touched, 1e-9));
  touched[2].radius += 1e-4;
  CHECK_FALSE(touches_all(edge, touched, 1e-5));
  CHECK(touches_all(edge, touched, 1e-3));
}

namespace {

/// More edges than are sorted in memory, in order. The last one is listed twice.
Lines many_edges() {
  Lines lines;
  for (int z = 0; z < 50; ++z)
    for (int y = 0; y < 50; ++y)
      for (int x = 0; x < 60; ++x)
        lines.push_back(
            fmt::format("{0} {1} {2} {3} {1} {2} {0} {1} {2} 1 0 0 {0} ", x, y, z, x + 1));
  lines.push_back(lines.back() + "100");
  return lines;
}

}  // namespace

TEST_CASE("diff: edges come in order, whatever their number and their order in the file",
          "[diff]") {
  const TemporaryDirectory directory;
  const Lines in_order = many_edges();
  Lines shuffled = in_order;
  // The repeated edge stays after the first one, because edges at the same place keep the order of
  // the file.
  const std::string repeated = shuffled.back();
  shuffled.pop_back();
  shuffle(shuffled, 8);
  shuffled.push_back(repeated);
  for (const std::size_t count : {in_order.size(), std::size_t{1000}, std::size_t{0}}) {
    for (const Lines* lines : std::array<const Lines*, 2>{&in_order, &shuffled}) {
      const Lines some(lines->end() - static_cast<std::ptrdiff_t>(count), lines->end());
      const fs::path path = directory.path() / edges_name;
      write_file(path, text_of(some));
      const OrderedEdges edges(path, unknown_size);
      for (int pass = 0; pass < 2; ++pass) {
        const ItemStream<eses::Crossing> stream = edges.stream();
        eses::Crossing edge, last;
        std::size_t seen = 0, misplaced = 0, wrong = 0;
        for (; stream(edge); last = edge, ++seen) {
          if (seen > 0 && edge_of(edge) < edge_of(last)) ++misplaced;
          const auto& lower = edge.lower;
          if (edge.position != Vec3{double(lower[0]), double(lower[1]), double(lower[2])}) ++wrong;
          const bool is_repeated = seen + 1 == count;
          if (edge.atom_count != (is_repeated ? 2 : 1) || edge.atoms[0] != AtomIndex(lower[0]))
            ++wrong;
        }
        CHECK(seen == count);
        CHECK(misplaced == 0);
        CHECK(wrong == 0);
      }
    }
  }
}

TEST_CASE("diff: only many unordered edges need the disk, and its failure is reported", "[diff]") {
  const Sandbox sandbox;
  Lines lines = many_edges();
  const auto diff = [&sandbox](const std::string& a, const std::string& b) {
    const int code =
        shell("cd " + shell_quoted(sandbox.directory().string()) + " && TMPDIR=$PWD/nowhere " +
              Sandbox::command({"diff", a, b}) + " >out 2>err </dev/null");
    return Outcome{code, read_file(sandbox.directory() / "out"),
                   read_file(sandbox.directory() / "err")};
  };
  for (const std::string name : {"a", "b"}) {
    fs::create_directory(sandbox.directory() / name);
    write_file(sandbox.directory() / name / edges_name, text_of(lines));
    std::swap(lines[0], lines.back());
  }
  CHECK(contains(diff("a", "a").out, "  1 edge repeated in A, not compared:\n    59 49 49 -> "));
  const Outcome outcome = diff("a", "b");
  CHECK(outcome.code == 2);
  CHECK(outcome.err.rfind("eses-blocks: error: no directory for temporary files: ", 0) == 0);
  CHECK(contains(sandbox.run({"diff", "a", "b"}).out, "\n  150000 edges in both\n"));
}

}  // namespace eses::detail::test
