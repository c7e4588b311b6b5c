#pragma once
/// Disjoint sets of numbered elements (Galler and Fischer, Comm. ACM 7, 301, 1964,
/// doi:10.1145/364099.364331).

#include <algorithm>
#include <cstdint>
#include <vector>

namespace eses::detail {

/// A division of the elements 0, 1, ... into sets. The root of a set is its smallest element, so
/// that it does not depend on the order in which sets are united.
class DisjointSets {
 public:
  using Element = std::uint32_t;

  DisjointSets() = default;
  explicit DisjointSets(Element count) { add(count); }

  Element count() const { return static_cast<Element>(parents_.size()); }

  /// Adds elements, each in a set of its own. Returns the first one.
  Element add(Element count = 1) {
    const Element first = this->count();
    for (Element k = 0; k < count; ++k) parents_.push_back(first + k);
    return first;
  }

  /// Returns the root of the set of an element. Several threads may call it at the same time.
  Element root(Element element) const {
    while (parents_[element] != element) element = parents_[element];
    return element;
  }

  /// Returns root(element), and shortens the path to it. Not for several threads at a time.
  Element shorten(Element element) {
    while (parents_[element] != element) element = parents_[element] = parents_[parents_[element]];
    return element;
  }

  /// Unites the sets of two elements. Shortens the paths to their roots.
  void unite(Element a, Element b) {
    const Element first = shorten(a), second = shorten(b);
    parents_[std::max(first, second)] = std::min(first, second);
  }

  /// Returns the index of the set of each element. Sets are in ascending order of their roots.
  std::vector<Element> labels() const {
    std::vector<Element> labels(parents_.size());
    Element sets = 0;
    // A parent is smaller than its child.
    for (Element k = 0; k < count(); ++k)
      labels[k] = parents_[k] == k ? sets++ : labels[parents_[k]];
    return labels;
  }

 private:
  std::vector<Element> parents_;
};

}  // namespace eses::detail
