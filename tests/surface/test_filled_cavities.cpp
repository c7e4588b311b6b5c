/// Tests of surfaces whose cavities are filled.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "catch.hpp"
#include "eses/compute.hpp"
#include "eses/measure.hpp"
#include "support/atom_lists.hpp"
#include "support/atom_sets.hpp"
#include "support/brute_force.hpp"
#include "support/eses_files.hpp"
#include "support/measured_sets.hpp"
#include "support/run.hpp"
#include "support/temporary_directory.hpp"
#include "surface/measure_patches.hpp"

namespace eses::detail::test {
namespace {

using std::numbers::pi;

constexpr double all = std::numeric_limits<double>::infinity();

Measures measure_filled(const std::vector<Atom>& atoms, double probe,
                        std::optional<double> max_void, const MeasureOptions& options = {}) {
  return measure(Surface(atoms, {.probe_radius = probe, .max_filled_void = max_void}), options);
}

std::vector<Atom> joined(std::vector<Atom> atoms, const std::vector<Atom>& others) {
  atoms.insert(atoms.end(), others.begin(), others.end());
  return atoms;
}

/// Two chambers of different size between three squares of atoms, along x. The SAS spheres of the
/// middle square meet at `window` on either side of its plane.
std::vector<Atom> unequal_chambers(double probe, double window) {
  const double b = 2, open = b * std::numbers::sqrt2;
  std::vector<Atom> atoms;
  for (const double x : {-b, 0., 1.1 * b})
    for (const double y : {-b, b})
      for (const double z : {-b, b})
        atoms.push_back({{x, y, z}, (x == 0 ? std::hypot(open, window) : 1.45 * b) - probe});
  return atoms;
}

bool is_inside(const Surface& surface, Vec3 point) {
  const Grid grid{point, 1e-3, {2, 2, 2}};
  return compute(surface, grid).is_inside({0, 0, 0});
}

/// The components of a set of atoms, found by `find_components`, whose result the tests of cavities
/// compare with flood fills.
class Oracle {
 public:
  Oracle(const std::vector<Atom>& atoms, double probe, double max_void)
      : atoms_(atoms),
        probe_(probe),
        components_(find_components(Molecule(atoms), {.probe_radius = probe, .cavities = true})) {
    const Measures measures = measure(Surface(atoms), {.probe_radius = probe, .cavities = true});
    for (const Cavity& cavity : measures.cavities)
      if (cavity.void_volume <= max_void) filled_.push_back(cavity);
  }

  std::size_t filled_count() const { return filled_.size(); }

  /// Whether an accessible probe centre is in a filled cavity. A centre on the boundary is moved a
  /// little away from the atoms that it touches.
  bool is_filled(Vec3 center) const {
    std::vector<Vec3> toward;
    for (const Atom& atom : atoms_)
      if (norm(center - atom.center) < atom.radius + probe_ + 1e-6)
        toward.push_back(normalized(atom.center - center));
    Vec3 away;
    if (toward.size() < 3) {
      for (const Vec3 direction : toward) away = away - direction;
    } else {
      away = cross(toward[1] - toward[0], toward[2] - toward[0]);
      if (dot(away, toward[0]) > 0) away = -away;
    }
    const Vec3 moved = toward.empty() ? center : center + 1e-5 * normalized(away);
    return is_filled_component(moved);
  }

 private:
  bool is_filled_component(Vec3 point) const {
    const auto gap = [&](const Atom& atom) { return norm(point - atom.center) - atom.radius; };
    const auto nearest =
        std::min_element(atoms_.begin(), atoms_.end(),
                         [&](const Atom& a, const Atom& b) { return gap(a) < gap(b); });
    const auto wall = components_.wall_at(static_cast<AtomIndex>(nearest - atoms_.begin()),
                                          normalized(point - nearest->center));
    if (!wall) return false;
    const ComponentIndex component = components_[*wall].component;
    if (component == Components::outside) return false;
    // The cavity with the atoms of the component around the point.
    std::vector<AtomIndex> atoms;
    for (AtomIndex i = 0; i < atoms_.size(); ++i) {
      bool has_face = false;
      components_.for_each_wall_of(
          i, [&](WallIndex w) { has_face = has_face || components_[w].component == component; });
      if (has_face) atoms.push_back(i);
    }
    return std::any_of(filled_.begin(), filled_.end(),
                       [&](const Cavity& cavity) { return cavity.atoms == atoms; });
  }

