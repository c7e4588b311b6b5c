#pragma once
/// The four files of a run, read back as another program would read them, but without mercy: a
/// line that is not exactly as the format says is an error.

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "compute/run.hpp"
#include "eses/atoms.hpp"
#include "eses/grid.hpp"
#include "eses/vec3.hpp"

namespace eses::detail::test {

struct GridPoint {
  GridIndex index{};
  int sign = 0;  ///< 1 inside, -1 outside
};

struct Crossing {
  GridIndex inside{};
  GridIndex outside{};
  Vec3 point;
  Vec3 normal;
  std::vector<std::int64_t> atoms;
};

struct AtomArea {
  std::int64_t atom = 0;
  double area = 0;
};

struct EsesFiles {
  Vec3 lower;
  Vec3 upper;
  GridIndex size{};
  std::vector<GridPoint> points;
  std::vector<Crossing> crossings;
  std::vector<AtomArea> areas;
};

/// The names of the four files, in the order in which EsesFiles holds them.
inline constexpr const char* eses_file_names[] = {"bounding_box.txt", "grid_info.txt",
                                                  "intersection_info.txt", "partition_area.txt"};

/// The bytes of a file. Throws std::runtime_error if it cannot be read.
std::string read_bytes(const std::filesystem::path& path);

/// Throws std::runtime_error, naming file and line, at the first malformed line. Whether the
/// numbers make sense is for the oracle to say, see brute_force.hpp.
EsesFiles read_eses_files(const std::filesystem::path& directory);

struct RunResult {
  EsesFiles files;
  Summary summary;
};

/// Runs with all outputs, into a directory that is gone afterwards, and reads them back.
RunResult run_and_read(const Molecule& molecule, const Parameters& parameters);

}  // namespace eses::detail::test
