#include "cases/runner/results/results.hpp"

#include <algorithm>
#include <chrono>
#include <exception>
#include <fstream>
#include <limits>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>

#include "cases/runner/process/output_file.hpp"
#include "cases/runner/results/checkpoint/checkpoint_files.hpp"
#include "cases/runner/results/files/csv_table.hpp"
#include "cases/runner/results/files/hdf5_file.hpp"
#include "cases/runner/results/files/part_file.hpp"
#include "cases/runner/results/files/xdmf_series.hpp"
#include "cases/runner/results/folder/results_folder.hpp"
#include "cases/runner/results/folder/safe_copy.hpp"
#include "cases/runner/results/parts/crack_lines.hpp"
#include "cases/runner/results/parts/point_cells.hpp"
#include "cases/runner/results/parts/step_part.hpp"
#include "cases/runner/results/parts/vtk_hdf.hpp"
#include "cases/runner/results/sensitivities.hpp"
#include "cases/runner/results/tables/convergence_table.hpp"
#include "cases/runner/results/tables/load_displacement.hpp"
#include "cases/runner/results/tables/record_tables.hpp"
#include "cases/runner/results/tables/settings_table.hpp"
#include "cases/runner/results/tables/summary_json.hpp"
#include "src/core/input_error.hpp"
#include "src/core/stopwatch.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {
namespace {

constexpr std::size_t master_growth = 1 << 18;  // bytes
// Generous bound of what HDF5 needs for the groups of a step [byte].
constexpr std::uint64_t room_for_step = 1 << 14;

using Clock = std::chrono::steady_clock;

/// Room for summary.json [byte]: fixed members, and those of supports and probes.
std::uint64_t room_for_summary(const std::vector<std::string>& sets,
                               const std::vector<ProbeColumns>& probes) {
  std::uint64_t room = 4096;
  for (const std::string& set : sets) room += 128 + 6 * set.size();
  for (const ProbeColumns& probe : probes) room += 128 + 6 * probe.name.size();
  return room;
}

/// Constant fields of points in results.xdmf.
std::vector<XdmfSeries::Field> constant_fields(const Points& points) {
  std::vector<XdmfSeries::Field> fields{{"volume", "/points/volume"}};
  for (const auto& [name, members] : points.sets) {
    fields.push_back({"set_" + name, flags_of(name), false, true});
  }
  return fields;
}

std::string version_of(const CaseText& text) {
  const auto version = text.versions.find("peristat");
  return version == text.versions.end() ? "" : version->second;
}

/// Identity of a run, with the files of its lines.
RunIdentity identity(const CaseText& text, const FurtherOutput& further) {
  RunIdentity run{version_of(text), text.title, text.file, {}};
  for (const LineTable& line : further.lines) run.files.push_back(file_of_line(line.name));
  if (further.has_sensitivities) run.files.emplace_back(Sensitivities::file_name);
  return run;
}

std::string group_of_line(const std::string& name) { return "/lines/" + name; }

/// Path of a file relative to the results folder, as links name it.
std::string name_in(const ResultsFolder& folder, const std::filesystem::path& file) {
  return file.lexically_relative(folder.directory).generic_string();
}

/// Largest resident memory since the program was started [byte]. getrusage would also count the
/// memory of the process that started it.
std::int64_t peak_memory_bytes() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    std::int64_t kilobytes = 0;
    if (word == "VmHWM:" && status >> kilobytes) return kilobytes * 1024;
  }
  return 0;
}

void write_dossier(const RowSink& sink, const std::vector<double>& residual,
                   const std::vector<double>& displacement, StepShape shape) {
  const auto dimension = static_cast<std::uint64_t>(shape.dimension);
  sink.write("/dossier/residual", residual, {dimension},
             {"N",
              "residual of the state in which the last search ended, 0 where displacements are "
              "prescribed"});
  sink.write("/dossier/displacement", displacement, {dimension},
             {"m", "displacement of the state in which the last search ended"});
}

/// Reads the parts of a results folder. The part that was opened last stays open, as it may hold
/// many steps.
class PartReader {
 public:
  explicit PartReader(const ResultsFolder& folder) : folder_(folder) {}

  const Hdf5File& open(const std::string& part) {
    if (part != name_) {
      file_.emplace(Hdf5File::open_for_reading(folder_.directory / part));
      name_ = part;
    }
    return *file_;
  }

