#include "src/geometry/pixels.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/core/program_output.hpp"
#include "src/core/table_text.hpp"

namespace peristat {
namespace {

/// Prints "columns rows least largest", and then a byte per pixel, 1 inside, row by row from the
/// top; or "refused", and why.
constexpr const char* script = R"python(
import re, sys, warnings
try:
    import numpy as np
    from PIL import Image, UnidentifiedImageError
except ImportError as error:
    print(f"refused\nPython can't load {error.name}, which reads images (Debian: python3-pil, python3-numpy)")
    sys.exit()
warnings.simplefilter("ignore")
Image.MAX_IMAGE_PIXELS = 50_000_000  # twice as many are an error
UPRIGHT = 1
class Refused(Exception):
    pass
try:
    with Image.open(sys.argv[1], formats=["PNG", "TIFF"]) as image:
        image.verify()  # checksums and the end, if it is a PNG
    with Image.open(sys.argv[1], formats=["PNG", "TIFF"]) as image:
        raw = str(image.tile[0][3]) if image.tile else ""
        if getattr(image, "n_frames", 1) > 1:
            raise Refused(f"has {image.n_frames} pictures; only one is allowed")
        if image.getexif().get(274, UPRIGHT) != UPRIGHT:
            raise Refused("is marked as turned or mirrored; store it upright")
        image.load()
        if image.mode not in ("1", "L", "P", "PA", "LA", "RGB", "RGBA", "RGBX", "I", "F", "I;16", "I;16L", "I;16B"):
            raise Refused(f"has pixels of mode {image.mode}; convert it to grey")
        if image.mode in ("L", "LA", "RGB", "RGBA", "RGBX") and re.search("(L|RGB)[AX]*;16", raw):
            raise Refused("has 16 bits per colour or beside transparency; convert it to grey of 16 bits or to 8 bits")
        if image.mode[0] not in "IF" and (image.mode in ("PA", "LA", "RGBA") or "transparency" in image.info):
            if image.convert("RGBA").getchannel("A").getextrema()[0] < 255:
                raise Refused("has transparent pixels, which have no value of grey; fill its background")
        elif "transparency" in image.info:
            raise Refused("has a transparent value of grey; store it without")
        if image.mode not in ("1", "L", "LA") and image.mode[0] not in "IF":
            image = image.convert("RGB")
        if image.mode in ("LA", "RGB"):
            image = image.convert("L")
        grey = np.asarray(image).astype(float) * (255.0 if image.mode == "1" else 1.0)
        if not np.isfinite(grey).all():
            raise Refused("has pixels without a finite value")
        low, high = float(sys.argv[2]), float(sys.argv[3])
        head = f"{grey.shape[1]} {grey.shape[0]} {float(grey.min())!r} {float(grey.max())!r}\n"
        sys.stdout.buffer.write(head.encode() + ((grey >= low) & (grey <= high)).astype(np.uint8).tobytes())
except UnidentifiedImageError:
    print("refused\nis neither PNG nor TIFF, or is damaged")
except Refused as error:
    print(f"refused\n{error}")
except Exception as error:
    print(f"refused\ncan't be read: {error or type(error).__name__}")
)python";

/// Number of the pixel at a place along an axis.
std::size_t pixel_at(double place, double from, double to, std::size_t count) {
  const double width = to - from;
  double at = (place - from) / width * double(count);
  const double border = std::round(at);
  const double largest = std::max(std::abs(from), std::abs(to));
  const double slack =
      boundary_tolerance + 8 * std::numeric_limits<double>::epsilon() * largest / width;
  if (std::abs(at - border) <= slack * double(count)) at = border;
  return std::size_t(std::clamp(std::floor(at), 0.0, double(count - 1)));
}

}  // namespace

void find_borders(Pixels& pixels) {
  const auto [columns, rows] = pixels.counts;
  const auto is_inside = [&](std::size_t column, std::size_t row) {
    return column < columns && row < rows && pixels.is_inside[row * columns + column] != 0;
  };
  std::vector<char> is_border_of_column(columns + 1, 0), is_border_of_row(rows + 1, 0);
  for (std::size_t row = 0; row <= rows; ++row) {
    for (std::size_t column = 0; column <= columns; ++column) {
      const bool here = is_inside(column, row);
      if (here != is_inside(column - 1, row)) is_border_of_column[column] = 1;
      if (here != is_inside(column, row - 1)) is_border_of_row[row] = 1;
    }
  }
  for (std::size_t k = 0; k <= columns; ++k)
    if (is_border_of_column[k]) pixels.borders[0].push_back(k);
  for (std::size_t k = 0; k <= rows; ++k)
    if (is_border_of_row[k]) pixels.borders[1].push_back(k);
}

Pixels read_pixels(const std::filesystem::path& file, const std::array<double, 2>& grey) {
  const std::string output =
      program_output({"/usr/bin/python3", "-BEs", "-c", script, file.string(), number_text(grey[0]),
                      number_text(grey[1])});
  const std::size_t end = output.find('\n');
  const std::string head = output.substr(0, end);
  if (head == "refused")
    throw InputError("file", "", output.substr(end + 1, output.size() - end - 2));
  std::string why_not;
  const auto fields = split_at_blanks(head);
  const auto number = [&](std::size_t k) {
    return k < fields.size() ? number_in(fields[k], why_not).value_or(0.0) : 0.0;
  };
  Pixels pixels{{std::size_t(number(0)), std::size_t(number(1))}, {}, {number(2), number(3)}, {}};
  const auto [columns, rows] = pixels.counts;
  if (end == std::string::npos || columns * rows == 0 || output.size() != end + 1 + columns * rows)
    throw InputError("file", "", "can't be read");
  pixels.is_inside.resize(columns * rows);
  for (std::size_t row = 0; row < rows; ++row)
    std::copy_n(output.begin() + std::ptrdiff_t(end + 1 + row * columns), columns,
                pixels.is_inside.begin() + std::ptrdiff_t((rows - 1 - row) * columns));
  find_borders(pixels);
  return pixels;
}

bool is_in_pixel(const PixelImage& image, const Coordinates& place) {
  const auto [columns, rows] = image.pixels->counts;
  const std::size_t column = pixel_at(place[0], image.min[0], image.max[0], columns);
  const std::size_t row = pixel_at(place[1], image.min[1], image.max[1], rows);
  return image.pixels->is_inside[row * columns + column] != 0;
}

std::vector<double> borders_along(const PixelImage& image, std::size_t axis) {
  std::vector<double> at;
  for (const std::size_t border : image.pixels->borders[axis])
    at.push_back(image.min[axis] + (image.max[axis] - image.min[axis]) * double(border) /
                                       double(image.pixels->counts[axis]));
  return at;
}

}  // namespace peristat
