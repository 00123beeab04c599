#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cases/runner/case.hpp"
#include "solvers/drivers/drivers.hpp"

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
inline const Choices<LinearMethod> linear_methods{{"auto", LinearMethod::automatic},
                                                  {"cholesky", LinearMethod::cholesky},
                                                  {"pcg", LinearMethod::conjugate_gradients},
                                                  {"minres", LinearMethod::minres},
                                                  {"gmres", LinearMethod::gmres}};

inline const Choices<TangentStorage> tangent_storages{{"auto", TangentStorage::automatic},
                                                      {"stored", TangentStorage::stored},
                                                      {"matrix_free", TangentStorage::matrix_free}};

inline const Choices<PreconditionerKind> preconditioner_kinds{
    {"auto", PreconditionerKind::automatic},
    {"jacobi", PreconditionerKind::jacobi},
    {"block_jacobi", PreconditionerKind::block_jacobi},
    {"rigid_pieces", PreconditionerKind::rigid_pieces},
    {"surrogate", PreconditionerKind::surrogate},
    {"riluk", PreconditionerKind::riluk},
    {"chebyshev", PreconditionerKind::chebyshev},
    {"multigrid", PreconditionerKind::multigrid}};

inline const Choices<Predictor> predictors{{"consistent", Predictor::consistent},
                                           {"none", Predictor::none}};
inline const Choices<DamageLaw> damage_laws{{"none", DamageLaw::none},
                                            {"critical_stretch", DamageLaw::critical_stretch},
                                            {"tanh", DamageLaw::tanh},
                                            {"tanh_continuous", DamageLaw::tanh_continuous}};
inline const Choices<Mode> modes = [] {
  Choices<Mode> all;
  for (const DriverEntry& driver : all_drivers()) all.emplace_back(driver.mode.name, driver.mode);
  return all;
}();
inline const Choices<FragmentRemedy> fragment_remedies{{"hold", FragmentRemedy::hold},
                                                       {"remove", FragmentRemedy::remove},
                                                       {"stop", FragmentRemedy::stop}};
inline const Choices<Damping> dampings{{"adaptive", Damping::adaptive},
                                       {"kinetic", Damping::kinetic}};
inline const Choices<Breaking> breakings{{"at_equilibrium", Breaking::at_equilibrium},
                                         {"transient", Breaking::transient}};
inline const Choices<PlaneState> plane_states{{"stress", PlaneState::stress},
                                              {"strain", PlaneState::strain}};

template <class Value>
[[nodiscard]] std::string choice_name(const Choices<Value>& choices, Value value) {
  for (const auto& [name, choice] : choices)
    if (choice == value) return name;
  return {};
}

}  // namespace peristat
