#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "src/conditions/slip.hpp"
#include "src/core/types.hpp"

namespace peristat {

/// Internal variables that the terms of a model keep from committed states: one array of numbers
/// per term, which that term alone interprets. A value type: copies share an array until one of
/// them changes it, so that keeping a history is cheap, and giving up a step means dropping its
/// copy.
class History {
 public:
  [[nodiscard]] std::size_t terms() const { return terms_.size(); }

  /// Array of a term; empty if the term keeps nothing.
  [[nodiscard]] std::span<const double> of(std::size_t term) const {
    if (term >= terms_.size() || !terms_[term]) return {};
    return *terms_[term];
  }

  /// Number that differs between histories that leave other integrities to bonds, or other facets:
  /// equal ones leave the same.
  [[nodiscard]] std::uint64_t version() const { return version_; }
  /// To be called after integrities have changed in the arrays that `change` returns.
  void note_damage() { version_ = next_version(); }

  /// Array of a term for writing, copied first if other histories share it.
  [[nodiscard]] std::span<double> change(std::size_t term) {
    std::shared_ptr<std::vector<double>>& array = terms_.at(term);
    if (array.use_count() > 1) array = std::make_shared<std::vector<double>>(*array);
    return *array;
  }

  void replace(std::size_t term, std::vector<double> array) {
    if (term >= terms_.size()) terms_.resize(term + 1);
    terms_[term] = std::make_shared<std::vector<double>>(std::move(array));
    note_damage();
  }

  /// Contacts with friction of a kind.
  [[nodiscard]] const Slips& slips(Rub of = Rub::obstacles) const {
    static const Slips none;
    const auto& kept = slips_[std::size_t(of)];
    return kept ? *kept : none;
  }
  void replace_slips(Slips slips, Rub of = Rub::obstacles) {
    slips_[std::size_t(of)] = std::make_shared<const Slips>(std::move(slips));
  }

  /// Facets of the surface that have torn, ascending.
  [[nodiscard]] std::span<const Index> torn_facets() const {
    if (!torn_facets_) return {};
    return *torn_facets_;
  }
  void replace_torn_facets(std::vector<Index> facets) {
    torn_facets_ = std::make_shared<const std::vector<Index>>(std::move(facets));
    note_damage();
  }

  /// Takes what another history knows of contacts.
  void take_contacts(const History& from) {
    slips_ = from.slips_;
    torn_facets_ = from.torn_facets_;
    note_damage();
  }

 private:
  static std::uint64_t next_version() {
    static std::atomic<std::uint64_t> last = 0;
    return ++last;
  }

  std::uint64_t version_ = 0;
  std::vector<std::shared_ptr<std::vector<double>>> terms_;
  std::array<std::shared_ptr<const Slips>, all_rubs.size()> slips_;  // null: none
  std::shared_ptr<const std::vector<Index>> torn_facets_;            // null: none
};

}  // namespace peristat
