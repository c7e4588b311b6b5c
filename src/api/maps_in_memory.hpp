#pragma once
/// Receivers of map rows that keep the values in memory.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "eses/grid.hpp"
#include "output/map_writer.hpp"
#include "run/run_plan.hpp"

namespace eses::detail {

/// Returns receivers that put the values of dielectric maps into `values`, in the order of
/// Result::inside. Keeps a reference to `values`, which must have a value for each point of
/// `region`.
std::vector<MapSink> dielectric_receivers(std::span<const MapChoice> maps, const GridRegion& region,
                                          std::array<std::vector<double>, 3>& values);

/// Does the same for a map of the access of ions.
MapSink ion_access_receiver(const GridRegion& region, std::vector<std::uint8_t>& values);

}  // namespace eses::detail
