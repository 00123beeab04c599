#include "cases/runner/results/checkpoint/checkpoint.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "solvers/drivers/state_archive.hpp"

namespace peristat {
namespace {

constexpr std::string_view magic = "peristat checkpoint";

/// A named array of a checkpoint. A sparse one stores the values that differ from `usual`, with
/// their positions among the integers.
struct Entry {
  std::string name;
  std::size_t size = 0, others = 0;
  bool is_sparse = false;
  double usual = 0.0;
};

std::ostream& operator<<(std::ostream& out, const Entry& entry) {
  out << entry.name << ' ' << entry.size;
  if (entry.is_sparse) out << ' ' << entry.others << " beside " << entry.usual;
  return out << '\n';
}

Entry parse_entry(const std::string& line) {
  Entry entry;
  std::istringstream words(line);
  std::string beside;
  words >> entry.name >> entry.size;
  if (!words) throw BadCheckpoint("is damaged: its list of entries can't be read");
  entry.is_sparse = bool(words >> entry.others >> beside >> entry.usual);
  return entry;
}

/// True if the bits are the same: -0 is not 0.
bool is_same(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

/// Number of values that differ from 0, and from 1.
struct Differences {
  std::size_t from_0 = 0, from_1 = 0, of = 0;
};

/// Entry of an array: sparse if most values are 0, or most are 1, as in undamaged bodies and at
/// rest.
Entry entry_for(const std::string& name, const Differences& found) {
  const std::size_t fewest = std::min(found.from_0, found.from_1);
  // A position takes as much room as a value.
  if (2 * fewest >= found.of) return {name, found.of};
  return {name, found.of, fewest, true, found.from_0 <= found.from_1 ? 0.0 : 1.0};
}

template <class Value>
std::string_view bytes_of(const std::vector<Value>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Value)};
}

/// A value of a distributed array, and its position in the whole one.
struct PlacedValue {
  std::int64_t place;
  double value;
};

/// This rank's part of a distributed array.
struct PlacedPart {
  std::vector<PlacedValue> values{};
  std::int64_t size = 0;      ///< of the whole array
  std::uint64_t written = 0;  ///< number of values that all ranks write
  bool are_integers = false;  ///< otherwise numbers
  bool are_sparse = false;    ///< with their positions among the integers
};

/// Consecutive values among the numbers, and among the integers, of a checkpoint.
struct Piece {
  std::vector<double> numbers{};
  std::vector<std::int64_t> integers{};
  PlacedPart part{};

  [[nodiscard]] std::uint64_t count_of_numbers() const {
    return numbers.size() + (part.are_integers ? 0 : part.written);
  }
  [[nodiscard]] std::uint64_t count_of_integers() const {
    return integers.size() + (part.are_integers || part.are_sparse ? part.written : 0);
  }
};

/// Packs a state. Moves arrays out of it: copies would need their memory twice.
class Packer : public StateArchive {
 public:
  explicit Packer(StateNumbering* numbering) : numbering_(numbering) {}

  void transfer(const std::string& name, bool& value) override { integer(name, value ? 1 : 0); }
  void transfer(const std::string& name, int& value) override { integer(name, value); }
  void transfer(const std::string& name, std::int64_t& value) override { integer(name, value); }
  void transfer(const std::string& name, double& value) override {
    entries_ << Entry{name, 1};
    pieces_.emplace_back().numbers = {value};
  }
  void transfer(const std::string& name, std::vector<char>& values, Rows rows) override {
    integers(name, values, rows);
  }
  void transfer(const std::string& name, std::vector<Index>& values, Rows rows) override {
    if (numbering_ && rows == Rows::list_of_points) values = numbering_->numbers_of_all(values);
    integers(name, values, rows);
  }
  void transfer(const std::string& name, std::vector<double>& values, Rows rows) override {
    if (has_parts(rows)) return numbers_of_part(name, std::exchange(values, {}), rows);
    Piece& piece = pieces_.emplace_back();
    const auto others = [&](double usual) {
      return std::size_t(
          std::ranges::count_if(values, [&](double value) { return !is_same(value, usual); }));
    };
    const Entry entry = entry_for(name, {others(0.0), others(1.0), values.size()});
    entries_ << entry;
    piece.numbers = std::exchange(values, {});
    if (entry.is_sparse) keep_others(piece, entry.usual);
  }
  void number_free_dofs(const FragmentPins& pins) override {
    if (numbering_) numbering_->pin(pins);
  }

