#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "assembly/assembler.hpp"
#include "assembly/terms/bonds/bond_term.hpp"
#include "assembly/terms/model.hpp"
#include "tests/bodies.hpp"

namespace peristat {
namespace {

using tests::BoxBody;
using tests::distance;
using tests::norm;
using tests::upper_points;

void begin(Write how, std::span<double> result) {
  if (how == Write::over) std::fill(result.begin(), result.end(), 0.0);
}

/// Springs that pull every point back to where it was: E = k/2 sum_i |u_i|^2. Couples nothing.
class Foundation : public Term {
 public:
  Foundation(double stiffness, Index points) : stiffness_(stiffness), no_rows_(points + 1, 0) {}

  [[nodiscard]] Couplings couplings() const override { return {no_rows_, {}}; }
  [[nodiscard]] bool has_symmetric_blocks() const override { return true; }
  [[nodiscard]] Balances balances() const override { return {false, false, true}; }
  [[nodiscard]] std::unique_ptr<TermPasses> passes(const TermSetting& setting) const override;

 private:
  double stiffness_;
  std::vector<Offset> no_rows_;
};

class FoundationPasses : public TermPasses, BlockTangent {
 public:
  FoundationPasses(double stiffness, int dimension) : k_(stiffness), d_(dimension) {}

  Evaluation gradient(const StateView& at, std::span<double> gradient, Write how) override {
    begin(how, gradient);
    Evaluation found;
    for (std::size_t i = 0; i < at.displacement.size(); ++i) {
      found.energy += 0.5 * k_ * at.displacement[i] * at.displacement[i];
      if (!gradient.empty()) gradient[i] += k_ * at.displacement[i];
    }
    return found;
  }
  [[nodiscard]] TangentForms forms() override { return {.blocks = this}; }
  void tangent(const StateView&, Tangent& tangent, double, Write how) override {
    if (how == Write::over) tangent.clear();
    const auto d = std::size_t(d_);
    for (std::size_t k = 0; k < tangent.diagonal.size(); ++k) {
      if (k / d % d == k % d) tangent.diagonal[k] += k_;
    }
  }
  void product(const StateView&, std::span<const double> v, double, std::span<double> product,
               Write how) override {
    begin(how, product);
    for (std::size_t i = 0; i < v.size(); ++i) product[i] += k_ * v[i];
  }
  void point_energies(const StateView& at, std::span<double> energies, Write how) override {
    begin(how, energies);
    for (std::size_t i = 0; i < at.displacement.size(); ++i) {
      energies[i / std::size_t(d_)] += 0.5 * k_ * at.displacement[i] * at.displacement[i];
    }
  }

 private:
  double k_;
  int d_;
};

std::unique_ptr<TermPasses> Foundation::passes(const TermSetting& setting) const {
  return std::make_unique<FoundationPasses>(stiffness_, setting.points.dimension);
}

/// A value per point first, then forces: theta_i = sum_j |u_j - u_i|^2 over its bonds, E = k/2
/// sum_i theta_i^2. Couples the neighbours of a point with each other.
class PointState : public Term {
 public:
  PointState(double stiffness, const Bonds& bonds) : stiffness_(stiffness) {
    near_.resize(std::size_t(bonds.points()));
    tests::for_each_bond(bonds, [&](Index i, Index j, Offset) {
      near_[std::size_t(i)].push_back(j);
      near_[std::size_t(j)].push_back(i);
    });
    std::vector<std::set<Index>> above(near_.size());
    for (std::size_t i = 0; i < near_.size(); ++i) {
      std::vector<Index> all = near_[i];
      all.push_back(Index(i));
      for (const Index a : all) {
        for (const Index b : all) {
          if (a < b) above[std::size_t(a)].insert(b);
        }
      }
    }
    offset_.push_back(0);
    PartnersBuilder partners;
    for (const auto& row : above) {
      partners.add(row);
      offset_.push_back(offset_.back() + Offset(row.size()));
    }
    partner_ = partners.take();
  }