  const std::vector<Atom>& atoms_;
  double probe_;
  Components components_;
  std::vector<Cavity> filled_;
};

std::string first_of(const std::vector<std::string>& faults) {
  std::string text = std::to_string(faults.size()) + " faults";
  for (std::size_t f = 0; f < std::min<std::size_t>(5, faults.size()); ++f)
    text += "\n  " + faults[f];
  return text;
}

Parameters parameters_for(double probe, double spacing, double max_void) {
  Parameters parameters;
  parameters.probe_radius = probe;
  grid_options(parameters).spacing = spacing;
  grid_options(parameters).margin = 0.8;
  parameters.threads = 1;
  parameters.max_filled_void = max_void;
  return parameters;
}

/// Compares a run with the oracle. Returns the number of filled cavities.
std::size_t check_with_oracle(const std::vector<Atom>& atoms, double probe, double spacing,
                              double max_void) {
  const Oracle oracle(atoms, probe, max_void);
  const Parameters parameters = parameters_for(probe, spacing, max_void);
  const RunResult result = run_and_read(atoms, parameters);
  const auto faults = find_faults(atoms, parameters, result.files, result.summary,
                                  [&](Vec3 center) { return oracle.is_filled(center); });
  INFO(first_of(faults));
  CHECK(faults.empty());
  CHECK(result.summary.filled_cavities.size() == oracle.filled_count());
  const Measures exact = measure_filled(atoms, probe, max_void);
  CHECK(result.summary.divergence_volume == Approx(exact.ses_volume).epsilon(0.02));
  return oracle.filled_count();
}

std::string bytes_of(const std::vector<Atom>& atoms, const Parameters& parameters) {
  const TemporaryDirectory directory;
  Outputs outputs;
  outputs.mesh = MeshOptions{.file = directory.path() / "mesh.ply"};
  run(atoms, parameters, outputs, directory.path());
  std::string bytes = read_bytes(directory.path() / "mesh.ply");
  for (const char* name : eses_file_names) bytes += read_bytes(directory.path() / name);
  return bytes;
}

}  // namespace

TEST_CASE("filled cavities: a shell of atoms around one void") {
  const std::vector<Atom> atoms = make_icosahedron(4.4, 2.2);
  const double probe = 0.9;
  const Measures open = measure_filled(atoms, probe, {}, {.by_atom = true, .cavities = true});
  REQUIRE(open.cavities.size() == 1);
  const Cavity& cavity = open.cavities[0];
  REQUIRE(!cavity.overlaps_outside);
  const Measures filled =
      measure_filled(atoms, probe, all, {.by_atom = true, .gradients = true, .cavities = true});
  CHECK(filled.cavities.empty());
  REQUIRE(filled.filled_cavities.size() == 1);
  CHECK(filled.filled_cavities[0].id == 1);
  CHECK(filled.filled_cavities[0].void_volume == Approx(cavity.void_volume).epsilon(1e-12));
  CHECK(filled.ses_area == Approx(open.ses_area - cavity.ses_area).epsilon(1e-12));
  CHECK(filled.ses_volume == Approx(open.ses_volume + cavity.void_volume).epsilon(1e-12));
  CHECK(filled.sas_area == Approx(open.sas_area - cavity.sas_area).epsilon(1e-12));
  CHECK(filled.sas_volume == Approx(open.sas_volume + cavity.probe_center_volume).epsilon(1e-12));
  CHECK(filled.euler_number == open.euler_number - cavity.euler_number);
  double sum = 0;
  for (std::size_t i = 0; i < atoms.size(); ++i)
    sum += filled.by_atom.convex[i] + filled.by_atom.saddle[i] + filled.by_atom.concave[i];
  CHECK(sum == Approx(filled.ses_area).epsilon(1e-12));
  // A homogeneous function of the lengths (Euler).
  double scaled = probe * filled.gradients.ses_volume.probe;
  for (std::size_t i = 0; i < atoms.size(); ++i)
    scaled += dot(atoms[i].center, filled.gradients.ses_volume.centers[i]) +
              atoms[i].radius * filled.gradients.ses_volume.radii[i];
  CHECK(scaled == Approx(3 * filled.ses_volume).epsilon(1e-9));
  CHECK(check_with_oracle(atoms, probe, 0.41, all) == 1);
}

TEST_CASE("filled cavities: without a probe, the voids between the atoms are filled") {
  const std::vector<Atom> atoms = make_icosahedron(3.5, 2.3);
  const Measures bare = measure_filled(atoms, 1.4, {}, {.probe_radius = 0, .cavities = true});
  REQUIRE(bare.cavities.size() == 1);
  const Measures filled =
      measure_filled(atoms, 1.4, all, {.probe_radius = 0, .van_der_waals = true});
  REQUIRE(filled.filled_cavities.size() == 1);
  const Cavity& cavity = bare.cavities[0];
  CHECK(filled.ses_area == Approx(bare.ses_area - cavity.ses_area).epsilon(1e-10));
  CHECK(filled.ses_volume == Approx(bare.ses_volume + cavity.void_volume).epsilon(1e-10));
  // The van der Waals surface keeps its cavities.
  CHECK(filled.vdw_area == Approx(bare.ses_area).epsilon(1e-10));
}

// Such atoms need measurements with slack, with a shrinkage and with the exact radii. All of them
// need the voids of the same cavities.
TEST_CASE("filled cavities: voids of a noisy lattice are measured once") {
  Random random(5);
  std::vector<Atom> atoms = make_cube(6, 3, 1);
  for (Atom& atom : atoms)
    atom.center = atom.center +
                  1e-8 * Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
  int plain = 0, filled = 0;  // calls of the callback, in proportion to the patches measured
  const Measures open =
      measure_filled(atoms, 1.4, {}, {.cavities = true, .check = [&] { ++plain; }});
  REQUIRE(open.cavities.size() == 125);
  CHECK(measure_filled(atoms, 1.4, all, {.check = [&] { ++filled; }}).filled_cavities.size() ==
        125);
  INFO(plain << " and " << filled << " calls");
  CHECK(filled < 4 * plain);
}

TEST_CASE("filled cavities: the volume decides which of two is filled") {
  const double probe = 0.9;
  std::vector<Atom> large = make_icosahedron(4.6, 2.3), small = make_icosahedron(4.4, 2.2);
  for (Atom& atom : small) atom.center = atom.center + Vec3{0.2, 14, 0.1};
  const std::vector<Atom> atoms = joined(small, large);
  const Measures open = measure_filled(atoms, probe, {}, {.cavities = true});
  REQUIRE(open.cavities.size() == 2);
  const double between = 0.5 * (open.cavities[0].void_volume + open.cavities[1].void_volume);
  REQUIRE(open.cavities[0].void_volume > between);
  const Surface one(atoms, {.probe_radius = probe, .max_filled_void = between});
  CHECK(is_inside(one, {0.2, 14, 0.1}));
  CHECK(!is_inside(one, {0, 0, 0}));
  const Measures measures = measure(one);
  REQUIRE(measures.filled_cavities.size() == 1);
  CHECK(measures.filled_cavities[0].id == 2);
  CHECK(measures.ses_volume ==
        Approx(open.ses_volume + open.cavities[1].void_volume).epsilon(1e-12));
  const Surface both(atoms, {.probe_radius = probe, .max_filled_void = all});
  CHECK(is_inside(both, {0, 0, 0}));
  const Surface none(atoms, {.probe_radius = probe, .max_filled_void = 0});
  CHECK(!is_inside(none, {0.2, 14, 0.1}));
  CHECK(measure(none).filled_cavities.empty());
  CHECK(check_with_oracle(atoms, probe, 0.5, between) == 1);
}

TEST_CASE("filled cavities: the other side of a narrow window keeps its bulge") {
  const double probe = 1, window = 0.3;
  const std::vector<Atom> atoms = unequal_chambers(probe, window);
  const Measures open = measure_filled(atoms, probe, {}, {.cavities = true});
  REQUIRE(open.cavities.size() == 2);
  REQUIRE(open.cavities[0].overlaps == std::vector<std::size_t>{1});
  // The chamber with the lower x is smaller, and filled.
  const double between = 0.5 * (open.cavities[0].void_volume + open.cavities[1].void_volume);
  const Surface surface(atoms, {.probe_radius = probe, .max_filled_void = between});
  REQUIRE(open.cavities[1].centroid.x < 0);
  // A probe at x = window reaches to x = window - probe, beyond the place x = -window of a probe in
  // the filled chamber.
  const double reach = window - probe;
  CHECK(!is_inside(surface, {reach + 0.01, 0.0003, 0.0002}));
  CHECK(is_inside(surface, {reach - 0.01, 0.0003, 0.0002}));
  CHECK(!is_inside(Surface(atoms, {.probe_radius = probe}), {reach - 0.01, 0.0003, 0.0002}));
  CHECK(check_with_oracle(atoms, probe, 0.23, between) == 1);
}

TEST_CASE("filled cavities: a trapped probe") {
  // Six atoms that just hold a probe at the origin, which is a point of the grid.
  std::vector<Atom> atoms;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const double sign : {-1, 1}) {
      Vec3 center;
      center[axis] = sign * 1.7;
      atoms.push_back({center, 1});
    }
  const double probe = 0.7;
  const Surface open(atoms, {.probe_radius = probe});
  const Surface filled(atoms, {.probe_radius = probe, .max_filled_void = all});
  CHECK(!is_inside(open, {0, 0, 0}));
  CHECK(!is_inside(open, {0.3, 0.2, 0.1}));
  CHECK(is_inside(filled, {0, 0, 0}));
  CHECK(is_inside(filled, {0.3, 0.2, 0.1}));
  const Measures before = measure(open), after = measure(filled);
  REQUIRE(after.filled_cavities.size() == 1);
  const double sphere = 4 * pi * probe * probe;
  CHECK(after.filled_cavities[0].void_volume == Approx(sphere * probe / 3).epsilon(1e-6));
  CHECK(before.ses_area - after.ses_area == Approx(sphere).epsilon(1e-6));
  CHECK(after.ses_volume - before.ses_volume == Approx(sphere * probe / 3).epsilon(1e-6));
}

