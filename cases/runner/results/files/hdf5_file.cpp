#include "cases/runner/results/files/hdf5_file.hpp"

#include <algorithm>
#include <future>
#include <new>
#include <span>
#include <stdexcept>
#include <utility>

#include <hdf5.h>
#include <omp.h>

#include "cases/runner/process/output_file.hpp"
#include "cases/runner/results/files/compressed_chunks.hpp"

namespace peristat {
namespace {

static_assert(sizeof(hid_t) == sizeof(std::int64_t));

/// Throws the innermost message of the library's error stack if the result of a call is negative;
/// std::bad_alloc if the message is about memory.
template <class Result>
Result checked(Result result, const std::string& action) {
  if (result >= 0) return result;
  std::string message;
  const auto first = [](unsigned number, const H5E_error2_t* error, void* text) -> herr_t {
    if (number == 0) {
      *static_cast<std::string*>(text) = std::string(error->desc) + " (" + error->func_name + ")";
    }
    return 0;
  };
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, first, &message);
  if (message.find("memory allocation failed") != std::string::npos) throw std::bad_alloc();
  throw std::runtime_error("HDF5 can't " + action + ": " + message);
}

/// An identifier of the library with the function that releases it.
class Handle {
 public:
  Handle(hid_t id, herr_t (*release)(hid_t), const std::string& action)
      : id_(checked(id, action)), release_(release) {}
  ~Handle() {
    if (id_ >= 0) release_(id_);
  }
  Handle(Handle&& other) noexcept
      : id_(std::exchange(other.id_, hid_t{-1})), release_(other.release_) {}
  Handle& operator=(Handle&&) = delete;
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
  herr_t (*release_)(hid_t);
};

/// The library prints its error stack by default; here the message is thrown instead.
void silence_error_printing() { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

Handle file_access() { return {H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "prepare to open a file"}; }

/// Access without locks: only one run knows these files, and some file systems have no locks.
Handle unlocked_access() {
  Handle access = file_access();
  checked(H5Pset_file_locking(access, /*use=*/0, /*ignore_when_disabled=*/1), "switch locks off");
  return access;
}

Handle text_type() {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose, "make the type of texts");
  checked(H5Tset_size(type, H5T_VARIABLE), "make the type of texts");
  checked(H5Tset_cset(type, H5T_CSET_UTF8), "make the type of texts");
  return type;
}

Handle dataspace(const Hdf5File::Shape& shape) {
  if (shape.empty()) return {H5Screate(H5S_SCALAR), H5Sclose, "make a dataspace"};
  const std::vector<hsize_t> extent(shape.begin(), shape.end());
  return {H5Screate_simple(static_cast<int>(extent.size()), extent.data(), nullptr), H5Sclose,
          "make a dataspace"};
}

void write_attribute(hid_t object, const std::string& name, hid_t type, hid_t space,
                     const void* values) {
  const Handle attribute(H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT),
                         H5Aclose, "create attribute " + name);
  checked(H5Awrite(attribute, type, values), "write attribute " + name);
}

void write_attribute(hid_t object, const std::string& name, const std::string& text) {
  const char* pointer = text.c_str();
  write_attribute(object, name, text_type(), dataspace({}), &pointer);
}

void write_label(hid_t dataset, const DatasetLabel& label) {
  write_attribute(dataset, "unit", label.unit);
  write_attribute(dataset, "description", label.description);
}

void write_dataset(hid_t file, const std::string& path, hid_t type, const void* values,
                   const Hdf5File::Shape& shape, const DatasetLabel& label) {
  const Handle dataset(
      H5Dcreate2(file, path.c_str(), type, dataspace(shape), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
      H5Dclose, "create " + path);
  checked(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), "write " + path);
  write_label(dataset, label);
}

hid_t type_of(double) { return H5T_NATIVE_DOUBLE; }
hid_t type_of(std::int32_t) { return H5T_NATIVE_INT32; }
hid_t type_of(std::uint8_t) { return H5T_NATIVE_UINT8; }
hid_t type_of(std::int64_t) { return H5T_NATIVE_INT64; }

