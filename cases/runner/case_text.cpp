#include "cases/runner/case_text.hpp"

#include <sstream>

#include "cases/runner/case_keys.hpp"
#include "cases/runner/toml_text.hpp"

namespace peristat {
namespace {

using KeyText = std::pair<std::string, std::string>;

template <class Items, class Text>
std::string array_text(const Items& items, Text text) {
  std::string array;
  for (const auto& item : items) array += (array.empty() ? "" : ", ") + text(item);
  return "[" + array + "]";
}

std::string coordinates_text(const Coordinates& place, int dimension) {
  return array_text(std::vector<double>(place.begin(), place.begin() + dimension), toml_number);
}

/// Writes TOML line by line.
class Writer {
 public:
  void header(const std::string& name) { out_ << "\n[" << name << "]\n"; }
  void element(const std::string& name) { out_ << "\n[[" << name << "]]\n"; }
  void raw(const std::string& key, const std::string& text) {
    out_ << key << " = " << text << "\n";
  }
  void string(const std::string& key, const std::string& value) { raw(key, toml_string(value)); }
  void string_if_any(const std::string& key, const std::string& value) {
    if (!value.empty()) string(key, value);
  }
  void number(const std::string& key, double value) { raw(key, toml_number(value)); }
  void number_if_any(const std::string& key, const std::optional<double>& value) {
    if (value) number(key, *value);
  }
  template <class Integer>
  void integer(const std::string& key, Integer value) {
    raw(key, std::to_string(value));
  }
  void boolean(const std::string& key, bool value) { raw(key, value ? "true" : "false"); }

  [[nodiscard]] std::string text() const { return out_.str(); }

