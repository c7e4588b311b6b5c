#pragma once
/// A list that grows at its end and is cut off at its begin.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace eses::detail::mesh {

/// A list whose elements keep their indices, which are counted modulo 2^32, and their addresses.
/// Its memory is that of the elements that are left, in pages. Less significant bits of an index
/// are enough, as long as there are fewer elements than indices.
template <class Element>
class SlidingList {
 public:
  using Index = std::uint32_t;

  /// Index of the first element, and of the next one that is added.
  Index first() const { return first_; }
  Index end() const { return end_; }

  Element& operator[](Index i) { return page(i)[i & (page_size - 1)]; }
  const Element& operator[](Index i) const { return page(i)[i & (page_size - 1)]; }

  /// Adds an element, and returns it.
  Element& push_back(const Element& element) {
    if ((end_ & (page_size - 1)) == 0) add_page();
    return (*this)[end_++] = element;
  }

  /// Removes the elements before index `first`, which is an index of the list or its end.
  void remove_before(Index first) {
    for (; (first_ ^ first) >> page_bits != 0; first_ = (first_ & ~(page_size - 1)) + page_size)
      spare_ = std::move(page(first_));
    first_ = first;
  }

 private:
  using Page = std::unique_ptr<Element[]>;
  static constexpr unsigned page_bits = 10;
  static constexpr Index page_size = Index{1} << page_bits;

  Page& page(Index i) { return pages_[i >> page_bits & (pages_.size() - 1)]; }
  const Page& page(Index i) const { return pages_[i >> page_bits & (pages_.size() - 1)]; }

  void add_page() {
    if (pages_.empty() || page(end_)) {
      // The number of pages stays a power of two.
      std::vector<Page> old(pages_.empty() ? 1 : 2 * pages_.size());
      old.swap(pages_);
      for (std::size_t p = 0; p < old.size(); ++p) {
        const Index i = first_ + static_cast<Index>(p) * page_size;
        page(i) = std::move(old[i >> page_bits & (old.size() - 1)]);
      }
    }
    page(end_) = spare_ ? std::move(spare_) : std::make_unique_for_overwrite<Element[]>(page_size);
  }

  Index first_ = 0, end_ = 0;
  std::vector<Page> pages_;  // a ring: page i is at i modulo its length
  Page spare_;               // of removed elements
};

}  // namespace eses::detail::mesh