/// Rows of a chunk of a compressed dataset, some half a megabyte.
hsize_t rows_of_chunk(const Hdf5File::Shape& shape) { return std::min<hsize_t>(shape[0], 1 << 15); }

/// Properties of a dataset that is stored compressed.
void compress(hid_t creation, const Hdf5File::Shape& shape, const std::string& path) {
  std::vector<hsize_t> chunk(shape.begin(), shape.end());
  chunk[0] = rows_of_chunk(shape);
  if (chunk[0] == 0) return;
  checked(H5Pset_chunk(creation, int(chunk.size()), chunk.data()), "prepare " + path);
  checked(H5Pset_shuffle(creation), "prepare " + path);
  checked(H5Pset_deflate(creation, 1), "prepare " + path);
}

/// True if these rows are whole chunks of a compressed dataset, but for the last one of all.
bool fill_chunks(const Hdf5File::Shape& shape, std::uint64_t first, std::uint64_t rows) {
  const hsize_t of_chunk = rows_of_chunk(shape);
  return of_chunk > 0 && first % of_chunk == 0 &&
         (rows % of_chunk == 0 || first + rows == shape[0]);
}

/// Writes whole chunks, compressed on several threads.
template <class Value>
void write_chunks(hid_t dataset, const std::string& path, const Hdf5File::Shape& shape,
                  std::uint64_t values_per_row, std::uint64_t first,
                  const std::vector<Value>& rows) {
  const std::size_t whole = rows_of_chunk(shape) * values_per_row;
  const auto compressed = [&](std::size_t begin) {
    const std::size_t end = std::min(begin + whole, rows.size());
    std::vector<Value> values(rows.begin() + std::ptrdiff_t(begin),
                              rows.begin() + std::ptrdiff_t(end));
    values.resize(whole);  // the last chunk has rows past the end
    return shuffled_and_deflated(std::as_bytes(std::span(values)), sizeof(Value));
  };
  std::vector<hsize_t> start(shape.size(), 0);
  start[0] = first;
  for (std::size_t begin = 0; begin < rows.size();) {
    std::vector<std::future<std::vector<unsigned char>>> chunks;
    for (int k = 0; k < omp_get_max_threads() && begin < rows.size(); ++k, begin += whole) {
      chunks.push_back(std::async(compressed, begin));
    }
    for (auto& chunk : chunks) {
      const std::vector<unsigned char> bytes = chunk.get();
      checked(H5Dwrite_chunk(dataset, H5P_DEFAULT, 0, start.data(), bytes.size(), bytes.data()),
              "write " + path);
      start[0] += rows_of_chunk(shape);
    }
  }
}

std::string column_path(const std::string& group, const Column& column) {
  std::string name = column.name;
  std::replace(name.begin(), name.end(), '/', '|');
  return group + "/" + name;
}

/// Appends values to a growing dataset of one dimension.
void append_values(hid_t dataset, const std::string& path, hid_t type, const void* values,
                   hsize_t count, hid_t transfer = H5P_DEFAULT) {
  hsize_t start = 0;
  {
    const Handle space(H5Dget_space(dataset), H5Sclose, "size " + path);
    checked(H5Sget_simple_extent_dims(space, &start, nullptr), "size " + path);
  }
  const hsize_t end = start + count;
  checked(H5Dset_extent(dataset, &end), "extend " + path);
  const Handle space(H5Dget_space(dataset), H5Sclose, "size " + path);
  checked(H5Sselect_hyperslab(space, H5S_SELECT_SET, &start, nullptr, &count, nullptr),
          "select the end of " + path);
  checked(H5Dwrite(dataset, type, dataspace({count}), space, transfer, values), "write " + path);
}

std::vector<hsize_t> extents(hid_t space, const std::string& path) {
  const int rank = checked(H5Sget_simple_extent_ndims(space), "size " + path);
  std::vector<hsize_t> extents(static_cast<std::size_t>(rank));
  checked(H5Sget_simple_extent_dims(space, extents.data(), nullptr), "size " + path);
  return extents;
}

