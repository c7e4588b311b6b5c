#pragma once
/// Calls that look for interrupts too rarely, in a thread that can be left behind.

#include <eses/eses.hpp>
#include <functional>

namespace eses::python {

/// Calls `action(check)` in a thread of its own and waits for it. After an interrupt it throws at
/// once. The action is then left behind and ends when it calls `check`. Therefore it must own all
/// that it uses. Must be called without the interpreter's lock.
void call_in_background(std::function<void(const CheckCallback& check)> action);

/// Waits for all threads that were left behind, so that they do not use what the process destroys
/// when it exits. Must be called without the interpreter's lock.
void join_threads_left_behind();

}  // namespace eses::python
