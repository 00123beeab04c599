#include "cases/runner/results/step_part.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "src/parallel/communicator.hpp"

namespace peristat {
namespace {

/// Number of values per point of a field: one, one per axis, one per pair of axes, or one per
/// symmetric pair.
enum class Rank { scalar, vector, tensor, symmetric };

/// A field that a step may have.
struct FieldKind {
  std::string name;
  DatasetLabel label;
  Rank rank;
  const std::vector<double>* StepFields::*values;

  [[nodiscard]] Hdf5File::Shape shape(StepShape of) const {
    const auto points = static_cast<std::uint64_t>(of.points);
    const auto d = static_cast<std::uint64_t>(of.dimension);
    if (rank == Rank::vector) return {points, d};
    if (rank == Rank::tensor) return {points, d, d};
    if (rank == Rank::symmetric) return {points, d * (d + 1) / 2};
    return {points};
  }
  /// True if results.xdmf needs a view of it.
  [[nodiscard]] bool has_view(StepShape of) const {
    return rank == Rank::tensor || (rank == Rank::vector && of.dimension < 3);
  }
};

const std::vector<FieldKind>& field_kinds() {
  static const std::vector<FieldKind> kinds{
      {"displacement",
       {"m", "displacement of each point"},
       Rank::vector,
       &StepFields::displacement},
      {"force",
       {"N", "internal force on each point: minus the derivative of the stored energy"},
       Rank::vector,
       &StepFields::force},
      {"damage", {"1", "damage of each point, 0 intact to 1"}, Rank::scalar, &StepFields::damage},
      {"energy_density",
       {"J/m3", "stored energy per volume of each point"},
       Rank::scalar,
       &StepFields::energy_density},
      {"stretch",
       {"1", "largest stretch of the unbroken bonds of each point: current / reference length - 1"},
       Rank::scalar,
       &StepFields::stretch},
      {"fragment",
       {"1", "number of the floating piece that the point belongs to; 0: held by the supports"},
       Rank::scalar,
       &StepFields::fragment},
      {"deformation_gradient",
       {"1",
        "deformation gradient F from the unbroken bonds of each point, least squares; identity "
        "where they give none"},
       Rank::tensor,
       &StepFields::deformation_gradient},
      {"green_lagrange_strain",
       {"1", "strain E = (F^T F - I) / 2"},
       Rank::tensor,
       &StepFields::green_lagrange_strain},
      {"first_piola_stress",
       {"Pa", "first Piola-Kirchhoff stress P, the virial of each point over its volume"},
       Rank::tensor,
       &StepFields::first_piola_stress},
      {"cauchy_stress",
       {"Pa", "Cauchy stress P F^T / det F; 0 where the unbroken bonds give no F"},
       Rank::tensor,
       &StepFields::cauchy_stress},
      {"strain",
       {"1", "green_lagrange_strain: xx, or xx, yy, xy, or xx, yy, zz, xy, yz, xz"},
       Rank::symmetric,
       &StepFields::strain},
      {"stress",
       {"Pa", "symmetric part of cauchy_stress: xx, or xx, yy, xy, or xx, yy, zz, xy, yz, xz"},
       Rank::symmetric,
       &StepFields::stress},
      {"von_mises", {"Pa", "von Mises stress"}, Rank::scalar, &StepFields::von_mises},
      {"principal_stress",
       {"Pa", "principal values of the Cauchy stress, the largest first"},
       Rank::vector,
       &StepFields::principal_stress},
      {"principal_direction",
       {"1", "unit vectors of the principal stresses, one per row"},
       Rank::tensor,
       &StepFields::principal_direction},
      {"missing_neighbourhood",
       {"1",
        "share of a neighbourhood inside the lattice that each point lacks, by surfaces, cracks "
        "and "
        "broken bonds; 1 where the unbroken bonds give no F"},
       Rank::scalar,
       &StepFields::missing_neighbourhood},
      {"velocity", {"m/s", "velocity of each point"}, Rank::vector, &StepFields::velocity},
      {"kinetic_energy_density",
       {"J/m3", "kinetic energy per volume of each point"},
       Rank::scalar,
       &StepFields::kinetic_energy_density}};
  return kinds;
}

const FieldKind& kind_of(const std::string& field) {
  const auto& kinds = field_kinds();
  return *std::find_if(kinds.begin(), kinds.end(),
                       [&](const FieldKind& kind) { return kind.name == field; });
}

void check(const FieldKind& kind, const std::vector<double>& values, StepShape shape) {
  std::uint64_t count = 1;
  for (const std::uint64_t extent : kind.shape(shape)) count *= extent;
  if (values.size() != count) {
    throw std::logic_error("results: " + kind.name + " has the wrong number of values");
  }
  if (!std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); })) {
    throw std::logic_error("results: " + kind.name + " has values that are not finite");
  }
}

