#include "cases/runner/results/folder/earlier_run.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <system_error>

#include <unistd.h>

#include "cases/runner/process/fault_aside.hpp"
#include "cases/runner/process/output_file.hpp"
#include "cases/runner/results/checkpoint/checkpoint_files.hpp"
#include "cases/runner/results/parts/points_part.hpp"
#include "cases/runner/results/tables/record_tables.hpp"
#include "cases/runner/results/tables/settings_table.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {
namespace {

namespace fs = std::filesystem;

/// The first `count` rows of a table.
std::vector<Row> first_rows(const Hdf5File& file, const std::string& group,
                            const std::vector<Column>& columns, int count) {
  std::vector<Row> rows = file.rows(group, columns);
  if (count < 0 || std::size_t(count) > rows.size()) {
    throw BadCheckpoint("has more rows than the table " + group);
  }
  rows.resize(std::size_t(count));
  return rows;
}

/// File and path of an object of a results file.
ObjectInFile place_of(const Hdf5File& file, const fs::path& name, const std::string& path) {
  return file.link_target(path).value_or(ObjectInFile{name.filename().string(), path});
}

bool has_checkpoints(const ResultsFolder& folder) {
  return std::any_of(CheckpointFiles::names.begin(), CheckpointFiles::names.end(),
                     [&](const char* name) { return fs::exists(folder.parts() / name); });
}

/// Checkpoint in results.h5 of a run that has ended.
CheckpointBytes checkpoint_in(const fs::path& results) {
  const auto file = std::make_shared<const Hdf5File>(Hdf5File::open_for_reading(results));
  const std::uint64_t size = file->count_of_rows("/checkpoint");
  return {size, [file, size](std::uint64_t first, std::uint64_t count) {
            const std::uint64_t here = std::min(count, size - std::min(first, size));
            const auto bytes = file->some_rows<std::uint8_t>("/checkpoint", first, here);
            return std::string(bytes.begin(), bytes.end());
          }};
}

ResultsMarker claim(const fs::path& directory) {
  if (!fs::is_directory(directory)) throw RefusedFolder("is not the results folder of a run");
  std::optional<ResultsMarker> marker = ResultsMarker::find(directory);
  if (!marker || marker->is_blank()) throw RefusedFolder("holds no run");
  return std::move(*marker);
}

/// Copies everything into memory as a test, as it will be copied when the run ends.
void try_to_copy(const ResultsFolder& folder, const EarlierResults& earlier) {
  const auto copy = [&](const std::string& file, const std::string& object) {
    Hdf5File::in_memory("trial (in memory)", std::size_t(1) << 20)
        .copy(Hdf5File::open_for_reading(folder.directory / file), object, "/copy");
  };
  copy(earlier.points.file, earlier.points.object);
  for (const WrittenStep& step : earlier.steps) copy(step.file, step.group);
}

/// Gives a file a second name, or copies it where the file system can't.
void put_beside(const fs::path& file, const fs::path& name) {
  const fs::path unfinished = temporary(name);
  std::error_code error;
  fs::remove(unfinished, error);
  fs::create_hard_link(file, unfinished, error);
  if (error) fs::copy_file(file, unfinished, fs::copy_options::overwrite_existing, error);
  if (error) throw OutputError(name.string() + ": " + error.message(), error.value());
  rename_file(unfinished, name);
}

}  // namespace

EarlierRun::EarlierRun(const fs::path& directory, const std::string& program,
                       const Communicator& ranks)
    : folder_{fs::absolute(directory).lexically_normal()}, program_(program), ranks_(ranks) {
  if (ranks.rank() == 0) choose();
  std::string chosen(1, generation_ == Generation::safe ? 's' : 'n');
  chosen += checkpoint_file_.string();
  ranks.broadcast(chosen);
  if (ranks.rank() == 0) return;
  checkpoint_file_ = chosen.substr(1);
  read(chosen.front() == 's' ? Generation::safe : Generation::newest);
}

