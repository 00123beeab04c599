#include "solvers/ranks/agree_on_kinds.hpp"

#include <cstddef>
#include <cstring>
#include <string>
#include <unordered_set>
#include <utility>

#include "solvers/ranks/heard_of_bonds.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {
namespace {

bool has_table(const BondKinds& kinds) { return kinds.bytes_per_bond() < sizeof(BondKind); }

/// No kinds, and no table: the table is dropped once there are more kinds than it holds.
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

/// The distinct kinds of the bonds, as bytes.
std::string table_of(const BondKinds& kinds) {
  std::unordered_set<std::string> known;
  std::string table;
  for (std::size_t bond = 0; bond < kinds.size(); ++bond) {
    const std::string bytes = bytes_of(kinds[Offset(bond)]);
    if (known.insert(bytes).second) table += bytes;
  }
  return table;
}

/// One bond of each kind that any rank has, in the order of the ranks; without bonds and table if a
/// rank has no table, or all together have too many kinds. Collective.
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

}  // namespace

void agree_on_kinds(Bonds& bonds, const Points& points, const NumberedPoints& numbered,
                    const Communicator& ranks) {
  if (ranks.count() == 1) return;
  BondKinds agreed = kinds_of_all(bonds.kind, ranks);
  const auto first = Offset(agreed.size());
  agreed.reserve(agreed.size() + std::size_t(bonds.count()) + 1);
  for (Offset bond = 0; bond < bonds.count(); ++bond) agreed.push_back(bonds.kind[bond]);
  const HeardOfBonds heard = heard_of_bonds(bonds, points, numbered, ranks, BetweenImages::nothing,
                                            2, [&](Offset bond, double* to) {
                                              to[0] = agreed[first + bond].inverse_length;
                                              to[1] = agreed[first + bond].weight;
                                            });
  const Offset last = first + bonds.count();
  for (std::size_t k = 0; k < heard.bond.size(); ++k) {
    agreed.push_back({heard.values[2 * k], heard.values[2 * k + 1]});
    agreed.copy(last, first + heard.bond[k]);
    agreed.truncate(last);
  }
  for (Offset bond = 0; bond < bonds.count(); ++bond) agreed.copy(first + bond, bond);
  agreed.truncate(bonds.count());
  bonds.kind = std::move(agreed);
}

}  // namespace peristat