TEST_CASE("filled cavities: an atom floats in a filled cavity") {
  const std::vector<Atom> shell = make_icosahedron(7.5, 4.1);
  const double probe = 0.5;
  const std::vector<Atom> atoms = joined(shell, {{{0.1, 0.2, 0}, 1}});
  const Surface surface(atoms, {.probe_radius = probe, .max_filled_void = all});
  REQUIRE(measure(Surface(atoms), {.probe_radius = probe, .cavities = true}).cavities.size() == 1);
  CHECK(is_inside(surface, {2, 0.3, 0.2}));
  const Measures filled = measure(surface), alone = measure_filled(shell, probe, all);
  CHECK(filled.ses_area == Approx(alone.ses_area).epsilon(1e-12));
  CHECK(filled.ses_volume == Approx(alone.ses_volume).epsilon(1e-12));
  CHECK(check_with_oracle(atoms, probe, 0.9, all) == 1);
  // A grid inside of the cavity.
  const Result inside = compute(surface, Grid{{-1, -1, -1}, 0.25, {9, 9, 9}});
  CHECK(inside.summary().inside_points == 9 * 9 * 9);
  CHECK(inside.crossings().empty());
}

TEST_CASE("filled cavities: random sets agree with the oracle") {
  std::size_t filled = 0;
  for (std::uint64_t seed = 0; seed < 24; ++seed) {
    const std::vector<Atom> atoms = make_sponge(seed);
    const double probe = seed % 3 == 0 ? 0.35 : 0.6;
    INFO("seed " << seed);
    filled += check_with_oracle(atoms, probe, 0.45, seed % 2 == 0 ? all : 4);
  }
  CHECK(filled > 20);
}

