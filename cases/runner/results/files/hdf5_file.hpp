#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cases/runner/results/files/table.hpp"

namespace peristat {

/// Unit and meaning of a dataset, written as its attributes `unit` and `description`.
struct DatasetLabel {
  std::string unit, description;
};

/// An object of a file; the file is relative to the folder of the file that links to it.
struct ObjectInFile {
  std::string file, object;
};

/// An open HDF5 file; closed by the destructor. Paths of objects are absolute ("/steps/000001").
/// Every error of the library is thrown as std::runtime_error with the library's own message.
class Hdf5File {
 public:
  using Shape = std::vector<std::uint64_t>;

  /// A new file that lives in memory and never touches the disk; see image().
  /// @param name  unique among the open files
  /// @param growth bytes by which the memory grows
  [[nodiscard]] static Hdf5File in_memory(const std::string& name, std::size_t growth);
  /// A new file on the disk, in place of an existing one. HDF5 1.10 may crash when the disk runs
  /// full under it, so the room is set aside first; closing the file gives back what is not used.
  /// @param room bytes that the file may need
  /// @throws OutputError if the disk has less room
  [[nodiscard]] static Hdf5File create(const std::filesystem::path& file, std::uint64_t room);
  /// Creates a file with contents from image(); `room` counts them as well.
  [[nodiscard]] static Hdf5File create(const std::filesystem::path& file, std::uint64_t room,
                                       std::string_view image);
  [[nodiscard]] static Hdf5File open_for_reading(const std::filesystem::path& file);

  Hdf5File(Hdf5File&& other) noexcept;
  Hdf5File& operator=(Hdf5File&&) = delete;
  ~Hdf5File();
  /// Closes the file now, so that an error on the way to the disk is thrown.
  void close();

  void make_group(const std::string& path);

  void write(const std::string& path, const std::vector<double>& values, const Shape& shape,
             const DatasetLabel& label);
  void write(const std::string& path, const std::vector<std::int32_t>& values, const Shape& shape,
             const DatasetLabel& label);
  void write(const std::string& path, const std::vector<std::uint8_t>& values, const Shape& shape,
             const DatasetLabel& label);
  void write(const std::string& path, const std::vector<std::int64_t>& values, const Shape& shape,
             const DatasetLabel& label);
  /// Writes rows into a dataset, from row `first` on.
  template <class Value>
  using PutRows = std::function<void(std::uint64_t first, const std::vector<Value>& rows)>;
  enum class Storage { plain, compressed };
  /// Writes a dataset in parts, which `fill` puts: values are double, int32 or uint8.
  template <class Value>
  void write_rows(const std::string& path, const Shape& shape, const DatasetLabel& label,
                  const std::function<void(const PutRows<Value>&)>& fill,
                  Storage storage = Storage::plain);
  /// A single text.
  void write(const std::string& path, const std::string& text, const DatasetLabel& label);
  /// A virtual dataset that shows vectors (count x dimension) of this file as count x 3, or tensors
  /// (count x dimension x dimension) as count x 9, with zeros beyond the dimension; takes no space.
  /// @param shape of the dataset `source`
  void write_padded_view(const std::string& path, const std::string& source, const Shape& shape,
                         const DatasetLabel& label);

  /// Rows of a dataset as part of a view. The dataset may have further rows.
  struct ViewedRows {
    ObjectInFile of;        ///< relative to this file's folder; "." is this file
    Shape shape;            ///< of the rows that are shown
    std::uint64_t row = 0;  ///< of the view at which they are shown
    std::uint64_t column = 0;
  };
  /// A virtual dataset that shows rows of others; takes no space. The values of a row are shown in
  /// columns from `column` on, those of a tensor (row x a x b) in groups of three columns; the rest
  /// is zero.
  /// @tparam Value double, int64 or uint8, the type of all datasets
  template <class Value>
  void write_view(const std::string& path, const Shape& shape, const std::vector<ViewedRows>& parts,
                  const DatasetLabel& label);

  void set_attribute(const std::string& path, const std::string& name, double value);
  void set_attribute(const std::string& path, const std::string& name, std::int64_t value);
  void set_attribute(const std::string& path, const std::string& name, const std::string& text);
  void set_attribute(const std::string& path, const std::string& name,
                     const std::vector<std::string>& texts);
  void set_attribute(const std::string& path, const std::string& name,
                     const std::vector<std::int64_t>& values);
  /// A text of fixed length in ASCII, which the readers of VTK ask for.
  void set_fixed_attribute(const std::string& path, const std::string& name,
                           const std::string& text);

  /// True if there is an object; a link to one that can't be opened counts as none.
  [[nodiscard]] bool has(const std::string& path) const;
  /// True if there is an object or a link, wherever it leads.
  [[nodiscard]] bool has_link(const std::string& path) const;
  [[nodiscard]] bool has_attribute(const std::string& path, const std::string& name) const;
  [[nodiscard]] std::string text_attribute(const std::string& path, const std::string& name) const;

  /// Values of a dataset, in the order of its rows; other types are converted.
  [[nodiscard]] std::vector<double> numbers(const std::string& path) const;
  [[nodiscard]] std::vector<std::int64_t> integers(const std::string& path) const;
  [[nodiscard]] std::vector<std::uint8_t> bytes(const std::string& path) const;
  /// The values of some rows, and how many rows there are: values are double or uint8.
  template <class Value>
  [[nodiscard]] std::vector<Value> some_rows(const std::string& path, std::uint64_t first,
                                             std::uint64_t count) const;
  [[nodiscard]] std::uint64_t count_of_rows(const std::string& path) const;
  [[nodiscard]] std::string text(const std::string& path) const;
  /// Rows of a table, see make_table.
  [[nodiscard]] std::vector<Row> rows(const std::string& group,
                                      const std::vector<Column>& columns) const;
  /// Names of the objects in a group, ascending.
  [[nodiscard]] std::vector<std::string> names(const std::string& group) const;

  /// A group with one growing dataset per column, without rows; a '/' in a column's name becomes
  /// '|'.
  void make_table(const std::string& group, const std::vector<Column>& columns);
  void append(const std::string& group, const std::vector<Column>& columns,
              const std::vector<Row>& rows);

  /// A link to an object of another file, whose path is relative to this file's folder.
  void link(const std::string& path, const std::string& file, const std::string& object);
  void unlink(const std::string& path);
  /// Target of a link; none if the object is in this file.
  [[nodiscard]] std::optional<ObjectInFile> link_target(const std::string& path) const;
  void copy(const Hdf5File& from, const std::string& source, const std::string& path);

  /// The bytes of the file as it is now; valid until the next call.
  [[nodiscard]] std::string_view image();

  /// "1.10.8"
  [[nodiscard]] static std::string library_version();

 private:
  explicit Hdf5File(std::int64_t id) : id_(id) {}
  void close_columns();

  std::int64_t id_;
  std::map<std::string, std::int64_t> columns_;  // datasets of the tables, open, by path
  std::string image_;  // kept, so that its memory is not cleared again for every image
};

}  // namespace peristat
