#pragma once
/// A list that grows at its end and is cut off at its begin.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace eses::detail::mesh {

/// A list whose elements keep their indices, which are counted modulo 2^32, and their addresses.
/// Its memory is that of the elements that are left, in pages. The upper bits of an index are not
/// needed, as long as the lower ones distinguish twice as many elements as there are.
template <class Element>
class SlidingList {
 public:
  using Index = std::uint32_t;

  /// Index of the first element, and of the next one that is added.
  Index first() const { return first_; }
  Index end() const { return end_; }

  Element& operator[](Index i) { return table_[i >> page_bits & mask_][i & (page_size - 1)]; }
  const Element& operator[](Index i) const {
    return table_[i >> page_bits & mask_][i & (page_size - 1)];
  }

  /// Adds an element, and returns it.
  Element& push_back(const Element& element) {
    if ((end_ & (page_size - 1)) == 0) add_page();
    return (*this)[end_++] = element;
  }

  /// Removes the elements before index `first`, which is an index of the list or its end.
  void remove_before(Index first) {
    for (; (first_ ^ first) >> page_bits != 0; first_ = (first_ & ~(page_size - 1)) + page_size)
      spare_ = std::move(pages_[first_ >> page_bits & mask_]);
    first_ = first;
  }

 private:
  using Page = std::unique_ptr<Element[]>;
  static constexpr unsigned page_bits = 10;
  static constexpr Index page_size = Index{1} << page_bits;

  void add_page() {
    if (pages_.empty() || pages_[end_ >> page_bits & mask_]) double_table();
    Page& page = pages_[end_ >> page_bits & mask_];
    page = spare_ ? std::move(spare_) : std::make_unique_for_overwrite<Element[]>(page_size);
    table_[end_ >> page_bits & mask_] = page.get();
  }

  void double_table() {
    const std::size_t size = pages_.empty() ? 1 : 2 * pages_.size();
    const Index old_mask = std::exchange(mask_, static_cast<Index>(size - 1));
    std::vector<Page> old(size);
    old.swap(pages_);
    table_.resize(size);
    for (std::size_t p = 0; p < old.size(); ++p) {
      const Index page = (first_ >> page_bits) + static_cast<Index>(p);
      pages_[page & mask_] = std::move(old[page & old_mask]);
      table_[page & mask_] = pages_[page & mask_].get();
    }
  }

  Index first_ = 0, end_ = 0, mask_ = 0;
  std::vector<Element*> table_;  // of the pages, in a ring: page i is at i & mask_
  std::vector<Page> pages_;      // the same, with ownership
  Page spare_;                   // of removed elements
};

}  // namespace eses::detail::mesh
