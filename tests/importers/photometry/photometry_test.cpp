#include "importers/photometry/photometry.h"

#include <gtest/gtest.h>

#include <functional>

#include "pipeline/optics/lights/light_distribution.h"
#include "tests/expect_error.h"
#include "tests/importers/photometry/lamp_files.h"

namespace patchlight::test {
namespace {

Photometry read(const std::string& text, const std::string& name = "lamp.ies") {
  return read_photometry(text, name, [](const std::string&) -> std::string { return "1 2 0 90 1 0.5"; });
}

Vec3d direction_at(double vertical, double horizontal) {
  const double v = vertical * kPi / 180, h = horizontal * kPi / 180;
  return {std::sin(v) * std::cos(h), std::sin(v) * std::sin(h), -std::cos(v)};
}

double candela_at(const Photometry& lamp, double vertical, double horizontal) {
  return lamp.candela * relative_intensity(lamp.distribution, direction_at(vertical, horizontal));
}

using Of = std::function<double(double, double)>;

void expect_candela(const Photometry& lamp, const Of& of, const std::string& what, double low = 0, double high = 180) {
  for (int k = 0; k < 300; ++k) {
    const double v = std::fmod(k * 37.3, 180.0), h = std::fmod(k * 101.7, 360.0);
    const double expected = v >= low && v <= high ? of(v, h) : 0.0;
    ASSERT_NEAR(candela_at(lamp, v, h), expected, 0.002 * lamp.candela) << what << " " << v << " " << h;
  }
}

TEST(Photometry, OfLm63IsReadInEveryVersion) {
  const std::vector<double> v = angles(0, 180, 2.5), h = angles(0, 360, 5);
  for (const char* header : {"", "any text\n", "IESNA91\n[TEST] 1\n", "IESNA:LM-63-1995\n[TEST] 1\n",
                             "IESNA:LM-63-2002\r\n[TEST] 1\r\n", "IES:LM-63-2019\n[TEST] 1\n[_OWN] x\n"}) {
    expect_candela(read(ies_text(v, h, lopsided, header)), lopsided, header);
  }
}

TEST(Photometry, OfLm63IsMultipliedByItsFactors) {
  const std::vector<double> v = angles(0, 180, 5), h = {0};
  const auto even = [](double, double) { return 100.0; };
  EXPECT_NEAR(read(ies_text(v, h, even, "IESNA91\n", 2.5)).candela, 100, 1e-3) << "the file has a 2.5th";
  EXPECT_NEAR(read(ies_text(v, h, even, "IESNA91\n", 1, "0.9 0.5 20")).candela, 45, 1e-3);
  EXPECT_NEAR(read(ies_text(v, h, even, "IESNA:LM-63-1995\n", 1, "0.9 0.5 20")).candela, 45, 1e-3);
  EXPECT_NEAR(read(ies_text(v, h, even, "IESNA:LM-63-2002\n", 1, "0.9 0.5 20")).candela, 90, 1e-3);
  EXPECT_NEAR(read(ies_text(v, h, even, "IES:LM-63-2019\n", 1, "0.9 1.10000 20")).candela, 90, 1e-3)
      << "the type of the file is no factor";
}

TEST(Photometry, IsMirroredWhereItIsSymmetric) {
  const std::vector<double> v = angles(0, 180, 2.5);
  const auto folded = [](double angle) { return std::abs(std::remainder(angle, 360)); };  // 0 to 180
  const Of about_c0 = [=](double a, double b) { return lopsided(a, folded(b)); };
  const Of about_c90 = [=](double a, double b) { return lopsided(a, 90 + folded(b - 90)); };
  const Of quadrants = [=](double a, double b) { return lopsided(a, 90 - std::abs(90 - folded(b))); };
  const Of rotational = [](double a, double) { return lopsided(a, 30); };
  struct Case {
    const char* name;
    Of of;
    std::vector<double> horizontal;
    int symmetry;
  };
  const std::vector<Case> cases{
      {"none", lopsided, angles(0, 360, 5), 0},      {"open", lopsided, angles(0, 355, 5), 0},
      {"about C0", about_c0, angles(0, 180, 5), 2},  {"about C90", about_c90, angles(90, 270, 5), 3},
      {"quadrants", quadrants, angles(0, 90, 5), 4}, {"rotational", rotational, {0}, 1}};
  for (const Case& one : cases) {
    expect_candela(read(ies_text(v, one.horizontal, one.of)), one.of, std::string("LM-63, ") + one.name);
    expect_candela(read(ldt_text(one.symmetry, 72, 2000, v, one.of), "lamp.LDT"), one.of,
                   std::string("EULUMDAT, ") + one.name);
  }
}

TEST(Photometry, EndsAtItsLastAngle) {
  expect_candela(
      read(ies_text(angles(0, 90, 2.5), {0}, [](double v, double) { return lopsided(v, 0); })),
      [](double v, double) { return lopsided(v, 0); }, "down", 0, 90);
  expect_candela(read(ies_text(angles(90, 180, 2.5), angles(0, 360, 5), lopsided)), lopsided, "up", 90, 180);
}

TEST(Photometry, OfEulumdatIsPerThousandLumensOfTheFirstLampSet) {
  const auto even = [](double, double) { return 100.0; };
  std::string text = ldt_text(1, 4, 500, {0, 90, 180}, even);
  EXPECT_NEAR(read(text, "a.ldt").candela, 100, 1e-9);
  const auto replaced = [&](const std::string& from, const std::string& to) {
    std::string other = text;
    other.replace(other.find(from), from.size(), to);
    return other;
  };
  EXPECT_NEAR(read(replaced("80\r\n1.0\r\n", "80\r\n1,5\r\n"), "a.ldt").candela, 150, 1e-9) << "a decimal comma";
  EXPECT_NEAR(read(replaced("0\r\n1\r\n2\r\n", "0\r\n2\r\n2\r\n")
                       .replace(text.find("0.5\r\n"), 0, "1\r\nx\r\n9\r\n\r\n\r\n9\r\n"),
                   "a.ldt")
                  .candela,
              100, 1e-9)
      << "a second set";
  EXPECT_NEAR(read(ies_text({0, 90, 180}, {0}, even), "misnamed.ldt").candela, 100, 1e-9) << "LM-63 by its content";
}

TEST(Photometry, OfTypesAAndBHasItsBeamAlongTheNadir) {
  // 20 degrees to the side and 10 degrees up, seen against the axes.
  const auto beam = [](double v, double h) {
    return 100 * std::exp(-((v - 10) * (v - 10) + (h - 20) * (h - 20)) / 200);
  };
  for (const int type : {2, 3}) {
    std::string text = ies_text(angles(-90, 90, 2), angles(-90, 90, 2), beam);
    text.replace(text.find(" 1 2 0 0 0"), 10, fmt::format(" {} 2 0 0 0", type));
    const Photometry lamp = read(text);
    const double v = 10 * kPi / 180, h = 20 * kPi / 180;
    const Vec3d b(std::cos(h) * std::sin(v), -std::sin(h), -std::cos(h) * std::cos(v));
    const Vec3d a(std::cos(v) * std::sin(h), std::sin(v), -std::cos(v) * std::cos(h));
    EXPECT_NEAR(relative_intensity(lamp.distribution, type == 2 ? b : a), 1, 1e-6);
    EXPECT_LT(relative_intensity(lamp.distribution, type == 2 ? a : b), 0.9);
    EXPECT_EQ(relative_intensity(lamp.distribution, {0, 0, 1}), 0) << "behind";
    text = ies_text(angles(0, 90, 2), angles(0, 90, 2), beam);
    text.replace(text.find(" 1 2 0 0 0"), 10, fmt::format(" {} 2 0 0 0", type));
    const Photometry mirrored = read(text);
    for (const double x : {-1.0, 1.0})
      for (const double y : {-1.0, 1.0})
        EXPECT_NEAR(relative_intensity(mirrored.distribution, (type == 2 ? b : a) * Vec3d(x, y, 1)), 1, 1e-6);
  }
}

TEST(Photometry, IsTiltedByItsTable) {
  std::string text = ies_text({0, 90}, {0}, [](double, double) { return 10.0; });
  EXPECT_EQ(read(text).tilt_factor(40), 1);
  const std::string none = "TILT=NONE";
  text.replace(text.find(none), none.size(), "TILT=INCLUDE\n1\n3\n0 30 90\n1 0.8 0.7");
  const Photometry included = read(text);
  EXPECT_NEAR(included.candela, 10, 1e-9);
  EXPECT_NEAR(included.tilt_factor(15), 0.9, 1e-12);
  EXPECT_NEAR(included.tilt_factor(60), 0.75, 1e-12);
  EXPECT_NEAR(included.tilt_factor(170), 0.7, 1e-12);
  text = ies_text({0, 90}, {0}, [](double, double) { return 10.0; });
  text.replace(text.find(none), none.size(), "TILT=lamp.tlt");
  EXPECT_NEAR(read(text).tilt_factor(45), 0.75, 1e-12) << "of the file";
}

TEST(Photometry, OfADarkLampIsZero) {
  const Photometry dark = read(ies_text({0, 90}, {0}, [](double, double) { return 0.0; }));
  EXPECT_EQ(dark.candela, 0);
  EXPECT_EQ(relative_intensity(dark.distribution, {0, 0, -1}), 0);
}

TEST(Photometry, OfMalformedLm63IsRefusedWithItsLine) {
  const std::string good = "IESNA:LM-63-1995\nTILT=NONE\n1 -1 1 3 2 1 2 0 0 0\n1 1 20\n0 45 90\n0 90\n1 2 3\n4 5 6\n";
  EXPECT_NEAR(read(good).candela, 6, 1e-9);
  const std::vector<std::array<std::string, 3>> faults{
      {"TILT=NONE\n", "", "a line TILT="},
      {"TILT=NONE", "TILT=", "line 2"},
      {"TILT=NONE", "TILT=INCLUDE\n9", "lamp.ies, line 3"},
      {"TILT=NONE", "TILT=INCLUDE\n1 2\n30 20\n1 1", "line 4"},
      {"1 -1 1 3", "1 -1 one 3", "'one' stands where the multiplier is expected"},
      {"1 -1 1 3", "1 -1 -1 3", "line 3"},
      {"1 -1 1 3", "1 -1 nan 3", "line 3"},
      {"1 -1 1 3", "1 -1 1 0", "the number of vertical angles is 0"},
      {"1 -1 1 3", "1 -1 1 2.5", "line 3"},
      {"1 -1 1 3", "1 -1 1 1000000000", "line 3"},
      {"3 2 1 2", "3601 3601 1 2", "are more than"},
      {"3 2 1 2", "3 2 4 2", "the photometric type is 4"},
      {"3 2 1 2", "3 2 1 3", "the type of units is 3"},
      {"3 2 1 2 0 0 0\n1 1 20\n0 45 90", "3 2 2 2 0 0 0\n1 1 20\n0 45 80", "types A and B"},
      {"1 1 20", "1e99 1 20", "lamp.ies, line 4"},
      {"0 45 90", "0 45 40", "lamp.ies, line 5"},
      {"0 45 90", "0 45 190", "out of the range"},
      {"0 45 90", "-1 45 90", "line 5"},
      {"\n0 90\n", "\n0 100\n", "line 6"},
      {"\n0 90\n", "\n10 90\n", "required is one angle"},
      {"1 2 3", "1 -2 3", "lamp.ies, line 7"},
      {"1 2 3", "1 inf 3", "line 7"},
      {"1 2 3", "1 2\x1b[31m 3", "'2?[31m'"},
      {"4 5 6\n", "4 5\n", "the file ends before a luminous intensity"},
  };
  for (const auto& [from, to, message] : faults) {
    std::string bad = good;
    ASSERT_NE(bad.find(from), std::string::npos) << from;
    bad.replace(bad.find(from), from.size(), to);
    EXPECT_ERROR(read(bad), ExitCode::bad_data, message);
  }
  for (std::size_t size = 0; size + 2 < good.size(); ++size)
    EXPECT_ERROR(read(good.substr(0, size)), ExitCode::bad_data, "line");
  EXPECT_ERROR(read(std::string(20 << 20, ' ')), ExitCode::over_limit, "16 MiB");
}

TEST(Photometry, OfMalformedEulumdatIsRefusedWithItsLine) {
  const std::string good = ldt_text(4, 4, 500, {0, 90, 180}, lopsided);
  const auto with_line = [&](int number, const std::string& content) {
    std::string text = good;
    std::size_t at = 0;
    for (int line = 1; line < number; ++line) at = text.find("\r\n", at) + 2;
    return text.replace(at, text.find("\r\n", at) - at, content);
  };
  EXPECT_NO_THROW(read(with_line(1, ""), "a.ldt"));
  const std::vector<std::pair<int, std::string>> faults{
      {2, "7"},   {3, "5"},  {3, ""},     {4, "0"},   {4, "6"},    {4, "999999"}, {6, "0"},    {6, "1e9"},
      {24, "-1"}, {24, "x"}, {26, "0"},   {26, "99"}, {29, "-5"},  {29, "inf"},   {43, "500"}, {44, "0"},
      {47, "-1"}, {48, "0"}, {49, "200"}, {50, "-1"}, {51, "nan"}, {52, "1e30"}};
  for (const auto& [line, content] : faults)
    EXPECT_ERROR(read(with_line(line, content), "a.ldt"), ExitCode::bad_data, fmt::format("a.ldt, line {}", line));
  for (std::size_t size = 0; size < good.rfind("\r\n", good.size() - 3); size += 3)
    EXPECT_ERROR(read(good.substr(0, size), "a.ldt"), ExitCode::bad_data, "a.ldt, line");
}

}  // namespace
}  // namespace patchlight::test