TEST_CASE("filled cavities: proteins agree with the verification") {
  for (const char* name : {"1ubq.xyzr", "c60.xyzr"}) {
    const std::vector<Atom> atoms = read_atom_list(std::string(ESES_DATA) + "/" + name);
    Parameters parameters = parameters_for(name[0] == 'c' ? 0.7 : 1.4, 0.5, all);
    parameters.verify = 3000;
    const Summary summary = compute(atoms, parameters);
    INFO(name << ' ' << first_of(summary.verification->faults));
    CHECK(summary.verification->faults.empty());
    CHECK(!summary.filled_cavities.empty());
    const Measures exact = measure_filled(atoms, parameters.probe_radius, all);
    CHECK(summary.divergence_volume == Approx(exact.ses_volume).epsilon(5e-3));
    CHECK(summary.area == Approx(exact.ses_area).epsilon(5e-3));
  }
}

TEST_CASE("filled cavities: the bytes do not depend on threads and blocks") {
  for (const std::uint64_t seed : {2U, 3U}) {
    const std::vector<Atom> atoms = make_sponge(seed);
    Parameters parameters = parameters_for(0.35, 0.3, seed == 2 ? all : 4);
    const std::string expected = bytes_of(atoms, parameters);
    for (const std::int64_t block : {5, 13, 70})
      for (const int threads : {1, 3}) {
        parameters.block_size = block;
        parameters.threads = threads;
        CHECK(bytes_of(atoms, parameters) == expected);
      }
  }
}

TEST_CASE("filled cavities: without filled cavities, the surface is the same") {
  const std::vector<Atom> atoms = make_sponge(5);
  Parameters parameters = parameters_for(0.35, 0.3, 0);
  const std::string none_filled = bytes_of(atoms, parameters);
  parameters.max_filled_void.reset();
  CHECK(bytes_of(atoms, parameters) == none_filled);
}

TEST_CASE("filled cavities: invalid volumes are refused") {
  const std::vector<Atom> atoms{{{0, 0, 0}, 1}};
  for (const double value : {-1., std::numeric_limits<double>::quiet_NaN()})
    CHECK_THROWS_AS(Surface(atoms, {.max_filled_void = value}), std::invalid_argument);
}

}  // namespace eses::detail::test