template <class Value>
std::vector<Value> read_dataset(hid_t file, const std::string& path, hid_t type) {
  const Handle dataset(H5Dopen2(file, path.c_str(), H5P_DEFAULT), H5Dclose, "open " + path);
  const Handle space(H5Dget_space(dataset), H5Sclose, "size " + path);
  const auto count = checked(H5Sget_simple_extent_npoints(space), "size " + path);
  std::vector<Value> values(static_cast<std::size_t>(count));
  checked(H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), "read " + path);
  return values;
}

std::vector<std::string> read_texts(hid_t file, const std::string& path) {
  const Handle type = text_type();
  const std::vector<char*> pointers = read_dataset<char*>(file, path, type);
  std::vector<std::string> texts;
  for (char* const pointer : pointers) {
    texts.emplace_back(pointer ? pointer : "");
    checked(H5free_memory(pointer), "free what was read from " + path);
  }
  return texts;
}

template <class Value>
Value read_attribute(hid_t file, const std::string& path, const std::string& name, hid_t type) {
  const std::string what = "attribute " + name + " of " + path;
  const Handle attribute(
      H5Aopen_by_name(file, path.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
      "open " + what);
  Value value{};
  checked(H5Aread(attribute, type, &value), "read " + what);
  return value;
}

template <class Value, class Entry>
std::vector<Value> column_values(const std::vector<Row>& rows, std::size_t column, Entry entry) {
  std::vector<Value> values;
  values.reserve(rows.size());
  for (const Row& row : rows) values.push_back(entry(row.at(column)));
  return values;
}

}  // namespace

Hdf5File Hdf5File::in_memory(const std::string& name, std::size_t growth) {
  silence_error_printing();
  const Handle access = file_access();
  checked(H5Pset_fapl_core(access, growth, /*backing_store=*/0), "keep a file in memory");
  return Hdf5File(checked(H5Fcreate(name.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access),
                          "create a file in memory"));
}

Hdf5File Hdf5File::create(const std::filesystem::path& file, std::uint64_t room) {
  static const std::string empty(in_memory("empty file (in memory)", 1 << 12).image());
  return create(file, room, empty);
}

Hdf5File Hdf5File::create(const std::filesystem::path& file, std::uint64_t room,
                          std::string_view image) {
  silence_error_printing();
  write_file(file, image);
  reserve_file(file, room);
  return Hdf5File(
      checked(H5Fopen(file.c_str(), H5F_ACC_RDWR, unlocked_access()), "open " + file.string()));
}

Hdf5File Hdf5File::open_for_reading(const std::filesystem::path& file) {
  silence_error_printing();
  return Hdf5File(
      checked(H5Fopen(file.c_str(), H5F_ACC_RDONLY, unlocked_access()), "open " + file.string()));
}

Hdf5File::Hdf5File(Hdf5File&& other) noexcept
    : id_(std::exchange(other.id_, -1)),
      columns_(std::exchange(other.columns_, {})),
      image_(std::move(other.image_)) {}

Hdf5File::~Hdf5File() {
  close_columns();
  if (id_ >= 0) H5Fclose(id_);
}

void Hdf5File::close_columns() {
  for (const auto& [path, dataset] : columns_) H5Dclose(dataset);
  columns_.clear();
}

void Hdf5File::close() {
  close_columns();
  checked(H5Fflush(id_, H5F_SCOPE_LOCAL), "write a file to the disk");
  checked(H5garbage_collect(), "free what HDF5 keeps of written rows");
  checked(H5Fclose(std::exchange(id_, -1)), "close a file");
}