 private:
  const ResultsFolder& folder_;
  std::string name_;
  std::optional<Hdf5File> file_;
};

/// Copies the bytes of a checkpoint, in parts.
void copy_checkpoint(const std::filesystem::path& from, Hdf5File& file) {
  const CheckpointBytes bytes = bytes_of_file(from);
  constexpr std::uint64_t most = 1 << 20;
  file.write_rows<std::uint8_t>("/checkpoint", {bytes.size},
                                {"none", "state from which the run can be resumed, for peristat"},
                                [&](const Hdf5File::PutRows<std::uint8_t>& put) {
                                  for (std::uint64_t at = 0; at < bytes.size; at += most) {
                                    const std::string part =
                                        bytes.read(at, std::min(most, bytes.size - at));
                                    put(at, {part.begin(), part.end()});
                                  }
                                });
}

/// Start of results: an empty folder, or the results of an earlier run.
struct Beginning {
  ClaimedFolder folder;
  const EarlierResults* earlier = nullptr;
  const Checkpoint* checkpoint = nullptr;
  StateNumbering* numbering = nullptr;

  [[nodiscard]] std::vector<Row> rows(std::vector<Row> EarlierResults::*table) const {
    return earlier ? earlier->*table : std::vector<Row>();
  }
};

StepShape shape_of(const Points& points, const RowGathering& gathering,
                   const FurtherOutput& further) {
  return {Index(gathering.rows(points.volume.size())), points.dimension, further.has_stress};
}

}  // namespace

struct Results::Files {
  Files(Beginning beginning, const Points& points, const CaseText& text,
        const std::vector<std::string>& sets, const std::vector<ProbeColumns>& probe_columns,
        const std::vector<PointCounts>& counts, const CellsOfBody& cells_of_body,
        const FurtherOutput& further, const RowGathering& of_ranks);

  void describe(const CaseText& text);
  void go_on(const EarlierResults& earlier, const Checkpoint& checkpoint,
             StateNumbering* numbering);
  void add(const StepRecord& record, const StepFields& fields);
  void add_fields(const StepRecord& record, const StepFields& step_fields);
  void write_step(const StepRecord& record, const StepPart& part);
  void link(WrittenStep step);
  void append_pending();
  void publish();
  void write_checkpoint(Checkpoint checkpoint, StateNumbering* numbering);
  void add_dossier(const std::vector<double>& residual, const std::vector<double>& displacement);
  void publish_xdmf();
  void publish_vtk_hdf();
  void publish_summary(const Summary& summary) const;
  void gather_parts();

  /// Largest peak memory among all ranks when the run ended.
  std::int64_t peak_memory_of_others = 0;

  const RowGathering& gathering;
  StepShape shape;
  std::vector<std::string> support_sets;
  std::vector<ProbeColumns> probes;
  std::vector<Column> history_header;
  ClaimedFolder claimed;
  const ResultsFolder& folder;
  LoadDisplacement load_displacement;
  CsvTable history, curve, iterations, decisions, broken_bonds;
  /// A table of values along a line, and its rows that results.h5 does not have yet.
  struct Line {
    LineTable table;
    std::unique_ptr<CsvTable> file;
    std::vector<Row> pending;
  };
  std::vector<Line> lines;
  Hdf5File master;  ///< results.h5 with links to the parts; lives in memory
  CrackLines lines_of_cracks;
  const CellSizes cells;
  const std::vector<XdmfSeries::Field> constant;
  XdmfSeries xdmf;
  std::string program;  ///< version
  StepTotals totals;
  TableRows rows;
  ConvergenceTable convergence;
  CheckpointFiles checkpoints;
  SafeCopy safe_copy;
  bool xdmf_is_behind = false, vtk_is_behind = false;
  Clock::time_point xdmf_time{};  ///< when it was last published
  Clock::time_point vtk_time{};   ///< likewise results.vtkhdf
  double vtk_seconds = 0.0;       ///< that this has taken
  std::vector<Row> pending_iterations, pending_decisions, pending_broken_bonds;
  ObjectInFile points_part;
  std::optional<ObjectInFile> dossier_part;
  std::vector<WrittenStep> written_steps;
  int last_step = std::numeric_limits<int>::min();
  bool closed = false;
  double seconds = 0.0;
};

