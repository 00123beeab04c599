#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

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

  /// Array of a term for writing, copied first if other histories share it.
  [[nodiscard]] std::span<double> change(std::size_t term) {
    std::shared_ptr<std::vector<double>>& array = terms_.at(term);
    if (array.use_count() > 1) array = std::make_shared<std::vector<double>>(*array);
    return *array;
  }

  void replace(std::size_t term, std::vector<double> array) {
    if (term >= terms_.size()) terms_.resize(term + 1);
    terms_[term] = std::make_shared<std::vector<double>>(std::move(array));
  }

 private:
  std::vector<std::shared_ptr<std::vector<double>>> terms_;
};

}  // namespace peristat
