/// Tests of pockets. Expected values are closed forms, exact differences of volumes, and a search
/// of the points of a whole grid by brute force.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <stdexcept>
#include <tuple>
#include <vector>

#include "catch.hpp"
#include "eses/compute.hpp"
#include "eses/maps.hpp"
#include "eses/measure.hpp"
#include "eses/pockets.hpp"
#include "support/atom_lists.hpp"
#include "support/atom_sets.hpp"
#include "support/measured_sets.hpp"

namespace eses::detail::test {
namespace {

using std::numbers::pi;

constexpr double all_cavities = std::numeric_limits<double>::infinity();

double filled_volume(const std::vector<Atom>& atoms, double probe) {
  return measure(Surface(atoms, {.max_filled_void = all_cavities}), {.probe_radius = probe})
      .ses_volume;
}

/// The exact value that Pockets::difference_volume approaches.
double exact_difference(const std::vector<Atom>& atoms, double small, double large) {
  return filled_volume(atoms, large) - filled_volume(atoms, small);
}

/// Checks that the volumes add up if no pocket is left out.
void check_sum(const Pockets& pockets) {
  double sum = pockets.shallow_volume;
  for (const Pocket& pocket : pockets.pockets) sum += pocket.volume;
  CHECK(difference(sum, pockets.difference_volume) < 1e-12);
}

void check_equal(const Pockets& a, const Pockets& b) {
  CHECK(a.difference_volume == b.difference_volume);
  CHECK(a.shallow_volume == b.shallow_volume);
  REQUIRE(a.pockets.size() == b.pockets.size());
  for (std::size_t k = 0; k < a.pockets.size(); ++k) {
    CHECK(a.pockets[k].volume == b.pockets[k].volume);
    CHECK(a.pockets[k].probe_center_volume == b.pockets[k].probe_center_volume);
    CHECK(a.pockets[k].mouth_area == b.pockets[k].mouth_area);
    CHECK(a.pockets[k].mouth_count == b.pockets[k].mouth_count);
    CHECK(a.pockets[k].centroid == b.pockets[k].centroid);
    CHECK(a.pockets[k].atoms == b.pockets[k].atoms);
  }
}

/// A ring of many atoms, which is nearly a torus, and two probes. The small one passes through the
/// hole, the large one closes it on both sides.
struct Ring {
  static constexpr AtomIndex count = 80;
  double atom = 3, distance = 5.2, small = 1.4, large = 3.5;

  std::vector<Atom> atoms(Vec3 center = {}) const {
    std::vector<Atom> ring;
    for (AtomIndex k = 0; k < count; ++k) {
      const double turn = 2 * pi * k / count;
      ring.push_back({{distance * std::cos(turn), distance * std::sin(turn), 0}, atom});
    }
    ring = rotated(ring);
    for (Atom& each : ring) each.center = each.center + center;
    return ring;
  }
  /// Height of the centre of the large probe over the plane of the ring.
  double height() const { return std::sqrt((atom + large) * (atom + large) - distance * distance); }

  /// A point of a plane through the axis, at `r` from the axis and `z` over the ring.
  struct Point {
    double r, z;
  };
  bool is_in_gap(const Point& point, double radius) const {
    return std::hypot(point.r - distance, point.z) > radius &&
           std::hypot(point.r, point.z - height()) > large;
  }

