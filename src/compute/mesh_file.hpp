#pragma once
/// The mesh's file of a run that writes all of it.

#include <cstdint>
#include <functional>
#include <span>

#include "eses/run.hpp"
#include "mesh/mesh_writer.hpp"
#include "output/output_file.hpp"
#include "output/scratch_file.hpp"
#include "sweep/mesh_output.hpp"

namespace eses {

/// Vertices go into the file, triangles into a scratch file until all vertices are there.
class MeshFile {
 public:
  /// Keeps references to `plan`, `labels` and `file`. The scratch file is in `directory`.
  MeshFile(const Plan& plan, const MeshChoice& choice, std::span<const AtomLabel> labels,
           OutputFile& file, const std::filesystem::path& directory);

  MeshOutput& output() { return output_; }

  /// Completes the file, and returns its bytes. Calls `check` now and then.
  std::uint64_t finish(const MeshCounts& counts, const std::function<void()>& check);

 private:
  OutputFile& file_;
  ScratchFile triangles_;
  mesh::MeshText text_;
  std::uint64_t header_bytes_;
  MeshOutput output_;
};

}  // namespace eses
