#pragma once
/// Checks of arguments that several functions of the library share.

#include "eses/measure.hpp"

namespace eses::detail {

/// Throws std::invalid_argument if the probe radius or the number of threads is out of its range.
void require_valid(const MeasureOptions& options);

}  // namespace eses::detail
