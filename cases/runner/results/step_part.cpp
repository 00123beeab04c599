#include "cases/runner/results/step_part.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

namespace peristat {
namespace {

/// A field that a step may have.
struct FieldKind {
  std::string name;
  DatasetLabel label;
  bool is_vector;
  const std::vector<double>* StepFields::*values;
};

const std::vector<FieldKind>& field_kinds() {
  static const std::vector<FieldKind> kinds{
      {"displacement", {"m", "displacement of each point"}, true, &StepFields::displacement},
      {"force",
       {"N", "internal force on each point: minus the derivative of the stored energy"},
       true,
       &StepFields::force},
      {"damage", {"1", "damage of each point, 0 intact to 1"}, false, &StepFields::damage},
      {"energy_density",
       {"J/m3", "stored energy per volume of each point"},
       false,
       &StepFields::energy_density},
      {"stretch",
       {"1", "largest stretch of the unbroken bonds of each point: current / reference length - 1"},
       false,
       &StepFields::stretch},
      {"fragment",
       {"1", "number of the floating piece that the point belongs to; 0: held by the supports"},
       false,
       &StepFields::fragment}};
  return kinds;
}

const FieldKind& kind_of(const std::string& field) {
  const auto& kinds = field_kinds();
  return *std::find_if(kinds.begin(), kinds.end(),
                       [&](const FieldKind& kind) { return kind.name == field; });
}

void check(const FieldKind& kind, const std::vector<double>& values, StepShape shape) {
  if (values.size() != std::size_t(shape.points) * (kind.is_vector ? shape.dimension : 1)) {
    throw std::logic_error("results: " + kind.name + " has the wrong number of values");
  }
  if (!std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); })) {
    throw std::logic_error("results: " + kind.name + " has values that are not finite");
  }
}

/// The histories of bonds that have changed, as the group `path`.
void write_histories(Hdf5File& file, const std::string& path, const BondHistories& changed) {
  const Hdf5File::Shape shape{changed.largest_stretch.size()};
  file.make_group(path);
  file.write(path + "/first_point", changed.first_point, shape,
             {"1", "lower point of each bond whose history has changed since the step before"});
  file.write(path + "/second_point", changed.second_point, shape,
             {"1", "other point of each bond whose history has changed since the step before"});
  if (!changed.second_image.empty()) {
    file.write(path + "/second_image", changed.second_image, shape,
               {"1", "image of that point it ends at, row of /points/images from 1; 0: itself"});
  }
  file.write(path + "/largest_stretch", changed.largest_stretch, shape,
             {"1", "largest stretch that has damaged the bond; -1: the bond never fails"});
}

}  // namespace

std::string WrittenStep::name() const {
  char text[16];
  std::snprintf(text, sizeof text, "%06d", step);
  return text;
}

StepPart::StepPart(StepShape shape, const StepFields& fields) : shape_(shape), fields_(fields) {
  for (const FieldKind& kind : field_kinds()) {
    if (fields.*kind.values == nullptr) continue;
    check(kind, *(fields.*kind.values), shape);
    names_.push_back(kind.name);
  }
}

std::uint64_t StepPart::bytes() const {
  std::uint64_t bytes = 0;
  for (const std::string& name : names_) {
    bytes += (fields_.*kind_of(name).values)->size() * sizeof(double);
  }
  if (fields_.histories) {
    bytes += fields_.histories->largest_stretch.size() * (sizeof(double) + 3 * sizeof(Index));
  }
  return bytes;
}

void StepPart::write(Hdf5File& file, const WrittenStep& step) const {
  const auto points = static_cast<std::uint64_t>(shape_.points);
  const auto dimension = static_cast<std::uint64_t>(shape_.dimension);
  file.make_group(step.group);
  file.set_attribute(step.group, "step", std::int64_t{step.step});
  file.set_attribute(step.group, "load_factor", step.load_factor);
  file.set_attribute(step.group, "mode", step.mode);
  for (const std::string& name : names_) {
    const FieldKind& kind = kind_of(name);
    file.write(step.group + "/" + name, *(fields_.*kind.values),
               kind.is_vector ? Hdf5File::Shape{points, dimension} : Hdf5File::Shape{points},
               kind.label);
  }
  if (fields_.histories) write_histories(file, step.group + "/history", *fields_.histories);
  if (shape_.has_views()) write_views(file, step.views, step.group, names_, shape_);
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
    if (!kind.is_vector) continue;
    file.write_padded_view(
        views + "/" + name, group + "/" + name, static_cast<std::uint64_t>(shape.points),
        static_cast<std::uint64_t>(shape.dimension),
        {kind.label.unit, name + " with zeros beyond the dimension, for results.xdmf"});
  }
}

std::vector<XdmfSeries::Field> shown_fields(const WrittenStep& step, StepShape shape) {
  std::vector<XdmfSeries::Field> shown;
  for (const std::string& name : step.fields) {
    const bool is_vector = kind_of(name).is_vector;
    const std::string group = is_vector && shape.has_views() ? "/xdmf/" : "/steps/";
    shown.push_back({name, group + step.name() + "/" + name, is_vector});
  }
  return shown;
}

}  // namespace peristat
