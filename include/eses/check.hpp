#pragma once
/// @file
/// The callback with which callers can cancel an operation.

#include <functional>

namespace eses {

/// Called repeatedly during an operation, from any of its threads, but never from two at the same
/// time. If it throws an exception, the operation ends and throws this exception. Its purpose is to
/// cancel the operation, for example after a signal.
using CheckCallback = std::function<void()>;

}  // namespace eses