Results::Files::Files(Beginning beginning, const Points& points, const CaseText& text,
                      const std::vector<std::string>& sets,
                      const std::vector<ProbeColumns>& probe_columns,
                      const std::vector<PointCounts>& counts, const CellsOfBody& cells_of_body,
                      const FurtherOutput& further, const RowGathering& of_ranks)
    : gathering(of_ranks),
      shape(shape_of(points, of_ranks, further)),
      support_sets(sets),
      probes(probe_columns),
      history_header(history_columns(sets, probe_columns)),
      claimed(std::move(beginning.folder)),
      folder(claimed.paths),
      load_displacement(history_header, further.has_control),
      history(folder.history(), history_header, beginning.rows(&EarlierResults::history)),
      curve(folder.load_displacement(), load_displacement.columns(),
            load_displacement.rows(beginning.rows(&EarlierResults::history))),
      iterations(folder.iterations(), iteration_columns(),
                 beginning.rows(&EarlierResults::iterations)),
      decisions(folder.decisions(), decision_columns(), beginning.rows(&EarlierResults::decisions)),
      broken_bonds(folder.broken_bonds(), broken_bond_columns(),
                   beginning.rows(&EarlierResults::broken_bonds)),
      master(Hdf5File::in_memory(folder.results().string() + " (in memory)", master_growth)),
      lines_of_cracks(master, !points.images.kinds.empty()),
      cells(cells_of_body.sizes),
      constant(constant_fields(points)),
      xdmf(shape.points, xdmf_cells(cells), constant),
      program(version_of(text)),
      checkpoints(folder.parts()),
      safe_copy(folder),
      points_part{name_in(folder, folder.points()), "/points"} {
  write_file(temporary(folder.summary()), "");
  reserve_file(temporary(folder.summary()), room_for_summary(sets, probe_columns));
  for (const LineTable& line : further.lines) {
    std::vector<Row> rows_so_far;
    if (beginning.earlier) rows_so_far = beginning.earlier->lines.at(line.name);
    auto file = std::make_unique<CsvTable>(folder.directory / file_of_line(line.name), line.columns,
                                           rows_so_far);
    lines.push_back({line, std::move(file), std::move(rows_so_far)});
  }
  describe(text);
  if (beginning.earlier) {
    go_on(*beginning.earlier, *beginning.checkpoint, beginning.numbering);
  } else {
    publish_part(
        folder.points(), bytes_of(points, counts, cells, std::uint64_t(shape.points)),
        [&](Hdf5File& file) { write_points(file, points, counts, cells_of_body, gathering); });
  }
  master.link("/points", points_part.file, points_part.object);
  publish();
}

void Results::Files::describe(const CaseText& text) {
  master.set_attribute("/", "title", text.title);
  auto versions = text.versions;
  versions.emplace("hdf5", Hdf5File::library_version());
  for (const auto& [name, version] : versions) {
    master.set_attribute("/", name + "_version", version);
  }
  master.make_group("/case");
  master.set_attribute("/case", "file", text.file.string());
  master.write("/case/as_read", text.as_read, {"none", "text of the case file (TOML)"});
  master.write("/case/as_resolved", text.as_resolved,
               {"none", "the case with overrides and defaults in place (TOML)"});
  if (!text.files.empty()) {
    master.write(
        "/case/files", text.files,
        {"none",
         "checksum (FNV-1a) and path of each file that the case reads; names of what a program "
         "gave"});
  }
  if (!text.preflight.empty()) {
    master.write("/case/preflight", text.preflight,
                 {"none", "facts about body, loads and law, as `check` prints them"});
  }
  write_settings(master, text.settings);
  master.make_table("/history", history_header);
  master.make_table("/iterations", iteration_columns());
  master.make_table("/decisions", decision_columns());
  master.make_table("/broken_bonds", broken_bond_columns());
  if (!lines.empty()) master.make_group("/lines");
  for (const Line& line : lines) {
    master.make_table(group_of_line(line.table.name), line.table.columns);
  }
  master.make_group("/steps");
  if (shape.has_views()) master.make_group("/xdmf");
}

