#pragma once
/// Chunks: the texts and sums of ranges of planes, which are merged into the files in the end. A
/// checkpoint keeps them on disk, so that a run that was cut off can be resumed. May use what the
/// sweep delivers and scratch files, but knows nothing of other processes.

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "grid/plane_range.hpp"
#include "output/output_directory.hpp"
#include "output/scratch_file.hpp"
#include "sweep/region_totals.hpp"

namespace eses::detail {

/// An atom's share of the area of some planes, in units of `area_share_unit`.
struct AtomSum {
  AreaShare share = 0;
  AtomIndex atom = 0;                      ///< in the file
  std::array<std::uint32_t, 3> padding{};  ///< these bytes are written, too
};

/// The texts of a chunk, numbered: those of grid_info.txt and intersection_info.txt, rows of words
/// for the map, and of the mesh vertices as text of its format and triangles as
/// mesh::LocalTriangle.
enum class ChunkText : std::uint8_t { grid, edges, map, vertices, triangles };
inline constexpr std::size_t chunk_text_count = 5;

/// The data of a chunk that all processes know.
struct ChunkInfo {
  PlaneRange planes;
  std::array<std::uint64_t, chunk_text_count> bytes{};
  std::array<std::uint32_t, chunk_text_count> checksums{};  ///< crc32; of chunks in a checkpoint
  std::uint32_t padding = 0;                                ///< these bytes are written, too
  MeshCounts mesh;
  RegionTotals totals;

  std::uint64_t bytes_of(ChunkText text) const { return bytes[static_cast<std::size_t>(text)]; }
};

struct PlaneChunk {
  ChunkInfo info;
  std::vector<AtomSum> sums;  ///< of atoms whose share is not 0, ascending; only for a checkpoint
  /// Open while they are written, and afterwards unless they are in a checkpoint.
  std::array<std::unique_ptr<ScratchFile>, chunk_text_count> texts;
  /// The chunk is the whole run, and texts without a scratch file are at their place in the final
  /// files. The triangles are in a scratch file, as text of the mesh's format.
  bool is_in_place = false;
  bool is_restored = false;  ///< left by an earlier run, so that its texts may be damaged

  /// The scratch file of a text; null where there is none.
  std::unique_ptr<ScratchFile>& text(ChunkText which) {
    return texts[static_cast<std::size_t>(which)];
  }
};

/// The checksum of a text that is written in parts, in any order and by several threads.
class TextChecksum {
 public:
  void add(std::span<const char> text, std::uint64_t offset);
  /// Of all parts, which must leave no gaps.
  std::uint32_t value() const;

 private:
  struct Part {
    std::uint64_t bytes;
    std::uint32_t checksum;
  };
  std::mutex mutex_;
  std::map<std::uint64_t, Part> parts_;  // by offset
};

/// Keeps the chunks of a run so that another one can go on from them: in a hidden directory beside
/// the files, texts as they are, and behind them, when they are complete, the sums. Every failure
/// throws Error.
class Checkpoint {
 public:
  /// `identity` is a text that tells apart runs whose chunks do not fit together.
  Checkpoint(const std::filesystem::path& output_directory, std::string identity);
  /// Removes the directory if nothing is in it.
  ~Checkpoint();
  Checkpoint(const Checkpoint&) = delete;
  Checkpoint& operator=(const Checkpoint&) = delete;

  /// Creates the directory, if need be, and locks it against other runs while this lives.
  void lock();
  /// The chunks that are complete, ascending and disjoint; of one whose sums are damaged or whose
  /// texts are not as long as they should be nothing is told, so that it is done again. Throws
  /// Error if there are chunks of a run of another identity.
  std::vector<PlaneRange> complete() const;
  /// Removes what is there of chunks that are not among these.
  void remove_others(std::span<const PlaneRange> complete) const;
  /// Drops a chunk, so that it is done again.
  void drop(const PlaneRange& planes) const;
  /// Says that what comes is of this identity.
  void prepare() const;

  /// For a chunk's text that is to be written.
  std::unique_ptr<ScratchFile> create(const PlaneRange& planes, ChunkText text) const;
  /// Writes the sums behind its texts; from then on the chunk is complete, and nothing of it needs
  /// to be held.
  void finish(const PlaneChunk& chunk) const;
  /// A complete chunk without its texts.
  PlaneChunk read(const PlaneRange& planes) const;
  std::unique_ptr<ScratchFile> open(const PlaneRange& planes, ChunkText text) const;
  /// Removes everything.
  void remove();

 private:
  bool is_whole(const PlaneRange& planes) const;
  std::string sums_path(const PlaneRange& planes) const;

  std::filesystem::path path_;
  std::string identity_;
  std::optional<OutputDirectory> lock_;
};

}  // namespace eses::detail