void Hdf5File::make_group(const std::string& path) {
  const Handle group(H5Gcreate2(id_, path.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose,
                     "create " + path);
}

void Hdf5File::write(const std::string& path, const std::vector<double>& values, const Shape& shape,
                     const DatasetLabel& label) {
  write_dataset(id_, path, H5T_NATIVE_DOUBLE, values.data(), shape, label);
}

void Hdf5File::write(const std::string& path, const std::vector<std::int32_t>& values,
                     const Shape& shape, const DatasetLabel& label) {
  write_dataset(id_, path, H5T_NATIVE_INT32, values.data(), shape, label);
}

void Hdf5File::write(const std::string& path, const std::vector<std::uint8_t>& values,
                     const Shape& shape, const DatasetLabel& label) {
  write_dataset(id_, path, H5T_NATIVE_UINT8, values.data(), shape, label);
}

void Hdf5File::write(const std::string& path, const std::vector<std::int64_t>& values,
                     const Shape& shape, const DatasetLabel& label) {
  write_dataset(id_, path, H5T_NATIVE_INT64, values.data(), shape, label);
}

template <class Value>
void Hdf5File::write_rows(const std::string& path, const Shape& shape, const DatasetLabel& label,
                          const std::function<void(const PutRows<Value>&)>& fill, Storage storage) {
  const hid_t type = type_of(Value{});
  const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "prepare " + path);
  if (storage == Storage::compressed) compress(creation, shape, path);
  const Handle dataset(
      H5Dcreate2(id_, path.c_str(), type, dataspace(shape), H5P_DEFAULT, creation, H5P_DEFAULT),
      H5Dclose, "create " + path);
  std::uint64_t values_per_row = 1;
  for (std::size_t k = 1; k < shape.size(); ++k) values_per_row *= shape[k];
  fill([&](std::uint64_t first, const std::vector<Value>& rows) {
    if (storage == Storage::compressed && fill_chunks(shape, first, rows.size() / values_per_row)) {
      return write_chunks(dataset, path, shape, values_per_row, first, rows);
    }
    std::vector<hsize_t> start(shape.size(), 0), count(shape.begin(), shape.end());
    start[0] = first;
    count[0] = rows.size() / values_per_row;
    const Handle space(H5Dget_space(dataset), H5Sclose, "size " + path);
    checked(
        H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr),
        "select rows of " + path);
    checked(H5Dwrite(dataset, type, dataspace({rows.size()}), space, H5P_DEFAULT, rows.data()),
            "write " + path);
  });
  write_label(dataset, label);
}

template void Hdf5File::write_rows<double>(const std::string&, const Shape&, const DatasetLabel&,
                                           const std::function<void(const PutRows<double>&)>&,
                                           Storage);
template void Hdf5File::write_rows<std::int32_t>(
    const std::string&, const Shape&, const DatasetLabel&,
    const std::function<void(const PutRows<std::int32_t>&)>&, Storage);
template void Hdf5File::write_rows<std::uint8_t>(
    const std::string&, const Shape&, const DatasetLabel&,
    const std::function<void(const PutRows<std::uint8_t>&)>&, Storage);

void Hdf5File::write(const std::string& path, const std::string& text, const DatasetLabel& label) {
  const char* pointer = text.c_str();
  write_dataset(id_, path, text_type(), &pointer, {}, label);
}

template <class Value>
void Hdf5File::write_view(const std::string& path, const Shape& shape,
                          const std::vector<ViewedRows>& parts, const DatasetLabel& label) {
  const hid_t type = type_of(Value{});
  const Handle view = dataspace(shape);
  const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "prepare " + path);
  const Value zero{};
  checked(H5Pset_fill_value(creation, type, &zero), "prepare " + path);
  for (const ViewedRows& part : parts) {
    const Handle source = dataspace(part.shape);
    // The dataset may have more rows than `shape`, so that all of it must not be selected.
    const std::vector<hsize_t> origin(part.shape.size(), 0),
        all(part.shape.begin(), part.shape.end());
    checked(
        H5Sselect_hyperslab(source, H5S_SELECT_SET, origin.data(), nullptr, all.data(), nullptr),
        "select rows for " + path);
    const hsize_t inner = part.shape.size() > 1 ? part.shape.back() : 1;
    const hsize_t outer = part.shape.size() > 2 ? part.shape[1] : 1;
    const hsize_t start[] = {part.row, part.column}, stride[] = {1, 3},
                  blocks[] = {part.shape[0], outer}, block[] = {1, inner};
    checked(H5Sselect_hyperslab(view, H5S_SELECT_SET, start, stride, blocks, block),
            "select rows of " + path);
    checked(H5Pset_virtual(creation, view, part.of.file.c_str(), part.of.object.c_str(), source),
            "map " + path);
  }
  checked(H5Sselect_all(view), "select " + path);
  const Handle dataset(
      H5Dcreate2(id_, path.c_str(), type, view, H5P_DEFAULT, creation, H5P_DEFAULT), H5Dclose,
      "create " + path);
  write_label(dataset, label);
}