/// Takes over the results of an earlier run. The checkpoint is written before results.h5 is
/// published, so that a kill in between leaves the earlier run as it was.
void Results::Files::go_on(const EarlierResults& earlier, const Checkpoint& checkpoint,
                           StateNumbering* numbering) {
  master.append("/history", history_header, earlier.history);
  master.append("/iterations", iteration_columns(), earlier.iterations);
  master.append("/decisions", decision_columns(), earlier.decisions);
  master.append("/broken_bonds", broken_bond_columns(), earlier.broken_bonds);
  append_pending();  // the lines
  rows = checkpoint.rows;
  auto iteration = earlier.iterations.begin();
  for (const Row& row : earlier.history) {
    const StepRecord record = read_step(row, support_sets, probes);
    for (; iteration != earlier.iterations.end(); ++iteration) {
      const IterationRecord of_step = read_iteration(*iteration);
      if (of_step.step > record.step) break;
      convergence.add(of_step);
    }
    convergence.accept(record.step);
    totals.add(record);
    last_step = record.step;
  }
  auto bond = earlier.broken_bonds.begin();
  for (const WrittenStep& step : earlier.steps) {
    const auto is_broken = [&](const Row& row) {
      return std::get<std::int64_t>(row.front()) <= step.step;
    };
    for (; bond != earlier.broken_bonds.end() && is_broken(*bond); ++bond) {
      lines_of_cracks.add(*bond);
    }
    link(step);
  }
  for (; bond != earlier.broken_bonds.end(); ++bond) lines_of_cracks.add(*bond);
  lines_of_cracks.append_pending();
  points_part = earlier.points;
  write_checkpoint(checkpoint, numbering);
}

void Results::Files::append_pending() {
  master.append("/iterations", iteration_columns(), pending_iterations);
  pending_iterations.clear();
  master.append("/decisions", decision_columns(), pending_decisions);
  pending_decisions.clear();
  master.append("/broken_bonds", broken_bond_columns(), pending_broken_bonds);
  pending_broken_bonds.clear();
  lines_of_cracks.append_pending();
  for (Line& line : lines) {
    master.append(group_of_line(line.table.name), line.table.columns, line.pending);
    line.pending.clear();
  }
}

void Results::Files::publish() { publish_file(folder.results(), master.image()); }

void Results::Files::write_checkpoint(Checkpoint checkpoint, StateNumbering* numbering) {
  checkpoint.rows = rows;
  checkpoint.last_with_fields =
      written_steps.empty() ? Checkpoint::none : written_steps.back().step;
  checkpoints.write([&](const PutBytes& put) {
    peristat::write_checkpoint(std::move(checkpoint), program, numbering, put);
  });
}

void Results::Files::link(WrittenStep step) {
  master.link("/steps/" + step.name(), step.file, step.group);
  if (shape.has_views()) master.link("/xdmf/" + step.name(), step.file, step.views);
  xdmf.add(step.step, step.load_factor, step.mode, shown_fields(step, shape),
           lines_of_cracks.lines_of(step.name()));
  xdmf_is_behind = true;
  written_steps.push_back(std::move(step));
}

void Results::Files::write_step(const StepRecord& record, const StepPart& part) {
  WrittenStep step{record.step, record.load_factor, record.mode, {}, "/step", "/xdmf", {}};
  step.fields = part.names();
  const std::filesystem::path file = folder.parts() / (step.name() + ".h5");
  step.file = name_in(folder, file);
  publish_part(file, part.bytes(), [&](Hdf5File& made) { part.write(made, step); });
  link(std::move(step));
}

void Results::Files::add(const StepRecord& record, const StepFields& fields) {
  const Row row = make_row(record, support_sets, probes);
  const StepPart part(shape, fields, gathering);
  if (record.step < 0 || record.step <= last_step) {
    throw std::logic_error("results: step " + std::to_string(record.step) + " after step " +
                           std::to_string(last_step));
  }
  last_step = record.step;

  if (!part.is_empty()) write_step(record, part);
  append_pending();
  master.append("/history", history_header, {row});
  ++rows.history;
  publish();
  totals.add(record);  // accepted: results.h5 has it, whatever becomes of the tables
  history.append(row);
  curve.append(load_displacement.row(row));
  convergence.accept(record.step);
  // The file grows with the steps, so that a run of quick steps would mostly write this file.
  if (Clock::now() - xdmf_time >= std::chrono::seconds(1)) publish_xdmf();
}