  /// Puts the sizes of entries, numbers and integers, and then these in turn; frees the numbers.
  void put(const PutBytes& put) {
    const std::string entries = entries_.str();
    std::vector<std::uint64_t> sizes{entries.size(), 0, 0};
    for (const Piece& piece : pieces_) {
      sizes[1] += piece.count_of_numbers();
      sizes[2] += piece.count_of_integers();
    }
    put(bytes_of(sizes));
    put(entries);
    for (Piece& piece : pieces_) {
      put(bytes_of(piece.numbers));
      piece.numbers = std::vector<double>();
      if (!piece.part.are_integers) put_part<double>(piece.part, put, &PlacedValue::value);
    }
    for (const Piece& piece : pieces_) {
      put(bytes_of(piece.integers));
      if (piece.part.are_integers) put_part<std::int64_t>(piece.part, put, &PlacedValue::value);
      if (piece.part.are_sparse) put_part<std::int64_t>(piece.part, put, &PlacedValue::place);
    }
  }

 private:
  [[nodiscard]] bool has_parts(Rows rows) const {
    return numbering_ && rows != Rows::whole && rows != Rows::list_of_points;
  }

  static void keep_others(Piece& piece, double usual) {
    std::vector<double> others;
    for (std::size_t k = 0; k < piece.numbers.size(); ++k) {
      if (is_same(piece.numbers[k], usual)) continue;
      others.push_back(piece.numbers[k]);
      piece.integers.push_back(static_cast<std::int64_t>(k));
    }
    piece.numbers = std::move(others);
  }

  void integer(const std::string& name, std::int64_t value) {
    entries_ << Entry{name, 1};
    pieces_.emplace_back().integers = {value};
  }

  template <class Value>
  void integers(const std::string& name, const std::vector<Value>& values, Rows rows) {
    Piece& piece = pieces_.emplace_back();
    if (has_parts(rows)) {
      piece.part = part_of(rows, {values.begin(), values.end()});
      piece.part.are_integers = true;
    } else {
      piece.integers.assign(values.begin(), values.end());
    }
    entries_ << Entry{name, std::size_t(piece.count_of_integers())};
  }

  void numbers_of_part(const std::string& name, const std::vector<double>& values, Rows rows) {
    PlacedPart& part = pieces_.emplace_back().part;
    part = part_of(rows, values);
    const auto others = [&](double usual) {
      const auto here = std::ranges::count_if(
          part.values, [&](const PlacedValue& at) { return !is_same(at.value, usual); });
      return std::size_t(numbering_->gathering().part().ranks().count_all(here).all);
    };
    const Entry entry = entry_for(name, {others(0.0), others(1.0), std::size_t(part.size)});
    entries_ << entry;
    if (!entry.is_sparse) return;
    part.are_sparse = true;
    part.written = entry.others;
    std::erase_if(part.values, [&](const auto& at) { return is_same(at.value, entry.usual); });
  }

  [[nodiscard]] PlacedPart part_of(Rows rows, const std::vector<double>& values) const {
    PlacedPart part;
    part.size = numbering_->whole_size(rows, values.size());
    part.written = std::uint64_t(part.size);
    for (const auto& [whole, here] : numbering_->places(rows, values.size())) {
      part.values.push_back({whole, values[here]});
    }
    return part;
  }

  template <class Written, class Member>
  void put_part(const PlacedPart& part, const PutBytes& put, Member member) const {
    if (part.written == 0) return;
    numbering_->gathering().gather_in_order(
        part.values, part.size, [](const PlacedValue& at) { return std::pair(at.place, 0); },
        [&](const std::vector<PlacedValue>& all) {
          std::vector<Written> written;
          for (const PlacedValue& at : all) written.push_back(static_cast<Written>(at.*member));
          put(bytes_of(written));
        });
  }

  StateNumbering* numbering_;
  std::ostringstream entries_;
  std::vector<Piece> pieces_;
};

/// Reads consecutive values from some bytes, in order.
template <class Value>
class Values {
 public:
  Values(const CheckpointBytes& bytes, std::uint64_t first, std::uint64_t count)
      : bytes_(bytes), at_(first), left_(count) {}

  Value take() {
    if (next_ == buffer_.size()) fill();
    return buffer_[next_++];
  }
  void skip(std::uint64_t count) {
    require(count <= left());
    const std::uint64_t here = std::min<std::uint64_t>(count, buffer_.size() - next_);
    next_ += here;
    at_ += (count - here) * sizeof(Value);
    left_ -= count - here;
  }
  [[nodiscard]] std::uint64_t left() const { return left_ + (buffer_.size() - next_); }

