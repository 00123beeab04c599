#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <vector>

#include "src/geometry/shape.hpp"

namespace peristat {

/// Pixels of an image, and which of them are inside.
struct Pixels {
  std::array<std::size_t, 2> counts{};  ///< of columns and of rows
  std::vector<char> is_inside{};        ///< row by row from the bottom, which is y = min
  std::array<double, 2> extremes{};     ///< least and largest value of grey of all pixels
  /// Numbers of the borders between columns and between rows, from 0 to their count, on which a
  /// pixel begins or ends to be inside.
  std::array<std::vector<std::size_t>, 2> borders{};
};

/// Reads a PNG or TIFF file of one picture by Python's Pillow, in a process of its own. Values of
/// grey are as stored: 0 to 255, or to 65535 with 16 bits; TIFF may have any numbers. Fewer bits
/// are scaled to 255. Colours give the luminance 0.299 red + 0.587 green + 0.114 blue, rounded.
/// @param grey least and largest value of pixels that are inside
/// @throws InputError ("file") if it is no such file, is truncated, has 16 bits per colour,
///         transparent pixels, an orientation other than upright or more than 1e8 pixels;
///         MachineError if Python can't be run
[[nodiscard]] Pixels read_pixels(const std::filesystem::path& file,
                                 const std::array<double, 2>& grey);

/// True if the place lies in a pixel that is inside. On a border of two pixels, the one with the
/// larger x or y counts; on the rectangle's own sides, the last one.
[[nodiscard]] bool is_in_pixel(const PixelImage& image, const Coordinates& place);

/// Places along an axis of the borders of pixels on which the inside begins or ends [m].
[[nodiscard]] std::vector<double> borders_along(const PixelImage& image, std::size_t axis);

/// Finds the borders.
void find_borders(Pixels& pixels);

}  // namespace peristat
