#pragma once
/// @file
/// The callback by which callers end an operation early.

#include <functional>

namespace eses {

/// Called from time to time during an operation, by any of its threads, but never by two at the
/// same time. An exception that it throws ends the operation, which throws it on. It serves to
/// look for an interrupt of the user.
using CheckCallback = std::function<void()>;

}  // namespace eses
