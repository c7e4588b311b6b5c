#pragma once
/// Meshes in memory, from points and crossings in memory.

#include <cstdint>
#include <functional>

#include "eses/check.hpp"
#include "eses/compute.hpp"

namespace eses::detail {

/// Returns the component of a crossing. See Mesh::components.
using ComponentOfVertex = std::function<std::uint32_t(const Crossing& crossing)>;

/// Returns the mesh of the cells that have all their corners in the region of a result. `check` is
/// called for every plane, if it is not empty. See MeshOptions::quality for `quality`. The mesh has
/// components unless `component_of` is empty.
Mesh mesh_in_memory(const Result& result, const CheckCallback& check, bool quality = false,
                    const ComponentOfVertex& component_of = {});

}  // namespace eses::detail