  [[nodiscard]] const std::vector<std::vector<Index>>& near() const { return near_; }
  [[nodiscard]] double stiffness() const { return stiffness_; }
  [[nodiscard]] Couplings couplings() const override { return {offset_, partner_}; }
  [[nodiscard]] Balances balances() const override { return {true, false, true}; }
  [[nodiscard]] std::unique_ptr<TermPasses> passes(const TermSetting& setting) const override;

 private:
  double stiffness_;
  std::vector<std::vector<Index>> near_;
  std::vector<Offset> offset_;
  Partners partner_;
};

class PointStatePasses : public TermPasses, BlockTangent {
 public:
  PointStatePasses(const PointState& term, const TermSetting& setting)
      : term_(term),
        pattern_(setting.pattern),
        d_(std::size_t(setting.points.dimension)),
        theta_(term.near().size()) {}

  Evaluation gradient(const StateView& at, std::span<double> gradient, Write how) override {
    begin(how, gradient);
    Evaluation found;
    find_states(at);
    for (std::size_t i = 0; i < theta_.size(); ++i) {
      found.energy += 0.5 * term_.stiffness() * theta_[i] * theta_[i];
      if (gradient.empty()) continue;
      for (const Index j : term_.near()[i]) {
        for (std::size_t c = 0; c < d_; ++c) {
          const double force = 2.0 * term_.stiffness() * theta_[i] * arm(at, i, j, c);
          gradient[std::size_t(j) * d_ + c] += force;
          gradient[i * d_ + c] -= force;
        }
      }
    }
    return found;
  }

  [[nodiscard]] TangentForms forms() override { return {.blocks = this}; }
  void tangent(const StateView& at, Tangent& tangent, double, Write how) override {
    if (how == Write::over) tangent.clear();
    for_each_entry(at, [&](std::size_t row, std::size_t column, double value) {
      const std::size_t a = row / d_, b = column / d_, r = row % d_, c = column % d_;
      if (a == b) tangent.diagonal[(a * d_ + r) * d_ + c] += value;
      if (a >= b) return;  // the upper half is stored
      std::vector<double> block(d_ * d_, 0.0);
      block[r * d_ + c] = value;
      tangent.add_to_block(place(Index(a), Index(b)), block);
    });
  }

  void product(const StateView& at, std::span<const double> v, double, std::span<double> product,
               Write how) override {
    begin(how, product);
    for_each_entry(at, [&](std::size_t row, std::size_t column, double value) {
      product[row] += value * v[column];
    });
  }

  void point_energies(const StateView& at, std::span<double> energies, Write how) override {
    begin(how, energies);
    find_states(at);
    for (std::size_t i = 0; i < theta_.size(); ++i) {
      energies[i] += 0.5 * term_.stiffness() * theta_[i] * theta_[i];
    }
  }

 private:
  [[nodiscard]] double arm(const StateView& at, std::size_t i, Index j, std::size_t c) const {
    return at.displacement[std::size_t(j) * d_ + c] - at.displacement[i * d_ + c];
  }
  void find_states(const StateView& at) {
    for (std::size_t i = 0; i < theta_.size(); ++i) {
      theta_[i] = 0.0;
      for (const Index j : term_.near()[i]) {
        for (std::size_t c = 0; c < d_; ++c) theta_[i] += arm(at, i, j, c) * arm(at, i, j, c);
      }
    }
  }
  [[nodiscard]] Offset place(Index a, Index b) const {
    const auto row = pattern_.of(a);
    return pattern_.offset[a] + (std::find(row.begin(), row.end(), b) - row.begin());
  }
  /// visit(row, column, entry) for the parts of k (grad theta grad theta^T + theta hess theta).
  template <class Visit>
  void for_each_entry(const StateView& at, const Visit& visit) {
    find_states(at);
    for (std::size_t i = 0; i < theta_.size(); ++i) {
      std::vector<std::pair<std::size_t, double>> slope;
      for (const Index j : term_.near()[i]) {
        for (std::size_t c = 0; c < d_; ++c) {
          const std::size_t own = i * d_ + c, other = std::size_t(j) * d_ + c;
          slope.push_back({other, 2.0 * arm(at, i, j, c)});
          slope.push_back({own, -2.0 * arm(at, i, j, c)});
          const double second = 2.0 * term_.stiffness() * theta_[i];
          for (const auto& [row, column, sign] : {std::tuple(own, own, 1.0),
                                                  {other, other, 1.0},
                                                  {own, other, -1.0},
                                                  {other, own, -1.0}}) {
            visit(row, column, sign * second);
          }
        }
      }
      for (const auto& [row, a] : slope) {
        for (const auto& [column, b] : slope) visit(row, column, term_.stiffness() * a * b);
      }
    }
  }

