#pragma once

#include "src/parallel/communicator.hpp"

namespace Teuchos {
template <class T>
class RCP;
template <typename Ordinal>
class Comm;
}  // namespace Teuchos

namespace peristat::trilinos {

/// Returns the ranks as a communicator of Trilinos; they must outlive it.
[[nodiscard]] Teuchos::RCP<const Teuchos::Comm<int>> teuchos_communicator(
    const Communicator& ranks);

}  // namespace peristat::trilinos
