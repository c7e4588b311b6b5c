#pragma once
/// Atomic access to variables that are not atomic themselves.

namespace eses::detail {

/// Does what std::atomic_ref does with relaxed memory order. The C++ library of LLVM, which macOS
/// uses, lacks std::atomic_ref before version 19.
template <class Value>
class RelaxedReference {
 public:
  explicit RelaxedReference(Value& value) : value_(value) {}

  Value load() const {
    Value seen;
    __atomic_load(&value_, &seen, __ATOMIC_RELAXED);
    return seen;
  }

  void store(Value value) const { __atomic_store(&value_, &value, __ATOMIC_RELAXED); }

  void set_bits(Value bits) const { __atomic_fetch_or(&value_, bits, __ATOMIC_RELAXED); }

  /// Replaces the value if it is `seen`. Otherwise, or by chance, returns false and sets `seen`.
  bool try_replace(Value& seen, Value value) const {
    return __atomic_compare_exchange(&value_, &seen, &value, true, __ATOMIC_RELAXED,
                                     __ATOMIC_RELAXED);
  }

 private:
  Value& value_;
};

}  // namespace eses::detail
