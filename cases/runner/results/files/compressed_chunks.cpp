#include "cases/runner/results/files/compressed_chunks.hpp"

#include <new>
#include <stdexcept>

#include <zlib.h>

namespace peristat {

std::vector<unsigned char> shuffled_and_deflated(std::span<const std::byte> chunk,
                                                 std::size_t value_size) {
  const std::size_t values = chunk.size() / value_size;
  std::vector<unsigned char> shuffled(chunk.size());
  for (std::size_t value = 0; value < values; ++value) {
    for (std::size_t byte = 0; byte < value_size; ++byte) {
      shuffled[byte * values + value] = (unsigned char)(chunk[value * value_size + byte]);
    }
  }
  constexpr int fastest = 1;
  uLongf size = compressBound(uLong(chunk.size()));
  std::vector<unsigned char> deflated(size);
  const int outcome =
      compress2(deflated.data(), &size, shuffled.data(), uLong(shuffled.size()), fastest);
  if (outcome == Z_MEM_ERROR) throw std::bad_alloc();
  if (outcome != Z_OK) throw std::logic_error("zlib can't compress a chunk");
  deflated.resize(size);
  return deflated;
}

}  // namespace peristat
