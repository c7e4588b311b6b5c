#pragma once
/// What is done of a run: texts and sums of ranges of planes, to be joined in the end.

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/scratch_file.hpp"
#include "processes/processes.hpp"
#include "processes/slabs.hpp"
#include "run/region_totals.hpp"

namespace eses {

/// An atom's share of the area of some planes, as in Tally.
struct AtomSum {
  Tally::Sum share = 0;
  AtomIndex atom = 0;  ///< in the file
};

/// The texts of a piece, numbered.
enum class PieceText : std::uint8_t { grid, edges };
inline constexpr std::size_t piece_texts = 2;

/// All that other processes are told of a piece.
struct PieceInfo {
  PlaneRange planes;
  std::array<std::uint64_t, piece_texts> bytes{};
  RegionTotals totals;
};

struct Piece {
  PieceInfo info;
  std::vector<AtomSum> sums;  ///< of atoms whose share is not 0, ascending
  /// While they are being written, and afterwards unless they are in a store.
  std::array<std::unique_ptr<ScratchFile>, piece_texts> texts;
};

/// Keeps the pieces of a run so that another one can go on from them: in a hidden directory beside
/// the files, texts as they are, and behind them, when they are complete, the sums. Every failure
/// throws Error.
class PieceStore {
 public:
  /// `identity` is a text that tells apart runs whose pieces do not fit together.
  PieceStore(const std::filesystem::path& output_directory, std::string identity);

  /// The pieces that are complete, ascending and disjoint. Throws Error if they are of a run of
  /// another identity.
  std::vector<PlaneRange> complete() const;

  /// Creates the directory, if need be, for a run of this identity.
  void prepare() const;
  /// For a piece's text that is to be written.
  std::unique_ptr<ScratchFile> create(const PlaneRange& planes, PieceText text) const;
  /// Writes the sums behind its texts; from then on the piece is complete, and nothing of it needs
  /// to be held.
  void finish(Piece piece) const;
  /// A complete piece without its texts.
  Piece read(const PlaneRange& planes) const;
  std::unique_ptr<ScratchFile> open(const PlaneRange& planes, PieceText text) const;

 private:
  std::filesystem::path path_;
  std::string identity_;
};

}  // namespace eses
