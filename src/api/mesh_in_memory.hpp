#pragma once
/// Meshes in memory, from points and crossings in memory.

#include <cstdint>
#include <functional>
#include <span>

#include "eses/check.hpp"
#include "eses/compute.hpp"

namespace eses::detail {

/// Returns the component of a crossing. See Mesh::components.
using ComponentOfVertex = std::function<std::uint32_t(const Crossing& crossing)>;

/// Returns the mesh of the cells that have all their corners in a region. `inside` and `crossings`
/// are the values of a Result. `check` is called for every plane, if it is not empty. See
/// MeshOptions::quality for `quality`. The mesh has components unless `component_of` is empty.
Mesh make_mesh(const eses::Grid& grid, const GridRegion& region,
               std::span<const std::uint8_t> inside, std::span<const eses::Crossing> crossings,
               const CheckCallback& check, bool quality = false,
               const ComponentOfVertex& component_of = {});

}  // namespace eses::detail
