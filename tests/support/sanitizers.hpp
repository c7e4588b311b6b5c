#pragma once
/// Properties of sanitizers that tests need.

namespace eses::detail::test {

/// Whether memory cannot be measured, because a sanitizer takes several times as much as the
/// program.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool holds_shadow_memory = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
inline constexpr bool holds_shadow_memory = true;
#else
inline constexpr bool holds_shadow_memory = false;
#endif
#else
inline constexpr bool holds_shadow_memory = false;
#endif

}  // namespace eses::detail::test
