#pragma once
/// Chunks of planes and checkpoints. A chunk has the texts and sums of a range of planes; all
/// chunks are merged into the output files at the end of a run. A checkpoint keeps them on disk, so
/// that an interrupted run can be resumed. Nothing here communicates with other processes.

#include <array>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "grid/plane_range.hpp"
#include "output/file.hpp"
#include "output/map_writer.hpp"
#include "output/output_directory.hpp"
#include "run/range_sums.hpp"
#include "run/request.hpp"

namespace eses::detail {

/// The texts of a chunk: the lines of grid_info.txt and intersection_info.txt, the pieces of the
/// mesh (see piece_bytes.hpp), and rows of words for each map, by its quantity.
enum class ChunkText : std::uint8_t { grid, edges, mesh, first_map };
inline constexpr std::size_t chunk_text_count =
    static_cast<std::size_t>(ChunkText::first_map) + map_quantities;

/// Returns the text with the rows of a map.
constexpr ChunkText text_of(MapQuantity quantity) {
  return static_cast<ChunkText>(static_cast<std::size_t>(ChunkText::first_map) +
                                static_cast<std::size_t>(quantity));
}

/// The data of a chunk besides its texts and the sums of its atoms.
struct ChunkInfo {
  PlaneRange planes;
  std::array<std::uint64_t, chunk_text_count> bytes{};      ///< length of each text
  std::array<std::uint32_t, chunk_text_count> checksums{};  ///< crc32
  RangeSums sums;

  /// Length of a text in bytes.
  std::uint64_t bytes_of(ChunkText text) const { return bytes[static_cast<std::size_t>(text)]; }
};

/// A chunk of planes without its texts.
struct PlaneChunk {
  ChunkInfo info;
  /// Shares of the atoms with a share that is not 0, ascending.
  std::vector<AtomSum> atom_sums;
};

/// The checksum of a text that several threads write in parts, in any order.
class TextChecksum {
 public:
  /// Adds a part of the text. Several threads may call it at the same time.
  void add(std::span<const char> text, std::uint64_t offset);
  /// Returns the checksum of the whole text. The parts must leave no gaps.
  std::uint32_t value() const;

 private:
  struct Part {
    std::uint64_t bytes;
    std::uint32_t checksum;
  };
  std::mutex mutex_;
  std::map<std::uint64_t, Part> parts_;  // by offset
};

/// Name of the file in the directory of a checkpoint that identifies the run.
inline constexpr char run_name[] = "run";

/// Removes the checkpoint that an earlier run has left in an output directory.
void remove_checkpoint(const std::filesystem::path& output_directory) noexcept;

/// A hidden directory in the output directory that keeps the chunks of a run, so that another run
/// can continue. Each text of a chunk is a file. The file of the sums is written last: a chunk with
/// sums is complete. All failures throw Error.
class Checkpoint {
 public:
  /// Whether the chunks of a run that fails are kept, so that another run can continue.
  enum class Chunks : bool { temporary, kept };
  /// `identity` is a text that identifies the run: runs whose chunks must not be combined have
  /// different identities.
  Checkpoint(const std::filesystem::path& output_directory, std::string identity, Chunks chunks);
  /// Removes temporary chunks, and the directory if it is empty.
  ~Checkpoint();
  Checkpoint(const Checkpoint&) = delete;
  Checkpoint& operator=(const Checkpoint&) = delete;

  /// Creates the directory if necessary, and locks it against other runs while this object exists.
  void lock();
  /// Does the same, but lets runs of other parts use the directory at the same time. Throws Error
  /// if it belongs to another run, even if that run has no complete chunk.
  void lock_part(const Share& part);
  /// Unlocks the directory, and removes it if it is empty.
  void unlock();
  /// Whether the file system supports locks.
  bool is_locked() const { return lock_ && lock_->is_locked(); }
  /// Returns the planes of the complete chunks, ascending and disjoint. A chunk with damaged sums
  /// or with texts of the wrong length is not complete. Throws Error if there are chunks of a run
  /// with another identity, or if the file with the identity is damaged.
  std::vector<PlaneRange> complete() const;
  /// Removes the files of all chunks except `complete`.
  void remove_others(std::span<const PlaneRange> complete);
  /// Marks a chunk as incomplete.
  void drop(const PlaneRange& planes);
  /// Writes the identity. Must be called before the first chunk is written.
  void prepare();

  /// Creates the scratch file of a text, and marks the chunk as incomplete.
  std::unique_ptr<ScratchFile> create(const PlaneRange& planes, ChunkText text);
  /// Writes the sums of a chunk whose texts are on the disk, which makes it complete.
  void finish(const PlaneChunk& chunk);
  /// Reads a complete chunk.
  PlaneChunk read(const PlaneRange& planes) const;
  /// Opens the scratch file of a text.
  std::unique_ptr<ScratchFile> open(const PlaneRange& planes, ChunkText text) const;
  /// Removes the checkpoint.
  void remove();
  /// Removes temporary chunks before a failed process ends all others.
  void remove_temporary() noexcept;

 private:
  bool is_complete(const PlaneRange& planes) const;
  void require_same_run() const;
  std::string sums_path(const PlaneRange& planes) const;
  void write_complete(const std::string& name, std::initializer_list<std::span<const char>> parts);

  std::filesystem::path path_;
  std::string identity_;
  Chunks chunks_;
  std::optional<OutputDirectory> lock_, part_lock_;
};

}  // namespace eses::detail