  const PointState& term_;
  const BlockPattern& pattern_;
  std::size_t d_;
  std::vector<double> theta_;
};

std::unique_ptr<TermPasses> PointState::passes(const TermSetting& setting) const {
  return std::make_unique<PointStatePasses>(*this, setting);
}

/// Forces without a potential: every point pulls the one before it, dE/dx_i = k (u_i - u_(i+1)) for
/// energies that there are not. Couples nothing in blocks.
class Chase : public Term {
 public:
  Chase(double stiffness, Index points) : stiffness_(stiffness), no_rows_(points + 1, 0) {}

  [[nodiscard]] Couplings couplings() const override { return {no_rows_, {}}; }
  [[nodiscard]] TangentKind tangent_kind() const override { return TangentKind::rows; }
  [[nodiscard]] Balances balances() const override { return {.potential = false}; }
  [[nodiscard]] std::unique_ptr<TermPasses> passes(const TermSetting& setting) const override;

 private:
  double stiffness_;
  std::vector<Offset> no_rows_;
};

class ChasePasses : public TermPasses, RowOperator {
 public:
  ChasePasses(double stiffness, const Points& points)
      : k_(stiffness), d_(std::size_t(points.dimension)), dofs_(points.reference.size()) {}

  Evaluation gradient(const StateView& at, std::span<double> gradient, Write how) override {
    product(at, at.displacement, 0.0, gradient, how);
    return {};
  }
  [[nodiscard]] TangentForms forms() override { return {.rows = this, .products = this}; }
  void product(const StateView&, std::span<const double> v, double, std::span<double> product,
               Write how) override {
    begin(how, product);
    for (std::size_t row = 0; row < product.size(); ++row) {
      product[row] += k_ * (v[row] - v[next(row)]);
    }
  }
  [[nodiscard]] SparseRows rows(const StateView&, RowReach) override {
    SparseRows made{{0}, {}, {}};
    for (std::size_t row = 0; row < dofs_; ++row) {
      const bool is_last = next(row) < row;
      for (const bool is_own : {!is_last, is_last}) {
        made.column.push_back(Index(is_own ? row : next(row)));
        made.value.push_back(is_own ? k_ : -k_);
      }
      made.offset.push_back(Offset(made.column.size()));
    }
    return made;
  }
  [[nodiscard]] double bytes_of_rows() const override { return 1.0; }
  void outline(const StateView&, std::span<double> diagonal, std::span<double> sums) override {
    for (std::size_t row = 0; row < dofs_; ++row) {
      diagonal[row * d_ + row % d_] += k_;
      sums[row] += 2.0 * k_;
    }
  }
  [[nodiscard]] LatticeStencil stencil(const StateView&) override { return {}; }
  void point_energies(const StateView&, std::span<double> energies, Write how) override {
    begin(how, energies);
  }

 private:
  [[nodiscard]] std::size_t next(std::size_t row) const { return (row + d_) % dofs_; }

  double k_;
  std::size_t d_, dofs_;
};

std::unique_ptr<TermPasses> Chase::passes(const TermSetting& setting) const {
  return std::make_unique<ChasePasses>(stiffness_, setting.points);
}

/// A body with triangles whose energy comes from terms of several kinds, in different orders.
struct Composed {
  BoxBody body;
  std::string terms;
  Model model;

