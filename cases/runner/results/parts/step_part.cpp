#include "cases/runner/results/parts/step_part.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "solvers/observe/point_fields.hpp"
#include "src/parallel/collectives.hpp"

namespace peristat {
namespace {

Hdf5File::Shape shape_of(const PointField& field, StepShape of) {
  Hdf5File::Shape shape{static_cast<std::uint64_t>(of.points)};
  for (const std::uint64_t extent : field.extents(of.dimension)) shape.push_back(extent);
  return shape;
}

/// False for fields that only probes show.
bool is_written(const PointField& field, StepShape of) {
  const bool is_asked_for = field.needs != FieldNeeds::stress || of.has_tensors;
  return field.shown_by != ShownBy::probes && is_asked_for;
}

bool is_vector(const PointField& field) {
  return field.rank == FieldRank::vector || field.rank == FieldRank::principal;
}

/// True if results.xdmf needs a view of it.
bool has_view(const PointField& field, StepShape of) {
  return field.rank == FieldRank::tensor || (is_vector(field) && of.dimension < 3);
}

void check(const PointField& field, const std::vector<double>& values, StepShape shape) {
  std::uint64_t count = 1;
  for (const std::uint64_t extent : shape_of(field, shape)) count *= extent;
  if (values.size() != count) {
    throw std::logic_error("results: " + field.name + " has the wrong number of values");
  }
  if (!std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); })) {
    throw std::logic_error("results: " + field.name + " has values that are not finite");
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
  for (const PointField& field : point_fields()) {
    const auto values = fields.values.find(field.name);
    if (!is_written(field, shape) || values == fields.values.end()) continue;
    check(field, values->second, here);
    names_.push_back(field.name);
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
    for (const std::uint64_t extent : shape_of(*point_field(name), shape_)) values *= extent;
    bytes += values * sizeof(double);
  }
  return bytes + changed_bonds_ * (sizeof(double) + 3 * sizeof(Index));
}

void StepPart::write(Hdf5File& file, const WrittenStep& step) const {
  file.make_group(step.group);
  file.set_attribute(step.group, "step", std::int64_t{step.step});
  file.set_attribute(step.group, "load_factor", step.load_factor);
  file.set_attribute(step.group, "mode", step.mode);
  if (fields_.values.contains("velocity")) file.set_attribute(step.group, "time", step.load_factor);
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
    const PointField& field = *point_field(name);
    sink.write(group + "/" + name, fields_.values.at(name), field.extents(shape_.dimension),
               {field.unit, field.meaning});
  }
  if (fields_.histories) {
    write_histories(sink, group + "/history", *fields_.histories, changed_bonds_, have_images_);
  }
}

std::vector<std::string> field_names(const Hdf5File& file, const std::string& group) {
  const std::vector<std::string> objects = file.names(group);
  std::vector<std::string> names;
  for (const PointField& field : point_fields()) {
    if (std::ranges::find(objects, field.name) != objects.end()) names.push_back(field.name);
  }
  return names;
}

void write_views(Hdf5File& file, const std::string& views, const std::string& group,
                 const std::vector<std::string>& fields, StepShape shape) {
  file.make_group(views);
  for (const std::string& name : fields) {
    const PointField& field = *point_field(name);
    if (!has_view(field, shape)) continue;
    file.write_padded_view(
        views + "/" + name, group + "/" + name, shape_of(field, shape),
        {field.unit, name + " with zeros beyond the dimension, for results.xdmf"});
  }
}

std::vector<XdmfSeries::Field> shown_fields(const WrittenStep& step, StepShape shape) {
  std::vector<XdmfSeries::Field> shown;
  for (const std::string& name : step.fields) {
    const PointField& field = *point_field(name);
    if (field.rank == FieldRank::symmetric) continue;  // shown by its tensor
    const std::string group = has_view(field, shape) ? "/xdmf/" : "/steps/";
    shown.push_back({name, group + step.name() + "/" + name, is_vector(field), false,
                     field.rank == FieldRank::tensor});
  }
  return shown;
}

}  // namespace peristat