void Results::Files::add_fields(const StepRecord& record, const StepFields& step_fields) {
  if (record.step != last_step) {
    throw std::logic_error("results: fields of step " + std::to_string(record.step) +
                           " after step " + std::to_string(last_step));
  }
  if (!written_steps.empty() && written_steps.back().step == record.step) return;
  write_step(record, StepPart(shape, step_fields, gathering));
  publish();
}

void Results::Files::add_dossier(const std::vector<double>& residual,
                                 const std::vector<double>& displacement) {
  const std::uint64_t bytes = 2 * sizeof(double) * std::uint64_t(shape.points * shape.dimension);
  const std::filesystem::path file = folder.parts() / "dossier.h5";
  publish_part(file, bytes, [&](Hdf5File& made) {
    made.make_group("/dossier");
    write_dossier({&made, gathering, std::uint64_t(shape.points)}, residual, displacement, shape);
  });
  dossier_part = ObjectInFile{name_in(folder, file), "/dossier"};
  master.link("/dossier", dossier_part->file, dossier_part->object);
}

void Results::Files::publish_xdmf() {
  if (xdmf_is_behind) {
    publish_file(folder.xdmf(), xdmf.text());
    xdmf_is_behind = false;
    vtk_is_behind = true;
    xdmf_time = Clock::now();
  }
  // Written anew each time, too, which takes longer.
  constexpr double share_of_time = 0.01;
  const std::chrono::duration<double> since = Clock::now() - vtk_time;
  if (!vtk_is_behind) return;
  if (closed || vtk_seconds <= share_of_time * since.count()) publish_vtk_hdf();
}

void Results::Files::publish_vtk_hdf() {
  vtk_seconds = 0.0;
  const Stopwatch stopwatch(vtk_seconds);
  auto file = Hdf5File::in_memory(folder.vtk_hdf().string() + " (in memory)", master_growth);
  write_vtk_hdf(file, written_steps, shape, cells, constant);
  publish_file(folder.vtk_hdf(), file.image());
  vtk_is_behind = false;
  vtk_time = Clock::now();
}

void Results::Files::publish_summary(const Summary& summary) const {
  const std::int64_t most = std::max(peak_memory_bytes(), peak_memory_of_others);
  publish_reserved_file(folder.summary(), summary_json(summary, totals, most));
}

/// Replaces the links of results.h5 by what they link to and removes the parts.
void Results::Files::gather_parts() {
  const std::filesystem::path gathered = temporary(folder.results());
  const std::filesystem::path checkpoint = checkpoints.last();
  try {
    std::set<std::string> parts{points_part.file};
    if (dossier_part) parts.insert(dossier_part->file);
    for (const WrittenStep& step : written_steps) parts.insert(step.file);
    const std::string_view image = master.image();
    std::uint64_t room = image.size() + room_for_structure + written_steps.size() * room_for_step;
    if (!checkpoint.empty()) room += std::filesystem::file_size(checkpoint);
    for (const std::string& part : parts) {
      room += std::filesystem::file_size(folder.directory / part);
    }
    auto file = Hdf5File::create(gathered, room, image);
    PartReader reader(folder);
    file.unlink("/points");
    file.copy(reader.open(points_part.file), points_part.object, "/points");
    if (dossier_part) {
      file.unlink("/dossier");
      file.copy(reader.open(dossier_part->file), dossier_part->object, "/dossier");
    }
    for (const WrittenStep& step : written_steps) {
      file.unlink("/steps/" + step.name());
      file.copy(reader.open(step.file), step.group, "/steps/" + step.name());
      if (!shape.has_views()) continue;
      // A view names the path of what it shows, so it is made anew instead of copied.
      file.unlink("/xdmf/" + step.name());
      write_views(file, "/xdmf/" + step.name(), "/steps/" + step.name(), step.fields, shape);
    }
    if (!checkpoint.empty()) copy_checkpoint(checkpoint, file);
    file.close();
    if (safe_copy.is_due()) sync_file(gathered);  // the parts are removed next
    rename_file(gathered, folder.results());
  } catch (const std::runtime_error& error) {
    std::error_code ignored;
    std::filesystem::remove(gathered, ignored);
    throw OutputError(
        folder.results().string() +
        ": the steps can't be gathered into one file; they stay in parts/: " + error.what());
  }
  remove_parts(folder);
}

