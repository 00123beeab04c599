#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cases/runner/case.hpp"

namespace peristat {

/// Every key that a table of a case file may have, by the table's dotted name without indices
/// ("lattice.shape"); the document itself has the empty name.
[[nodiscard]] const std::map<std::string, std::vector<std::string>>& case_keys();

/// Keys that describe a shape, by its kind ("box": min, max).
[[nodiscard]] const std::map<std::string, std::vector<std::string>>& shape_keys();

/// Names of the values of an enumeration in case files.
template <class Value>
using Choices = std::vector<std::pair<std::string, Value>>;

inline const Choices<LatticeOrigin> lattice_origins{{"cell_centres", LatticeOrigin::cell_centres},
                                                    {"nodes", LatticeOrigin::nodes}};
inline const Choices<VolumeCorrection> volume_corrections{{"none", VolumeCorrection::none},
                                                          {"linear", VolumeCorrection::linear}};
inline const Choices<SurfaceCorrection> surface_corrections{{"none", SurfaceCorrection::none},
                                                            {"volume", SurfaceCorrection::volume},
                                                            {"energy", SurfaceCorrection::energy}};
inline const Choices<InteractionWeights> interaction_weights{{"mean", InteractionWeights::mean},
                                                             {"bulk", InteractionWeights::bulk}};
inline const Choices<MaterialModel> material_models{{"bond", MaterialModel::bond},
                                                    {"cpd", MaterialModel::cpd}};
inline const Choices<Calibration> calibrations{{"lattice", Calibration::lattice},
                                               {"continuum", Calibration::continuum}};
inline const Choices<Projection> projections{
    {"auto", Projection::automatic}, {"never", Projection::never}, {"always", Projection::always}};
inline const Choices<Predictor> predictors{{"consistent", Predictor::consistent},
                                           {"none", Predictor::none}};
inline const Choices<PlaneState> plane_states{{"stress", PlaneState::stress},
                                              {"strain", PlaneState::strain}};

template <class Value>
[[nodiscard]] std::string choice_name(const Choices<Value>& choices, Value value) {
  for (const auto& [name, choice] : choices)
    if (choice == value) return name;
  return {};
}

}  // namespace peristat
