#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cases/runner/input/given_values.hpp"
#include "cases/runner/setup/feature_lengths.hpp"
#include "solvers/body/body.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {

/// Plain values about the body, the loads and the law of a case, which `check` prints and the rules
/// of preflight_rules.hpp judge.
struct Preflight {
  /// A box of the body along one of the lattice's axes.
  struct Division {
    std::string key;     ///< "lattice.shape[0]"
    int axis = 0;        ///< from 0
    double asked = 0.0;  ///< extent that the case gives [m]
    double made = 0.0;   ///< extent of the lattice's cells in it [m]
    double cells = 0.0;  ///< number of cells
  };
  /// A subtracted shape.
  struct Opening {
    std::string key, kind;  ///< "lattice.shape[1]", "box"
    double width = 0.0;     ///< at its narrowest [m]
    std::int64_t bridging = 0;
    bool cuts_bonds = false;
  };
  struct CutByCrack {
    std::string key;
    std::int64_t bonds = 0;
  };
  /// A value of supports, loads or eigenstrains.
  struct Applied {
    GivenValue::Kind kind = GivenValue::Kind::displacement;
    std::string key, where, unit, text;
    bool changes = false;           ///< depends on a load parameter or the time
    std::array<double, 2> begin{};  ///< least and largest at load 0
    std::array<double, 2> end{};    ///< likewise at the end of the programme
    double largest = 0.0;           ///< magnitude at load 0 and all entries of the programme
  };
  /// A material whose bonds fail by their stretches.
  struct Fracture {
    std::string name;  ///< of its region; empty: of the body
    std::string key;   ///< "material"
    double youngs_modulus = 0.0, energy = 0.0, strength = 0.0;  ///< [Pa], [J/m2], [Pa]
    double critical = 0.0;                                      ///< stretch
    bool has_strength = false;  ///< strength is given, or follows from given stretches
    bool is_data = false;       ///< strength itself is given
    bool softens = false;
    /// E G / f_t^2, to which the length of a crack's process zone is proportional [m].
    [[nodiscard]] double characteristic_length() const {
      return youngs_modulus * energy / (strength * strength);
    }
  };
  struct Stiffness {
    std::string key;              ///< "material.youngs_modulus"
    double youngs_modulus = 0.0;  ///< as given [Pa]
  };
  /// The mesh that the points were made of.
  struct OfMesh {
    std::string elements;                                 ///< "120 triangles"
    double finest_spacing = 0.0, coarsest_spacing = 0.0;  ///< around a point [m]
    bool has_horizons = false;                            ///< each point has its own
    bool cuts_bonds = false;
    std::int64_t leaving = 0;  ///< bonds that leave the body and are cut
    std::vector<std::string> remarks;
  };
  struct Idle {
    std::string key, needs;
  };

  int dimension = 0;
  bool is_plane_stress = false;
  double spacing = 0.0, horizon = 0.0;  ///< [m]
  std::vector<double> extents;          ///< of the body [m]
  double cross_section = 0.0;           ///< [m] or [m2]; dimensions 1 and 2
  std::string cross_section_key;        ///< "lattice.thickness"
  bool cross_section_is_given = false, cross_section_counts = false;
  bool is_quasi_static = true, is_controlled = false, may_fail = false;
  bool has_functions = false;  ///< of a program, which may set their values while the run goes on
  int steps = 1;               ///< in all stages of the programme together
  std::vector<Division> divisions;
  std::vector<FeatureLength> lengths;
  std::vector<Opening> openings;
  std::optional<OfMesh> mesh;
  std::vector<CutByCrack> cracks;
  std::vector<Applied> applied;
  std::vector<Fracture> fractures;
  std::vector<Stiffness> stiffnesses;
  std::vector<Idle> idle;
  std::vector<std::string> of_materials;  ///< warnings that models give of their fracture data
  bool begins_moving = false;             ///< by initial fields
  std::vector<std::string> along_rows;    ///< keys of cracks, see cracks_along_rows
  bool has_notch = false;  ///< a crack or a subtracted shape, at which stress concentrates

  /// The shortest length of a kind; null: there is none.
  [[nodiscard]] const FeatureLength* shortest(FeatureLength::Kind kind) const;
};

/// Collective.
/// @throws InputError ("cracks[0]") for a crack that cuts no bond
[[nodiscard]] Preflight preflight_of(const Case& from, const Body& body, const Communicator& ranks);

/// Lines of `check`: label and text.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> preflight_lines(const Preflight& of);

}  // namespace peristat