  /// Volumes and areas of the pocket by quadrature in the plane through the axis, which is a plane
  /// of symmetry, so that the nearest probe centre of a point is in it.
  struct Values {
    double difference_volume = 0, volume = 0, probe_center_volume = 0, mouth_area = 0;
  };
  Values expected() const {
    constexpr double step = 0.03;
    const double touching = height() * atom / (atom + large);
    const double rim = distance * large / (atom + large);
    std::vector<Point> gap, centers;
    for (double r = step / 2; r < rim; r += step)
      for (double z = step / 2; z < touching; z += step) {
        if (is_in_gap({r, z}, atom)) gap.push_back({r, z});
        if (is_in_gap({r, z}, atom + small)) centers.push_back({r, z});
      }
    const auto is_near = [&](const Point& point) {
      return std::any_of(centers.begin(), centers.end(), [&](const Point& center) {
        return std::hypot(point.r - center.r, point.z - center.z) <= small + step / 2;
      });
    };
    Values values;
    const double ring_area = 2 * 2 * pi * step * step;  // on both sides of the ring, per r
    for (const Point& point : gap) {
      values.difference_volume += ring_area * point.r;
      if (is_near(point)) values.volume += ring_area * point.r;
    }
    for (const Point& center : centers) values.probe_center_volume += ring_area * center.r;
    const double half = std::asin(rim / large);
    for (double angle = half / 400; angle < half; angle += half / 200) {
      const double r = large * std::sin(angle);
      if (is_near({r, height() - large * std::cos(angle)}))
        values.mouth_area += 2 * 2 * pi * r * large * half / 200;
    }
    return values;
  }

