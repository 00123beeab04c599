#include "cases/runner/results/results.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <string>

#include "cases/runner/process/output_file.hpp"
#include "cases/runner/results/convergence_table.hpp"
#include "cases/runner/results/csv_table.hpp"
#include "cases/runner/results/hdf5_file.hpp"
#include "cases/runner/results/record_tables.hpp"
#include "cases/runner/results/results_folder.hpp"
#include "cases/runner/results/summary_json.hpp"
#include "cases/runner/results/xdmf_series.hpp"
#include "src/core/input_error.hpp"
#include "src/core/stopwatch.hpp"

namespace peristat {
namespace {

constexpr std::size_t master_growth = 1 << 18;  // bytes
// Generous bounds of what HDF5 needs beside the values of a file and for the groups of a step
// [byte].
constexpr std::uint64_t room_for_structure = 1 << 16;
constexpr std::uint64_t room_for_step = 1 << 14;

using Clock = std::chrono::steady_clock;

std::string step_name(int step) {
  char name[16];
  std::snprintf(name, sizeof name, "%06d", step);
  return name;
}

/// A field of a step with its values.
struct Field {
  std::string name;
  DatasetLabel label;
  bool is_vector;
  const std::vector<double>* values;
};

/// Room for summary.json [byte]: its fixed members, and what it tells of a support or a probe.
std::uint64_t room_for_summary(const std::vector<std::string>& sets,
                               const std::vector<ProbeColumns>& probes) {
  std::uint64_t room = 4096;
  for (const std::string& set : sets) room += 128 + 6 * set.size();
  for (const ProbeColumns& probe : probes) room += 128 + 6 * probe.name.size();
  return room;
}

struct VectorField {
  std::string name, unit;
};

struct WrittenStep {
  std::string name;  ///< "000001"
  std::vector<VectorField> vectors;
};

std::vector<Field> present_fields(const StepFields& fields, Index count, int dimension) {
  std::vector<Field> present{
      {"displacement", {"m", "displacement of each point"}, true, fields.displacement},
      {"force",
       {"N", "internal force on each point: minus the derivative of the stored energy"},
       true,
       fields.force},
      {"damage", {"1", "damage of each point, 0 intact to 1"}, false, fields.damage},
      {"energy_density",
       {"J/m3", "stored energy per volume of each point"},
       false,
       fields.energy_density},
      {"stretch",
       {"1", "largest stretch of the unbroken bonds of each point: current / reference length - 1"},
       false,
       fields.stretch},
      {"fragment",
       {"1", "number of the floating piece that the point belongs to; 0: held by the supports"},
       false,
       fields.fragment}};
  std::erase_if(present, [](const Field& field) { return field.values == nullptr; });
  for (const Field& field : present) {
    const std::vector<double>& values = *field.values;
    if (values.size() != std::size_t(count) * (field.is_vector ? dimension : 1)) {
      throw std::logic_error("results: " + field.name + " has the wrong number of values");
    }
    if (!std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); })) {
      throw std::logic_error("results: " + field.name + " has values that are not finite");
    }
  }
  return present;
}

/// Publishes an HDF5 file whose contents `write` makes, with so many bytes of values.
/// @throws OutputError
template <class Write>
void publish_hdf5(const std::filesystem::path& path, std::uint64_t bytes, Write write) {
  const std::filesystem::path unfinished = temporary(path);
  const auto discard = [&] {
    std::error_code ignored;
    std::filesystem::remove(unfinished, ignored);
  };
  try {
    auto file = Hdf5File::create(unfinished, bytes + room_for_structure);
    write(file);
    file.close();
  } catch (const OutputError&) {
    discard();
    throw;
  } catch (const std::runtime_error& error) {
    discard();
    throw OutputError(path.string() + ": can't be written: " + error.what());
  }
  rename_file(unfinished, path);
}

/// Path of a set's flags, one per point.
std::string flags_of(const std::string& set) {
  std::string name = set;
  std::replace(name.begin(), name.end(), '/', '|');
  return "/points/sets/" + name;
}

/// What results.xdmf shows of every point beside the fields of the steps.
std::vector<XdmfSeries::Field> constant_fields(const Points& points) {
  std::vector<XdmfSeries::Field> fields{{"volume", "/points/volume"}};
  for (const auto& [name, members] : points.sets) {
    fields.push_back({"set_" + name, flags_of(name), false, true});
  }
  return fields;
}

