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

// The keys of this process, and the keys that the processes have sent to it. The hash of a key
// determines the process that receives it.
class KeyExchange {
 public:
  KeyExchange(std::span<const std::string> keys, const Processes& processes)
      : processes_(processes), sent_(static_cast<std::size_t>(processes.count())) {
    std::vector<std::vector<char>> texts(sent_.size());
    for (std::size_t k = 0; k < keys.size(); ++k) {
      const std::size_t receiver = std::hash<std::string_view>()(keys[k]) % sent_.size();
      sent_[receiver].push_back(k);
      texts[receiver].insert(texts[receiver].end(), keys[k].begin(), keys[k].end());
      texts[receiver].push_back('\0');
    }
    const std::vector<char> received = processes.exchange(std::move(texts));
    std::unordered_map<std::string, std::uint32_t> id_of;
    for (std::string& key : unpack({received.begin(), received.end()}))
      ids_.push_back(id_of.try_emplace(std::move(key), static_cast<std::uint32_t>(id_of.size()))
                         .first->second);
    id_count_ = id_of.size();
    senders_ = send(std::vector(keys.size(), static_cast<std::uint32_t>(processes.rank())));
  }

  // Received keys, in the order of their senders: equal keys have the same id, from 0.
  std::span<const std::uint32_t> ids() const { return ids_; }
  std::span<const std::uint32_t> senders() const { return senders_; }
  std::size_t id_count() const { return id_count_; }

  // Sends a value for each key of this process. Returns the values for the received keys.
  std::vector<std::uint32_t> send(std::span<const std::uint32_t> of_key) const {
    std::vector<std::vector<std::uint32_t>> to(sent_.size());
    for (std::size_t rank = 0; rank < sent_.size(); ++rank)
      for (const std::size_t k : sent_[rank]) to[rank].push_back(of_key[k]);
    return processes_.exchange(std::move(to));
  }

  // Sends a value for each received key back. Returns the values for the keys of this process.
  std::vector<std::uint32_t> send_back(std::span<const std::uint32_t> of_id) const {
    std::vector<std::vector<std::uint32_t>> to(sent_.size());
    for (std::size_t q = 0; q < ids_.size(); ++q) to[senders_[q]].push_back(of_id[ids_[q]]);
    const std::vector<std::uint32_t> answers = processes_.exchange(std::move(to));
    std::vector<std::uint32_t> of_key(answers.size());
    for (auto answer = answers.begin(); const auto& part : sent_)
      for (const std::size_t k : part) of_key[k] = *answer++;
    return of_key;
  }

 private:
  const Processes& processes_;
  std::vector<std::vector<std::size_t>> sent_;  // indices of keys by receiver
  std::vector<std::uint32_t> ids_, senders_;    // of received keys
  std::size_t id_count_ = 0;
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

// Numbers the groups whose first labels in this process are `first`. Appends to `names` the labels
// that are the first of their group in all processes.
template <class Key>
KeyNumbers number_first_labels(std::span<const AtomLabel> labels, std::span<const AtomIndex> first,
                               Key&& key, const Processes& processes,
                               std::vector<AtomLabel>& names) {
  KeyNumbers numbers;
  if (processes.count() == 1) {
    numbers.of_key.resize(first.size());
    std::iota(numbers.of_key.begin(), numbers.of_key.end(), 0U);
    numbers.first_here.assign(numbers.of_key.begin(), numbers.of_key.end());
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
  std::vector<std::uint32_t> of_id(exchange.id_count());
  // Keys arrive in the order of ranks, so the last assignment has the lowest rank.
  for (std::size_t q = exchange.ids().size(); q-- > 0;)
    of_id[exchange.ids()[q]] = exchange.senders()[q];
  const std::vector<std::uint32_t> first_rank = exchange.send_back(of_id);
  KeyNumbers numbers;
  for (std::size_t k = 0; k < keys.size(); ++k)
    if (first_rank[k] == static_cast<std::uint32_t>(processes.rank()))
      numbers.first_here.push_back(k);
  numbers.first = static_cast<std::uint32_t>(processes.sum_before(numbers.first_here.size()));
  std::vector<std::uint32_t> assigned(keys.size(), not_numbered);
  for (std::uint32_t number = numbers.first; const std::size_t k : numbers.first_here)
    assigned[k] = number++;
  const std::vector<std::uint32_t> received = exchange.send(assigned);
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
