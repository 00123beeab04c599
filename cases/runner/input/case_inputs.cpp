#include "cases/runner/input/case_inputs.hpp"

#include <cstdint>
#include <fstream>
#include <iterator>
#include <system_error>
#include <variant>

#include <fmt/format.h>

#include "src/core/input_error.hpp"

namespace peristat {
namespace {

/// FNV-1a [http://www.isthe.com/chongo/tech/comp/fnv] of the bytes of a file.
std::uint64_t checksum_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::uint64_t sum = 0xcbf29ce484222325u;
  for (std::istreambuf_iterator<char> at(stream), end; at != end; ++at) {
    sum = (sum ^ static_cast<unsigned char>(*at)) * 0x100000001b3u;
  }
  if (!stream.is_open() || stream.bad())
    throw InputError("", file.string(), "the file can't be read");
  return sum;
}

}  // namespace

std::filesystem::path absolute_beside_case(const Case& from, const std::string& name) {
  if (name.empty()) throw InputError("", "", "is empty");
  const auto folder = std::filesystem::path(from.file).parent_path();
  const auto file = std::filesystem::absolute(folder / name).lexically_normal();
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    throw InputError("", name, "no such file; searched for " + file.string());
  return file;
}

std::vector<std::filesystem::path> inputs_of(const Case& from) {
  std::vector<std::filesystem::path> files{from.file};
  if (const auto* points = std::get_if<PointSource>(&from.body)) {
    files.push_back(points->file);  // empty if the points are given
    if (!points->neighbours.empty()) files.push_back(points->neighbours);
  }
  if (const auto* lattice = std::get_if<Lattice>(&from.body)) {
    for (const ShapeStep& step : lattice->shapes) files.push_back(file_of(step.shape));
  }
  for (const SetRule& rule : from.sets) {
    if (rule.shape) files.push_back(file_of(*rule.shape));
  }
  std::erase_if(files, [](const std::filesystem::path& file) { return file.empty(); });
  files.insert(files.end(), from.tables->begin(), from.tables->end());
  return files;
}

std::string checksums_of_files(const Case& from) {
  std::vector<std::filesystem::path> files = inputs_of(from);
  files.erase(files.begin());
  std::string lines = lines_of(*from.givens);
  for (const std::filesystem::path& file : files)
    lines += fmt::format("{:016x} {}\n", checksum_of(file), file.string());
  return lines;
}

}  // namespace peristat
