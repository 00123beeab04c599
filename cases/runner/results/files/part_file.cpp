#include "cases/runner/results/files/part_file.hpp"

#include <stdexcept>
#include <system_error>

#include "cases/runner/process/output_file.hpp"

namespace peristat {
void publish_part(const std::filesystem::path& path, std::uint64_t bytes,
                  const std::function<void(Hdf5File&)>& write) {
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

}  // namespace peristat
