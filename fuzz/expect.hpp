#pragma once
/// The entry point and the checks that all fuzz targets share.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "eses/error.hpp"

/// Runs one input. Each target defines it; libFuzzer or the main function of replay.cpp calls it.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace eses::detail::fuzz {

/// Ends the process, which libFuzzer reports as a finding.
[[noreturn]] void fail(std::string_view what);

inline void expect(bool holds, std::string_view what) {
  if (!holds) fail(what);
}

/// Checks the message of an error and returns it: one line of printable ASCII that begins with the
/// file's name.
std::string checked_message(const Error& error, std::string_view name);

inline std::string_view as_text(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

}  // namespace eses::detail::fuzz
