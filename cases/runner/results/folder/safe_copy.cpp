#include "cases/runner/results/folder/safe_copy.hpp"

#include <filesystem>
#include <system_error>

#include "cases/runner/process/output_file.hpp"

namespace peristat {
namespace {

namespace fs = std::filesystem;

constexpr double share_of_time = 0.01;

/// Gives the file a second name in place of an older one.
void link_as(const fs::path& file, const fs::path& name) {
  std::error_code error;
  fs::remove(temporary(name), error);
  fs::create_hard_link(file, temporary(name), error);
  if (error) return;  // a file system without links has no safe copy; it loses no more than before
  rename_file(temporary(name), name);
}

/// Copies a file in the place of any entry of that name, which may be a link.
void put_copy(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::remove(to, error);
  fs::copy_file(from, to, error);
  if (error) {
    throw OutputError(to.string() + ": can't be written: " + error.message(), error.value());
  }
}

}  // namespace

bool SafeCopy::is_due() const {
  const std::chrono::duration<double> elapsed = Clock::now() - start_;
  return seconds_spent_ + seconds_expected_ <= share_of_time * elapsed.count();
}

void SafeCopy::make(const std::string& points, const std::vector<WrittenStep>& steps,
                    const std::filesystem::path& checkpoint) {
  const Clock::time_point begin = Clock::now();
  if (safe_steps_ == 0) sync_file(folder_.directory / points);
  for (; safe_steps_ < steps.size(); ++safe_steps_) {
    sync_file(folder_.directory / steps[safe_steps_].file);
  }
  sync_file(folder_.results());
  put_copy(checkpoint, temporary(folder_.safe_checkpoint()));
  sync_file(temporary(folder_.safe_checkpoint()));
  link_as(folder_.results(), folder_.safe_results());
  rename_file(temporary(folder_.safe_checkpoint()), folder_.safe_checkpoint());
  sync_file(folder_.parts());
  sync_file(folder_.directory);
  seconds_expected_ = std::chrono::duration<double>(Clock::now() - begin).count();
  seconds_spent_ += seconds_expected_;
}

}  // namespace peristat
