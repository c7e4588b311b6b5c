// Prints a triangle mesh of a molecule's surface in the OFF format.
//
//   mesh-to-off FILE [SPACING]

#include <cstdio>
#include <cstdlib>
#include <eses/eses.hpp>
#include <exception>

int main(int argc, char** argv) try {
  if (argc < 2 || argc > 3) {
    std::fputs("usage: mesh-to-off FILE [SPACING]\n", stderr);
    return 2;
  }
  const eses::Surface surface(eses::read_atoms(argv[1]));
  const double spacing = argc > 2 ? std::atof(argv[2]) : 0.5;
  const eses::Grid grid = eses::make_grid(surface, {.spacing = spacing, .margin = 2 * spacing});
  const eses::Result result = eses::compute(surface, grid, {.mesh = true});
  const eses::Mesh& mesh = result.mesh().value();

  std::printf("OFF\n%zu %zu 0\n", mesh.vertices.size(), mesh.faces.size());
  for (const eses::Vec3& vertex : mesh.vertices)
    std::printf("%.6f %.6f %.6f\n", vertex.x, vertex.y, vertex.z);
  for (const auto& [a, b, c] : mesh.faces)
    std::printf("3 %llu %llu %llu\n", static_cast<unsigned long long>(a),
                static_cast<unsigned long long>(b), static_cast<unsigned long long>(c));
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "mesh-to-off: %s\n", error.what());
  return 1;
}