/// The point sets as a matrix: 1 where the point of the row is in the set of the column.
std::vector<std::uint8_t> membership(const Points& points) {
  std::vector<std::uint8_t> matrix(std::size_t(points.count()) * points.sets.size());
  std::size_t column = 0;
  for (const auto& [name, members] : points.sets) {
    for (const Index point : members) matrix[point * points.sets.size() + column] = 1;
    ++column;
  }
  return matrix;
}

RunIdentity identity(const CaseText& text) {
  const auto version = text.versions.find("peristat");
  return {version == text.versions.end() ? "" : version->second, text.title, text.file, {}};
}

/// The histories of bonds that have changed, as the group `path`.
void write_histories(Hdf5File& file, const std::string& path, const BondHistories& changed) {
  const Hdf5File::Shape shape{changed.largest_stretch.size()};
  file.make_group(path);
  file.write(path + "/first_point", changed.first_point, shape,
             {"1", "lower point of each bond whose history has changed since the step before"});
  file.write(path + "/second_point", changed.second_point, shape,
             {"1", "upper point of each bond whose history has changed since the step before"});
  file.write(path + "/largest_stretch", changed.largest_stretch, shape,
             {"1", "largest stretch that has damaged the bond; -1: the bond never fails"});
}

void write_points(Hdf5File& file, const Points& points, const std::vector<PointCounts>& counts) {
  const auto count = static_cast<std::uint64_t>(points.count());
  const auto dimension = static_cast<std::uint64_t>(points.dimension);
  file.make_group("/points");
  file.set_attribute("/points", "dimension", std::int64_t{points.dimension});
  file.set_attribute("/points", "spacing", points.spacing);
  file.write("/points/reference", points.reference, {count, dimension},
             {"m", "reference position of each point"});
  file.write("/points/volume", points.volume, {count}, {"m3", "volume of each point"});

  file.write(
      "/points/set_ids", membership(points), {count, points.sets.size()},
      {"1", "1 where the point (row) is in the set (column); attribute sets names the columns"});
  std::vector<std::string> names;
  for (const auto& [name, members] : points.sets) names.push_back(name);
  file.set_attribute("/points/set_ids", "sets", names);

  file.make_group("/points/sets");
  for (const auto& [name, members] : points.sets) {
    std::vector<std::uint8_t> flags(points.volume.size());
    for (const Index point : members) flags[point] = 1;
    file.write(flags_of(name), flags, {count}, {"1", "1 where the point is in set " + name});
  }

  for (const PointCounts& of_points : counts) {
    file.write("/points/" + of_points.name, of_points.values, {count},
               {"1", of_points.description});
  }

  std::vector<double> geometry;
  std::vector<std::int32_t> numbers;
  for (Index point = 0; point < points.count(); ++point) {
    const Coordinates at = points.position(point);
    geometry.insert(geometry.end(), at.begin(), at.end());
    numbers.push_back(point);
  }
  file.write("/points/geometry", geometry, {count, 3},
             {"m", "reference position with zeros beyond the dimension, for results.xdmf"});
  file.write("/points/number", numbers, {count}, {"1", "number of each point, for results.xdmf"});
}

/// Largest resident memory since the program was started: getrusage would also count what was
/// there before it, of whoever started it.
std::int64_t peak_memory_bytes() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    std::int64_t kilobytes = 0;
    if (word == "VmHWM:" && status >> kilobytes) return kilobytes * 1024;
  }
  return 0;
}

}  // namespace

struct Results::Files {
  Files(const std::filesystem::path& directory, const Points& points, const CaseText& text,
        const std::vector<std::string>& sets, const std::vector<ProbeColumns>& probe_columns,
        const std::vector<PointCounts>& counts, bool overwrite);

  void add(const StepRecord& record, const std::optional<StepFields>& step_fields);
  void add_fields(const StepRecord& record, const StepFields& step_fields);
  void write_step(const StepRecord& record, const std::vector<Field>& fields,
                  const BondHistories* histories);
  void write_views(Hdf5File& file, const std::string& group, const std::string& step,
                   const std::vector<VectorField>& vectors) const;
  void append_pending();
  void publish_xdmf();
  void publish_summary(const Summary& summary) const;
  void gather_parts();

  /// Whether vectors need views of three components (see XdmfSeries).
  [[nodiscard]] bool has_views() const { return dimension < 3; }