  Composed(int dimension, const std::string& order) : body(box(dimension)), terms(order) {
    model = Model(body.model.bonds());
    const auto scale = std::visit([](const auto& law) { return law.modulus; }, body.potential());
    const auto bonds = body.model.bond_failure();
    for (const char kind : order) {
      if (kind == 'b') model.add(std::make_shared<BondTerm>(bonds));
      if (kind == 'f') model.add(std::make_shared<Foundation>(1e-7 * scale, body.points.count()));
      if (kind == 's') model.add(std::make_shared<PointState>(1e-5 * scale, body.model.bonds()));
      if (kind == 'c') model.add(std::make_shared<Chase>(1e-5 * scale, body.points.count()));
      if (kind == 't') {
        model.add(std::make_shared<SimplexTerm>(bonds, body.simplex_term()->triangles(),
                                                body.simplex_term()->tetrahedra()));
      }
    }
  }

  static tests::BoxSetting box(int dimension) {
    tests::BoxSetting box = tests::small_box(dimension);
    box.extent = dimension == 2 ? std::array{6, 5, 0} : std::array{4, 3, 3};
    if (dimension == 2) box.triangles = 0.7;
    if (dimension == 3) box.tetrahedra = 0.7;
    return box;
  }
};

class Terms : public ::testing::TestWithParam<std::tuple<int, std::string>> {};

// With differences: no term knows of the others, of its place among them, or of the number of
// threads.
TEST_P(Terms, DerivativesAreThoseOfTheirSum) {
  const auto& [dimension, order] = GetParam();
  const Composed composed(dimension, order);
  const BoxBody& body = composed.body;
  const std::vector<double> state = body.random_state(3);
  const std::vector<double> v = tests::Random(4).vector(body.dofs());
  for (const int threads : {1, 3}) {
    Assembler assembler(body.points, composed.model, threads);
    Tangent tangent(assembler);
    const std::size_t n = body.dofs();
    // Of whatever was there before nothing may stay.
    std::vector<double> gradient(n, 1e9), product(n, 1e9), energies(body.points.volume.size(), 1e9);
    std::fill(tangent.diagonal.begin(), tangent.diagonal.end(), 1e9);
    std::fill(tangent.off_diagonal.begin(), tangent.off_diagonal.end(), 1e9);
    const double energy = assembler.gradient(state, gradient).energy;
    assembler.tangent(state, tangent);
    assembler.product(state, v, product);
    assembler.point_energies(state, energies);
    ASSERT_GT(energy, 0.0);
    EXPECT_NEAR(assembler.energy(state).energy / energy, 1.0, 1e-14);
    double sum = 0.0;
    for (const double of_point : energies) sum += of_point;
    EXPECT_NEAR(sum / energy, 1.0, 1e-13);

    const double step = 1e-6 * body.points.spacing;
    std::vector<double> forward = state, backward = state;
    for (std::size_t i = 0; i < n; ++i) {
      forward[i] += step * v[i];
      backward[i] -= step * v[i];
    }
    std::vector<double> ahead(n), behind(n);
    const double rise =
        assembler.gradient(forward, ahead).energy - assembler.gradient(backward, behind).energy;
    // Central differences of step 1e-6: their error is 1e-12, round-off 1e-16 / 1e-6.
    EXPECT_NEAR(rise / (2.0 * step) / tests::dot(gradient, v), 1.0, 1e-7);
    for (std::size_t i = 0; i < n; ++i) ahead[i] = (ahead[i] - behind[i]) / (2.0 * step);
    EXPECT_LE(distance(product, ahead), 1e-7 * norm(product));

    std::vector<double> stored(n);
    tangent.multiply(v, stored);
    EXPECT_LE(distance(product, stored), 1e-13 * norm(product));
  }
}

INSTANTIATE_TEST_SUITE_P(Orders, Terms,
                         ::testing::Combine(::testing::Values(2, 3),
                                            ::testing::Values("b", "t", "f", "s", "bf", "fb", "bs",
                                                              "sb", "bt", "tb", "bts", "stb",
                                                              "tsfb")),
                         [](const auto& tested) {
                           return "In" + std::to_string(std::get<0>(tested.param)) + "D_" +
                                  std::get<1>(tested.param);
                         });

class Rows : public ::testing::TestWithParam<std::string> {};

// Rows of all terms are added, whether these have rows, blocks or diagonal blocks alone.
TEST_P(Rows, AreThoseOfAllTerms) {
  const Composed composed(2, GetParam());
  const BoxBody& body = composed.body;
  const std::vector<double> state = body.random_state(3);
  const std::vector<double> v = tests::Random(4).vector(body.dofs());
  Assembler assembler(body.points, composed.model, 2);
  const SparseRows rows = assembler.rows(state, RowReach::whole);
  std::vector<double> diagonal(2 * body.dofs()), sums(body.dofs()), product(body.dofs());
  assembler.outline(state, diagonal, sums);
  assembler.product(state, v, product);
  ASSERT_EQ(std::size_t(rows.rows()), body.dofs());
  std::vector<double> found(body.dofs());
  for (std::size_t row = 0; row < found.size(); ++row) {
    double sum = 0.0;
    for (auto k = std::size_t(rows.offset[row]); k < std::size_t(rows.offset[row + 1]); ++k) {
      const auto column = std::size_t(rows.column[k]);
      if (k > std::size_t(rows.offset[row])) {
        EXPECT_GT(rows.column[k], rows.column[k - 1]);
      }
      found[row] += rows.value[k] * v[column];
      sum += std::abs(rows.value[k]);
      if (column / 2 != row / 2) continue;
      EXPECT_NEAR(rows.value[k], diagonal[2 * row + column % 2], 1e-13 * sums[row]);
    }
    EXPECT_LE(sum, sums[row] * (1.0 + 1e-13));
  }
  EXPECT_LE(distance(product, found), 1e-13 * norm(product));
}

INSTANTIATE_TEST_SUITE_P(Orders, Rows, ::testing::Values("c", "cf", "fc", "cc", "cb", "bsc", "b"),
                         [](const auto& tested) { return tested.param; });

TEST(ModelOfTerms, HasThePatternOfAllOfThem) {
  const Composed bonds(2, "b"), both(2, "bt"), wide(2, "bs"), none(2, "f");
  const Couplings rows = bonds.model.bonds();
  // A view, not a copy, where one term has all blocks.
  EXPECT_TRUE(bonds.model.pattern().is_same_view(bonds.model.terms()[0]->couplings()));
  EXPECT_EQ(upper_points(both.model.pattern()), upper_points(rows));
  EXPECT_GT(wide.model.pattern().blocks(), rows.partner.size());
  EXPECT_EQ(upper_points(wide.model.pattern()), upper_points(wide.model.terms()[1]->couplings()));
  EXPECT_EQ(none.model.pattern().blocks(), 0);
  EXPECT_EQ(none.model.pattern().points(), none.body.points.count());
  const std::vector<Offset> places = wide.model.pattern().places_of(rows);
  ASSERT_EQ(Offset(places.size()), rows.partner.size());
  const std::vector<Index> all = upper_points(wide.model.pattern()), upper = upper_points(rows);
  for (std::size_t k = 0; k < places.size(); ++k) {
    EXPECT_EQ(all[std::size_t(places[k])], upper[k]);
  }
  EXPECT_THROW(static_cast<void>(bonds.model.pattern().places_of(wide.model.pattern())),
               std::logic_error);
}

TEST(ModelOfTerms, OwesWhatEachOfThemDoes) {
  EXPECT_TRUE(Composed(2, "bt").model.balances().force_sum);
  EXPECT_TRUE(Composed(2, "bt").model.balances().moment_sum);
  EXPECT_FALSE(Composed(2, "bs").model.balances().moment_sum);
  EXPECT_FALSE(Composed(2, "bf").model.balances().force_sum);
  EXPECT_EQ(Composed(2, "b").model.tangent_kind(), TangentKind::visited);
  EXPECT_EQ(Composed(2, "bf").model.tangent_kind(), TangentKind::stored);
  EXPECT_EQ(Composed(2, "cb").model.tangent_kind(), TangentKind::rows);
  EXPECT_TRUE(Composed(2, "bf").model.has_symmetric_blocks());
  EXPECT_FALSE(Composed(2, "bt").model.has_symmetric_blocks());
}

TEST(ModelOfTerms, WithoutAnyHasNoEnergy) {
  const BoxBody body(tests::small_box(2));
  EXPECT_THROW(Assembler(body.points, Model(body.model.bonds()), 1), std::logic_error);
}

}  // namespace
}  // namespace peristat
