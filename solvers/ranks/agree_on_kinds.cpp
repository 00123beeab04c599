#include "solvers/ranks/agree_on_kinds.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <stdexcept>
#include <string>
#include <unordered_set>
#include <utility>
#include <vector>

#include "solvers/ranks/ranks.hpp"
#include "src/geometry/counts_bond.hpp"

namespace peristat {
namespace {

bool has_table(const BondKinds& kinds) { return kinds.bytes_per_bond() < sizeof(BondKind); }

/// Of no bond yet, and without a table: there is none once there are more kinds than it holds.
BondKinds without_table() {
  BondKinds kinds;
  for (double length = 1.0; has_table(kinds); ++length) kinds.push_back({1.0 / length, 0.0});
  kinds.truncate(0);
  return kinds;
}

std::string bytes_of(const BondKind& kind) {
  std::string bytes(sizeof(BondKind), '\0');
  std::memcpy(bytes.data(), &kind, sizeof(BondKind));
  return bytes;
}

BondKind kind_of(const std::string& bytes, std::size_t number) {
  BondKind kind;
  std::memcpy(&kind, &bytes[number * sizeof(BondKind)], sizeof(BondKind));
  return kind;
}

/// What its bonds are of, each once.
std::string table_of(const BondKinds& kinds) {
  std::unordered_set<std::string> known;
  std::string table;
  for (std::size_t bond = 0; bond < kinds.size(); ++bond) {
    const std::string bytes = bytes_of(kinds[Offset(bond)]);
    if (known.insert(bytes).second) table += bytes;
  }
  return table;
}

/// A bond of each kind that the ranks have, in their order; without a table and bonds if one of
/// them has none, or all together have too many.
BondKinds kinds_of_all(const BondKinds& mine, const Communicator& ranks) {
  const std::string none = "none";
  BondKinds all;
  bool have_table = true;
  ranks.gather(has_table(mine) ? table_of(mine) : none, [&](int, const std::string& theirs) {
    have_table = have_table && theirs != none;
    for (std::size_t k = 0; have_table && k < theirs.size() / sizeof(BondKind); ++k) {
      all.push_back(kind_of(theirs, k));
      have_table = has_table(all);
    }
  });
  std::string table = have_table ? table_of(all) : none;
  ranks.broadcast(table);
  if (table == none) return without_table();
  BondKinds known;
  for (std::size_t k = 0; k < table.size() / sizeof(BondKind); ++k) {
    known.push_back(kind_of(table, k));
  }
  return known;
}

template <class Visit>
void for_each_bond(const Bonds& bonds, const Visit& visit) {
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      visit(i, bonds.partner[std::size_t(bond)], bond);
    }
  }
}

/// Points of a part by their numbers in the whole body.
Index point_of(const Part& part, GlobalIndex number, bool is_ghost) {
  const auto middle = part.number.begin() + std::ptrdiff_t(part.owned);
  const auto first = is_ghost ? middle : part.number.begin();
  const auto last = is_ghost ? part.number.end() : middle;
  const auto found = std::lower_bound(first, last, number);
  if (found == last || *found != number) {
    throw std::logic_error("a bond between two parts has a point that is not here");
  }
  return Index(found - part.number.begin());
}

/// Bond between a point of this rank's and a ghost.
Offset bond_of(const Bonds& bonds, Index point, Index ghost) {
  const auto first = bonds.partner.begin() + std::ptrdiff_t(bonds.offset[point]);
  const auto last = bonds.partner.begin() + std::ptrdiff_t(bonds.offset[point + 1]);
  const auto found = std::lower_bound(first, last, ghost);
  if (found == last || *found != ghost) {
    throw std::logic_error("a bond between two parts is on one rank alone");
  }
  return found - bonds.partner.begin();
}

}  // namespace

void agree_on_kinds(Bonds& bonds, const Part& part, const Communicator& ranks) {
  if (ranks.count() == 1) return;
  BondKinds agreed = kinds_of_all(bonds.kind, ranks);
  const auto first = Offset(agreed.size());
  agreed.reserve(agreed.size() + std::size_t(bonds.count()) + 1);
  for (Offset bond = 0; bond < bonds.count(); ++bond) agreed.push_back(bonds.kind[bond]);

  // Who counts a bond tells the other rank of it what it is.
  Records told{2, 2, {}, {}};
  std::vector<int> to;
  for_each_bond(bonds, [&](Index i, Index j, Offset bond) {
    if (part.is_ghost(i) || !part.is_ghost(j) || !counts_bond(part.points, i, j)) return;
    const BondKind& kind = agreed[first + bond];
    told.values.insert(told.values.end(), {kind.inverse_length, kind.weight});
    told.numbers.push_back(part.number[std::size_t(i)]);
    told.numbers.push_back(part.number[std::size_t(j)]);
    to.push_back(part.owner[std::size_t(j - part.owned)]);
  });
  const Records heard = exchange(ranks, to, told);
  const Offset last = first + bonds.count();
  for (std::size_t k = 0; k < heard.values.size(); k += 2) {
    const Index ghost = point_of(part, heard.numbers[k], true);
    const Index mine = point_of(part, heard.numbers[k + 1], false);
    agreed.push_back({heard.values[k], heard.values[k + 1]});
    agreed.copy(last, first + bond_of(bonds, mine, ghost));
    agreed.truncate(last);
  }
  for (Offset bond = 0; bond < bonds.count(); ++bond) agreed.copy(first + bond, bond);
  agreed.truncate(bonds.count());
  bonds.kind = std::move(agreed);
}

}  // namespace peristat