template void Hdf5File::write_view<double>(const std::string&, const Shape&,
                                           const std::vector<ViewedRows>&, const DatasetLabel&);
template void Hdf5File::write_view<std::int64_t>(const std::string&, const Shape&,
                                                 const std::vector<ViewedRows>&,
                                                 const DatasetLabel&);
template void Hdf5File::write_view<std::uint8_t>(const std::string&, const Shape&,
                                                 const std::vector<ViewedRows>&,
                                                 const DatasetLabel&);

void Hdf5File::write_padded_view(const std::string& path, const std::string& source,
                                 const Shape& shape, const DatasetLabel& label) {
  const std::uint64_t width = shape.size() == 3 ? 9 : 3;
  write_view<double>(path, {shape[0], width}, {{{".", source}, shape}}, label);
}

void Hdf5File::set_attribute(const std::string& path, const std::string& name, double value) {
  const Handle object(H5Oopen(id_, path.c_str(), H5P_DEFAULT), H5Oclose, "open " + path);
  write_attribute(object, name, H5T_NATIVE_DOUBLE, dataspace({}), &value);
}

void Hdf5File::set_attribute(const std::string& path, const std::string& name, std::int64_t value) {
  const Handle object(H5Oopen(id_, path.c_str(), H5P_DEFAULT), H5Oclose, "open " + path);
  write_attribute(object, name, H5T_NATIVE_INT64, dataspace({}), &value);
}

void Hdf5File::set_attribute(const std::string& path, const std::string& name,
                             const std::string& text) {
  const Handle object(H5Oopen(id_, path.c_str(), H5P_DEFAULT), H5Oclose, "open " + path);
  write_attribute(object, name, text);
}

void Hdf5File::set_attribute(const std::string& path, const std::string& name,
                             const std::vector<std::string>& texts) {
  const Handle object(H5Oopen(id_, path.c_str(), H5P_DEFAULT), H5Oclose, "open " + path);
  std::vector<const char*> pointers;
  for (const std::string& text : texts) pointers.push_back(text.c_str());
  write_attribute(object, name, text_type(), dataspace({pointers.size()}), pointers.data());
}

void Hdf5File::set_attribute(const std::string& path, const std::string& name,
                             const std::vector<std::int64_t>& values) {
  const Handle object(H5Oopen(id_, path.c_str(), H5P_DEFAULT), H5Oclose, "open " + path);
  write_attribute(object, name, H5T_NATIVE_INT64, dataspace({values.size()}), values.data());
}

void Hdf5File::set_fixed_attribute(const std::string& path, const std::string& name,
                                   const std::string& text) {
  const Handle object(H5Oopen(id_, path.c_str(), H5P_DEFAULT), H5Oclose, "open " + path);
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose, "make the type of a text");
  checked(H5Tset_size(type, text.size()), "make the type of a text");
  checked(H5Tset_strpad(type, H5T_STR_NULLPAD), "make the type of a text");
  write_attribute(object, name, type, dataspace({}), text.data());
}

bool Hdf5File::has_attribute(const std::string& path, const std::string& name) const {
  return checked(H5Aexists_by_name(id_, path.c_str(), name.c_str(), H5P_DEFAULT),
                 "look for attribute " + name) > 0;
}

bool Hdf5File::has(const std::string& path) const {
  // Checks every group on the way: the library fails below one that is missing.
  for (std::size_t slash = path.find('/', 1);; slash = path.find('/', slash + 1)) {
    const std::string part = path.substr(0, slash);
    if (H5Lexists(id_, part.c_str(), H5P_DEFAULT) <= 0 ||
        H5Oexists_by_name(id_, part.c_str(), H5P_DEFAULT) <= 0) {
      return false;
    }
    if (slash == std::string::npos) return true;
  }
}

bool Hdf5File::has_link(const std::string& path) const {
  return checked(H5Lexists(id_, path.c_str(), H5P_DEFAULT), "look for " + path) > 0;
}