  Index count;
  int dimension;
  std::vector<std::string> support_sets;
  std::vector<ProbeColumns> probes;
  std::vector<Column> history_header;  // before the folder: a bad probe leaves it alone
  ClaimedFolder claimed;
  const ResultsFolder& folder;
  CsvTable history, iterations, decisions, broken_bonds;
  Hdf5File master;  ///< results.h5 with links to the parts; lives in memory
  XdmfSeries xdmf;
  StepTotals totals;
  ConvergenceTable convergence;
  bool xdmf_is_behind = false;
  Clock::time_point xdmf_time{};  ///< when it was last published
  std::vector<Row> pending_iterations, pending_decisions, pending_broken_bonds;
  std::vector<WrittenStep> written_steps;
  int last_step = std::numeric_limits<int>::min();
  bool closed = false;
  double seconds = 0.0;
};

Results::Files::Files(const std::filesystem::path& directory, const Points& points,
                      const CaseText& text, const std::vector<std::string>& sets,
                      const std::vector<ProbeColumns>& probe_columns,
                      const std::vector<PointCounts>& counts, bool overwrite)
    : count(points.count()),
      dimension(points.dimension),
      support_sets(sets),
      probes(probe_columns),
      history_header(history_columns(sets, probe_columns)),
      claimed(claim_results_folder(directory, identity(text), overwrite)),
      folder(claimed.paths),
      history(folder.history(), history_header),
      iterations(folder.iterations(), iteration_columns()),
      decisions(folder.decisions(), decision_columns()),
      broken_bonds(folder.broken_bonds(), broken_bond_columns()),
      master(Hdf5File::in_memory(folder.results().string() + " (in memory)", master_growth)),
      xdmf(points.count(), constant_fields(points)) {
  write_file(temporary(folder.summary()), "");
  reserve_file(temporary(folder.summary()), room_for_summary(sets, probe_columns));
  master.set_attribute("/", "title", text.title);
  auto versions = text.versions;
  versions.emplace("hdf5", Hdf5File::library_version());
  for (const auto& [name, version] : versions) {
    master.set_attribute("/", name + "_version", version);
  }
  master.make_group("/case");
  master.write("/case/as_read", text.as_read, {"none", "text of the case file (TOML)"});
  master.write("/case/as_resolved", text.as_resolved,
               {"none", "the case with overrides and defaults in place (TOML)"});
  master.make_table("/history", history_header);
  master.make_table("/iterations", iteration_columns());
  master.make_table("/decisions", decision_columns());
  master.make_table("/broken_bonds", broken_bond_columns());
  master.make_group("/steps");
  if (has_views()) master.make_group("/xdmf");

  const std::uint64_t bytes_per_point = counts.size() * sizeof(std::int32_t) +
                                        (std::uint64_t(dimension) + 4) * sizeof(double) +
                                        sizeof(std::int32_t) + 2 * points.sets.size();
  publish_hdf5(folder.parts() / "points.h5", std::uint64_t(count) * bytes_per_point,
               [&](Hdf5File& file) { write_points(file, points, counts); });
  master.link("/points", "parts/points.h5", "/points");
  publish_file(folder.results(), master.image());
}

void Results::Files::append_pending() {
  master.append("/iterations", iteration_columns(), pending_iterations);
  pending_iterations.clear();
  master.append("/decisions", decision_columns(), pending_decisions);
  pending_decisions.clear();
  master.append("/broken_bonds", broken_bond_columns(), pending_broken_bonds);
  pending_broken_bonds.clear();
}

void Results::Files::write_views(Hdf5File& file, const std::string& group, const std::string& step,
                                 const std::vector<VectorField>& vectors) const {
  file.make_group(group);
  for (const VectorField& vector : vectors) {
    file.write_padded_view(
        group + "/" + vector.name, step + "/" + vector.name, static_cast<std::uint64_t>(count),
        static_cast<std::uint64_t>(dimension),
        {vector.unit, vector.name + " with zeros beyond the dimension, for results.xdmf"});
  }
}

