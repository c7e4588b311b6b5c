#include "surface/cavity_list.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <numeric>

#include "surface/atom_loops.hpp"
#include "surface/largest_probe.hpp"
#include "system/serial_check.hpp"

namespace eses::detail {
namespace {

using std::numbers::pi;

// Volumes that differ by less than this have the same rank, so that rounding does not decide the
// order of equal ones (cubic angstrom).
constexpr double same_volume = 1e-6;

std::int64_t rank_of(double volume) { return -std::llround(volume / same_volume); }

/// Returns the order of items by descending volume, and by their first atom if volumes are equal.
template <class Item>
std::vector<std::size_t> order_by(const std::vector<Item>& items, double Item::*volume) {
  std::vector<std::size_t> order(items.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const std::int64_t first = rank_of(items[a].*volume), second = rank_of(items[b].*volume);
    return first != second ? first < second : items[a].atoms < items[b].atoms;
  });
  return order;
}

std::vector<std::size_t> inverse_of(const std::vector<std::size_t>& order) {
  std::vector<std::size_t> inverse(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) inverse[order[k]] = k;
  return inverse;
}

template <class Item>
void reorder(std::vector<Item>& items, const std::vector<std::size_t>& order) {
  std::vector<Item> sorted;
  sorted.reserve(items.size());
  for (const std::size_t k : order) sorted.push_back(std::move(items[k]));
  items = std::move(sorted);
}

/// Sums over the walls of a component.
struct WallSums {
  PatchSums patches;
  FaceSums faces;
  Vec3 moment;
  Box box = empty_box();

  void add(const Wall& wall) {
    patches += wall.patches;
    faces += wall.faces;
    moment = moment + wall.moment;
    box = united(box, wall.box);
  }
  double ses_area() const { return faces.convex_area + patches.saddle + patches.concave; }
  double ses_flux() const { return faces.convex_flux + patches.flux; }
  std::int64_t euler_number() const {
    return 2 * std::llround((faces.solid_angle + patches.curvature) / (4 * pi));
  }
};

Vec3 clamped(Vec3 point, const Box& box) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    point[axis] = std::clamp(point[axis], box.low[axis], box.high[axis]);
  return point;
}

class CavityLister {
 public:
  CavityLister(const SurfaceModel& surface, Vec3 origin, double probe_radius,
               const Components& components)
      : surface_(surface), origin_(origin), probe_radius_(probe_radius), components_(components) {}

  void list(const MeasureSettings& settings, std::vector<Cavity>& cavities,
            std::vector<Piece>& pieces) {
    list_atoms(cavities, pieces);
    add_walls(cavities, pieces);
    if (settings.largest_probes) find_largest_probes(settings, cavities);
    for (const auto& [first, second] : components_.overlaps) {
      if (first == Components::outside) {
        cavities[cavity_of(second)].overlaps_outside = true;
        continue;
      }
      cavities[cavity_of(first)].overlaps.push_back(cavity_of(second));
      cavities[cavity_of(second)].overlaps.push_back(cavity_of(first));
    }
    sort(cavities, pieces);
  }

 private:
  // Returns the index of the cavity of a component until cavities are sorted.
  static std::size_t cavity_of(ComponentIndex component) {
    return as_number(component) - std::size_t{1};
  }

  void list_atoms(std::vector<Cavity>& cavities, std::vector<Piece>& pieces) {
    cavities.assign(components_.count - 1, {});
    pieces.clear();
    for (AtomIndex i = 0; i < surface_.atoms.size(); ++i) {
      if (components_.piece_of_atom[i] == pieces.size()) pieces.emplace_back();
      pieces[components_.piece_of_atom[i]].atoms.push_back(i);
      components_.for_each_wall_of(i, [&](WallIndex wall) {
        const ComponentIndex component = components_[wall].component;
        if (component == Components::outside) return;
        std::vector<AtomIndex>& atoms = cavities[cavity_of(component)].atoms;
        if (atoms.empty() || atoms.back() != i) atoms.push_back(i);
      });
    }
    for (const Wall& wall : components_.walls)
      if (!wall.atom && wall.component != Components::outside)
        cavities[cavity_of(wall.component)].atoms =
            touched_atoms(surface_, 0.5 * (wall.box.low + wall.box.high));
  }

