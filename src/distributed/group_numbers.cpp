#include "distributed/group_numbers.hpp"

#include <functional>
#include <limits>
#include <numeric>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "distributed/packed_texts.hpp"

namespace eses::detail {
namespace {

constexpr std::uint32_t not_numbered = std::numeric_limits<std::uint32_t>::max();

// The exchange of keys with the processes that are responsible for them.
class KeyExchange {
 public:
  KeyExchange(std::span<const std::string> keys, const Processes& processes)
      : processes_(processes), sent_(static_cast<std::size_t>(processes.count())) {
    std::vector<std::vector<char>> texts(sent_.size());
    for (std::size_t k = 0; k < keys.size(); ++k) {
      const std::size_t keeper = std::hash<std::string_view>()(keys[k]) % sent_.size();
      sent_[keeper].push_back(k);
      texts[keeper].insert(texts[keeper].end(), keys[k].begin(), keys[k].end());
      texts[keeper].push_back('\0');
    }
    std::vector<std::vector<std::uint64_t>> counts;
    counts.reserve(sent_.size());
    for (const auto& part : sent_) counts.push_back({part.size()});
    received_ = processes.exchange(std::move(counts));
    const std::vector<char> all = processes.exchange(std::move(texts));
    for (std::string& key : unpack({all.begin(), all.end()}))
      ids_.push_back(id_of_.try_emplace(std::move(key), static_cast<std::uint32_t>(id_of_.size()))
                         .first->second);
  }

  // Ids of the keys that this process received, ordered by sender. Equal keys have equal ids.
  std::span<const std::uint32_t> ids() const { return ids_; }
  std::size_t id_count() const { return id_of_.size(); }

  // Sends a value for each key of this process to the responsible process. Returns the received
  // ones.
  std::vector<std::uint32_t> send(std::span<const std::uint32_t> of_key) const {
    std::vector<std::vector<std::uint32_t>> to;
    to.reserve(sent_.size());
    for (const auto& part : sent_) {
      to.emplace_back();
      for (const std::size_t k : part) to.back().push_back(of_key[k]);
    }
    return processes_.exchange(std::move(to));
  }

  // Sends a value for each received key back to its sender. Returns the values of this process's
  // keys.
  std::vector<std::uint32_t> send_back(std::span<const std::uint32_t> of_id) const {
    std::vector<std::vector<std::uint32_t>> to;
    to.reserve(received_.size());
    for (auto id = ids_.begin(); const std::uint64_t count : received_) {
      to.emplace_back();
      for (std::uint64_t q = 0; q < count; ++q) to.back().push_back(of_id[*id++]);
    }
    const std::vector<std::uint32_t> answers = processes_.exchange(std::move(to));
    std::vector<std::uint32_t> of_key(answers.size());
    for (auto one = answers.begin(); const auto& part : sent_)
      for (const std::size_t k : part) of_key[k] = *one++;
    return of_key;
  }

  // Returns for each id the lowest rank that sent the key.
  std::vector<std::uint32_t> first_senders() const {
    std::vector<std::uint32_t> first(id_count(), not_numbered);
    auto id = ids_.begin();
    for (std::uint32_t rank = 0; rank < received_.size(); ++rank)
      for (std::uint64_t q = 0; q < received_[rank]; ++q, ++id)
        if (first[*id] == not_numbered) first[*id] = rank;
    return first;
  }

 private:
  const Processes& processes_;
  std::vector<std::vector<std::size_t>> sent_;  // indices of keys by responsible rank
  std::vector<std::uint64_t> received_;         // number of keys by sender
  std::unordered_map<std::string, std::uint32_t> id_of_;
  std::vector<std::uint32_t> ids_;
};

// Returns the key of a label's chain.
std::string chain_key(const AtomLabel& label) {
  return std::string(mesh::truncated_name(label.chain));
}

// Returns the key of a label's residue. Names are separated by a character that no name contains.
std::string residue_key(const AtomLabel& label) {
  std::string key = chain_key(label);
  for (const std::string_view name : {label.residue_number, label.residue}) {
    key += '\1';
    key += mesh::truncated_name(name);
  }
  return key;
}

// Returns the numbers of the keys of a single process.
KeyNumbers numbers_alone(std::size_t keys) {
  KeyNumbers numbers;
  numbers.of_key.resize(keys);
  std::iota(numbers.of_key.begin(), numbers.of_key.end(), 0U);
  numbers.first_here.resize(keys);
  std::iota(numbers.first_here.begin(), numbers.first_here.end(), std::size_t{0});
  return numbers;
}

// Numbers the groups whose first labels in this process are `first`. Appends to `names` the labels
// that are the first of their group in all processes.
template <class Key>
KeyNumbers number_first_labels(std::span<const AtomLabel> labels, std::span<const AtomIndex> first,
                               Key&& key, const Processes& processes,
                               std::vector<AtomLabel>& names) {
  KeyNumbers numbers;
  if (processes.count() == 1) {
    numbers = numbers_alone(first.size());
  } else {
    std::vector<std::string> keys;
    keys.reserve(first.size());
    for (const AtomIndex label : first) keys.push_back(key(labels[label]));
    numbers = number_keys(keys, processes);
  }
  names.reserve(numbers.first_here.size());
  for (const std::size_t k : numbers.first_here) names.push_back(labels[first[k]]);
  return numbers;
}

}  // namespace

KeyNumbers number_keys(std::span<const std::string> keys, const Processes& processes) {
  const KeyExchange exchange(keys, processes);
  const std::vector<std::uint32_t> first = exchange.send_back(exchange.first_senders());
  KeyNumbers numbers;
  for (std::size_t k = 0; k < keys.size(); ++k)
    if (first[k] == static_cast<std::uint32_t>(processes.rank())) numbers.first_here.push_back(k);
  numbers.first = static_cast<std::uint32_t>(processes.sum_before(numbers.first_here.size()));
  std::vector<std::uint32_t> assigned(keys.size(), not_numbered);
  for (std::size_t q = 0; q < numbers.first_here.size(); ++q)
    assigned[numbers.first_here[q]] = numbers.first + static_cast<std::uint32_t>(q);
  const std::vector<std::uint32_t> received = exchange.send(assigned);
  std::vector<std::uint32_t> of_id(exchange.id_count());
  for (std::size_t q = 0; q < received.size(); ++q)
    if (received[q] != not_numbered) of_id[exchange.ids()[q]] = received[q];
  numbers.of_key = exchange.send_back(of_id);
  return numbers;
}

GroupNumbering number_groups(const ResidueRuns& runs, const Processes& processes) {
  GroupNumbering groups;
  GroupNames& names = groups.names;
  names.are_known = processes.sum(runs.labels.size()) > 0;
  const mesh::LabelNumbers local = mesh::number_labels(runs.labels);
  const KeyNumbers chains =
      number_first_labels(runs.labels, local.chains, chain_key, processes, names.chains);
  const KeyNumbers residues =
      number_first_labels(runs.labels, local.residues, residue_key, processes, names.residues);
  names.first_chain = chains.first;
  names.first_residue = residues.first;
  groups.of_atom.reserve(std::accumulate(runs.atoms.begin(), runs.atoms.end(), std::uint64_t{0}));
  for (std::size_t run = 0; run < runs.labels.size(); ++run)
    groups.of_atom.insert(
        groups.of_atom.end(), runs.atoms[run],
        {chains.of_key[local.chain_of[run]], residues.of_key[local.residue_of[run]]});
  return groups;
}

}  // namespace eses::detail