 private:
  std::ostringstream out_;
};

/// Name of a shape's kind and the keys that describe it.
struct ShapeText {
  std::string kind;
  std::vector<KeyText> keys;
};

ShapeText shape_text(const Shape& shape, int dimension) {
  struct Visitor {
    int dimension;
    [[nodiscard]] std::string at(const Coordinates& c) const {
      return coordinates_text(c, dimension);
    }
    ShapeText operator()(const Box& s) const {
      return {"box", {{"min", at(s.min)}, {"max", at(s.max)}}};
    }
    ShapeText operator()(const Disk& s) const {
      return {"disk", {{"centre", at(s.centre)}, {"radius", toml_number(s.radius)}}};
    }
    ShapeText operator()(const Cylinder& s) const {
      return {"cylinder",
              {{"centre", at(s.centre)},
               {"axis", at(s.axis)},
               {"radius", toml_number(s.radius)},
               {"length", toml_number(s.length)}}};
    }
    ShapeText operator()(const Sphere& s) const {
      return {"sphere", {{"centre", at(s.centre)}, {"radius", toml_number(s.radius)}}};
    }
    ShapeText operator()(const Polygon& s) const {
      return {"polygon", {{"vertices", array_text(s.vertices, [](const auto& vertex) {
                             return array_text(vertex, toml_number);
                           })}}};
    }
  };
  return std::visit(Visitor{dimension}, shape);
}

void write_cross_section(Writer& out, int dimension, double cross_section) {
  if (dimension == 1) out.number("area", cross_section);
  if (dimension == 2) out.number("thickness", cross_section);
}

void write_lattice(Writer& out, const Lattice& lattice, double horizon_ratio) {
  out.header("lattice");
  out.number("spacing", lattice.spacing);
  out.number("horizon_ratio", horizon_ratio);
  write_cross_section(out, lattice.dimension, lattice.cross_section);
  out.string("origin", choice_name(lattice_origins, lattice.origin));
  out.number("perturbation", lattice.perturbation);
  out.integer("seed", lattice.seed);
  for (const auto& step : lattice.shapes) {
    const auto shape = shape_text(step.shape, lattice.dimension);
    out.element("lattice.shape");
    out.string(step.action == ShapeStep::Action::add ? "add" : "subtract", shape.kind);
    for (const auto& [key, text] : shape.keys) out.raw(key, text);
  }
  for (const auto& layer : lattice.layers) {
    out.element("lattice.layer");
    out.string("name", layer.name);
    out.string("side", std::string(1, "xyz"[layer.side.axis]) + (layer.side.sign > 0 ? "+" : "-"));
    out.integer("thickness", layer.thickness);
    out.string_if_any("where", layer.where);
  }
}

void write_points(Writer& out, const PointSource& points, int dimension) {
  out.header("points");
  out.string("file", points.file.string());
  out.number("horizon", points.horizon);
  write_cross_section(out, dimension, points.cross_section);
}

void write_set(Writer& out, const SetRule& set, int dimension) {
  out.element("set");
  out.string("name", set.name);
  out.string_if_any("where", set.where);
  if (!set.shape) return;
  const auto shape = shape_text(*set.shape, dimension);
  std::string inside;
  for (const auto& [key, text] : shape.keys)
    inside += (inside.empty() ? "" : ", ") + key + " = " + text;
  out.raw("shape", "{ " + shape.kind + " = { " + inside + " } }");
}

void write_damage(Writer& out, const DamageSpecification& damage) {
  out.header("material.damage");
  out.string("law", choice_name(damage_laws, damage.law));
  if (damage.law == DamageLaw::none) return;
  out.number("critical", damage.critical);
  if (damage.law != DamageLaw::critical_stretch) {
    out.number("onset", damage.onset);
    out.number("rate", damage.rate);
  }
  if (!damage.no_fail.empty()) out.raw("no_fail", array_text(damage.no_fail, toml_string));
}

void write_relaxation(Writer& out, const RelaxationSpecification& relaxation) {
  const RelaxationOptions& options = relaxation.options;
  out.header("relaxation");
  out.integer("steps", relaxation.steps);
  out.string("load", relaxation.moving ? "moving" : "fixed");
  if (relaxation.moving) {
    out.integer("iterations", relaxation.iterations);
  } else {
    out.integer("ramp", options.ramp);
    out.integer("quiet_iterations", options.quiet_iterations);
  }
  out.string("breaking", choice_name(breakings, options.breaking));
  out.string("damping", choice_name(dampings, options.damping));
  out.number("mass_factor", options.mass_factor);
  out.integer("max_iterations", options.max_iterations);
  out.number("displacement_tolerance", options.displacement_tolerance);
}

}  // namespace

std::string resolved_text(const Case& from) {
  Writer out;
  out.string("title", from.title);
  out.integer("dimension", from.dimension);

  if (const auto* lattice = std::get_if<Lattice>(&from.body))
    write_lattice(out, *lattice, from.horizon_ratio);
  else
    write_points(out, std::get<PointSource>(from.body), from.dimension);
  for (const auto& set : from.sets) write_set(out, set, from.dimension);

  for (const Crack& crack : from.cracks) {
    out.element("crack");
    if (const auto* segment = std::get_if<CrackSegment>(&crack)) {
      out.raw("from", coordinates_text(segment->from, 2));
      out.raw("to", coordinates_text(segment->to, 2));
    } else {
      out.raw("vertices",
              array_text(std::get<CrackPolygon>(crack).vertices,
                         [](const Coordinates& vertex) { return coordinates_text(vertex, 3); }));
    }
  }

  out.header("quadrature");
  const MaterialSpecification& material = from.material;
  const bool is_cpd = material.model == MaterialModel::cpd;
  if (is_cpd) {
    out.string("weights", choice_name(interaction_weights, from.weights));
  } else {
    out.string("volume_correction", choice_name(volume_corrections, from.volume_correction));
    out.string("surface_correction", choice_name(surface_corrections, from.surface_correction));
  }

  out.header("material");
  out.string("model", choice_name(material_models, material.model));
  if (!is_cpd && from.dimension == 2)
    out.string("plane", choice_name(plane_states, material.plane));
  out.number_if_any("youngs_modulus", material.youngs_modulus);
  out.number_if_any("poisson_ratio", material.poisson_ratio);
  out.number_if_any("micromodulus", material.micromodulus);
  out.number_if_any("c1", material.c1);
  if (is_cpd && (material.c1 || from.dimension == 3)) out.number("c2", material.c2);
  if (is_cpd && material.c1) out.number("c3", material.c3);
  if (is_cpd && !material.c1) {
    out.string("calibration", choice_name(calibrations, material.calibration));
  }
  out.number_if_any("density", material.density);
  write_damage(out, material.damage);

  for (const auto& support : from.supports) {
    out.element("support");
    out.string("set", support.set);
    const auto* begin = support.displacement.data();
    out.raw("displacement",
            array_text(std::vector(begin, begin + from.dimension),
                       [](const auto& value) { return toml_string(value.value_or("free")); }));
  }
  for (const auto& load : from.loads) {
    out.element("load");
    out.string("set", load.set);
    const auto* begin = load.value.data();
    out.raw(load.kind == LoadSpecification::Kind::body_force ? "body_force" : "total_force",
            array_text(std::vector(begin, begin + from.dimension), toml_string));
  }

  out.header("loading");
  out.integer("steps", from.loading.steps);
  out.boolean("adaptive", from.loading.adaptive);
  out.number("smallest_step", from.loading.smallest_step);
  out.number("largest_step", from.loading.largest_step);
  out.integer("max_broken_bonds", from.loading.max_broken_bonds);

  out.header("solver");
  out.string("mode", choice_name(modes, from.solver.mode));
  out.string("linear", choice_name(linear_methods, from.solver.linear));
  out.string("preconditioner", choice_name(preconditioner_kinds, from.solver.preconditioner));
  out.string("tangent", choice_name(tangent_storages, from.solver.tangent));
  out.string("predictor", choice_name(predictors, from.solver.predictor));
  out.string("projection", choice_name(projections, from.solver.projection));
  out.number("relative_tolerance", from.solver.relative_tolerance);
  out.number("linear_tolerance", from.solver.linear_tolerance);
  out.integer("max_iterations", from.solver.max_iterations);
  out.string("fragments", choice_name(fragment_remedies, from.solver.fragments));
  if (from.solver.elastic_horizon_ratio > 0.0)
    out.number("elastic_horizon_ratio", from.solver.elastic_horizon_ratio);
  write_relaxation(out, from.relaxation);

  out.header("output");
  out.string("directory", from.output.directory.string());
  out.integer("every", from.output.every);
  out.boolean("count_cracks", from.output.count_cracks);

  for (const auto& probe : from.probes) {
    out.element("probe");
    out.string("name", probe.name);
    out.string("set", probe.set);
    out.string("field", probe.field);
    if (probe.field == "poisson_ratio" || probe.field == "crack_length")
      out.string("axis", std::string(1, "xyz"[probe.axis]));
    if (probe.field == "opening") out.string("other", probe.other);
  }
  return out.text();
}

}  // namespace peristat
