// Computes the surface area of each frame of a trajectory, for scripts/benchmarks/trajectory.
//
//   trajectory-loop ATOMS FRAMES COUNT SPACING
//
// FRAMES holds COUNT frames of doubles x, y, z. With SPACING 0, the surfaces are measured without a
// grid. Prints the sum of the areas and the CPU time.

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <eses/eses.hpp>
#include <exception>
#include <fstream>
#include <stdexcept>
#include <vector>

namespace {

double cpu_seconds() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

std::vector<double> read_numbers(const char* path, std::size_t count) {
  std::vector<double> numbers(count);
  std::ifstream file(path, std::ios::binary);
  file.read(reinterpret_cast<char*>(numbers.data()),
            static_cast<std::streamsize>(count * sizeof(double)));
  if (!file) throw std::runtime_error("too few numbers in the file of frames");
  return numbers;
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 5) {
    std::fputs("usage: trajectory-loop ATOMS FRAMES COUNT SPACING\n", stderr);
    return 2;
  }
  const std::vector<eses::Atom> atoms = eses::read_atoms(argv[1]).atoms;
  const auto frames = static_cast<std::size_t>(std::atoll(argv[3]));
  const double spacing = std::atof(argv[4]);
  const std::vector<double> centers = read_numbers(argv[2], 3 * frames * atoms.size());
  double sum = 0;
  const double start = cpu_seconds();
  for (std::size_t frame = 0; frame < frames; ++frame) {
    std::vector<eses::Atom> moved = atoms;
    const double* next = &centers[3 * frame * atoms.size()];
    for (eses::Atom& atom : moved) {
      atom.center = {next[0], next[1], next[2]};
      next += 3;
    }
    const eses::Surface surface(std::move(moved));
    if (spacing == 0) {
      sum += eses::measure(surface, {.threads = 1}).ses_area;
      continue;
    }
    const eses::Grid grid = eses::make_grid(surface, {.spacing = spacing, .margin = 2 * spacing});
    sum += eses::compute(surface, grid, {.threads = 1}).area();
  }
  std::printf("%.17g %.6f\n", sum, cpu_seconds() - start);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "trajectory-loop: %s\n", error.what());
  return 1;
}
