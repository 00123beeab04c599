#pragma once

#include <concepts>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "assembly/energy/history.hpp"
#include "src/conditions/environment.hpp"
#include "src/core/types.hpp"

namespace peristat {

/// State on a path of equilibria.
struct State {
  std::vector<double> displacement;  ///< points x dimension, row major [m]
  double stage = 0.0;  ///< position in the loading programme: without tables the load factor
  History history{};
  /// First load parameter, if a displacement control has found it; nothing: the loading
  /// programme's.
  std::optional<double> load = std::nullopt;
  SharedEnvironment environment = nullptr;  ///< loading data of its load point
  double preload = 1.0;                     ///< see LoadPoint
};

/// Treatment of bonds that are stretched beyond their histories: they soften, or damage is frozen
/// and they follow their secants. Both agree in a state in which `growth` is zero.
enum class Damage { grows, held };

/// Of a product with the tangent: `single` allows terms to compute the parts of their interactions
/// in single precision. Differences between points and sums stay in double precision.
enum class Precision { full, single };

/// Where energy, gradient, tangent and product are evaluated: a view of a displacement and of the
/// history before it, both of which must outlive the view, and the loading data that the energy
/// depends on.
struct StateView {
  template <std::convertible_to<std::span<const double>> Displacement>
  StateView(const Displacement& at, const History& after = none(), Damage rule = Damage::grows,
            SharedEnvironment under = nullptr)
      : displacement(at), history(after), damage(rule), environment(std::move(under)) {}
  StateView(const State& state, Damage rule = Damage::grows)
      : StateView(state.displacement, state.history, rule, state.environment) {}

  std::span<const double> displacement;  ///< points x dimension, row major [m]
  const History& history;                ///< of the same model
  Damage damage;
  /// Curvature of rotating rigid sets, see Constraints::curvature; empty: none rotates, or it is
  /// not needed.
  std::span<const Tensor> curvature{};
  SharedEnvironment environment;
  /// For the predictor of a step: the displacement that it is expected to lead to. A contact that
  /// touches here, or is closed there, is then a linear spring. Empty: contacts follow their law.
  std::span<const double> foreseen{};
  bool has_contacts = true;               ///< false: without the energy of contacts
  Precision precision = Precision::full;  ///< of products

  /// Eigenstretch per point, or empty.
  [[nodiscard]] std::span<const double> eigenstretch() const {
    return environment ? std::span<const double>(environment->eigenstretch)
                       : std::span<const double>();
  }

 private:
  static const History& none() {
    static const History history;
    return history;
  }
};

}  // namespace peristat
