#include "cases/runner/results/checkpoint.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "solvers/drivers/state_archive.hpp"

namespace peristat {
namespace {

constexpr std::string_view magic = "peristat checkpoint";

/// All values of a checkpoint in a row, to be read.
struct Packed {
  std::string entries;  ///< their names and sizes, a line each: see Entry
  std::vector<double> numbers;
  std::vector<std::int64_t> integers;
};

/// A named array of a checkpoint. Of a sparse one the places of what differs from `usual` stand
/// among the integers.
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

/// To the last bit: -0 is not 0.
bool is_same(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

/// As what an array is written: whole bonds and bodies at rest are full of zeros or ones.
Entry entry_for(const std::string& name, const std::vector<double>& values) {
  const auto others = [&](double usual) {
    return std::size_t(std::count_if(values.begin(), values.end(),
                                     [&](double value) { return !is_same(value, usual); }));
  };
  const std::size_t not_0 = others(0.0), not_1 = others(1.0), fewest = std::min(not_0, not_1);
  // A place takes as much room as a value.
  if (2 * fewest >= values.size()) return {name, values.size()};
  return {name, values.size(), fewest, true, not_0 <= not_1 ? 0.0 : 1.0};
}

template <class Value>
std::string_view bytes_of(const Value* values, std::size_t count) {
  return {reinterpret_cast<const char*>(values), count * sizeof(Value)};
}

/// Takes arrays away from what it packs, and keeps them as they are: beside a copy they would need
/// their memory twice.
class Packer : public StateArchive {
 public:
  void transfer(const std::string& name, bool& value) override { integer(name, value ? 1 : 0); }
  void transfer(const std::string& name, int& value) override { integer(name, value); }
  void transfer(const std::string& name, std::int64_t& value) override { integer(name, value); }
  void transfer(const std::string& name, double& value) override {
    entries_ << Entry{name, 1};
    numbers_.push_back({value});
  }
  void transfer(const std::string& name, std::vector<char>& values) override {
    integers(name, values);
  }
  void transfer(const std::string& name, std::vector<Index>& values) override {
    integers(name, values);
  }
  void transfer(const std::string& name, std::vector<double>& values) override {
    const Entry entry = entry_for(name, values);
    entries_ << entry;
    if (!entry.is_sparse) {
      numbers_.push_back(std::exchange(values, {}));
      return;
    }
    std::vector<double>& others = numbers_.emplace_back();
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (is_same(values[k], entry.usual)) continue;
      others.push_back(values[k]);
      integers_.push_back(static_cast<std::int64_t>(k));
    }
    values = std::vector<double>();
  }

  /// Entries, numbers and integers one after the other, behind how many there are of each.
  void visit(const VisitBytes& visit) const {
    const std::string entries = entries_.str();
    std::array<std::uint64_t, 3> sizes{entries.size(), 0, integers_.size()};
    for (const std::vector<double>& part : numbers_) sizes[1] += part.size();
    visit(bytes_of(sizes.data(), sizes.size()));
    visit(entries);
    for (const std::vector<double>& part : numbers_) visit(bytes_of(part.data(), part.size()));
    visit(bytes_of(integers_.data(), integers_.size()));
  }

 private:
  void integer(const std::string& name, std::int64_t value) {
    entries_ << Entry{name, 1};
    integers_.push_back(value);
  }
  template <class Value>
  void integers(const std::string& name, const std::vector<Value>& values) {
    entries_ << Entry{name, values.size()};
    integers_.insert(integers_.end(), values.begin(), values.end());
  }

  std::ostringstream entries_;
  std::vector<std::vector<double>> numbers_;
  std::vector<std::int64_t> integers_;
};

class Unpacker : public StateArchive {
 public:
  explicit Unpacker(Packed packed) : packed_(std::move(packed)), entries_(packed_.entries) {}

  void transfer(const std::string& name, bool& value) override { value = integer(name) != 0; }
  void transfer(const std::string& name, int& value) override { value = int(integer(name)); }
  void transfer(const std::string& name, std::int64_t& value) override { value = integer(name); }
  void transfer(const std::string& name, double& value) override {
    require(next(name).size == 1);
    value = take(packed_.numbers, next_number_);
  }
  void transfer(const std::string& name, std::vector<char>& values) override {
    integers(name, values);
  }
  void transfer(const std::string& name, std::vector<Index>& values) override {
    integers(name, values);
  }
  void transfer(const std::string& name, std::vector<double>& values) override {
    const Entry entry = next(name);
    const std::size_t written = entry.is_sparse ? entry.others : entry.size;
    require(written <= packed_.numbers.size() - next_number_);
    require(!entry.is_sparse || entry.size < most_values);
    values.assign(entry.size, entry.usual);
    for (std::size_t k = 0; k < written; ++k) {
      const std::size_t place =
          entry.is_sparse ? std::size_t(take(packed_.integers, next_integer_)) : k;
      require(place < values.size());
      values[place] = take(packed_.numbers, next_number_);
    }
  }

  void require_end() {
    std::string rest;
    require(!(entries_ >> rest) && next_number_ == packed_.numbers.size() &&
            next_integer_ == packed_.integers.size());
  }

 private:
  /// No body has more bonds: what claims to is damaged.
  static constexpr std::size_t most_values = std::size_t(1) << 40;