/// Chooses the state to resume from: the newest, or else the safe one. Throws if neither can be
/// used.
void EarlierRun::choose() {
  try {
    marker_.emplace(claim(folder_.directory));
    if (::access(folder_.directory.c_str(), W_OK) != 0) {
      throw RefusedFolder("the folder can't be written: " + std::string(std::strerror(errno)));
    }
  } catch (const RefusedFolder& error) {
    throw refusal(error.what());
  } catch (const fs::filesystem_error& error) {
    throw refusal(error.code().message());
  }
  const auto fault_of = [&](Generation which) {
    return fault_aside([&] {
      read(which);
      require_whole_checkpoint();
    });
  };
  const auto fault = fault_of(Generation::newest);
  if (!fault) {
    read(Generation::newest);
    return;
  }
  const std::string loss = "the run can't be resumed: " + *fault;
  if (!fs::exists(folder_.safe_results()) || fault_of(Generation::safe)) throw refusal(loss);
  read(Generation::safe);
  remark_ = loss + "; an older state, which is on the disk, is used instead";
}

InputError EarlierRun::refusal(const std::string& reason) const {
  return {"", "", reason, folder_.directory.string()};
}

void EarlierRun::read(Generation which) {
  generation_ = which;
  results_ = which == Generation::newest ? folder_.results() : folder_.safe_results();
  const auto file = Hdf5File::open_for_reading(results_);
  is_gathered_ = !file.link_target("/points");
  const bool has_checkpoint = is_gathered_ ? file.has("/checkpoint") : has_checkpoints(folder_);
  if (!has_checkpoint) {
    throw BadCheckpoint(
        "it has no accepted step, or comes from an older peristat that wrote no checkpoint; run "
        "the case again");
  }
  try {
    if (!is_gathered_ && checkpoint_file_.empty()) {
      checkpoint_file_ = which == Generation::safe ? folder_.safe_checkpoint()
                                                   : newest_checkpoint(folder_.parts(), program_);
    }
    checkpoint_ = read_checkpoint(bytes_of_checkpoint(), program_, {.has_arrays = false});
  } catch (const BadCheckpoint& error) {
    throw BadCheckpoint(std::string("its checkpoint ") + error.what());
  }
  case_file_ = file.text_attribute("/case", "file");
  case_text_ = file.text("/case/as_read");
  if (file.has("/case/files")) files_ = file.text("/case/files");
  settings_ = read_settings(file);
  // A run writes each step before its checkpoint, so that the tables must have its rows.
  static_cast<void>(
      first_rows(file, "/iterations", iteration_columns(), checkpoint_.rows.iterations));
}

void EarlierRun::require_whole_checkpoint() const {
  try {
    require_whole(bytes_of_checkpoint(), program_);
  } catch (const BadCheckpoint& error) {
    throw BadCheckpoint(std::string("its checkpoint ") + error.what());
  }
}

CheckpointBytes EarlierRun::bytes_of_checkpoint() const {
  return is_gathered_ ? checkpoint_in(results_) : bytes_of_file(checkpoint_file_);
}

void EarlierRun::load(StateNumbering* numbering) {
  CheckpointBytes bytes = bytes_of_checkpoint();
  if (ranks_.count() > 1) {
    // Each rank picks its own values from these.
    bytes.read = [this, read = bytes.read](std::uint64_t first, std::uint64_t count) {
      std::string part;
      if (ranks_.rank() == 0) part = read(first, count);
      ranks_.broadcast(part);
      return part;
    };
  }
  const PathState::Rungs rungs = checkpoint_.path.rungs;
  try {
    checkpoint_ = read_checkpoint(bytes, program_, {.numbering = numbering});
  } catch (const BadCheckpoint& error) {
    throw refusal(std::string("its checkpoint ") + error.what());
  }
  checkpoint_.path.rungs = rungs;
}