std::string Hdf5File::text_attribute(const std::string& path, const std::string& name) const {
  const Handle type = text_type();
  char* const read = read_attribute<char*>(id_, path, name, type);
  const std::string text = read ? read : "";
  checked(H5free_memory(read), "free what was read from " + path);
  return text;
}

std::vector<double> Hdf5File::numbers(const std::string& path) const {
  return read_dataset<double>(id_, path, H5T_NATIVE_DOUBLE);
}

std::vector<std::int64_t> Hdf5File::integers(const std::string& path) const {
  return read_dataset<std::int64_t>(id_, path, H5T_NATIVE_INT64);
}

std::vector<std::uint8_t> Hdf5File::bytes(const std::string& path) const {
  return read_dataset<std::uint8_t>(id_, path, H5T_NATIVE_UINT8);
}

template <class Value>
std::vector<Value> Hdf5File::some_rows(const std::string& path, std::uint64_t first,
                                       std::uint64_t count) const {
  const Handle dataset(H5Dopen2(id_, path.c_str(), H5P_DEFAULT), H5Dclose, "open " + path);
  const Handle space(H5Dget_space(dataset), H5Sclose, "size " + path);
  std::vector<hsize_t> extent(extents(space, path)), start(extent.size(), 0);
  start.at(0) = first;
  extent.at(0) = count;
  hsize_t values = 1;
  for (const hsize_t along : extent) values *= along;
  std::vector<Value> rows(values);
  if (rows.empty()) return rows;
  checked(H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, extent.data(), nullptr),
          "select rows of " + path);
  checked(H5Dread(dataset, type_of(Value{}), dataspace({values}), space, H5P_DEFAULT, rows.data()),
          "read " + path);
  return rows;
}

template std::vector<double> Hdf5File::some_rows<double>(const std::string&, std::uint64_t,
                                                         std::uint64_t) const;
template std::vector<std::uint8_t> Hdf5File::some_rows<std::uint8_t>(const std::string&,
                                                                     std::uint64_t,
                                                                     std::uint64_t) const;

std::uint64_t Hdf5File::count_of_rows(const std::string& path) const {
  const Handle dataset(H5Dopen2(id_, path.c_str(), H5P_DEFAULT), H5Dclose, "open " + path);
  const Handle space(H5Dget_space(dataset), H5Sclose, "size " + path);
  return extents(space, path).at(0);
}

std::string Hdf5File::text(const std::string& path) const { return read_texts(id_, path).at(0); }

std::vector<Row> Hdf5File::rows(const std::string& group,
                                const std::vector<Column>& columns) const {
  std::vector<Row> rows;
  const auto take = [&rows](std::size_t column, const auto& values) {
    if (column == 0) rows.resize(values.size());
    if (rows.size() != values.size()) throw std::runtime_error("columns of different lengths");
    for (std::size_t k = 0; k < values.size(); ++k) rows[k].emplace_back(values[k]);
  };
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const std::string path = column_path(group, columns[i]);
    if (columns[i].kind == Column::Kind::integer) {
      take(i, integers(path));
    } else if (columns[i].kind == Column::Kind::number) {
      take(i, numbers(path));
    } else {
      take(i, read_texts(id_, path));
    }
  }
  return rows;
}

std::vector<std::string> Hdf5File::names(const std::string& group) const {
  std::vector<std::string> names;
  const auto add = [](hid_t, const char* name, const H5L_info_t*, void* to) -> herr_t {
    static_cast<std::vector<std::string>*>(to)->emplace_back(name);
    return 0;
  };
  checked(H5Literate_by_name(id_, group.c_str(), H5_INDEX_NAME, H5_ITER_INC, nullptr, add, &names,
                             H5P_DEFAULT),
          "list " + group);
  return names;
}