/// State of a rank that only sends.
struct Results::Sender {
  const RowGathering& gathering;
  StepShape shape;
  std::filesystem::path directory;
  int last_with_fields = Checkpoint::none;
  StepTotals totals{};

  void send(const StepRecord& record, const StepFields& fields) {
    StepPart(shape, fields, gathering).send();
    last_with_fields = record.step;
  }
  /// Writes the summary in the place of rank 0, which waits for this rank.
  void publish_summary(const Summary& summary) const {
    publish_reserved_file(ResultsFolder{directory}.summary(),
                          summary_json(summary, totals, peak_memory_bytes()));
  }
};

Results::Results(const std::filesystem::path& directory, const Points& points, const CaseText& text,
                 const std::vector<std::string>& support_sets,
                 const std::vector<ProbeColumns>& probes, const std::vector<PointCounts>& counts,
                 bool overwrite, const FurtherOutput& further, const RowGathering& gathering) {
  const CellsOfBody cells(points, gathering);
  if (!gathering.part().is_first_rank()) {
    const StepShape shape = shape_of(points, gathering, further);
    sender_ = std::make_unique<Sender>(Sender{gathering, shape, directory});
    send_points(points, counts, cells, gathering);
    return;
  }
  double seconds = 0.0;
  {
    const Stopwatch stopwatch(seconds);
    // A probe that is refused leaves the folder alone.
    static_cast<void>(history_columns(support_sets, probes));
    files_ = std::make_unique<Files>(
        Beginning{claim_results_folder(directory, identity(text, further), overwrite)}, points,
        text, support_sets, probes, counts, cells, further, gathering);
  }
  files_->seconds = seconds;
}

Results::Results(EarlierRun& run, EarlierResults& earlier, const Points& points,
                 const CaseText& text, const std::vector<std::string>& support_sets,
                 const std::vector<ProbeColumns>& probes, const FurtherOutput& further,
                 StateNumbering* numbering) {
  const RowGathering& gathering = numbering ? numbering->gathering() : no_gathering();
  const CellsOfBody cells(points, gathering);
  if (!gathering.part().is_first_rank()) {
    const StepShape shape = shape_of(points, gathering, further);
    sender_ = std::make_unique<Sender>(Sender{gathering, shape, run.directory()});
    for (const Row& row : earlier.history) {
      sender_->totals.add(read_step(row, support_sets, probes));
    }
    if (!earlier.steps.empty()) sender_->last_with_fields = earlier.steps.back().step;
    write_checkpoint(run.checkpoint(), "", numbering, {});
    return;
  }
  double seconds = run.checkpoint().costs.seconds.output;
  {
    const Stopwatch stopwatch(seconds);
    ClaimedFolder folder = run.take_over(identity(text, further), earlier);
    files_ = std::make_unique<Files>(
        Beginning{std::move(folder), &earlier, &run.checkpoint(), numbering}, points, text,
        support_sets, probes, std::vector<PointCounts>(), cells, further, gathering);
  }
  files_->seconds = seconds;
}

Results::~Results() {
  if (!files_) return;
  try {
    files_->closed = true;
    files_->publish_xdmf();
  } catch (const std::exception&) {
    // The file of the step before stays; results.h5 and the tables are complete.
  }
}

void Results::add(const IterationRecord& record) {
  if (!files_) return;
  const Stopwatch stopwatch(files_->seconds);
  if (files_->closed) throw std::logic_error("results: closed");
  Row row = make_row(record);
  files_->convergence.add(record);
  files_->iterations.append(row);
  files_->pending_iterations.push_back(std::move(row));
  ++files_->rows.iterations;
}

void Results::add(const DecisionRecord& record) {
  if (!files_) return;
  const Stopwatch stopwatch(files_->seconds);
  if (files_->closed) throw std::logic_error("results: closed");
  Row row = make_row(record);
  files_->decisions.append(row);
  files_->pending_decisions.push_back(std::move(row));
  ++files_->rows.decisions;
}

void Results::add(const std::vector<BrokenBondRecord>& records) {
  if (sender_) return sender_->gathering.gather_of_bonds(records, [](const auto&) {});
  const Stopwatch stopwatch(files_->seconds);
  if (files_->closed) throw std::logic_error("results: closed");
  const auto append = [&](const std::vector<BrokenBondRecord>& some) {
    for (const BrokenBondRecord& record : some) {
      Row row = make_row(record);
      files_->broken_bonds.append(row);
      files_->lines_of_cracks.add(row);
      files_->pending_broken_bonds.push_back(std::move(row));
      ++files_->rows.broken_bonds;
    }
  };
  if (files_->gathering.is_whole()) return append(records);
  files_->gathering.gather_of_bonds(records, append);
}

