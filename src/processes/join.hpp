#pragma once
/// How the files of a joint run are made of what all processes have.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "io/output_file.hpp"
#include "processes/joint_run.hpp"
#include "processes/pieces.hpp"
#include "processes/processes.hpp"
#include "processes/shared_file.hpp"
#include "run/region_totals.hpp"

namespace eses {

/// All of it is to be called by all processes. Where a file is asked for, the first process has it,
/// and the others give null.
class Join {
 public:
  /// Keeps references to all but `check`, which is called now and then, and may end the run.
  Join(const JointTask& task, const JointPlan& plan, const JointPaths& paths,
       const Processes& processes, std::function<void()> check);

  /// Learns of all pieces, of which this process has `own`. Throws SharedError if they are not
  /// those of the whole run.
  void take(std::vector<Piece> own);

  const RegionTotals& totals() const { return totals_; }

  /// Returns the bytes of the file.
  std::uint64_t join_texts(OutputFile* file, const char* name, PieceText text);

  /// Each process adds up, and writes, the areas of as many atoms; `area` becomes their sum in the
  /// order of atoms, as that of numbers with a point depends on it. Returns the bytes of the file.
  std::uint64_t join_areas(OutputFile* file, double& area);

 private:
  void add_up();
  SharedFile open(OutputFile* file, const char* name) const;
  void copy(Piece& piece, PieceText text, SharedFile& to, std::uint64_t offset) const;
  std::uint64_t write_empty_member(SharedFile& file) const;
  Processes::Share share_of(int rank) const;
  std::vector<double> own_areas();
  template <class Take>
  void for_area_texts(std::span<const double> areas, Take&& take) const;

  const JointTask& task_;
  const JointPlan& plan_;
  const JointPaths& paths_;
  const Processes& processes_;
  std::function<void()> check_;
  std::vector<PieceInfo> all_;  // by planes
  std::vector<Piece> own_;      // likewise
  RegionTotals totals_;
};

}  // namespace eses
