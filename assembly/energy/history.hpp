#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace peristat {

/// What the terms of a model remember of the states that were committed: an array of numbers per
/// term, which that term alone understands. A value: copies share an array until one of them
/// changes it, so that keeping a history costs nothing, and giving up a step is dropping it.
class History {
 public:
  [[nodiscard]] std::size_t terms() const { return terms_.size(); }

  /// Of a term; empty if it remembers nothing.
  [[nodiscard]] std::span<const double> of(std::size_t term) const {
    if (term >= terms_.size() || !terms_[term]) return {};
    return *terms_[term];
  }

  /// The same to be written: no other history sees what is changed here.
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