void EarlierRun::find_followers(const Assembler& body) {
  History& history = checkpoint_.path.accepted.history;
  history = with_followers(std::move(history), body);
}

bool EarlierRun::is_concluded() const { return is_gathered_ && fs::exists(folder_.summary()); }

EarlierResults EarlierRun::results(const std::vector<std::string>& support_sets,
                                   const std::vector<ProbeColumns>& probes,
                                   const std::vector<LineTable>& lines) const {
  if (ranks_.rank() == 0) {
    const auto fault =
        fault_aside([&] { try_to_copy(folder_, read_results(support_sets, probes, lines)); });
    if (fault) throw refusal("its results are damaged: " + *fault);
  }
  EarlierResults earlier = read_results(support_sets, probes, lines);
  static_cast<void>(ranks_.count_all(0));  // no rank writes before all have read
  return earlier;
}

EarlierResults EarlierRun::read_results(const std::vector<std::string>& support_sets,
                                        const std::vector<ProbeColumns>& probes,
                                        const std::vector<LineTable>& lines) const {
  const auto file = Hdf5File::open_for_reading(results_);
  const TableRows& rows = checkpoint_.rows;
  EarlierResults earlier{
      first_rows(file, "/history", history_columns(support_sets, probes), rows.history),
      first_rows(file, "/iterations", iteration_columns(), rows.iterations),
      first_rows(file, "/decisions", decision_columns(), rows.decisions),
      first_rows(file, "/broken_bonds", broken_bond_columns(), rows.broken_bonds),
      place_of(file, results_, "/points"),
      {}};
  const std::int64_t last =
      earlier.history.empty() ? 0 : read_step(earlier.history.back(), support_sets, probes).step;
  for (const LineTable& line : lines) {
    std::vector<Row>& of_line = earlier.lines[line.name];
    of_line = file.rows("/lines/" + line.name, line.columns);
    std::erase_if(of_line,
                  [&](const Row& row) { return std::get<std::int64_t>(row.front()) > last; });
  }
  const bool has_views = file.has("/xdmf");
  for (const Row& row : earlier.history) {
    const StepRecord record = read_step(row, support_sets, probes);
    WrittenStep step{record.step, record.load_factor, record.mode, {}, {}, {}, {}};
    const std::string path = "/steps/" + step.name();
    if (record.step > checkpoint_.last_with_fields || !file.has_link(path)) continue;
    const ObjectInFile place = place_of(file, results_, path);
    step.file = place.file;
    step.group = place.object;
    if (has_views) step.views = place_of(file, results_, "/xdmf/" + step.name()).object;
    step.fields =
        is_gathered_
            ? field_names(file, step.group)
            : field_names(Hdf5File::open_for_reading(folder_.directory / step.file), step.group);
    earlier.steps.push_back(std::move(step));
  }
  return earlier;
}

bool EarlierRun::has_points(const Points& points, const RowGathering& gathering) const {
  if (ranks_.rank() > 0) return holds_points(nullptr, "", points, gathering);
  const auto file = Hdf5File::open_for_reading(results_);
  const ObjectInFile place = place_of(file, results_, "/points");
  const auto holder = Hdf5File::open_for_reading(folder_.directory / place.file);
  return holds_points(&holder, place.object, points, gathering);
}

ClaimedFolder EarlierRun::take_over(const RunIdentity& run, EarlierResults& earlier) {
  if (is_gathered_) {
    std::error_code error;
    fs::create_directory(folder_.parts(), error);
    if (error) throw OutputError(folder_.parts().string() + ": " + error.message(), error.value());
    put_beside(results_, folder_.earlier());
    const std::string moved = "parts/" + folder_.earlier().filename().string();
    earlier.points.file = moved;
    for (WrittenStep& step : earlier.steps) step.file = moved;
  }
  go_on_in_results_folder(folder_, *marker_, run);
  return {folder_, std::move(*marker_)};
}

}  // namespace peristat
