#include "cases/runner/input/givens.hpp"

#include <atomic>
#include <filesystem>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "cases/runner/input/case.hpp"
#include "cases/runner/input/case_inputs.hpp"
#include "cases/runner/setup/body.hpp"
#include "cases/runner/setup/part_body.hpp"
#include "src/core/input_error.hpp"

namespace peristat {
namespace {

/// A plate whose expressions stand in for words in capitals.
const std::string plate = R"(dimension = 2
[lattice]
spacing = 1
horizon_ratio = 3
thickness = 1
[[lattice.shape]]
add = "box"
min = [0, 0]
max = [20, 10]
[[lattice.layer]]
name = "left"
side = "x-"
where = "WHERE"
[[lattice.layer]]
name = "right"
side = "x+"
[[set]]
name = "some"
where = "WHERE"
[material]
youngs_modulus = 70e3
density = 1
[[material.scatter]]
of = "stiffness"
factor = "FACTOR"
[[support]]
set = "left"
displacement = ["FIELD", 0]
[[support]]
set = "right"
displacement = ["FIELD", "free"]
[[load]]
set = "some"
body_force = ["FIELD", "FIELD"]
[[load]]
set = "some"
total_force = ["TOTAL", 0]
[[eigenstrain]]
strain = "FIELD"
)";

std::string replaced_all(std::string text, const std::string& part, const std::string& by) {
  for (std::size_t at = text.find(part); at != std::string::npos;
       at = text.find(part, at + by.size())) {
    text.replace(at, part.size(), by);
  }
  return text;
}

std::string with_texts(const std::string& where, const std::string& factor,
                       const std::string& field, const std::string& total) {
  std::string text = replaced_all(plate, "WHERE", where);
  text = replaced_all(text, "FACTOR", factor);
  return replaced_all(replaced_all(text, "FIELD", field), "TOTAL", total);
}

double number_at(std::span<const double> of, std::size_t k) { return of[of.size() == 1 ? 0 : k]; }

/// field(x, load) = 1e-3*x*load, among others; counts calls.
std::shared_ptr<const Givens> counting_givens(int& calls) {
  const auto of = [&calls](auto value) {
    return [&calls, value](std::span<const std::span<const double>> arguments,
                           std::span<double> values) {
      ++calls;
      for (std::size_t k = 0; k < values.size(); ++k) values[k] = value(arguments, k);
    };
  };
  Givens givens;
  givens.functions["upper"] = {1, of([](auto arguments, std::size_t k) {
                                 return number_at(arguments[0], k) > 5 ? 1.0 : 0.0;
                               })};
  givens.functions["factor"] = {2, of([](auto arguments, std::size_t k) {
                                  return 1 + 0.01 * number_at(arguments[0], k) +
                                         0.02 * number_at(arguments[1], k);
                                })};
  givens.functions["field"] = {2, of([](auto arguments, std::size_t k) {
                                 return 1e-3 * number_at(arguments[0], k) *
                                        number_at(arguments[1], k);
                               })};
  givens.functions["total"] = {
      1, of([](auto arguments, std::size_t k) { return 3 * number_at(arguments[0], k); })};
  return std::make_shared<const Givens>(std::move(givens));
}

const std::string as_calls =
    with_texts("upper(y)", "factor(x, y)", "field(x, load)", "total(load)");
const std::string as_text = with_texts("y > 5", "1 + 0.01*x + 0.02*y", "1e-3*x*load", "3*load");

std::string refusal(const std::string& text, const std::shared_ptr<const Givens>& givens) {
  try {
    static_cast<void>(make_body(read_case("a.toml", text, {}, givens), 1));
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

void expect_same_conditions(const Body& a, const Body& b, double relative) {
  const auto expect = [&](const std::vector<double>& one, const std::vector<double>& other) {
    ASSERT_EQ(one.size(), other.size());
    double largest = 0.0;
    for (const double value : one) largest = std::max(largest, std::abs(value));
    EXPECT_GT(largest, 0.0);
    for (std::size_t k = 0; k < one.size(); ++k) {
      ASSERT_NEAR(one[k], other[k], relative * largest) << k;
    }
  };
  const LoadPoint half{0.5};
  for (const bool is_force : {false, true}) {
    const auto values = [&](const Body& body) {
      std::vector<double> all(body.conditions->constraints().dofs(), 0.0);
      is_force ? body.conditions->external_force(half, all) : body.conditions->prescribe(half, all);
      return all;
    };
    expect(values(a), values(b));
  }
  expect(a.conditions->environment(half)->eigenstretch,
         b.conditions->environment(half)->eigenstretch);
  EXPECT_EQ(a.points.sets, b.points.sets);
  expect(a.factors.stiffness, b.factors.stiffness);
}

TEST(Givens, AreTheSameBodyAsTheirExpressions) {
  int calls = 0;
  const Case called = read_case("a.toml", as_calls, {}, counting_givens(calls));
  EXPECT_EQ(calls, 0) << "reading calls no function";
  const auto body = make_body(called, 1);
  expect_same_conditions(*body, *make_body(read_case("a.toml", as_text, {}), 1), 0.0);
  EXPECT_NE(called.as_resolved.find("field(x, load)"), std::string::npos);
}

TEST(Givens, AreCalledOncePerSet) {
  int calls = 0;
  const auto body = make_body(read_case("a.toml", as_calls, {}, counting_givens(calls)), 1);
  std::vector<double> all(body->conditions->constraints().dofs());
  const auto calls_of = [&](const auto& work) {
    calls = 0;
    work();
    return calls;
  };
  const LoadPoint end{1.0};
  EXPECT_EQ(calls_of([&] { body->conditions->prescribe(end, all); }), 2);
  EXPECT_EQ(calls_of([&] { body->conditions->external_force(end, all); }), 3);
  EXPECT_EQ(calls_of([&] { static_cast<void>(body->conditions->environment(end)); }), 1);
}

TEST(Givens, HaveTheUnitsOfTheCase) {
  int calls = 0;
  const std::string units = "[units]\nlength = \"mm\"\nstress = \"MPa\"\n";
  const auto with_units = [&](const std::string& text) {
    return replaced_all(text, "[lattice]\n", units + "[lattice]\n");
  };
  const auto body =
      make_body(read_case("a.toml", with_units(as_calls), {}, counting_givens(calls)), 1);
  expect_same_conditions(*body, *make_body(read_case("a.toml", with_units(as_text), {}), 1), 1e-14);
  EXPECT_EQ(body->points.spacing, 1e-3);
  calls = 0;
  std::vector<double> all(body->conditions->constraints().dofs());
  body->conditions->prescribe({1.0}, all);
  EXPECT_EQ(calls, 2);
}

TEST(Givens, MayStandBesideUnits) {
  int calls = 0;
  const std::string text = replaced_all(as_calls, "[\"field(x, load)\", \"free\"]",
                                        "[\"2e-3 m*field(x, load)\", \"free\"]");
  const Case from = read_case("a.toml", text, {}, counting_givens(calls));
  EXPECT_EQ(*from.supports[1].displacement[0], "0.002*field(x, load)");
}

TEST(Givens, AreRefusedWithTheirNames) {
  int calls = 0;
  const auto givens = counting_givens(calls);
  const std::string unknown =
      refusal(with_texts("upper(y)", "factor(x, y)", "feld(x, load)", "0*load"), givens);
  EXPECT_NE(unknown.find("unknown function feld"), std::string::npos) << unknown;
  EXPECT_NE(unknown.find("did you mean field?"), std::string::npos) << unknown;
  Givens bad;
  bad.functions["sin"] = givens->functions.at("field");
  EXPECT_NE(
      refusal(as_text, std::make_shared<const Givens>(bad)).find("already has another meaning"),
      std::string::npos);
}

TEST(Givens, PassExceptionsOn) {
  int calls = 0;
  Givens givens = *counting_givens(calls);
  givens.functions["field"].fill = [](auto, auto) { throw std::out_of_range("mine"); };
  const Case from =
      read_case("a.toml", as_calls, {}, std::make_shared<const Givens>(std::move(givens)));
  EXPECT_THROW(static_cast<void>(make_body(from, 1)), std::out_of_range);
}

TEST(Givens, AreNamedInTheInputsOfARun) {
  int calls = 0;
  const auto givens = counting_givens(calls);
  const std::string lines = checksums_of_files(read_case("a.toml", as_calls, {}, givens));
  EXPECT_EQ(lines,
            "given function factor\ngiven function field\ngiven function total\n"
            "given function upper\n");
  EXPECT_NO_THROW(require_givens(lines, *givens));
  EXPECT_NO_THROW(require_givens("0123456789abcdef /given points\n", {}));
  try {
    require_givens(lines + "0123456789abcdef /a/file\n", {});
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_EQ(
        error.allowed(),
        "this run used functions or points of a program: function factor, function field, function "
        "total, function upper. Resume it in a program that gives them");
  }
}

TEST(Givens, AreForOneRank) {
  int calls = 0;
  const Case from = read_case("a.toml", as_calls, {}, counting_givens(calls));
  EXPECT_THROW(refuse_keys_without_ranks(from), InputError);
}

// ---- Points

const std::string cloud = R"(dimension = 2
[points]
FILE
horizon = 3.015e-3
thickness = 1e-3
[material]
youngs_modulus = 70e9
[[support]]
set = "held"
displacement = [0, 0]
[[load]]
set = "all"
body_force = ["heat*load", 0]
[[set]]
name = "all"
where = "heat > 0"
)";

/// A square of 12 x 12 points of 1 mm, in an order without locality.
Points square(double length) {
  Points points;
  points.dimension = 2;
  for (int number = 0; number < 144; ++number) {
    const int place = (number * 77) % 144;
    if (place / 12 < 2) points.sets["held"].push_back(number);
    points.reference.push_back(length * (place / 12));
    points.reference.push_back(length * (place % 12));
    points.volume.push_back(length * length * length);
    points.columns["heat"].push_back(1.0 + number);
  }
  return points;
}

std::shared_ptr<const Givens> given(Points points) {
  return std::make_shared<const Givens>(Givens{{}, std::move(points)});
}

TEST(GivenPoints, AreTheSameBodyAsTheirFile) {
  const Points points = square(1.0);
  const auto folder = std::filesystem::temp_directory_path() / "peristat_given_points";
  std::filesystem::create_directories(folder);
  std::ofstream file(folder / "points.csv");
  file << "x,y,volume,heat,set\n";
  for (Index i = 0; i < points.count(); ++i) {
    file << points.position(i)[0] << ',' << points.position(i)[1] << ",1,"
         << points.columns.at("heat")[std::size_t(i)] << ','
         << (points.position(i)[0] < 1.5 ? "held" : "") << '\n';
  }
  file.close();
  const std::string units = "length_unit = 1e-3\n";
  const auto of_file =
      make_body(read_case(folder / "a.toml",
                          replaced_all(cloud, "FILE", "file = \"points.csv\"\n" + units), {}),
                1);
  const Case from =
      read_case(folder / "a.toml", replaced_all(cloud, "FILE", units), {}, given(points));
  const auto body = make_body(from, 1);
  EXPECT_EQ(body->points.reference, of_file->points.reference);
  EXPECT_EQ(body->points.volume, of_file->points.volume);
  EXPECT_EQ(body->points.columns, of_file->points.columns);
  EXPECT_EQ(body->points.sets, of_file->points.sets);
  EXPECT_EQ(double(body->points.spacing), double(of_file->points.spacing));
  for (Index i = 0; i < body->points.count(); ++i) {
    const Index row = body->points.source_row[std::size_t(i)];
    EXPECT_EQ(body->points.position(i)[0], points.position(row)[0] / 1000);
  }
  EXPECT_EQ(from.as_resolved.find("file ="), std::string::npos);
  EXPECT_EQ(inputs_of(from).size(), 1u);
  EXPECT_EQ(checksums_of_files(from), "given points\n");
  // The resolved text is a case of the same points.
  EXPECT_EQ(read_case(folder / "a.toml", from.as_resolved, {}, given(points)).as_resolved,
            from.as_resolved);
  std::filesystem::remove_all(folder);
}

TEST(GivenPoints, GoWithNoOtherPoints) {
  const auto points = given(square(1e-3));
  const std::string text = replaced_all(cloud, "FILE", "");
  EXPECT_EQ(refusal(text, points), "accepted");
  for (const std::string line : {"file = \"points.csv\"", "neighbours = \"neighbours.csv\""}) {
    EXPECT_NE(refusal(replaced_all(cloud, "FILE", line), points).find("points."),
              std::string::npos);
  }
  EXPECT_NE(refusal(as_text, points).find("cannot be combined with points that a program gives"),
            std::string::npos);
  EXPECT_NE(refusal(text, std::make_shared<const Givens>()).find("points.file"), std::string::npos);
  EXPECT_NE(refusal(replaced_all(text, "dimension = 2", "dimension = 3"), points).find("dimension"),
            std::string::npos);
}

TEST(GivenPoints, AreCheckedLikeThoseOfAFile) {
  const std::string text = replaced_all(cloud, "FILE", "");
  const auto refused = [&](const auto& change) {
    Points points = square(1e-3);
    change(points);
    return refusal(text, given(std::move(points)));
  };
  const auto expect = [](const std::string& message, const std::string& part) {
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  expect(refused([](Points& p) { p.reference.pop_back(); }), "must have 288");
  expect(refused([](Points& p) { p.reference[3] = std::nan(""); }), "must be finite");
  expect(refused([](Points& p) { p.volume[3] = 0.0; }), "must be positive");
  expect(refused([](Points& p) { p.volume.clear(); }), "at least one");
  expect(refused([](Points& p) { p.sets["held"].push_back(144); }), "has point 144");
  expect(refused([](Points& p) { p.sets["held"].clear(); }), "has no point");
  expect(refused([](Points& p) { p.sets[""] = {1}; }), "1 to 100 characters");
  expect(refused([](Points& p) { p.columns["heat"].pop_back(); }), "must have 144");
  expect(refused([](Points& p) { p.columns["x"] = p.volume; }), "already has another meaning");
  expect(refused([](Points& p) { std::copy_n(p.reference.begin(), 2, p.reference.begin() + 10); }),
         "points 0 and 5 (from 0) have the same position");
}

}  // namespace
}  // namespace peristat
