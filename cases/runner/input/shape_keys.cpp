#include "cases/runner/input/shape_keys.hpp"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <tuple>
#include <variant>

#include "cases/runner/input/unit_system.hpp"
#include "cases/runner/input/value_schema.hpp"
#include "src/core/input_error.hpp"
#include "src/geometry/closed_surface.hpp"
#include "src/geometry/outline_file.hpp"
#include "src/geometry/pixels.hpp"

namespace peristat {
namespace {

template <class Rectangular>
Key<Rectangular> lower_corner() {
  return Key<Rectangular>("min", &Rectangular::min, coordinates(), "box, image: lower corner")
      .moreover("below `max`")
      .required();
}

template <class Rectangular>
Key<Rectangular> upper_corner() {
  return Key<Rectangular>("max", &Rectangular::max, coordinates(), "box, image: upper corner")
      .required();
}

constexpr const char* meaning_of_file =
    "polygon (instead of `vertices`): file with corners x, y; image: PNG or TIFF picture; stl: STL "
    "surface. The path is relative to the case file's folder";

template <class FromFile>
Key<FromFile> scale_of_file() {
  return Key<FromFile>("scale", &FromFile::scale, positive("m"),
                       "polygon, stl: length of 1 in the file")
      .otherwise(
          [](auto& shape, auto& from) { shape.scale = unit_system(from.units).length.size(); },
          "1, or the `length` of `[units]`");
}

/// Calls `read`; puts the file's key in front of the errors that name no place.
template <class Read>
auto read_from_file(const Entry& table, const Read& read) {
  try {
    return read();
  } catch (const InputError& error) {
    if (!error.place().empty()) throw;
    table.from.refuse("file", error.allowed());
  }
}

const Table<Box>& keys_of(const Box&) {
  static const Table<Box> table{"set.shape.box", {lower_corner<Box>(), upper_corner<Box>()}};
  return table;
}

template <class Round>
Key<Round> centre() {
  return Key<Round>("centre", &Round::centre, coordinates(),
                    "disk, ellipse, cylinder, sphere: centre")
      .required();
}

template <class Round>
Key<Round> radius() {
  return Key<Round>("radius", &Round::radius, positive("m"), "disk, cylinder, sphere: radius")
      .required();
}

const Table<Disk>& keys_of(const Disk&) {
  static const Table<Disk> table{"set.shape.disk", {centre<Disk>(), radius<Disk>()}};
  return table;
}

const Table<Cylinder>& keys_of(const Cylinder&) {
  using K = Key<Cylinder>;
  static const Table<Cylinder> table{
      "set.shape.cylinder",
      {centre<Cylinder>(),
       K("axis", &Cylinder::axis, coordinates(""), "cylinder: direction of its axis")
           .moreover("not zero")
           .default_words("`[0, 0, 1]`"),
       radius<Cylinder>(),
       K("length", &Cylinder::length, positive("m", std::numeric_limits<double>::infinity()),
         "cylinder: length along its axis, half to each side of the centre")
           .moreover("finite if it is added")
           .default_words("infinite")}};
  return table;
}

const Table<Sphere>& keys_of(const Sphere&) {
  static const Table<Sphere> table{"set.shape.sphere", {centre<Sphere>(), radius<Sphere>()}};
  return table;
}

const Table<Polygon>& keys_of(const Polygon&) {
  using K = Key<Polygon>;
  static const Table<Polygon> table{
      "set.shape.polygon",
      {K("vertices", &Polygon::vertices, pairs(),
         "polygon: corners in order. The last corner is joined to the first")
           .moreover("around an area")
           .written_if([](auto& polygon, auto&) { return polygon.file.empty(); })
           .one_of(),
       K("file", &Polygon::file, file_beside_the_case(), meaning_of_file)
           .written_if([](auto& polygon, auto&) { return !polygon.file.empty(); })
           .one_of()
           .early(),
       scale_of_file<Polygon>()
           .unless([](auto& polygon, auto&) { return polygon.file.empty(); }, "is for a file")
           .written_if([](auto& polygon, auto&) { return !polygon.file.empty(); })},
      {},
      [](auto& at, auto& polygon) {
        if (polygon.file.empty()) return;
        polygon.vertices =
            read_from_file(at, [&] { return read_outline(polygon.file, polygon.scale); });
      }};
  return table;
}

const Table<PixelImage>& keys_of(const PixelImage&) {
  using K = Key<PixelImage>;
  static const Table<PixelImage> table{
      "set.shape.image",
      {K("file", &PixelImage::file, file_beside_the_case(), meaning_of_file).required(),
       lower_corner<PixelImage>(), upper_corner<PixelImage>(),
       K("grey", &PixelImage::grey, range_of_numbers(),
         "image: smallest and largest grey value of the pixels inside the shape, 0 (black) to 255, "
         "or to 65535 in files with 16 bits")
           .required()},
      {},
      [](auto& at, auto& image) {
        image.pixels = read_from_file(at, [&] {
          return std::make_shared<const Pixels>(read_pixels(image.file, image.grey));
        });
      }};
  return table;
}

const Table<StlBody>& keys_of(const StlBody&) {
  using K = Key<StlBody>;
  static const Table<StlBody> table{
      "set.shape.stl",
      {K("file", &StlBody::file, file_beside_the_case(), meaning_of_file).required(),
       scale_of_file<StlBody>(),
       K("translate", &StlBody::translate, coordinates(), "stl: shift after the scaling")},
      {},
      [](auto& at, auto& body) {
        body.surface =
            read_from_file(at, [&] { return read_stl(body.file, body.scale, body.translate); });
      }};
  return table;
}

const Table<Ellipse>& keys_of(const Ellipse&) {
  using K = Key<Ellipse>;
  static const Table<Ellipse> table{
      "set.shape.ellipse",
      {centre<Ellipse>(),
       K("radii", &Ellipse::radii, coordinates(), "ellipse: radii along its two axes")
           .moreover("positive")
           .required(),
       K("angle", &Ellipse::angle, between(-360.0, 360.0, "degrees"),
         "ellipse: angle from x to the axis of the first radius, anticlockwise")}};
  return table;
}

/// Does something with one shape of every kind.
template <class Action>
void for_each_shape(const Action& action) {
  std::apply([&](const auto&... shape) { (action(shape), ...); },
             std::tuple<Box, Disk, Ellipse, Cylinder, Sphere, Polygon, PixelImage, StlBody>());
}

/// "box" of the table "set.shape.box".
template <class OneShape>
std::string kind_name(const OneShape& shape) {
  const std::string& table = keys_of(shape).name();
  return table.substr(table.rfind('.') + 1);
}

std::vector<std::string> shape_kinds() {
  std::vector<std::string> kinds;
  for_each_shape([&](const auto& shape) { kinds.push_back(kind_name(shape)); });
  return kinds;
}

/// Kinds of shapes that a body of this dimension can have.
std::vector<std::string> shape_kinds(int dimension) {
  if (dimension == 1) return {"box"};
  if (dimension == 2) return {"box", "disk", "ellipse", "polygon", "image"};
  return {"box", "cylinder", "sphere", "polygon", "stl"};
}

void refuse_other_dimension(const Entry& at, const std::string& kind) {
  const auto all = shape_kinds(), allowed = shape_kinds(at.so_far.dimension);
  if (std::count(all.begin(), all.end(), kind) == 0 ||
      std::count(allowed.begin(), allowed.end(), kind) > 0)
    return;
  at.refuse("there is no " + kind + " in dimension " + std::to_string(at.so_far.dimension) +
            "  (allowed: " + listed(allowed) + ")");
}

/// Reads the shape whose keys stand in the table.
Shape read_shape(const Entry& table, const std::string& kind) {
  Shape result;
  for_each_shape([&](auto shape) {
    if (kind_name(shape) != kind) return;
    keys_of(shape).read(table, shape);
    result = shape;
  });
  check_shape(result, table.so_far.dimension, table.from.path(), table.from.path());
  return result;
}

std::string shape_lines(const Shape& shape, const Case& from) {
  return std::visit([&](const auto& kind) { return keys_of(kind).lines(kind, from); }, shape);
}

/// Name of the table of a shape: "box".
std::string kind_of(const Shape& shape) {
  return std::visit([](const auto& kind) { return kind_name(kind); }, shape);
}

}  // namespace

Kind<Shape> shape_beside(const std::vector<std::string>& others) {
  const auto read = [others](const Entry& at) {
    refuse_other_dimension(at, at.from.string(at.key));
    const std::string kind = at.from.one_of(at.key, shape_kinds(at.so_far.dimension));
    std::vector<std::string> keys = case_keys().at("set.shape." + kind);
    keys.insert(keys.begin(), at.key);
    keys.insert(keys.begin() + 1, others.begin(), others.end());
    at.from.allow_only(keys, "is not a key of the shape " + kind);
    return read_shape(at, kind);
  };
  const auto text = [](const Shape& shape, const Case& from) {
    const std::string lines = shape_lines(shape, from);
    return toml_string(kind_of(shape)) + "\n" + lines.substr(0, lines.size() - 1);
  };
  Kind<Shape> kind{
      read, text, choice_schema(shape_kinds()),
      "`\"box\"` (1D, 2D, 3D), `\"disk\"`, `\"ellipse\"` (2D), `\"polygon\"` (2D; in 3D, where "
      "it is infinite in z, only to subtract), `\"image\"` (2D), `\"cylinder\"`, `\"sphere\"`, "
      "`\"stl\"` (3D)"};
  for_each_shape(
      [&](const auto& shape) { kind.schemas_beside.add_missing(keys_of(shape).key_schemas()); });
  return kind;
}

Kind<Shape> shape_inside() {
  const auto read = [](const Entry& at) {
    const TomlTable shape = at.from.table(at.key);
    const std::string kind = shape.exactly_one(shape_kinds());
    refuse_other_dimension({shape, kind, at.so_far}, kind);
    return read_shape({shape.table(kind), "", at.so_far}, kind);
  };
  const auto text = [](const Shape& shape, const Case& from) {
    std::string inside = shape_lines(shape, from);
    inside.pop_back();
    for (std::size_t end; (end = inside.find('\n')) != std::string::npos;)
      inside.replace(end, 1, ", ");
    return "{ " + kind_of(shape) + " = { " + inside + " } }";
  };
  JsonObject shapes;
  for_each_shape([&](const auto& shape) { shapes.add(kind_name(shape), keys_of(shape).schema()); });
  return {read, text, table_schema(shapes).add("minProperties", 1).add("maxProperties", 1),
          one_of(shape_kinds()).allowed};
}

void describe_shapes(std::vector<TableDescription>& all) {
  all.push_back({"set.shape", false, {}, shape_kinds()});
  for_each_shape([&](const auto& shape) { keys_of(shape).describe(all); });
}

void add_shapes(const std::vector<TableDescription>& all, TableDescription& to) {
  for (const auto& table : all) {
    if (!table.name.starts_with("set.shape.")) continue;
    for (const auto& key : table.listed) {
      if (std::count(to.listed.begin(), to.listed.end(), key) > 0) continue;
      to.listed.push_back(key);
      to.keys.push_back(*std::find_if(table.keys.begin(), table.keys.end(),
                                      [&](const auto& k) { return k.name == key; }));
    }
  }
}

}  // namespace peristat
