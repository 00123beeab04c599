#include "src/neighbourhood/bond_kinds.hpp"

#include <bit>

namespace peristat {
namespace {

/// A double rounded to 40 bits behind its leading one.
std::uint64_t rounded(double value) {
  constexpr int dropped = 12;
  return (std::bit_cast<std::uint64_t>(value) + (std::uint64_t(1) << (dropped - 1))) >> dropped;
}

}  // namespace

BondKinds::Key BondKinds::key_of(const BondKind& kind) {
  return {rounded(kind.inverse_length), rounded(kind.weight)};
}

std::size_t BondKinds::KeyHash::operator()(const Key& key) const {
  // Multiplicative hashing by odd constants near 2^64 over the golden ratio and over sqrt 2.
  std::uint64_t mixed = key.first * 0x9e3779b97f4a7c15u + key.second * 0xb504f333f9de6485u;
  mixed ^= mixed >> 32;
  return std::size_t(mixed * 0x9e3779b97f4a7c15u >> 16);
}

std::size_t BondKinds::number_of(const BondKind& kind) {
  const Key key = key_of(kind);
  Recent& recent = recent_[KeyHash{}(key) % recent_.size()];
  if (recent.key == key) return recent.number;
  const auto found = known_.find(key);
  if (found == known_.end() && kinds_.size() == most_kinds) return most_kinds;
  const std::size_t number = found == known_.end() ? kinds_.size() : found->second;
  if (found == known_.end()) {
    known_.emplace(key, number);
    kinds_.push_back(kind);
  }
  recent = {key, number};
  return number;
}

void BondKinds::keep_each_its_own() {
  std::vector<BondKind> own;
  own.reserve(number_.capacity());
  for (std::size_t bond = 0; bond < number_.size(); ++bond) own.push_back(kinds_[number_[bond]]);
  kinds_ = std::move(own);
  number_ = {};
  known_ = decltype(known_)();
  numbered_ = false;
}

void BondKinds::reserve(std::size_t bonds) {
  if (numbered_) {
    number_.reserve(bonds);
  } else {
    kinds_.reserve(bonds);
  }
}

void BondKinds::push_back(const BondKind& kind) {
  if (numbered_) {
    const std::size_t number = number_of(kind);
    if (number < most_kinds) {
      number_.push_back(static_cast<std::uint16_t>(number));
      return;
    }
    keep_each_its_own();
  }
  kinds_.push_back(kind);
}

void BondKinds::append(const BondKinds& part) {
  std::size_t bond = 0;
  if (numbered_ && part.numbered_) {
    std::vector<std::size_t> translated(part.kinds_.size(), most_kinds);
    for (; bond < part.number_.size(); ++bond) {
      const std::uint16_t of_part = part.number_[bond];
      std::size_t& number = translated[of_part];
      if (number == most_kinds) number = number_of(part.kinds_[of_part]);
      if (number == most_kinds) break;
      number_.push_back(static_cast<std::uint16_t>(number));
    }
  }
  for (; bond < part.size(); ++bond) push_back(part[Offset(bond)]);
}

void BondKinds::copy(Offset from, Offset to) {
  if (numbered_) {
    number_.copy(std::size_t(from), std::size_t(to));
  } else {
    kinds_[std::size_t(to)] = kinds_[std::size_t(from)];
  }
}

void BondKinds::truncate(Offset count) {
  if (numbered_) {
    number_.truncate(std::size_t(count));
  } else {
    kinds_.resize(std::size_t(count));
  }
}

ReweighedKinds::ReweighedKinds(const BondKinds& before) : before_(before) {
  after_.reserve(before.size());
  if (before.numbered_) last_.resize(before.kinds_.size());
}

void ReweighedKinds::push_back(double weight) {
  const Offset bond = Offset(after_.size());
  const double inverse_length = before_[bond].inverse_length;
  if (!before_.numbered_ || !after_.numbered_) {
    after_.push_back({inverse_length, weight});
    return;
  }
  Last& last = last_[before_.number(bond)];
  if (last.weight == weight) {
    after_.number_.push_back(last.number);
    return;
  }
  after_.push_back({inverse_length, weight});
  if (after_.numbered_) last = {weight, after_.number_[after_.size() - 1]};
}

}  // namespace peristat