void Results::Files::write_step(const StepRecord& record, const std::vector<Field>& fields,
                                const BondHistories* histories) {
  WrittenStep step{step_name(record.step), {}};
  const std::string& name = step.name;
  const auto points = static_cast<std::uint64_t>(count);
  const Hdf5File::Shape vectors{points, static_cast<std::uint64_t>(dimension)}, scalars{points};
  std::vector<XdmfSeries::Field> shown;
  std::uint64_t bytes = 0;
  for (const Field& field : fields) {
    bytes += field.values->size() * sizeof(double);
    const std::string group = field.is_vector && has_views() ? "/xdmf/" : "/steps/";
    shown.push_back({field.name, group + name + "/" + field.name, field.is_vector});
    if (field.is_vector) step.vectors.push_back({field.name, field.label.unit});
  }

  if (histories) {
    bytes += histories->largest_stretch.size() * (sizeof(double) + 2 * sizeof(Index));
  }

  publish_hdf5(folder.parts() / (name + ".h5"), bytes, [&](Hdf5File& file) {
    file.make_group("/step");
    file.set_attribute("/step", "step", std::int64_t{record.step});
    file.set_attribute("/step", "load_factor", record.load_factor);
    file.set_attribute("/step", "mode", record.mode);
    for (const Field& field : fields) {
      file.write("/step/" + field.name, *field.values, field.is_vector ? vectors : scalars,
                 field.label);
    }
    if (histories) write_histories(file, "/step/history", *histories);
    if (has_views()) write_views(file, "/xdmf", "/step", step.vectors);
  });

  master.link("/steps/" + name, "parts/" + name + ".h5", "/step");
  if (has_views()) master.link("/xdmf/" + name, "parts/" + name + ".h5", "/xdmf");
  xdmf.add(record.step, record.load_factor, record.mode, shown);
  written_steps.push_back(std::move(step));
}

void Results::Files::add(const StepRecord& record, const std::optional<StepFields>& step_fields) {
  const Row row = make_row(record, support_sets, probes);
  const std::vector<Field> fields =
      present_fields(step_fields.value_or(StepFields{}), count, dimension);
  if (record.step < 0 || record.step <= last_step) {
    throw std::logic_error("results: step " + std::to_string(record.step) + " after step " +
                           std::to_string(last_step));
  }
  last_step = record.step;

  if (!fields.empty()) write_step(record, fields, step_fields->histories);
  append_pending();
  master.append("/history", history_header, {row});
  publish_file(folder.results(), master.image());
  totals.add(record);  // accepted: results.h5 has it, whatever becomes of the tables
  history.append(row);
  convergence.accept(record.step);
  // Its length grows with the steps, so that a run of quick steps would mostly write this file.
  if (!fields.empty()) xdmf_is_behind = true;
  if (Clock::now() - xdmf_time >= std::chrono::seconds(1)) publish_xdmf();
}

void Results::Files::add_fields(const StepRecord& record, const StepFields& step_fields) {
  if (record.step != last_step) {
    throw std::logic_error("results: fields of step " + std::to_string(record.step) +
                           " after step " + std::to_string(last_step));
  }
  if (!written_steps.empty() && written_steps.back().name == step_name(record.step)) return;
  write_step(record, present_fields(step_fields, count, dimension), step_fields.histories);
  publish_file(folder.results(), master.image());
  xdmf_is_behind = true;
}

void Results::Files::publish_xdmf() {
  if (!xdmf_is_behind) return;
  publish_file(folder.xdmf(), xdmf.text());
  xdmf_is_behind = false;
  xdmf_time = Clock::now();
}

void Results::Files::publish_summary(const Summary& summary) const {
  publish_reserved_file(folder.summary(), summary_json(summary, totals, peak_memory_bytes()));
}

/// Replaces the links of results.h5 by what they link to and removes the parts.
void Results::Files::gather_parts() {
  const std::filesystem::path gathered = temporary(folder.results());
  try {
    const std::string_view image = master.image();
    std::uint64_t room = image.size() + std::filesystem::file_size(folder.parts() / "points.h5") +
                         room_for_structure;
    for (const WrittenStep& step : written_steps) {
      room += std::filesystem::file_size(folder.parts() / (step.name + ".h5")) + room_for_step;
    }
    auto file = Hdf5File::create(gathered, room, image);
    const auto gather = [&](const std::string& part, const std::string& source,
                            const std::string& path) {
      const auto from = Hdf5File::open_for_reading(folder.parts() / part);
      file.unlink(path);
      file.copy(from, source, path);
    };
    gather("points.h5", "/points", "/points");
    for (const WrittenStep& step : written_steps) {
      gather(step.name + ".h5", "/step", "/steps/" + step.name);
      if (!has_views()) continue;
      // A view names the path of what it shows, so it is made anew instead of copied.
      file.unlink("/xdmf/" + step.name);
      write_views(file, "/xdmf/" + step.name, "/steps/" + step.name, step.vectors);
    }
    file.close();
    rename_file(gathered, folder.results());
  } catch (const std::runtime_error& error) {
    std::error_code ignored;
    std::filesystem::remove(gathered, ignored);
    throw OutputError(
        folder.results().string() +
        ": the steps can't be gathered into one file, they stay in parts/: " + error.what());
  }
  remove_parts(folder);
}