  static void require(bool holds) {
    if (!holds) throw BadCheckpoint("is damaged: its entries and its values disagree");
  }

 private:
  void fill() {
    constexpr std::uint64_t most = 1 << 17;
    require(left_ > 0);
    buffer_.resize(std::min(left_, most));
    next_ = 0;
    const std::string read = bytes_.read(at_, buffer_.size() * sizeof(Value));
    if (read.size() != buffer_.size() * sizeof(Value)) {
      throw BadCheckpoint("is damaged: it is incomplete");
    }
    std::memcpy(buffer_.data(), read.data(), read.size());
    at_ += read.size();
    left_ -= buffer_.size();
  }

  const CheckpointBytes& bytes_;
  std::uint64_t at_, left_;  // of the values that are not in the buffer
  std::vector<Value> buffer_;
  std::size_t next_ = 0;
};

/// Takes the values that are wanted of an array of the whole body, which come in its order.
class ArrayTaker {
 public:
  /// @param usual value of entries that are not stored
  ArrayTaker(const WantedState& wanted, Rows rows, std::size_t size, double usual)
      : numbering_(rows == Rows::whole || rows == Rows::list_of_points ? nullptr
                                                                       : wanted.numbering),
        rows_(rows) {
    std::optional<std::size_t> here = size;
    if (numbering_) here = numbering_->size_here(rows, std::int64_t(size));
    takes_ = wanted.has_arrays && here && size > 0;
    if (!takes_) return;
    values_.assign(*here, usual);
    if (numbering_) places_ = numbering_->places(rows, *here);
  }

  /// True if any values are wanted.
  [[nodiscard]] bool takes() const { return takes_; }

  void take(std::size_t place, double value) {
    if (!numbering_) {
      values_[place] = value;
      return;
    }
    while (next_ < places_.size() && places_[next_].whole < std::int64_t(place)) ++next_;
    if (next_ < places_.size() && places_[next_].whole == std::int64_t(place)) {
      values_[places_[next_].here] = value;
    }
  }

  std::vector<double> values() {
    if (numbering_) numbering_->give_to_others(rows_, values_);
    return std::move(values_);
  }

 private:
  StateNumbering* numbering_;
  Rows rows_;
  bool takes_ = false;
  std::vector<double> values_;
  std::vector<StateNumbering::Place> places_;
  std::size_t next_ = 0;
};

class Unpacker : public StateArchive {
 public:
  Unpacker(const std::string& entries, Values<double> numbers, Values<std::int64_t> integers,
           const WantedState& wanted)
      : entries_(entries),
        numbers_(std::move(numbers)),
        integers_(std::move(integers)),
        wanted_(wanted) {}

  void transfer(const std::string& name, bool& value) override { value = integer(name) != 0; }
  void transfer(const std::string& name, int& value) override { value = int(integer(name)); }
  void transfer(const std::string& name, std::int64_t& value) override { value = integer(name); }
  void transfer(const std::string& name, double& value) override {
    require(next(name).size == 1);
    value = numbers_.take();
  }
  void transfer(const std::string& name, std::vector<char>& values, Rows rows) override {
    integers(name, values, rows);
  }
  void transfer(const std::string& name, std::vector<Index>& values, Rows rows) override {
    integers(name, values, rows);
    if (wanted_.numbering && rows == Rows::list_of_points) {
      values = wanted_.numbering->points_here(values);
    }
  }
  void transfer(const std::string& name, std::vector<double>& values, Rows rows) override {
    const Entry entry = next(name);
    const std::size_t written = entry.is_sparse ? entry.others : entry.size;
    require(written <= numbers_.left() && (!entry.is_sparse || written <= integers_.left()));
    require(!entry.is_sparse || entry.size < most_values);
    ArrayTaker taker(wanted_, rows, entry.size, entry.usual);
    values.clear();
    if (!taker.takes()) {
      numbers_.skip(written);
      if (entry.is_sparse) integers_.skip(written);
      return;
    }
    for (std::size_t k = 0; k < written; ++k) {
      const std::size_t place = entry.is_sparse ? std::size_t(integers_.take()) : k;
      require(place < entry.size);
      taker.take(place, numbers_.take());
    }
    values = taker.values();
  }
  void number_free_dofs(const FragmentPins& pins) override {
    if (wanted_.numbering) wanted_.numbering->pin(pins);
  }

