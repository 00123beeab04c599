#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "src/core/types.hpp"
#include "src/geometry/rigid_surface.hpp"
#include "src/geometry/side.hpp"

namespace peristat {

/// Prescribed displacements of a set: per component an expression of x, y, z and load [m], or
/// nothing for a free component.
struct SupportSpecification {
  std::string set{};
  std::array<std::optional<std::string>, 3> displacement{};
};

/// Initial values of a set, or without one of the body: per component an expression of x, y and z.
struct InitialSpecification {
  std::string set{};
  std::array<std::string, 3> displacement{"0", "0", "0"};  ///< [m]
  std::array<std::string, 3> velocity{"0", "0", "0"};      ///< [m/s]
};

/// A layer that absorbs waves: an expression of x, y and z on a set or, without one, the body.
struct AbsorbingSpecification {
  std::string set{};
  std::string rate{};  ///< at which velocities decay [1/s]
};

/// How deep a traction acts: in the outermost row of points alone, spread evenly over the horizon,
/// or on the surface itself (model "lps" only).
enum class Depth { row, horizon, surface };

/// A load. Loads of fixed direction are
/// - a body force density [N/m3] on a set, an expression of x, y, z and load;
/// - a total force [N], an expression of load alone, spread over a set in proportion to the volume;
/// - gravity [m/s2] on a set or, without one, the body, layers left out;
/// - a traction [Pa] on a flat part of a lattice body's boundary: the outermost plane of points on
///   a side, or a set that lies in one plane.
/// A pressure [Pa], its first value, follows the deformation of the exposed cell faces of a side or
/// set. With the depth `surface` traction and pressure act on the body's boundary: on a side, on
/// the boundary of a shape or at the points of a set; so does a stress [Pa], whose traction is
/// sigma n.
struct LoadSpecification {
  enum class Kind {
    body_force,
    total_force,
    gravity,
    traction,
    pressure,
    stress
  } kind = Kind::body_force;
  std::string set{};
  std::array<std::string, 3> value{"0", "0", "0"};
  std::optional<Side> side{};
  Depth depth = Depth::row;
  std::string boundary{};             ///< name of a shape
  std::vector<std::string> stress{};  ///< xx yy xy, or xx yy zz xy yz xz
};

/// Springs along the axes between points and a ground that may move: a modulus [N/m3] on a flat
/// part of a lattice body's boundary, given like that of a traction, or a total stiffness [N/m] of
/// a set, spread in proportion to the volume. Exactly one of the two is nonzero.
struct FoundationSpecification {
  std::string name{};
  std::string set{};
  std::optional<Side> side{};
  Coordinates modulus{}, stiffness{};
  std::array<std::string, 3> displacement{"0", "0", "0"};  ///< of the ground, an expression [m]
};

/// A rigid body that presses on points: see Obstacles.
struct ObstacleSpecification {
  std::string name{};
  std::string set{};  ///< points that it may touch; empty: all
  RigidSurface surface{};
  /// Expressions of load alone [m]; "free" for the component along which the force drives it.
  std::array<std::string, 3> displacement{"0", "0", "0"};
  std::string force{};     ///< on the body, an expression of load alone [N]; empty: none drives it
  double stiffness = 1.0;  ///< relative to that of the points' cells
  double depth = 0.25;     ///< largest depth over half a spacing, between 0 and 1
  double softness = 1e-4;  ///< depth over half a spacing within which the stiffness sets in
  double friction = 0.0;   ///< mu, of Coulomb
  double tangential_stiffness = 0.5;  ///< of contacts that stick, over that along the normal
};

/// Isotropic strain that a set, or without one the body, would have if nothing held it: length over
/// reference length - 1, an expression of x, y, z and load.
struct EigenstrainSpecification {
  std::string set{};
  std::string strain{"0"};
};

/// Key of a kind of load: "body_force", …
[[nodiscard]] constexpr const char* load_key(LoadSpecification::Kind kind) {
  switch (kind) {
    case LoadSpecification::Kind::body_force:
      return "body_force";
    case LoadSpecification::Kind::total_force:
      return "total_force";
    case LoadSpecification::Kind::gravity:
      return "gravity";
    case LoadSpecification::Kind::traction:
      return "traction";
    case LoadSpecification::Kind::pressure:
      return "pressure";
    case LoadSpecification::Kind::stress:
      return "stress";
  }
  return "";
}

/// A term of a control: its set's mean displacement, weighted per component.
struct ControlTerm {
  std::string set{};
  std::array<double, 3> weights{};
};

}  // namespace peristat
