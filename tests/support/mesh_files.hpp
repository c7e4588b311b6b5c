#pragma once
/// Readers of meshes, and checks of their shape.

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "eses/vec3.hpp"
#include "surface/molecule.hpp"

namespace eses::detail::test {

using MeshTriangle = std::array<std::uint64_t, 3>;

/// A mesh that was read. Values that the format does not have are empty.
struct Mesh {
  std::vector<Vec3> positions, normals;
  std::vector<int> patches;
  std::vector<std::uint32_t> atoms, chains, residues, components;
  std::vector<double> potentials;
  std::vector<std::array<int, 3>> colors;
  std::vector<MeshTriangle> triangles;
  std::vector<int> triangle_patches;
  std::vector<std::string> comments;
  std::vector<std::string> chain_names, residue_names;  ///< in VTP files
  std::array<double, 4> msms_header{};  ///< vertices, spheres, density, probe radius
};

/// Reads a mesh; the suffix decides. A .vert file is read together with its .face file, and `atoms`
/// are then the closest spheres, from 0. In an .stl file, each triangle has its own vertices and
/// one normal. Throws std::runtime_error if a file violates the format.
Mesh read_mesh(const std::filesystem::path& path);

/// Returns the faults that keep triangles from being a closed, oriented 2-manifold, one line each:
/// an edge that does not occur once in each direction, a vertex whose triangles are not one fan, a
/// vertex without triangles, or a repeated triangle.
std::vector<std::string> find_mesh_faults(std::size_t vertices,
                                          std::span<const MeshTriangle> triangles);

struct MeshMeasures {
  double area = 0;
  double volume = 0;    ///< positive if triangles are counterclockwise seen from outside
  double min_area = 0;  ///< smallest area of a triangle
  std::int64_t euler_number = 0;
  std::size_t components = 0;
};

MeshMeasures measure(const Mesh& mesh);

void check_no_faults(const Mesh& mesh);

/// Four atoms of three residues in two chains, one of which is interrupted by the other.
Molecule make_two_chains();

}  // namespace eses::detail::test