void Results::add_line(const std::string& name, const std::vector<Row>& rows) {
  if (!files_) return;
  const Stopwatch stopwatch(files_->seconds);
  if (files_->closed) throw std::logic_error("results: closed");
  const auto line = std::ranges::find_if(
      files_->lines, [&](const auto& known) { return known.table.name == name; });
  if (line == files_->lines.end()) throw std::logic_error("results: no line " + name);
  for (const Row& row : rows) {
    line->file->append(row);
    line->pending.push_back(row);
  }
}

void Results::add(const StepRecord& record, const StepFields& fields) {
  if (sender_) {
    if (!fields.values.empty()) sender_->send(record, fields);
    return sender_->totals.add(record);
  }
  const Stopwatch stopwatch(files_->seconds);
  if (files_->closed) throw std::logic_error("results: closed");
  files_->add(record, fields);
}

void Results::add_checkpoint(Checkpoint checkpoint, StateNumbering* numbering) {
  if (sender_) return write_checkpoint(std::move(checkpoint), "", numbering, {});
  const Stopwatch stopwatch(files_->seconds);
  if (files_->closed) throw std::logic_error("results: closed");
  if (!files_->pending_decisions.empty()) {  // about the step to come
    files_->append_pending();
    files_->publish();
  }
  files_->write_checkpoint(std::move(checkpoint), numbering);
  if (files_->safe_copy.is_due()) {
    files_->safe_copy.make(files_->points_part.file, files_->written_steps,
                           files_->checkpoints.last());
  }
}

void Results::add_fields(const StepRecord& record, const StepFields& fields) {
  if (sender_) {
    if (sender_->last_with_fields != record.step) sender_->send(record, fields);
    return;
  }
  const Stopwatch stopwatch(files_->seconds);
  if (files_->closed) throw std::logic_error("results: closed");
  files_->add_fields(record, fields);
}

void Results::add_dossier(const std::string& text, const std::vector<double>& residual,
                          const std::vector<double>& displacement) {
  if (sender_)
    return write_dossier({nullptr, sender_->gathering, std::uint64_t(sender_->shape.points)},
                         residual, displacement, sender_->shape);
  const Stopwatch stopwatch(files_->seconds);
  if (files_->closed) throw std::logic_error("results: closed");
  files_->add_dossier(residual, displacement);
  publish_file(files_->folder.dossier(), text);
}

void Results::close(Summary summary) {
  if (sender_) {
    static_cast<void>(sender_->gathering.ranks().max(double(peak_memory_bytes())));
    return;
  }
  const Stopwatch stopwatch(files_->seconds);
  if (files_->closed) throw std::logic_error("results: closed");
  files_->peak_memory_of_others =
      std::int64_t(files_->gathering.ranks().max(double(peak_memory_bytes())));
  files_->closed = true;
  files_->append_pending();
  std::exception_ptr failure;
  try {
    files_->publish();
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
    summary.status = "failed";
    summary.reason = reason;
    if (sender_) return sender_->publish_summary(summary);
    files_->closed = true;
    files_->publish_summary(summary);
  } catch (const std::exception&) {
    // The folder is gone or can't be written, which is what the reason says.
  }
}

void Results::abandon() noexcept {
  static_cast<void>(files_.release());
  static_cast<void>(sender_.release());
}

std::string Results::what_is_left() const {
  const ResultsFolder folder = sender_ ? ResultsFolder{sender_->directory} : files_->folder;
  std::error_code error;
  if (!std::filesystem::exists(folder.results(), error)) {
    return folder.directory.string() + " has been removed, and the results of this run with it";
  }
  const int steps = sender_ ? sender_->totals.steps : files_->totals.steps;
  return (steps == 1 ? "1 accepted step is in "
                     : std::to_string(steps) + " accepted steps are in ") +
         folder.directory.string();
}

double Results::seconds_spent() const { return sender_ ? 0.0 : files_->seconds; }

}  // namespace peristat
