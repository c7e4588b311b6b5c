#pragma once
/// Chunks of planes and checkpoints. A chunk has the pieces and sums of a range of planes; all
/// chunks are merged into the output files at the end of a run. A checkpoint keeps them on disk, so
/// that an interrupted run can be resumed. Only open_checkpoint communicates with other processes.

#include <array>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "geometry/plane_range.hpp"
#include "input/atom_names.hpp"
#include "output/file.hpp"
#include "output/output_directory.hpp"
#include "run/input_atoms.hpp"
#include "run/plan.hpp"
#include "run/request.hpp"
#include "solve/region_totals.hpp"
#include "system/processes.hpp"

namespace eses::detail {

/// An atom's area share of a chunk, in units of `area_share_unit`.
struct AtomSum {
  AreaShare share = 0;
  FileIndex atom{};
  std::array<std::uint32_t, 3> padding{};  ///< explicit padding, as the struct is written to disk
};

/// A chunk of planes without its pieces.
struct PlaneChunk {
  PlaneRange planes;
  std::uint64_t bytes = 0;  ///< length of all pieces, see chunks.hpp
  RegionTotals totals;
  /// Shares of the atoms with a share that is not 0, ascending.
  std::vector<AtomSum> atom_sums;
};

/// Name of the file in the directory of a checkpoint that identifies the run.
inline constexpr char run_name[] = "run";

/// Removes the checkpoint that an earlier run has left in an output directory.
void remove_checkpoint(const std::filesystem::path& output_directory) noexcept;

/// A hidden directory in the output directory that keeps the chunks of a run, so that another run
/// can continue. A chunk has a file of its pieces and a file of its sums, which is written last: a
/// chunk with sums is complete. All failures throw Error.
class Checkpoint {
 public:
  /// Whether the chunks of a run that fails are kept, so that another run can continue.
  enum class Chunks : bool { temporary, kept };
  /// `identity` identifies the run, see identity.hpp: runs whose chunks must not be combined have
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
  /// or with pieces of the wrong length is not complete. Throws Error if there are chunks of a run
  /// with another identity, or if the file with the identity is damaged.
  std::vector<PlaneRange> complete() const;
  /// Removes the files of all chunks except `complete`.
  void remove_others(std::span<const PlaneRange> complete);
  /// Marks a chunk as incomplete.
  void drop(const PlaneRange& planes);
  /// Writes the identity. Must be called before the first chunk is written.
  void prepare();

  /// Creates the file of the pieces of a chunk, and marks the chunk as incomplete.
  ScratchFile create(const PlaneRange& planes);
  /// Writes the sums of a chunk whose pieces are on the disk, which makes it complete.
  void finish(const PlaneChunk& chunk);
  /// Reads a complete chunk.
  PlaneChunk read(const PlaneRange& planes) const;
  /// Opens the file of the pieces of a chunk.
  ScratchFile open(const PlaneRange& planes) const;
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

/// The checkpoint of a run, and the planes that earlier runs have finished.
struct OpenCheckpoint {
  std::unique_ptr<Checkpoint> checkpoint;  ///< null if the run needs none
  std::vector<PlaneRange> finished;        ///< ascending and disjoint
};

/// Opens the checkpoint of a run that needs one: of several processes, or whose chunks are kept.
/// The first process locks it. All processes must call it. Throws SharedError if they have read
/// different atoms, and NotJoined or an error if the chunks cannot be used.
OpenCheckpoint open_checkpoint(const InputAtoms& input, const Request& request, const Plan& plan,
                               const Processes& processes);

}  // namespace eses::detail