  /// The volume between torus and large probes: a body of revolution less two spherical caps.
  double gap_volume() const {
    const double z = height() * atom / (atom + large), d = distance, a = atom;
    const double root = std::sqrt(a * a - z * z);
    const double inner = d * d * z - d * (z * root + a * a * std::asin(z / a)) + a * a * z -
                         z * z * z / 3;  // integral of (d - sqrt(a^2 - z^2))^2
    const double cap = z - (height() - large);
    return 2 * (pi * inner - pi * cap * cap * (3 * large - cap) / 3);
  }
};

/// Does what find_pockets does, with the whole grid in memory and without any shortcut.
Pockets search_whole_grid(const std::vector<Atom>& atoms, const PocketOptions& options) {
  const double p = *options.probe_radius, h = options.spacing;
  const Surface small(atoms, {.probe_radius = p, .max_filled_void = all_cavities});
  const Surface large(
      atoms, {.probe_radius = options.large_probe_radius, .max_filled_void = all_cavities});
  const Grid grid = make_grid(small, {.spacing = h, .margin = 2 * h});
  const Result inner = compute(small, grid), outer = compute(large, grid);
  const std::vector<std::uint8_t> access = compute_ion_access(small, grid, p);
  const auto index_of = [&](const GridIndex& at) {
    return static_cast<std::size_t>((at[2] * grid.size[1] + at[1]) * grid.size[0] + at[0]);
  };
  const auto squared_distance = [](const GridIndex& a, const GridIndex& b) {
    std::int64_t sum = 0;
    for (std::size_t q = 0; q < 3; ++q) sum += (a[q] - b[q]) * (a[q] - b[q]);
    return sum;
  };
  std::vector<GridIndex> gap, centers;
  for (std::int64_t z = 0; z < grid.size[2]; ++z)
    for (std::int64_t y = 0; y < grid.size[1]; ++y)
      for (std::int64_t x = 0; x < grid.size[0]; ++x) {
        const GridIndex at{x, y, z};
        if (inner.is_inside(at) || !outer.is_inside(at)) continue;
        gap.push_back(at);
        if (access[index_of(at)] != 0) centers.push_back(at);
      }
  // The sets of connected points, by the lowest index of a point.
  const auto sets_of = [&](const std::vector<GridIndex>& points) {
    std::vector<std::size_t> set(points.size());
    for (std::size_t k = 0; k < set.size(); ++k) set[k] = k;
    for (bool has_changed = true; has_changed;) {
      has_changed = false;
      for (std::size_t a = 0; a < points.size(); ++a)
        for (std::size_t b = 0; b < a; ++b)
          if (set[a] != set[b] && squared_distance(points[a], points[b]) <= 4) {
            set[a] = set[b] = std::min(set[a], set[b]);
            has_changed = true;
          }
    }
    return set;
  };
  const std::vector<std::size_t> set = sets_of(centers);
  struct Found {
    std::int64_t points = 0, centers = 0;
    double area = 0;
    std::set<AtomIndex> atoms;
    std::set<std::size_t> mouths;
    Vec3 sum;
  };
  std::map<std::size_t, Found> found;
  std::map<GridIndex, std::size_t> owner;
  for (const std::size_t each : set) ++found[each].centers;
  for (const GridIndex& at : gap) {
    // The nearest center, or the one with the lowest index.
    auto best = std::tuple(std::int64_t{0}, std::int64_t{0}, std::int64_t{0}, std::int64_t{0});
    std::size_t nearest = centers.size();
    for (std::size_t k = 0; k < centers.size(); ++k) {
      const auto key =
          std::tuple(squared_distance(at, centers[k]), centers[k][2], centers[k][1], centers[k][0]);
      if (nearest < centers.size() && key >= best) continue;
      best = key;
      nearest = k;
    }
    const double reach = p / h + 0.5;
    if (nearest == centers.size() || static_cast<double>(std::get<0>(best)) > reach * reach)
      continue;
    owner[at] = set[nearest];
    Found& pocket = found[set[nearest]];
    ++pocket.points;
    pocket.sum = pocket.sum + grid.point(at);
  }
  const auto end_of = [](const Crossing& crossing, bool inside) {
    return crossing.lower_is_inside == inside ? crossing.lower : crossing.upper();
  };
  for (const Crossing& crossing : inner.crossings())
    if (const auto at = owner.find(end_of(crossing, false)); at != owner.end())
      for (const AtomIndex atom : crossing.adjacent_atoms()) found[at->second].atoms.insert(atom);
  for (const Crossing& crossing : outer.crossings())
    if (const auto at = owner.find(end_of(crossing, true)); at != owner.end())
      found[at->second].area += h * h * std::fabs(crossing.normal[crossing.axis]);
  std::vector<GridIndex> ways_out;
  std::vector<std::size_t> pocket_of;
  for (std::size_t k = 0; k < centers.size(); ++k) {
    bool is_way_out = false;
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const std::int64_t step : {-1, 1}) {
        GridIndex neighbor = centers[k];
        neighbor[axis] += step;
        is_way_out = is_way_out || !outer.is_inside(neighbor);
      }
    if (!is_way_out) continue;
    ways_out.push_back(centers[k]);
    pocket_of.push_back(set[k]);
  }
  const std::vector<std::size_t> mouth = sets_of(ways_out);
  for (std::size_t k = 0; k < mouth.size(); ++k) found[pocket_of[k]].mouths.insert(mouth[k]);
  Pockets result;
  const double cell = h * h * h;
  result.difference_volume = cell * static_cast<double>(gap.size());
  result.shallow_volume = cell * static_cast<double>(gap.size() - owner.size());
  for (const auto& [first, pocket] : found)
    result.pockets.push_back({cell * static_cast<double>(pocket.points),
                              cell * static_cast<double>(pocket.centers),
                              pocket.area,
                              pocket.mouths.size(),
                              (1 / static_cast<double>(pocket.points)) * pocket.sum,
                              {pocket.atoms.begin(), pocket.atoms.end()}});
  std::stable_sort(result.pockets.begin(), result.pockets.end(),
                   [](const Pocket& a, const Pocket& b) { return a.volume > b.volume; });
  return result;
}

/// Atoms on a sphere around the origin, on a spiral of the golden angle, but none within `opening`
/// of the point (0, 0, distance).
std::vector<Atom> open_ball(std::size_t count, double distance, double radius, double opening) {
  std::vector<Atom> atoms;
  for (std::size_t k = 0; k < count; ++k) {
    const double height = 1 - (2 * static_cast<double>(k) + 1) / static_cast<double>(count);
    const double ring = std::sqrt(1 - height * height);
    const double turn = pi * (3 - std::sqrt(5.0)) * static_cast<double>(k);
    const Vec3 center = distance * Vec3{ring * std::cos(turn), ring * std::sin(turn), height};
    if (norm(center - Vec3{0, 0, distance}) >= opening) atoms.push_back({center, radius});
  }
  return atoms;
}

}  // namespace

