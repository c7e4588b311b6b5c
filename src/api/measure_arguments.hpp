#pragma once
/// Checks of the options of measurements.

#include "eses/measure.hpp"

namespace eses::detail {

/// Throws std::invalid_argument if the probe radius or the number of threads is out of its range.
void require_valid(const MeasureOptions& options);

}  // namespace eses::detail
