#pragma once
/// Formatted text that is passed on in parts, so that the memory does not grow with its length.

#include <fmt/format.h>

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <utility>

#include "system/formatted.hpp"

namespace eses::detail {

/// Receives the parts of a text, in order.
using TextSink = std::function<void(std::string_view part)>;

/// Buffers formatted text and passes it to a sink when the buffer is full.
class BufferedText {
 public:
  explicit BufferedText(TextSink sink) : sink_(std::move(sink)) {}

  template <class... Arguments>
  void append(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    constexpr std::size_t part_bytes = 1 << 16;
    append_formatted(text_, format, fmt::make_format_args(arguments...));
    if (text_.size() >= part_bytes) flush();
  }

  /// Passes the rest of the text to the sink. Must be called at the end.
  void flush() {
    sink_(text_);
    text_.clear();
  }

 private:
  TextSink sink_;
  std::string text_;
};

}  // namespace eses::detail