TEST_CASE("pockets: a tunnel through a ring of atoms has two mouths and the volumes of its form") {
  const Ring ring;
  const Ring::Values expected = ring.expected();
  CHECK(expected.difference_volume == Catch::Approx(ring.gap_volume()).epsilon(0.01));
  const std::vector<Atom> atoms = ring.atoms();
  // The grooves between the atoms of the ring are less than 0.01 angstrom deep.
  const double exact = exact_difference(atoms, ring.small, ring.large);
  CHECK(exact == Catch::Approx(ring.gap_volume()).epsilon(0.015));
  const Surface surface(atoms, {.probe_radius = ring.small});
  const Pockets found =
      find_pockets(surface, {.large_probe_radius = ring.large, .spacing = 0.1, .min_volume = 0});
  CHECK(found.difference_volume == Catch::Approx(exact).epsilon(0.005));
  check_sum(found);
  REQUIRE(found.pockets.size() == 1);
  const Pocket& pocket = found.pockets[0];
  CHECK(pocket.volume == Catch::Approx(expected.volume).epsilon(0.02));
  CHECK(pocket.probe_center_volume == Catch::Approx(expected.probe_center_volume).epsilon(0.03));
  CHECK(pocket.mouth_area == Catch::Approx(expected.mouth_area).epsilon(0.03));
  CHECK(pocket.mouth_count == 2);
  CHECK(norm(pocket.centroid) < 0.02);
  CHECK(pocket.atoms.size() == atoms.size());
  CHECK(find_pockets(
            surface,
            {.large_probe_radius = ring.large, .spacing = 0.2, .min_volume = 1.1 * expected.volume})
            .pockets.empty());
  // A smaller large probe comes through the hole.
  const Pockets passed =
      find_pockets(surface, {.large_probe_radius = 2, .spacing = 0.1, .min_volume = 0});
  CHECK(passed.pockets.empty());
  CHECK(passed.shallow_volume == passed.difference_volume);
}

TEST_CASE("pockets: two rings apart, one of them closed at one end") {
  const Ring ring;
  const Vec3 away{40, 3, -2};
  std::vector<Atom> atoms = ring.atoms();
  for (const Atom& atom : ring.atoms(away)) atoms.push_back(atom);
  const PocketOptions options{.large_probe_radius = ring.large, .spacing = 0.2, .min_volume = 10};
  const Ring::Values expected = ring.expected();
  const Pockets tunnels = find_pockets(Surface(atoms), options);
  REQUIRE(tunnels.pockets.size() == 2);
  for (const Pocket& pocket : tunnels.pockets) {
    CHECK(pocket.volume == Catch::Approx(expected.volume).epsilon(0.03));
    CHECK(pocket.mouth_count == 2);
    CHECK(std::min(norm(pocket.centroid), norm(pocket.centroid - away)) < 0.05);
    CHECK(pocket.atoms.back() - pocket.atoms.front() < Ring::count);
  }
  // An atom on the axis of the second ring leaves a way of the small probe on the other side only.
  const Vec3 axis = rotated({{{0, 0, 1}, 0}})[0].center;
  atoms.push_back({away - 4 * axis, 2});
  const Pockets cup = find_pockets(Surface(atoms), options);
  REQUIRE(cup.pockets.size() == 2);
  const bool first_is_cup = norm(cup.pockets[0].centroid - away) < ring.distance;
  const Pocket& closed = cup.pockets[first_is_cup ? 0 : 1];
  const Pocket& open = cup.pockets[first_is_cup ? 1 : 0];
  CHECK(closed.mouth_count == 1);
  CHECK(closed.mouth_area == Catch::Approx(expected.mouth_area / 2).epsilon(0.1));
  CHECK(closed.atoms.back() == 2 * Ring::count);
  CHECK(open.mouth_count == 2);
  CHECK(open.volume == Catch::Approx(expected.volume).epsilon(0.03));
}

