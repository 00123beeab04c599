#include "cases/runner/setup/read_mesh.hpp"

#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

#include <dlfcn.h>

#include "cases/runner/input/case.hpp"
#include "src/core/decimal.hpp"
#include "src/core/input_error.hpp"
#include "src/core/machine_error.hpp"
#include "src/core/program_output.hpp"
#include "src/geometry/mesh_body.hpp"
#include "src/geometry/mesh_interior.hpp"
#include "src/geometry/mesh_points.hpp"

namespace peristat {
namespace {

namespace fs = std::filesystem;

constexpr const char* python = "/usr/bin/python3";

[[noreturn]] void refuse_mesh_file(const fs::path& file, const std::string& what) {
  throw InputError("file", file.string(), what);
}

/// Path of the script, in the tree of the sources or of an installation above a folder; or empty.
fs::path script_above(fs::path folder) {
  constexpr int most_levels = 6;
  for (int level = 0; level < most_levels; ++level, folder = folder.parent_path()) {
    for (const char* const tools : {"cases/runner", "share/peristat"}) {
      const fs::path script = folder / tools / "meshes/read_mesh.py";
      std::error_code error;
      if (fs::is_regular_file(script, error)) return script;
    }
  }
  return {};
}

fs::path find_script() {
  std::error_code error;
  fs::path script = script_above(fs::read_symlink("/proc/self/exe", error).parent_path());
  Dl_info library{};  // of another program that uses the library
  if (script.empty() && dladdr(reinterpret_cast<const void*>(&read_mesh), &library) != 0)
    script = script_above(fs::absolute(library.dli_fname, error).parent_path());
  if (script.empty())
    throw MachineError(
        "meshes/read_mesh.py, which reads meshes, is not installed with the program");
  return script;
}

std::string answer_of_script(const fs::path& file) {
  const std::string script = find_script().string();
  try {
    return program_output({python, "-BEs", script, file.string()});
  } catch (const MachineError& error) {
    refuse_mesh_file(file, std::string("meshio could not read it to the end; the file may be "
                                       "broken or too large (") +
                               error.what() + ")");
  }
}

/// Values of the script's answer, one after another.
class AnswerReader {
 public:
  AnswerReader(const std::string& text, std::size_t at, const fs::path& file)
      : text_(text), at_(at), file_(file) {}

  template <class Value>
  std::vector<Value> values(std::size_t count) {
    if (count > (text_.size() - at_) / sizeof(Value))
      refuse_mesh_file(file_, "meshio ended before it had read the file");
    std::vector<Value> read(count);
    if (count > 0) std::memcpy(read.data(), text_.data() + at_, count * sizeof(Value));
    at_ += count * sizeof(Value);
    return read;
  }
  std::size_t count() { return std::size_t(values<std::int64_t>(1).front()); }
  std::string text() {
    const std::vector<char> letters = values<char>(count());
    return {letters.begin(), letters.end()};
  }

 private:
  const std::string& text_;
  std::size_t at_;
  const fs::path& file_;
};

Mesh mesh_of(AnswerReader answer) {
  Mesh mesh;
  mesh.nodes = answer.values<double>(3 * answer.count());
  for (std::size_t blocks = answer.count(); blocks > 0; --blocks) {
    Mesh::Block block;
    block.type = answer.text();
    const std::size_t elements = answer.count();
    block.nodes_per_element = answer.count();
    block.nodes = answer.values<std::int64_t>(elements * block.nodes_per_element);
    mesh.blocks.push_back(std::move(block));
  }
  for (std::size_t groups = answer.count(); groups > 0; --groups) {
    Mesh::Group group;
    group.name = answer.text();
    group.is_of_nodes = answer.count() != 0;
    group.members = answer.values<std::int64_t>(answer.count());
    mesh.groups.push_back(std::move(group));
  }
  for (std::size_t remarks = answer.count(); remarks > 0; --remarks)
    mesh.remarks.push_back(answer.text());
  return mesh;
}

}  // namespace

Mesh read_mesh(const fs::path& file, double length_unit) {
  const std::string answer = answer_of_script(file);
  const std::string mesh = "mesh\n", refused = "refused\n";
  if (answer.starts_with(refused)) refuse_mesh_file(file, answer.substr(refused.size()));
  if (!answer.starts_with(mesh)) refuse_mesh_file(file, "meshio gave no answer");
  Mesh read = mesh_of(AnswerReader(answer, mesh.size(), file));
  for (double& at : read.nodes) at = in_metres(at, length_unit);
  return read;
}

Points read_mesh_points(const PointSource& source, int dimension) {
  const Mesh mesh = read_mesh(source.file, source.length_unit);
  Points points = make_points(make_mesh_body(mesh, dimension, source.file.string()), source.at,
                              source.cross_section, source.file.string());
  if (source.cut_bonds) points.interior = std::make_shared<const MeshInterior>(points.mesh);
  return points;
}

}  // namespace peristat
