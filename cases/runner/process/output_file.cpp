#include "cases/runner/process/output_file.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace peristat {
namespace {

[[noreturn]] void fail(const std::filesystem::path& file, int error) {
  throw OutputError(file.string() + ": can't be written: " + std::strerror(error), error);
}

/// Writes the contents, which are then the whole file, and closes it.
/// @return the system's error, 0 for none
int write_and_close(int descriptor, std::string_view contents) {
  const auto size = static_cast<off_t>(contents.size());
  int error = 0;
  while (!contents.empty() && error == 0) {
    const ssize_t written = ::write(descriptor, contents.data(), contents.size());
    if (written > 0) {
      contents.remove_prefix(static_cast<std::size_t>(written));
    } else if (written == 0 || errno != EINTR) {
      error = written == 0 ? ENOSPC : errno;
    }
  }
  if (error == 0 && ::ftruncate(descriptor, size) != 0) error = errno;
  // Network file systems report a full disk only here.
  if (::close(descriptor) != 0 && errno != EINTR && error == 0) error = errno;
  return error;
}

/// True if the first line of a file is the heading.
bool begins_with(int descriptor, std::string_view heading) {
  std::string line(heading.size() + 1, '\0');
  const ssize_t count = ::pread(descriptor, line.data(), line.size(), 0);
  return count == static_cast<ssize_t>(line.size()) && line == std::string(heading) + "\n";
}

/// @return descriptor of a file that is new, empty, emptied or not regular; negative on failure
int open_empty_or_own(const std::filesystem::path& file, std::string_view heading) {
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0) {
    const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor < 0 && errno == EEXIST)
      throw ForeignFile("is a link to a file that does not exist");
    return descriptor;
  }
  if (!S_ISREG(status.st_mode)) return ::open(file.c_str(), O_WRONLY | O_CLOEXEC);
  const int descriptor = ::open(file.c_str(), O_RDWR | O_CLOEXEC);
  if (descriptor < 0 || ::fstat(descriptor, &status) != 0 || status.st_size == 0) return descriptor;
  if (!begins_with(descriptor, heading)) {
    ::close(descriptor);
    throw ForeignFile("has other contents, which would be lost");
  }
  if (::ftruncate(descriptor, 0) != 0) fail(file, errno);
  return descriptor;
}

}  // namespace

std::FILE* open_own_file(const std::filesystem::path& file, std::string_view heading) {
  const int descriptor = open_empty_or_own(file, heading);
  std::FILE* const stream = descriptor < 0 ? nullptr : ::fdopen(descriptor, "w");
  if (!stream) fail(file, errno);
  if (!heading.empty()) {
    std::fwrite(heading.data(), 1, heading.size(), stream);
    std::fputc('\n', stream);
  }
  return stream;
}

bool is_about_means(int error) {
  switch (error) {
    case ENOSPC:
    case EDQUOT:
    case EFBIG:
    case EMFILE:
    case ENFILE:
    case EIO:
    case ENOMEM:
      return true;
    default:
      return false;
  }
}

std::filesystem::path temporary(const std::filesystem::path& file) {
  std::filesystem::path path = file;
  return path += ".tmp";
}

void write_file(const std::filesystem::path& file, std::string_view contents) {
  if (::unlink(file.c_str()) != 0 && errno != ENOENT) fail(file, errno);
  const int descriptor =
      ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (descriptor < 0) fail(file, errno);
  if (const int error = write_and_close(descriptor, contents)) {
    ::unlink(file.c_str());
    fail(file, error);
  }
}

void publish_file(const std::filesystem::path& file, std::string_view contents) {
  write_file(temporary(file), contents);
  rename_file(temporary(file), file);
}

void publish_reserved_file(const std::filesystem::path& file, std::string_view contents) {
  const std::filesystem::path reserved = temporary(file);
  const int descriptor = ::open(reserved.c_str(), O_WRONLY | O_NOFOLLOW | O_CLOEXEC);
  if (descriptor < 0) return publish_file(file, contents);
  if (const int error = write_and_close(descriptor, contents)) fail(file, error);
  rename_file(reserved, file);
}

void reserve_file(const std::filesystem::path& file, std::uint64_t bytes) {
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_NOFOLLOW | O_CLOEXEC);
  if (descriptor < 0) fail(file, errno);
  int error = 0;
  do {
    error = ::posix_fallocate(descriptor, 0, static_cast<off_t>(bytes));
  } while (error == EINTR);
  ::close(descriptor);
  if (error != 0) fail(file, error);
}

void rename_file(const std::filesystem::path& from, const std::filesystem::path& to) {
  if (std::rename(from.c_str(), to.c_str()) != 0) fail(to, errno);
}

void sync_file(const std::filesystem::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC);
  if (descriptor < 0) fail(file, errno);
  const int error = ::fsync(descriptor) == 0 ? 0 : errno;
  ::close(descriptor);
  if (error != 0 && error != EINVAL && error != EROFS) fail(file, error);
}

}  // namespace peristat