TEST_CASE("pockets: two spheres have a groove, and a sphere has nothing") {
  const std::vector<Atom> atoms{{{0, 0, 0}, 1.7}, {{2, 2, 2.2}, 1.7}};
  const double exact = exact_difference(atoms, 1.4, 3);
  double error = 1;
  for (const double spacing : {0.2, 0.05}) {
    const Pockets found = find_pockets(Surface(atoms), {.spacing = spacing, .min_volume = 0});
    CHECK(found.pockets.empty());
    CHECK(found.shallow_volume == found.difference_volume);
    const double distance = std::fabs(found.difference_volume / exact - 1);
    CHECK(distance < error);
    error = 0.01;
  }
  const Pockets none = find_pockets(Surface({{{1, 2, 3}, 2}}), {.min_volume = 0});
  CHECK(none.pockets.empty());
  CHECK(none.difference_volume == 0);
}

TEST_CASE("pockets: the volume converges to the exact difference of the two surfaces") {
  for (const char* name : {"1ubq.xyzr", "boxb.pqr"}) {
    const std::vector<Atom> atoms = read_atom_list(std::string(ESES_DATA) + "/" + name);
    const double exact = exact_difference(atoms, 1.4, 3);
    const Pockets found = find_pockets(Surface(atoms), {.spacing = 0.25, .min_volume = 0});
    CAPTURE(name, exact, found.difference_volume);
    CHECK(found.difference_volume == Catch::Approx(exact).epsilon(0.005));
    check_sum(found);
    const double two_probes = 2 * 4 * pi / 3 * 1.4 * 1.4 * 1.4;
    CHECK(find_pockets(Surface(atoms), {.spacing = 0.25}).pockets.size() ==
          static_cast<std::size_t>(
              std::count_if(found.pockets.begin(), found.pockets.end(),
                            [&](const Pocket& pocket) { return pocket.volume >= two_probes; })));
    CHECK(std::is_sorted(found.pockets.begin(), found.pockets.end(),
                         [](const Pocket& a, const Pocket& b) { return a.volume > b.volume; }));
  }
}

TEST_CASE("pockets: a cavity becomes a pocket when the small probe can enter") {
  constexpr double distance = 7.5, radius = 1.6;
  const auto near_origin = [](const Pockets& found) {
    return std::find_if(found.pockets.begin(), found.pockets.end(),
                        [](const Pocket& pocket) { return norm(pocket.centroid) < 2; });
  };
  const std::vector<Atom> closed = open_ball(150, distance, radius, 0);
  const Measures measures = measure(Surface(closed), {.cavities = true});
  REQUIRE(measures.cavities.size() == 1);
  const double void_volume = measures.cavities[0].void_volume;
  const Pockets none = find_pockets(Surface(closed), {.spacing = 0.2, .min_volume = 0});
  CHECK(near_origin(none) == none.pockets.end());
  CHECK(none.difference_volume == Catch::Approx(exact_difference(closed, 1.4, 3)).epsilon(0.03));
  // Inside, there is room for the large probe, but it does not come in.
  CHECK(measures.cavities[0].largest_probe > 3);
  const std::vector<Atom> narrow = open_ball(150, distance, radius, 3.6);
  CHECK(measure(Surface(narrow), {.cavities = true}).cavities.empty());
  CHECK(measure(Surface(narrow), {.probe_radius = 3, .cavities = true}).cavities.size() == 1);
  const Pockets entered = find_pockets(Surface(narrow));
  const auto pocket = near_origin(entered);
  REQUIRE(pocket != entered.pockets.end());
  CHECK(pocket->volume > 0.99 * void_volume);
  CHECK(pocket->volume < void_volume + 4 * pi / 3 * 64);
  CHECK(pocket->mouth_count == 1);
  // The large probe comes in through a wide opening.
  const std::vector<Atom> wide = open_ball(150, distance, radius, 6);
  CHECK(measure(Surface(wide), {.probe_radius = 3, .cavities = true}).cavities.empty());
  const Pockets left = find_pockets(Surface(wide));
  CHECK(std::all_of(left.pockets.begin(), left.pockets.end(),
                    [&](const Pocket& each) { return each.volume < 0.2 * void_volume; }));
}