/// Writes the histories of bonds that have changed, in the group `path`.
/// @param count of changed bonds on all ranks
/// @param has_images true if any rank has values of `second_image`
void write_histories(const RowSink& sink, const std::string& path, const BondHistories& changed,
                     std::uint64_t count, bool has_images) {
  const auto write = [&](const std::string& name, const auto& values, const DatasetLabel& label) {
    sink.write_of_bonds(path + name, changed.first_point, changed.second_point,
                        changed.second_image, values, count, label);
  };
  write("/first_point", changed.first_point,
        {"1", "lower point of each bond whose history has changed since the step before"});
  write("/second_point", changed.second_point,
        {"1", "other point of each bond whose history has changed since the step before"});
  if (has_images) {
    write("/second_image", changed.second_image,
          {"1",
           "image of that point at which the bond ends, row of /points/images from 1; 0: the point "
           "itself"});
  }
  write("/largest_stretch", changed.largest_stretch,
        {"1", "largest stretch that has damaged the bond; -1: the bond never fails"});
}

}  // namespace

std::string WrittenStep::name() const {
  char text[16];
  std::snprintf(text, sizeof text, "%06d", step);
  return text;
}

StepPart::StepPart(StepShape shape, const StepFields& fields, const RowGathering& gathering)
    : shape_(shape), fields_(fields), gathering_(gathering) {
  StepShape here = shape;
  here.points = gathering.part().own_rows(shape.points);
  for (const FieldKind& kind : field_kinds()) {
    if (fields.*kind.values == nullptr) continue;
    check(kind, *(fields.*kind.values), here);
    names_.push_back(kind.name);
  }
  if (!fields.histories) return;
  const std::size_t changed = fields.histories->largest_stretch.size();
  changed_bonds_ = std::uint64_t(gathering.ranks().count_all(std::int64_t(changed)).all);
  have_images_ = any_of_all(gathering.ranks(), !fields.histories->second_image.empty());
}

std::uint64_t StepPart::bytes() const {
  std::uint64_t bytes = 0;
  for (const std::string& name : names_) {
    std::uint64_t values = 1;
    for (const std::uint64_t extent : kind_of(name).shape(shape_)) values *= extent;
    bytes += values * sizeof(double);
  }
  return bytes + changed_bonds_ * (sizeof(double) + 3 * sizeof(Index));
}

void StepPart::write(Hdf5File& file, const WrittenStep& step) const {
  file.make_group(step.group);
  file.set_attribute(step.group, "step", std::int64_t{step.step});
  file.set_attribute(step.group, "load_factor", step.load_factor);
  file.set_attribute(step.group, "mode", step.mode);
  if (fields_.velocity != nullptr) file.set_attribute(step.group, "time", step.load_factor);
  const RowSink sink(&file, gathering_, std::uint64_t(shape_.points));
  if (fields_.histories) file.make_group(step.group + "/history");
  write_rows(sink, step.group);
  if (shape_.has_views()) write_views(file, step.views, step.group, names_, shape_);
}

void StepPart::send() const {
  write_rows(RowSink(nullptr, gathering_, std::uint64_t(shape_.points)), "");
}

void StepPart::write_rows(const RowSink& sink, const std::string& group) const {
  for (const std::string& name : names_) {
    const FieldKind& kind = kind_of(name);
    Hdf5File::Shape row = kind.shape(shape_);
    row.erase(row.begin());
    sink.write(group + "/" + name, *(fields_.*kind.values), row, kind.label);
  }
  if (fields_.histories) {
    write_histories(sink, group + "/history", *fields_.histories, changed_bonds_, have_images_);
  }
}

std::vector<std::string> field_names(const Hdf5File& file, const std::string& group) {
  const std::vector<std::string> objects = file.names(group);
  std::vector<std::string> names;
  for (const FieldKind& kind : field_kinds()) {
    if (std::find(objects.begin(), objects.end(), kind.name) != objects.end()) {
      names.push_back(kind.name);
    }
  }
  return names;
}

void write_views(Hdf5File& file, const std::string& views, const std::string& group,
                 const std::vector<std::string>& fields, StepShape shape) {
  file.make_group(views);
  for (const std::string& name : fields) {
    const FieldKind& kind = kind_of(name);
    if (!kind.has_view(shape)) continue;
    file.write_padded_view(
        views + "/" + name, group + "/" + name, kind.shape(shape),
        {kind.label.unit, name + " with zeros beyond the dimension, for results.xdmf"});
  }
}

std::vector<XdmfSeries::Field> shown_fields(const WrittenStep& step, StepShape shape) {
  std::vector<XdmfSeries::Field> shown;
  for (const std::string& name : step.fields) {
    const FieldKind& kind = kind_of(name);
    if (kind.rank == Rank::symmetric) continue;  // shown by its tensor
    const std::string group = kind.has_view(shape) ? "/xdmf/" : "/steps/";
    shown.push_back({name, group + step.name() + "/" + name, kind.rank == Rank::vector, false,
                     kind.rank == Rank::tensor});
  }
  return shown;
}

}  // namespace peristat