  void require_end() {
    std::string rest;
    require(!(entries_ >> rest) && numbers_.left() == 0 && integers_.left() == 0);
  }

 private:
  /// No body has more bonds: a larger array is a sign of damage.
  static constexpr std::size_t most_values = std::size_t(1) << 40;

  static void require(bool holds) { Values<double>::require(holds); }

  Entry next(const std::string& name) {
    std::string line;
    std::getline(entries_, line);
    Entry entry = parse_entry(line);
    if (entry.name != name) {
      throw BadCheckpoint("is damaged: it has " + entry.name + " instead of " + name);
    }
    return entry;
  }

  std::int64_t integer(const std::string& name) {
    require(next(name).size == 1);
    return integers_.take();
  }

  template <class Value>
  void integers(const std::string& name, std::vector<Value>& values, Rows rows) {
    const Entry entry = next(name);
    require(entry.size <= integers_.left());
    values.clear();
    ArrayTaker taker(wanted_, rows, entry.size, 0.0);
    if (!taker.takes()) return integers_.skip(entry.size);
    for (std::size_t k = 0; k < entry.size; ++k) taker.take(k, double(integers_.take()));
    for (const double value : taker.values()) values.push_back(static_cast<Value>(value));
  }

  std::istringstream entries_;
  Values<double> numbers_;
  Values<std::int64_t> integers_;
  WantedState wanted_;
};

// As in state_archive.cpp the bindings name every member, so that none can be forgotten.
void transfer(StateArchive& archive, Checkpoint& checkpoint) {
  auto& [path, rows, last_with_fields, unwritten, costs] = checkpoint;
  transfer(archive, path);
  auto& [history, iterations, decisions, broken_bonds] = rows;
  archive.transfer("rows/history", history);
  archive.transfer("rows/iterations", iterations);
  archive.transfer("rows/decisions", decisions);
  archive.transfer("rows/broken_bonds", broken_bonds);
  archive.transfer("last_with_fields", last_with_fields);
  auto& [told_stretches, force] = unwritten;
  archive.transfer("unwritten/told_stretches", told_stretches, Rows::bonds);
  archive.transfer("unwritten/force", force, Rows::recorded_dofs);
  auto& [factorisations, linear_iterations, seconds] = costs;
  archive.transfer("costs/factorisations", factorisations);
  archive.transfer("costs/linear_iterations", linear_iterations);
  auto& [total, neighbourhood, assembly, linear, relaxation, output, checkpoints] = seconds;
  archive.transfer("costs/seconds/total", total);
  archive.transfer("costs/seconds/neighbourhood", neighbourhood);
  archive.transfer("costs/seconds/assembly", assembly);
  archive.transfer("costs/seconds/linear", linear);
  archive.transfer("costs/seconds/relaxation", relaxation);
  archive.transfer("costs/seconds/output", output);
  archive.transfer("costs/seconds/checkpoints", checkpoints);
}

/// FNV-1a over words of eight bytes [http://www.isthe.com/chongo/tech/comp/fnv], for bytes that
/// come in parts.
class Checksum {
 public:
  void add(std::string_view bytes) {
    if (!begun_.empty()) {
      const std::size_t more = std::min(word_size - begun_.size(), bytes.size());
      begun_ += bytes.substr(0, more);
      bytes.remove_prefix(more);
      if (begun_.size() < word_size) return;
      add_words(begun_);
      begun_.clear();
    }
    const std::size_t whole = bytes.size() / word_size * word_size;
    add_words(bytes.substr(0, whole));
    begun_ = bytes.substr(whole);
  }
  /// Checksum of the bytes added so far.
  [[nodiscard]] std::uint64_t sum() const {
    Checksum ended = *this;
    ended.add_words(ended.begun_);
    return ended.sum_;
  }

 private:
  static constexpr std::size_t word_size = sizeof(std::uint64_t);

  void add_words(std::string_view bytes) {
    for (std::size_t at = 0; at < bytes.size(); at += word_size) {
      std::uint64_t word = 0;
      std::memcpy(&word, bytes.data() + at, std::min(word_size, bytes.size() - at));
      sum_ = (sum_ ^ word) * 0x100000001b3u;
      sum_ ^= sum_ >> 32;  // products carry bits upwards only: brings high bits to the low ones
    }
  }