TEST_CASE("pockets: a search of the whole grid finds the same ones") {
  std::size_t count = 0;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const std::vector<Atom> atoms = seed < 6 ? make_sponge(seed) : make_chain(60, seed);
    const PocketOptions options{.probe_radius = seed % 3 == 0 ? 1.0 : 0.7,
                                .large_probe_radius = 2.5,
                                .spacing = seed % 2 == 0 ? 0.5 : 0.65,
                                .min_volume = 0};
    CAPTURE(seed);
    const Pockets found = find_pockets(Surface(atoms), options);
    const Pockets expected = search_whole_grid(atoms, options);
    check_sum(found);
    CHECK(difference(found.difference_volume, expected.difference_volume) < 1e-12);
    CHECK(difference(found.shallow_volume, expected.shallow_volume) < 1e-12);
    REQUIRE(found.pockets.size() == expected.pockets.size());
    count += found.pockets.size();
    for (std::size_t k = 0; k < found.pockets.size(); ++k) {
      CHECK(difference(found.pockets[k].volume, expected.pockets[k].volume) < 1e-12);
      CHECK(difference(found.pockets[k].probe_center_volume,
                       expected.pockets[k].probe_center_volume) < 1e-12);
      CHECK(difference(found.pockets[k].mouth_area, expected.pockets[k].mouth_area) < 1e-9);
      CHECK(found.pockets[k].mouth_count == expected.pockets[k].mouth_count);
      CHECK(norm(found.pockets[k].centroid - expected.pockets[k].centroid) < 1e-9);
      CHECK(found.pockets[k].atoms == expected.pockets[k].atoms);
    }
  }
  CHECK(count > 12);
}

TEST_CASE("pockets: results do not depend on threads and block size") {
  const Surface surface(read_atom_list(std::string(ESES_DATA) + "/1ubq.xyzr"));
  PocketOptions options{.spacing = 0.5, .min_volume = 0};
  options.threads = 1;
  int checks = 0;
  options.check = [&checks] { ++checks; };
  const Pockets expected = find_pockets(surface, options);
  CHECK(checks > 0);
  CHECK(expected.pockets.size() > 5);
  for (const int threads : {2, 5})
    for (const std::int64_t block_size : {0, 9, 30}) {
      options.threads = threads;
      options.block_size = block_size;
      check_equal(find_pockets(surface, options), expected);
    }
}

TEST_CASE("pockets: options out of their range are refused") {
  const Surface surface({{{0, 0, 0}, 1.5}});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const PocketOptions& options :
       {PocketOptions{.probe_radius = 0}, PocketOptions{.probe_radius = nan},
        PocketOptions{.large_probe_radius = 1.4}, PocketOptions{.large_probe_radius = 1001},
        PocketOptions{.large_probe_radius = nan}, PocketOptions{.spacing = 1.5},
        PocketOptions{.spacing = 1.4 / 33}, PocketOptions{.spacing = nan},
        PocketOptions{.min_volume = -1}, PocketOptions{.min_volume = nan},
        PocketOptions{.threads = -1}, PocketOptions{.block_size = 1}})
    CHECK_THROWS_AS(find_pockets(surface, options), std::invalid_argument);
  PocketOptions cancelled;
  cancelled.check = [] { throw std::runtime_error("cancelled"); };
  CHECK_THROWS_AS(find_pockets(surface, cancelled), std::runtime_error);
}

}  // namespace eses::detail::test