  static void require(bool holds) {
    if (!holds) throw BadCheckpoint("is damaged: its entries and its values disagree");
  }

  Entry next(const std::string& name) {
    std::string line;
    std::getline(entries_, line);
    Entry entry = parse_entry(line);
    if (entry.name != name) {
      throw BadCheckpoint("is damaged: it has " + entry.name + " in the place of " + name);
    }
    return entry;
  }

  template <class Value>
  static Value take(const std::vector<Value>& values, std::size_t& at) {
    require(at < values.size());
    return values[at++];
  }

  std::int64_t integer(const std::string& name) {
    require(next(name).size == 1);
    return take(packed_.integers, next_integer_);
  }

  template <class Value>
  void integers(const std::string& name, std::vector<Value>& values) {
    const Entry entry = next(name);
    require(entry.size <= packed_.integers.size() - next_integer_);
    values.clear();
    for (std::size_t k = 0; k < entry.size; ++k)
      values.push_back(static_cast<Value>(take(packed_.integers, next_integer_)));
  }

  Packed packed_;
  std::istringstream entries_;
  std::size_t next_number_ = 0, next_integer_ = 0;
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
  archive.transfer("unwritten/told_stretches", told_stretches);
  archive.transfer("unwritten/force", force);
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

/// FNV-1a over words of eight bytes [http://www.isthe.com/chongo/tech/comp/fnv] of pieces that
/// follow one another.
class Checksum {
 public:
  void add(std::string_view piece) {
    while (!piece.empty()) {
      const std::size_t taken = std::min(sizeof word_ - filled_, piece.size());
      std::memcpy(reinterpret_cast<char*>(&word_) + filled_, piece.data(), taken);
      piece.remove_prefix(taken);
      filled_ += taken;
      if (filled_ == sizeof word_) take_word();
    }
  }
  [[nodiscard]] std::uint64_t value() {
    if (filled_ > 0) take_word();
    return sum_;
  }

 private:
  void take_word() {
    sum_ = (sum_ ^ word_) * 0x100000001b3u;
    sum_ ^= sum_ >> 32;  // what a multiplication does to high bits alone reaches the low ones, too
    word_ = 0;
    filled_ = 0;
  }

  std::uint64_t sum_ = 0xcbf29ce484222325u, word_ = 0;
  std::size_t filled_ = 0;
};

/// Bytes, taken from the front.
class Bytes {
 public:
  explicit Bytes(std::string_view bytes) : whole_(bytes), rest_(bytes) {}

  std::string_view take(std::uint64_t size) {
    if (size > rest_.size()) throw BadCheckpoint("is damaged: it is not whole");
    const std::string_view taken = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return taken;
  }
  std::string line() { return std::string(take(rest_.find('\n') + 1)); }
  template <class Value>
  std::vector<Value> values(std::uint64_t count) {
    if (count > rest_.size() / sizeof(Value)) throw BadCheckpoint("is damaged: it is not whole");
    std::vector<Value> values(count);
    const std::string_view taken = take(count * sizeof(Value));
    if (!taken.empty()) std::memcpy(values.data(), taken.data(), taken.size());
    return values;
  }
  [[nodiscard]] std::string_view taken() const {
    return whole_.substr(0, whole_.size() - rest_.size());
  }

 private:
  std::string_view whole_, rest_;
};

/// "peristat checkpoint 1 0.1.0": the layout, and the version of the program that has written it.
std::string head_line(const std::string& program) {
  return std::string(magic) + ' ' + std::to_string(checkpoint_layout) + ' ' + program + '\n';
}

void check_head(const std::string& line, const std::string& program) {
  std::int64_t layout = 0;
  std::string writer;
  std::istringstream words(line.starts_with(magic) ? line.substr(magic.size()) : "");
  if (!(words >> layout >> writer)) throw BadCheckpoint("is damaged: it does not begin as one");
  if (layout == checkpoint_layout) return;
  throw BadCheckpoint("has layout " + std::to_string(layout) + " of peristat " + writer +
                      "; this is peristat " + program + ", which goes on from layout " +
                      std::to_string(checkpoint_layout));
}

}  // namespace

void encode(Checkpoint checkpoint, const std::string& program, const VisitBytes& visit) {
  Packer packer;
  transfer(packer, checkpoint);
  Checksum checksum;
  const auto pass_on = [&](std::string_view piece) {
    checksum.add(piece);
    visit(piece);
  };
  pass_on(head_line(program));
  packer.visit(pass_on);
  const std::uint64_t sum = checksum.value();
  visit(bytes_of(&sum, 1));
}

Checkpoint decode(std::string_view bytes, const std::string& program) {
  Bytes rest(bytes);
  check_head(rest.line(), program);
  const auto sizes = rest.values<std::uint64_t>(3);
  Packed packed;
  packed.entries = rest.take(sizes[0]);
  packed.numbers = rest.values<double>(sizes[1]);
  packed.integers = rest.values<std::int64_t>(sizes[2]);
  Checksum checksum;
  checksum.add(rest.taken());
  if (rest.values<std::uint64_t>(1).front() != checksum.value()) {
    throw BadCheckpoint("is damaged: its checksum is wrong");
  }
  Unpacker unpacker(std::move(packed));
  Checkpoint checkpoint;
  transfer(unpacker, checkpoint);
  unpacker.require_end();
  return checkpoint;
}

}  // namespace peristat