  std::uint64_t sum_ = 0xcbf29ce484222325u;
  std::string begun_;  // of an unfinished word
};

/// "peristat checkpoint 1 0.1.0": the layout, and the version of the program that has written it.
std::string head_line(const std::string& program) {
  return std::string(magic) + ' ' + std::to_string(checkpoint_layout) + ' ' + program + '\n';
}

void check_head(const std::string& line, const std::string& program) {
  std::int64_t layout = 0;
  std::string writer;
  std::istringstream words(line.starts_with(magic) ? line.substr(magic.size()) : "");
  if (!(words >> layout >> writer))
    throw BadCheckpoint("is damaged: it does not start like a checkpoint");
  if (layout == checkpoint_layout) return;
  throw BadCheckpoint("has layout " + std::to_string(layout) + " of peristat " + writer +
                      "; this is peristat " + program + ", which resumes from layout " +
                      std::to_string(checkpoint_layout));
}

/// Positions of the parts of a checkpoint.
struct Outline {
  std::string entries;
  std::uint64_t first_number = 0, numbers = 0, integers = 0;

  [[nodiscard]] std::uint64_t first_integer() const { return first_number + 8 * numbers; }
  [[nodiscard]] std::uint64_t end() const { return first_integer() + 8 * integers; }
};

Outline outline_of(const CheckpointBytes& bytes, const std::string& program) {
  const auto require = [](bool holds) {
    if (!holds) throw BadCheckpoint("is damaged: it is incomplete");
  };
  constexpr std::uint64_t most_of_head = 256;
  const std::string head = bytes.read(0, std::min(bytes.size, most_of_head));
  const std::size_t end_of_line = head.find('\n');
  require(end_of_line != std::string::npos);
  check_head(head.substr(0, end_of_line), program);
  std::array<std::uint64_t, 3> sizes{};
  std::uint64_t at = end_of_line + 1;
  require(at + sizeof sizes <= bytes.size);
  std::memcpy(sizes.data(), bytes.read(at, sizeof sizes).data(), sizeof sizes);
  at += sizeof sizes;
  require(sizes[0] <= bytes.size - at);
  Outline outline{bytes.read(at, sizes[0]), at + sizes[0], sizes[1], sizes[2]};
  const std::uint64_t values = (bytes.size - outline.first_number) / 8;  // with the checksum
  require(sizes[1] < values && sizes[2] < values - sizes[1]);
  return outline;
}

}  // namespace

void write_checkpoint(Checkpoint checkpoint, const std::string& program, StateNumbering* numbering,
                      const PutBytes& put) {
  Packer packer(numbering);
  transfer(packer, checkpoint);
  Checksum checksum;
  const bool writes = !numbering || numbering->gathering().part().ranks().rank() == 0;
  const auto add = [&](std::string_view bytes) {
    if (!writes || bytes.empty()) return;
    checksum.add(bytes);
    put(bytes);
  };
  add(head_line(program));
  packer.put(add);
  const std::uint64_t sum = checksum.sum();
  if (writes) put({reinterpret_cast<const char*>(&sum), sizeof sum});
}

Checkpoint read_checkpoint(const CheckpointBytes& bytes, const std::string& program,
                           const WantedState& wanted) {
  const Outline outline = outline_of(bytes, program);
  Unpacker unpacker(outline.entries, {bytes, outline.first_number, outline.numbers},
                    {bytes, outline.first_integer(), outline.integers}, wanted);
  Checkpoint checkpoint;
  transfer(unpacker, checkpoint);
  unpacker.require_end();
  return checkpoint;
}

void require_whole(const CheckpointBytes& bytes, const std::string& program) {
  const std::uint64_t end = outline_of(bytes, program).end();
  constexpr std::uint64_t most = 1 << 20;
  Checksum checksum;
  for (std::uint64_t at = 0; at < end; at += most) {
    checksum.add(bytes.read(at, std::min(most, end - at)));
  }
  std::uint64_t sum = 0;
  const std::string written = bytes.read(end, sizeof sum);
  std::memcpy(&sum, written.data(), std::min(sizeof sum, written.size()));
  if (checksum.sum() != sum) throw BadCheckpoint("is damaged: its checksum is wrong");
}

std::string encode(Checkpoint checkpoint, const std::string& program) {
  std::string bytes;
  write_checkpoint(std::move(checkpoint), program, nullptr,
                   [&](std::string_view part) { bytes += part; });
  return bytes;
}

Checkpoint decode(std::string_view bytes, const std::string& program) {
  const CheckpointBytes source{bytes.size(), [&](std::uint64_t first, std::uint64_t count) {
                                 return std::string(bytes.substr(first, count));
                               }};
  require_whole(source, program);
  return read_checkpoint(source, program, {});
}

}  // namespace peristat
