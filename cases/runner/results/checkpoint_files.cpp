#include "cases/runner/results/checkpoint_files.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <optional>
#include <string_view>

#include <fcntl.h>
#include <unistd.h>

#include "cases/runner/process/output_file.hpp"

namespace peristat {

CheckpointFiles::~CheckpointFiles() {
  for (const int descriptor : descriptors_) {
    if (descriptor >= 0) ::close(descriptor);
  }
}

void CheckpointFiles::write(Checkpoint checkpoint, const std::string& program) {
  const std::filesystem::path file = folder_ / names[next_];
  const auto fail = [&](int error) {
    throw OutputError(file.string() + ": can't be written: " + std::strerror(error), error);
  };
  int& descriptor = descriptors_[next_];
  if (descriptor < 0) {
    descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (descriptor < 0) fail(errno);
  }
  // Many of a body's pieces are single numbers: they go to the file together.
  constexpr std::size_t least_piece = std::size_t(1) << 16;
  off_t at = 0;
  std::string collected;
  const auto put = [&](std::string_view piece) {
    while (!piece.empty()) {
      const ssize_t written = ::pwrite(descriptor, piece.data(), piece.size(), at);
      if (written > 0) {
        at += written;
        piece.remove_prefix(static_cast<std::size_t>(written));
      } else if (written == 0 || errno != EINTR) {
        fail(written == 0 ? ENOSPC : errno);
      }
    }
  };
  const auto put_collected = [&] {
    put(collected);
    collected.clear();
  };
  encode(std::move(checkpoint), program, [&](std::string_view piece) {
    if (collected.size() + piece.size() > least_piece) put_collected();
    if (piece.size() > least_piece) return put(piece);
    collected += piece;
  });
  put_collected();
  if (::ftruncate(descriptor, at) != 0) fail(errno);
  next_ = 1 - next_;
}

std::filesystem::path CheckpointFiles::last() const { return folder_ / names[1 - next_]; }

std::vector<std::uint8_t> CheckpointFiles::last_bytes() const {
  const std::size_t last = 1 - next_;
  if (descriptors_[last] < 0) return {};
  std::ifstream stream(folder_ / names[last], std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

Checkpoint read_checkpoint(const std::filesystem::path& file, const std::string& program) {
  std::ifstream stream(file, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(stream)), {});
  if (!stream) throw BadCheckpoint("can't be read");
  return decode(bytes, program);
}

Checkpoint newest_checkpoint(const std::filesystem::path& folder, const std::string& program) {
  std::optional<Checkpoint> newest;
  std::optional<BadCheckpoint> fault;
  for (const char* name : CheckpointFiles::names) {
    if (!std::filesystem::exists(folder / name)) continue;
    try {
      Checkpoint read = read_checkpoint(folder / name, program);
      if (!newest || read.path.steps > newest->path.steps) newest = std::move(read);
    } catch (const BadCheckpoint& error) {
      fault = error;
    }
  }
  if (newest) return std::move(*newest);
  throw fault ? *fault : BadCheckpoint("is missing");
}

}  // namespace peristat
