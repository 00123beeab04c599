#include "src/results/output_file.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>

#include <fcntl.h>
#include <unistd.h>

namespace peristat {
namespace {

[[noreturn]] void fail(const std::filesystem::path& file, int error) {
  throw OutputError(file.string() + ": can't be written: " + std::strerror(error));
}

}  // namespace

std::filesystem::path temporary(const std::filesystem::path& file) {
  std::filesystem::path path = file;
  return path += ".tmp";
}

void write_file(const std::filesystem::path& file, std::string_view contents) {
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor < 0) fail(file, errno);
  while (!contents.empty()) {
    const ssize_t written = ::write(descriptor, contents.data(), contents.size());
    if (written > 0) {
      contents.remove_prefix(static_cast<std::size_t>(written));
    } else if (written == 0 || errno != EINTR) {
      const int error = written == 0 ? ENOSPC : errno;
      ::close(descriptor);
      ::unlink(file.c_str());
      fail(file, error);
    }
  }
  // Network file systems report a full disk only here.
  if (::close(descriptor) != 0 && errno != EINTR) {
    const int error = errno;
    ::unlink(file.c_str());
    fail(file, error);
  }
}

void publish_file(const std::filesystem::path& file, std::string_view contents) {
  write_file(temporary(file), contents);
  rename_file(temporary(file), file);
}

void reserve_file(const std::filesystem::path& file, std::uint64_t bytes) {
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CLOEXEC);
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

}  // namespace peristat
