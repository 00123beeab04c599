#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "assembly/assembler.hpp"
#include "assembly/stress.hpp"
#include "solvers/body/body.hpp"
#include "solvers/observe/point_fields.hpp"
#include "solvers/observe/recorded_points.hpp"

namespace peristat {

/// What fields depend on besides the displacement and the history of a state. Views must outlive
/// the observation.
struct ObservedExtras {
  std::vector<double> force{};            ///< see internal_force; may have more points [N]
  std::span<const std::int32_t> piece{};  ///< per point, see Fragments; empty: none floats
  std::span<const double> velocity{};     ///< of a body in motion, per degree of freedom [m/s]
  std::span<const double> life{};         ///< of each bond, see RemainingLives; empty: 1
  bool count_cracks = false;              ///< bonds that a pre-crack has cut count as damage
};

/// A state of a body in which fields are computed, each once, when it is first asked for. Values
/// belong to the recorded points: all but images, and in a part of a body those that its rank owns.
/// Asking is collective on ranks.
class Observation {
 public:
  /// All arguments but the extras must outlive this object.
  Observation(const Body& body, Assembler& assembler, const StateView& at, ObservedExtras extras);
  /// Observes a state of a body at rest, such as StudyResult::state; pieces that float are not
  /// searched. The body must outlive this object.
  /// @param threads 0: as many as OpenMP takes by itself
  Observation(const Body& body, const State& state, int threads = 0);
  ~Observation();
  Observation(const Observation&) = delete;
  Observation& operator=(const Observation&) = delete;

  /// Values of a field of point_fields: points x values of a point, row major.
  /// @throws InputError ("field") if there is none of this name, or if it needs a motion and the
  ///         body is at rest
  [[nodiscard]] const std::vector<double>& values(const std::string& field);
  /// All values that have been computed.
  [[nodiscard]] const PointValues& computed() const { return values_; }
  /// Moves them out; no values can be asked for afterwards.
  [[nodiscard]] PointValues release() { return std::move(values_); }

  [[nodiscard]] const Body& body() const { return body_; }
  [[nodiscard]] Assembler& assembler() { return assembler_; }
  [[nodiscard]] const StateView& at() const { return at_; }
  [[nodiscard]] const RecordedPoints& points() const { return points_; }

  // For the rows of point_fields: what several of them share. Each takes its own part away.

  struct Stretches {
    std::vector<double> of_points;
    double largest;  ///< of all unbroken bonds here; minus infinity without one
  };
  [[nodiscard]] Stretches& stretches();
  [[nodiscard]] Stress& stress();
  [[nodiscard]] ObservedExtras& extras() { return extras_; }

 private:
  struct Owned;  // of a state without an assembler
  Observation(const Body& body, std::unique_ptr<Owned> owned);

  std::unique_ptr<Owned> owned_;
  const Body& body_;
  Assembler& assembler_;
  StateView at_;
  ObservedExtras extras_;
  RecordedPoints points_;
  PointValues values_;
  std::optional<Stretches> stretches_;
  std::optional<Stress> stress_;
};

}  // namespace peristat
