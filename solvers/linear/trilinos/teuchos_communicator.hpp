#pragma once

#include "src/core/communicator.hpp"

namespace Teuchos {
template <class T>
class RCP;
template <typename Ordinal>
class Comm;
}  // namespace Teuchos

namespace peristat::trilinos {

/// The ranks as Trilinos sees them; they must outlive it.
[[nodiscard]] Teuchos::RCP<const Teuchos::Comm<int>> teuchos_communicator(
    const Communicator& ranks);

}  // namespace peristat::trilinos