  void add_walls(std::vector<Cavity>& cavities, std::vector<Piece>& pieces) {
    std::vector<WallSums> by_cavity(cavities.size()), by_piece(pieces.size());
    for (Cavity& cavity : cavities) cavity.wall_count = 0;
    for (const Wall& wall : components_.walls) {
      const bool is_outside = wall.component == Components::outside;
      if (is_outside && !wall.atom) continue;
      const std::size_t c = cavity_of(wall.component);
      const std::size_t piece =
          components_.piece_of_atom[wall.atom ? *wall.atom : cavities[c].atoms.front()];
      by_piece[piece].add(wall);
      if (is_outside) continue;
      by_cavity[c].add(wall);
      ++cavities[c].wall_count;
      if (wall.encloses_atoms) {
        cavities[c].inner.push_back(piece);
        pieces[piece].cavity = c;
      } else {
        cavities[c].piece = piece;
        ++pieces[piece].cavity_count;
      }
    }
    for (std::size_t c = 0; c < cavities.size(); ++c) {
      by_cavity[c].patches += components_.corrections[c + 1];
      describe(by_cavity[c], cavities[c]);
    }
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      pieces[k].ses_area = by_piece[k].ses_area();
      pieces[k].ses_volume = std::max(0.0, by_piece[k].ses_flux() / 3);
      pieces[k].sas_area = by_piece[k].faces.sas_area;
      pieces[k].sas_volume = std::max(0.0, by_piece[k].faces.sas_flux / 3);
      pieces[k].euler_number = by_piece[k].euler_number();
    }
  }

  // Normals point towards the probe centres, that is, inwards.
  void describe(const WallSums& sums, Cavity& cavity) const {
    cavity.void_volume = std::max(0.0, -sums.ses_flux() / 3);
    cavity.probe_center_volume = std::max(0.0, -sums.faces.sas_flux / 3);
    cavity.ses_area = sums.ses_area();
    cavity.sas_area = sums.faces.sas_area;
    cavity.euler_number = sums.euler_number();
    // Rounding would move the centroid of a very small cavity.
    const Vec3 centroid = cavity.probe_center_volume > 0
                              ? origin_ - (1 / cavity.probe_center_volume) * sums.moment
                              : 0.5 * (sums.box.low + sums.box.high);
    cavity.centroid = clamped(centroid, sums.box);
    const Box box = grown(sums.box, probe_radius_);
    cavity.low = box.low;
    cavity.high = box.high;
  }

  void find_largest_probes(const MeasureSettings& settings, std::vector<Cavity>& cavities) const {
    SerialCheck serial_check(settings.check);
    const CheckCallback check = [&] { serial_check(); };
    for_each_index(cavities.size(), settings.threads, [&](std::size_t c) {
      const Box centers = grown({cavities[c].low, cavities[c].high}, -probe_radius_);
      const LargestProbe probe =
          find_largest_probe(surface_, components_, static_cast<ComponentIndex>(c + 1), centers,
                             cavities[c].atoms, check);
      cavities[c].largest_probe = std::max(probe.radius, probe_radius_);
      cavities[c].largest_probe_center = probe.center;
    });
  }

  static void sort(std::vector<Cavity>& cavities, std::vector<Piece>& pieces) {
    const auto cavity_order = order_by_void(cavities);
    const auto piece_order = order_by(pieces, &Piece::sas_volume);
    const auto cavity_rank = inverse_of(cavity_order), piece_rank = inverse_of(piece_order);
    reorder(cavities, cavity_order);
    reorder(pieces, piece_order);
    for (Cavity& cavity : cavities) {
      cavity.piece = piece_rank[cavity.piece];
      for (std::size_t& piece : cavity.inner) piece = piece_rank[piece];
      for (std::size_t& other : cavity.overlaps) other = cavity_rank[other];
      std::sort(cavity.inner.begin(), cavity.inner.end());
      std::sort(cavity.overlaps.begin(), cavity.overlaps.end());
    }
    for (Piece& piece : pieces)
      if (piece.cavity) piece.cavity = cavity_rank[*piece.cavity];
  }

  const SurfaceModel& surface_;
  Vec3 origin_;
  double probe_radius_;
  const Components& components_;
};

}  // namespace

std::vector<std::size_t> order_by_void(const std::vector<Cavity>& cavities) {
  return order_by(cavities, &Cavity::void_volume);
}

void list_components(const SurfaceModel& surface, Vec3 origin, const MeasureSettings& settings,
                     const Components& components, std::vector<Cavity>& cavities,
                     std::vector<Piece>& pieces) {
  CavityLister(surface, origin, settings.probe_radius, components).list(settings, cavities, pieces);
}

}  // namespace eses::detail
