#include "cases/runner/results/checkpoint/checkpoint_files.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <memory>
#include <optional>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include "cases/runner/process/output_file.hpp"

namespace peristat {

CheckpointFiles::~CheckpointFiles() {
  for (const int descriptor : descriptors_) {
    if (descriptor >= 0) ::close(descriptor);
  }
}

namespace {

/// Writes bytes to a file one after the other, in place and in large parts.
class InPlace {
 public:
  InPlace(const std::filesystem::path& file, int descriptor)
      : file_(file), descriptor_(descriptor) {}

  void put(std::string_view bytes) {
    if (waiting_.size() + bytes.size() < part) {
      waiting_ += bytes;
      return;
    }
    write(waiting_);
    waiting_.clear();
    write(bytes);
  }
  void end() {
    write(waiting_);
    if (::ftruncate(descriptor_, static_cast<off_t>(at_)) != 0) fail(file_, errno);
  }
  [[noreturn]] static void fail(const std::filesystem::path& file, int error) {
    throw OutputError(file.string() + ": can't be written: " + std::strerror(error), error);
  }

 private:
  static constexpr std::size_t part = 1 << 16;

  void write(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t written =
          ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(at_));
      if (written > 0) {
        at_ += static_cast<std::uint64_t>(written);
        bytes.remove_prefix(static_cast<std::size_t>(written));
      } else if (written == 0 || errno != EINTR) {
        fail(file_, written == 0 ? ENOSPC : errno);
      }
    }
  }

  const std::filesystem::path& file_;
  int descriptor_;
  std::string waiting_;
  std::uint64_t at_ = 0;
};

}  // namespace

void CheckpointFiles::write(const std::function<void(const PutBytes&)>& put_into) {
  const std::filesystem::path file = folder_ / names[next_];
  int& descriptor = descriptors_[next_];
  if (descriptor < 0) {
    descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (descriptor < 0) InPlace::fail(file, errno);
  }
  InPlace writer(file, descriptor);
  put_into([&](std::string_view bytes) { writer.put(bytes); });
  writer.end();
  next_ = 1 - next_;
}

std::filesystem::path CheckpointFiles::last() const {
  const std::size_t last = 1 - next_;
  return descriptors_[last] < 0 ? std::filesystem::path() : folder_ / names[last];
}

CheckpointBytes bytes_of_file(const std::filesystem::path& file) {
  const auto stream = std::make_shared<std::ifstream>(file, std::ios::binary);
  std::error_code error;
  const std::uint64_t size = std::filesystem::file_size(file, error);
  if (!*stream || error) throw BadCheckpoint("can't be read");
  return {size, [stream](std::uint64_t first, std::uint64_t count) {
            std::string bytes(count, '\0');
            stream->clear();
            stream->seekg(static_cast<std::streamoff>(first));
            stream->read(bytes.data(), static_cast<std::streamsize>(count));
            bytes.resize(static_cast<std::size_t>(stream->gcount()));
            return bytes;
          }};
}

std::filesystem::path newest_checkpoint(const std::filesystem::path& folder,
                                        const std::string& program) {
  std::filesystem::path newest;
  int newest_step = 0;
  std::optional<BadCheckpoint> fault;
  for (const char* name : CheckpointFiles::names) {
    if (!std::filesystem::exists(folder / name)) continue;
    try {
      const CheckpointBytes bytes = bytes_of_file(folder / name);
      require_whole(bytes, program);
      const int step = read_checkpoint(bytes, program, {.has_arrays = false}).path.steps;
      if (!newest.empty() && step <= newest_step) continue;
      newest = folder / name;
      newest_step = step;
    } catch (const BadCheckpoint& error) {
      fault = error;
    }
  }
  if (newest.empty()) throw fault ? *fault : BadCheckpoint("is missing");
  return newest;
}

}  // namespace peristat
