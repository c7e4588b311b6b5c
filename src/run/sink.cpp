#include "run/sink.hpp"

namespace eses::detail {

void Sinks::take_block(const BlockResult& block, std::size_t thread) {
  for (Sink* const sink : sinks_) sink->take_block(block, thread);
}

void Sinks::prepare(Piece& piece) {
  for (Sink* const sink : sinks_) sink->prepare(piece);
}

void Sinks::place(Piece& piece) {
  for (Sink* const sink : sinks_) sink->place(piece);
}

void Sinks::store(const Piece& piece) {
  for (Sink* const sink : sinks_) sink->store(piece);
}

void PieceTextSink::place(Piece& piece) {
  PieceText& text = piece.*text_;
  text.offset = size_;
  size_ += text.buffer.text().size();
}

void PieceTextSink::store(const Piece& piece) {
  const PieceText& text = piece.*text_;
  file_.write_at(text.buffer.text(), text.offset);
}

void MapSink::store(const Piece& piece) {
  take_rows_(piece.first_row, piece.map_rows[static_cast<std::size_t>(quantity_)]);
}

}  // namespace eses::detail
