#pragma once
/// Strict readers of the four files of a run. A line that differs from the format in any way is an
/// error.

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "eses/atoms.hpp"
#include "eses/grid.hpp"
#include "eses/vec3.hpp"
#include "support/run.hpp"

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

/// Returns the bytes of a file. Throws std::runtime_error if it cannot be read.
std::string read_bytes(const std::filesystem::path& path);

/// Returns the text of a gzipped file, by zlib's own reader of files. Throws std::runtime_error if
/// the file is not gzipped or damaged.
std::string read_gzipped(const std::filesystem::path& path);

/// Reads the files of a run. Throws std::runtime_error, naming file and line, at the first
/// malformed line. The oracle checks whether the numbers are right (brute_force.hpp).
EsesFiles read_eses_files(const std::filesystem::path& directory);

struct RunResult {
  EsesFiles files;
  Summary summary;
};

/// Computes all outputs in a temporary directory and reads them back.
RunResult run_and_read(const Molecule& molecule, const Parameters& parameters);

}  // namespace eses::detail::test