void Hdf5File::make_table(const std::string& group, const std::vector<Column>& columns) {
  make_group(group);
  // Small chunks keep the file of a short run small.
  const hsize_t none = 0, unlimited = H5S_UNLIMITED, rows_per_chunk = 256;
  const Handle space(H5Screate_simple(1, &none, &unlimited), H5Sclose, "make a dataspace");
  const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "prepare " + group);
  checked(H5Pset_chunk(creation, 1, &rows_per_chunk), "prepare " + group);
  const Handle texts = text_type();
  for (const Column& column : columns) {
    const std::string path = column_path(group, column);
    const hid_t type = column.kind == Column::Kind::integer  ? H5T_NATIVE_INT64
                       : column.kind == Column::Kind::number ? H5T_NATIVE_DOUBLE
                                                             : hid_t{texts};
    const hid_t dataset =
        checked(H5Dcreate2(id_, path.c_str(), type, space, H5P_DEFAULT, creation, H5P_DEFAULT),
                "create " + path);
    columns_.emplace(path, dataset);
    write_label(dataset, {column.unit, column.description});
  }
}

void Hdf5File::append(const std::string& group, const std::vector<Column>& columns,
                      const std::vector<Row>& rows) {
  if (rows.empty()) return;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const std::string path = column_path(group, columns[i]);
    if (columns[i].kind == Column::Kind::integer) {
      const auto values = column_values<std::int64_t>(
          rows, i, [](const TableCell& cell) { return std::get<std::int64_t>(cell); });
      append_values(columns_.at(path), path, H5T_NATIVE_INT64, values.data(), values.size());
    } else if (columns[i].kind == Column::Kind::number) {
      const auto values = column_values<double>(
          rows, i, [](const TableCell& cell) { return std::get<double>(cell); });
      append_values(columns_.at(path), path, H5T_NATIVE_DOUBLE, values.data(), values.size());
    } else {
      const auto values = column_values<const char*>(
          rows, i, [](const TableCell& cell) { return std::get<std::string>(cell).c_str(); });
      // Texts are converted in a buffer that is cleared each time; the default one has a megabyte.
      const Handle transfer(H5Pcreate(H5P_DATASET_XFER), H5Pclose, "prepare to write " + path);
      checked(H5Pset_buffer(transfer, 1 << 12, nullptr, nullptr), "prepare to write " + path);
      append_values(columns_.at(path), path, text_type(), values.data(), values.size(), transfer);
    }
  }
}

void Hdf5File::link(const std::string& path, const std::string& file, const std::string& object) {
  checked(
      H5Lcreate_external(file.c_str(), object.c_str(), id_, path.c_str(), H5P_DEFAULT, H5P_DEFAULT),
      "link " + path);
}

void Hdf5File::unlink(const std::string& path) {
  checked(H5Ldelete(id_, path.c_str(), H5P_DEFAULT), "remove " + path);
}

std::optional<ObjectInFile> Hdf5File::link_target(const std::string& path) const {
  H5L_info_t link{};
  checked(H5Lget_info(id_, path.c_str(), &link, H5P_DEFAULT), "look at the link " + path);
  if (link.type != H5L_TYPE_EXTERNAL) return std::nullopt;
  std::vector<char> value(link.u.val_size);
  checked(H5Lget_val(id_, path.c_str(), value.data(), value.size(), H5P_DEFAULT),
          "read the link " + path);
  unsigned flags = 0;
  const char* file = nullptr;
  const char* object = nullptr;
  checked(H5Lunpack_elink_val(value.data(), value.size(), &flags, &file, &object),
          "read the link " + path);
  return ObjectInFile{file, object};
}

void Hdf5File::copy(const Hdf5File& from, const std::string& source, const std::string& path) {
  checked(H5Ocopy(from.id_, source.c_str(), id_, path.c_str(), H5P_DEFAULT, H5P_DEFAULT),
          "copy " + path);
}

std::string_view Hdf5File::image() {
  checked(H5Fflush(id_, H5F_SCOPE_LOCAL), "flush a file in memory");
  const auto size = checked(H5Fget_file_image(id_, nullptr, 0), "size a file in memory");
  image_.resize(static_cast<std::size_t>(size));
  checked(H5Fget_file_image(id_, image_.data(), image_.size()), "read a file in memory");
  return image_;
}

std::string Hdf5File::library_version() {
  unsigned major = 0, minor = 0, release = 0;
  checked(H5get_libversion(&major, &minor, &release), "tell its version");
  return std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(release);
}

}  // namespace peristat
