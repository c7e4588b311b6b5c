#pragma once
/// A process's part in a joint run, up to what is to be joined.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "checkpoint/pieces.hpp"
#include "compute/joint_run.hpp"
#include "distributed/processes.hpp"
#include "mesh/mesh_writer.hpp"
#include "sweep/patch_schedule.hpp"
#include "sweep/progress_report.hpp"
#include "sweep/verifier.hpp"

namespace eses {

class SlabRun {
 public:
  /// Keeps references to all but `processes`.
  SlabRun(const JointTask& task, const JointPlan& plan, const Callbacks& callbacks,
          const Processes& processes);

  /// Makes the pieces of the slab that are not done, and adds what they took, and what their
  /// verification finds, to the summary.
  std::vector<Piece> solve(Summary& summary);

  /// The mesh's, if there is one.
  const mesh::MeshText& mesh_text() const { return mesh_text_.value(); }

  /// Lets the callback end the run.
  void check() { report_.check(); }

 private:
  std::int64_t count_blocks() const;
  std::int64_t checks_of(const PlaneRange& planes) const;
  bool verify(Verifier& verifier, Summary& summary);
  Piece new_piece(const PlaneRange& planes) const;
  std::unique_ptr<ScratchFile> new_text(const PlaneRange& planes, PieceText text) const;
  Plan plan_of(const PlaneRange& planes) const;
  std::vector<AtomSum> sums_of(std::span<const AreaShare> shares) const;
  Piece solve(PatchSchedule& patches, const PlaneRange& planes, Summary& summary);

  const JointTask& task_;
  const JointPlan& plan_;
  const Callbacks& callbacks_;
  Processes::Share share_;  // of what is to be verified
  std::vector<PlaneRange> to_do_;
  std::optional<mesh::MeshText> mesh_text_;
  ProgressReport report_;
};

}  // namespace eses