Results::Results(const std::filesystem::path& directory, const Points& points, const CaseText& text,
                 const std::vector<std::string>& support_sets,
                 const std::vector<ProbeColumns>& probes, const std::vector<PointCounts>& counts,
                 bool overwrite) {
  double seconds = 0.0;
  {
    const Stopwatch stopwatch(seconds);
    files_ =
        std::make_unique<Files>(directory, points, text, support_sets, probes, counts, overwrite);
  }
  files_->seconds = seconds;
}

Results::~Results() {
  try {
    files_->publish_xdmf();
  } catch (const OutputError&) {
    // The file of the step before stays; results.h5 and the tables are complete.
  }
}

void Results::add(const IterationRecord& record) {
  const Stopwatch stopwatch(files_->seconds);
  if (files_->closed) throw std::logic_error("results: closed");
  Row row = make_row(record);
  files_->convergence.add(record);
  files_->iterations.append(row);
  files_->pending_iterations.push_back(std::move(row));
}

void Results::add(const DecisionRecord& record) {
  const Stopwatch stopwatch(files_->seconds);
  if (files_->closed) throw std::logic_error("results: closed");
  Row row = make_row(record);
  files_->decisions.append(row);
  files_->pending_decisions.push_back(std::move(row));
}

void Results::add(const std::vector<BrokenBondRecord>& records) {
  const Stopwatch stopwatch(files_->seconds);
  if (files_->closed) throw std::logic_error("results: closed");
  for (const BrokenBondRecord& record : records) {
    Row row = make_row(record);
    files_->broken_bonds.append(row);
    files_->pending_broken_bonds.push_back(std::move(row));
  }
}

void Results::add(const StepRecord& record, const std::optional<StepFields>& fields) {
  const Stopwatch stopwatch(files_->seconds);
  if (files_->closed) throw std::logic_error("results: closed");
  files_->add(record, fields);
}

void Results::add_fields(const StepRecord& record, const StepFields& fields) {
  const Stopwatch stopwatch(files_->seconds);
  if (files_->closed) throw std::logic_error("results: closed");
  files_->add_fields(record, fields);
}

void Results::add_dossier(const std::string& text, const std::vector<double>& residual,
                          const std::vector<double>& displacement) {
  const Stopwatch stopwatch(files_->seconds);
  if (files_->closed) throw std::logic_error("results: closed");
  const Hdf5File::Shape shape{static_cast<std::uint64_t>(files_->count),
                              static_cast<std::uint64_t>(files_->dimension)};
  files_->master.make_group("/dossier");
  files_->master.write("/dossier/residual", residual, shape,
                       {"N",
                        "residual of the state in which the last search ended, 0 where "
                        "displacements are prescribed"});
  files_->master.write("/dossier/displacement", displacement, shape,
                       {"m", "displacement of the state in which the last search ended"});
  publish_file(files_->folder.dossier(), text);
}

void Results::close(Summary summary) {
  const Stopwatch stopwatch(files_->seconds);
  if (files_->closed) throw std::logic_error("results: closed");
  files_->closed = true;
  files_->append_pending();
  std::exception_ptr failure;
  try {
    publish_file(files_->folder.results(), files_->master.image());
    publish_file(files_->folder.convergence(), files_->convergence.csv());
    files_->publish_xdmf();
    files_->gather_parts();
  } catch (const std::runtime_error& error) {
    failure = std::current_exception();
    summary.status = "failed";
    summary.reason = error.what();
  }
  files_->publish_summary(summary);
  if (failure) std::rethrow_exception(failure);
}

void Results::fail(Summary summary, const std::string& reason) noexcept {
  try {
    files_->closed = true;
    summary.status = "failed";
    summary.reason = reason;
    files_->publish_summary(summary);
  } catch (const std::exception&) {
    // The folder is gone or can't be written, which is what the reason says.
  }
}

std::string Results::what_is_left() const {
  const ResultsFolder& folder = files_->folder;
  std::error_code error;
  if (!std::filesystem::exists(folder.results(), error)) {
    return folder.directory.string() + " is gone: nothing of this run is left there";
  }
  const int steps = files_->totals.steps;
  return (steps == 1 ? "1 accepted step is in "
                     : std::to_string(steps) + " accepted steps are in ") +
         folder.directory.string();
}

double Results::seconds_spent() const { return files_->seconds; }

}  // namespace peristat
