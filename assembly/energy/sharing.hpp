#pragma once

#include <span>

#include "src/core/communicator.hpp"
#include "src/core/types.hpp"

namespace peristat {

/// What a part of a body shares with the parts that other ranks have. Its points are those that the
/// rank owns, and then ghosts, which follow their owners.
class Sharing {
 public:
  Sharing() = default;
  Sharing(const Sharing&) = delete;
  Sharing& operator=(const Sharing&) = delete;
  virtual ~Sharing() = default;

  [[nodiscard]] virtual const Communicator& ranks() const = 0;
  [[nodiscard]] virtual Index owned() const = 0;

  /// Gives ghosts what their owners have; a call that all ranks make.
  /// @param values points x dimension
  virtual void update_ghosts(std::span<double> values) const = 0;
};

}  // namespace peristat
