#pragma once
/// Items that are finished in any order and received in the order of their numbers.

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <utility>

namespace eses::detail {

/// Passes items to a receiver in the order of their numbers, by one thread at a time.
template <class Item>
class InTurn {
 public:
  using Receive = std::function<void(Item& item)>;
  /// Bytes of kept items before other threads wait.
  static constexpr std::size_t max_kept_bytes = std::size_t{1} << 20;

  explicit InTurn(Receive receive) : receive_(std::move(receive)) {}

  /// Passes item number `index`, which has this size, or keeps it if another thread must pass it on
  /// later. It waits only if many bytes are kept. Each number from 0 must be passed once, unless
  /// another thread calls `abandon`.
  void pass(std::int64_t index, Item& item, std::size_t bytes);
  /// Releases all waiting threads. Items that the receiver has not got are lost. Called after a
  /// failure.
  void abandon();

 private:
  struct Kept {
    Item item;
    std::size_t bytes;
  };

  Receive receive_;
  std::mutex mutex_;
  std::condition_variable turn_;
  std::int64_t next_ = 0;
  bool is_passing_ = false;  // whether a thread calls the receiver, or the receiver has thrown
  bool is_abandoned_ = false;
  std::map<std::int64_t, Kept> kept_;
  std::size_t kept_bytes_ = 0;
};

// The thread that has the next item calls the receiver for it and for all following items that are
// kept by then.
template <class Item>
void InTurn<Item>::pass(std::int64_t index, Item& item, std::size_t bytes) {
  std::unique_lock lock(mutex_);
  turn_.wait(lock, [&] {
    return next_ == index || kept_bytes_ + bytes <= max_kept_bytes || is_abandoned_;
  });
  if (is_abandoned_) return;
  if (is_passing_ || next_ != index) {
    kept_.try_emplace(index, Kept{std::exchange(item, Item()), bytes});
    kept_bytes_ += bytes;
    return;
  }
  is_passing_ = true;
  const auto receive = [&](Item& next) {
    ++next_;
    lock.unlock();
    turn_.notify_all();
    receive_(next);
    lock.lock();
  };
  receive(item);
  while (!is_abandoned_ && !kept_.empty() && kept_.begin()->first == next_) {
    auto kept = kept_.extract(kept_.begin());
    kept_bytes_ -= kept.mapped().bytes;
    receive(kept.mapped().item);
  }
  is_passing_ = false;
}

template <class Item>
void InTurn<Item>::abandon() {
  {
    const std::lock_guard lock(mutex_);
    is_abandoned_ = true;
  }
  turn_.notify_all();
}

}  // namespace eses::detail
