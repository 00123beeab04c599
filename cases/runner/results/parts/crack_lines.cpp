#include "cases/runner/results/parts/crack_lines.hpp"

#include "cases/runner/results/tables/record_tables.hpp"

namespace peristat {
namespace {

constexpr const char* lines_within = "/cracks/within";

}  // namespace

CrackLines::CrackLines(Hdf5File& file, bool has_images) : file_(file), has_images_(has_images) {
  file_.make_group("/cracks");
  if (has_images_) file_.make_table(lines_within, broken_bond_columns());
}

void CrackLines::add(const Row& broken_bond) {
  const bool is_within = std::get<std::int64_t>(broken_bond.back()) == 0;  // second_image
  if (!is_within) return;
  ++count_;
  if (has_images_) pending_.push_back(broken_bond);
}

void CrackLines::append_pending() {
  if (has_images_) file_.append(lines_within, broken_bond_columns(), pending_);
  pending_.clear();
}

XdmfSeries::Lines CrackLines::lines_of(const std::string& step) {
  if (count_ == 0) return {};
  const std::string group = "/cracks/" + step, table = has_images_ ? lines_within : "/broken_bonds";
  const auto column = [&](const char* name, std::uint64_t place) {
    return Hdf5File::ViewedRows{{".", table + "/" + name}, {count_}, 0, place};
  };
  file_.make_group(group);
  file_.write_view<std::int64_t>(group + "/bonds", {count_, 2},
                                 {column("first_point", 0), column("second_point", 1)},
                                 {"1", "points of the bonds that have broken up to this step"});
  file_.write_view<std::int64_t>(group + "/step", {count_}, {column("step", 0)},
                                 {"1", "step that broke each of them"});
  return {group, count_};
}

}  // namespace peristat
