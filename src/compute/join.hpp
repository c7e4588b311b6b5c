#pragma once
/// How the files of a joint run are made of what all processes have.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "checkpoint/pieces.hpp"
#include "compute/joint_run.hpp"
#include "distributed/processes.hpp"
#include "distributed/shared_file.hpp"
#include "mesh/mesh_writer.hpp"
#include "output/output_file.hpp"
#include "sweep/region_totals.hpp"

namespace eses {

/// All of it is to be called by all processes. Where a file is asked for, the first process has it,
/// and the others give null.
class Join {
 public:
  /// Keeps references to all but `check`, which is called now and then, and may end the run.
  Join(const JointTask& task, const JointPlan& plan, const Processes& processes,
       std::function<void()> check);

  /// Learns of all pieces, of which this process has `own`. Throws SharedError if they are not
  /// those of the whole run, or the mesh would have too many vertices.
  void take(std::vector<Piece> own);

  const RegionTotals& totals() const { return totals_; }
  const MeshCounts& mesh_counts() const { return mesh_; }

  /// Each of the following returns the bytes of the files that it makes.
  std::uint64_t join_texts(OutputFile* file, PieceText text);
  std::uint64_t join_map(OutputFile* file);
  std::uint64_t join_mesh(OutputFile* file, const mesh::MeshText& text);

  /// Each process adds up, and writes, the areas of as many atoms; `area` becomes their sum in the
  /// order of atoms, as that of numbers with a point depends on it.
  std::uint64_t join_areas(OutputFile* file, double& area);
  /// After it, of the same areas.
  std::uint64_t join_tables(OutputFile* residues, OutputFile* chains);

 private:
  void add_up();
  template <class Take>
  void read(Piece& piece, PieceText text, std::uint64_t unit, Take&& take) const;
  template <class Amount, class Action>
  std::uint64_t for_own(Amount&& amount, Action&& action);
  std::uint64_t copy(PieceText text, SharedFile& to, std::uint64_t begin);
  std::uint64_t write_mesh_header(SharedFile& file, const mesh::MeshText& text) const;
  template <class Take>
  void for_triangle_texts(Piece& piece, std::uint64_t first_vertex, const mesh::MeshText& text,
                          Take&& take) const;
  std::uint64_t write_triangles(SharedFile& file, std::uint64_t offset, const mesh::MeshText& text);
  std::uint64_t write_empty_member(SharedFile& file) const;
  Processes::Share share_of(int rank) const;
  std::vector<double> own_areas();
  template <class Take>
  void for_area_texts(Take&& take) const;

  const JointTask& task_;
  const JointPlan& plan_;
  const Processes& processes_;
  std::function<void()> check_;
  std::vector<PieceInfo> all_;  // by planes
  std::vector<Piece> own_;      // likewise
  RegionTotals totals_;
  MeshCounts mesh_;
  std::vector<double> areas_;  // of this process's share of the atoms
};

}  // namespace eses
