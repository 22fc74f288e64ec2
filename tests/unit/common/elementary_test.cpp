#include "common/core/elementary.hpp"

#include <bit>
#include <cstdint>
#include <gtest/gtest.h>
#include <initializer_list>
#include <limits>
#include <vector>

#include "common/core/angles.hpp"

namespace lookout {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kLeastNumber = std::numeric_limits<double>::denorm_min();
constexpr double kLeastNormal = std::numeric_limits<double>::min();
constexpr double kGreatest = std::numeric_limits<double>::max();

std::uint64_t Bits(double value) { return std::bit_cast<std::uint64_t>(value); }

// Whole numbers alone: the same on every computer (Knuth's MMIX generator, its high bits).
class Random {
 public:
  std::uint64_t Word() {
    state_ = state_ * 6364136223846793005U + 1442695040888963407U;
    return (state_ >> 33) << 32 | Half();
  }
  /// In [low, high), evenly.
  double Between(double low, double high) { return low + (high - low) * (static_cast<double>(Word() >> 11) * 0x1p-53); }
  /// Any finite number, all exponents alike.
  double Any() {
    for (;;) {
      const auto number = std::bit_cast<double>(Word());
      if (std::isfinite(number)) return number;
    }
  }

 private:
  std::uint64_t Half() {
    state_ = state_ * 6364136223846793005U + 1442695040888963407U;
    return state_ >> 32;
  }
  std::uint64_t state_ = 20261122;
};

// In units of the distance between doubles at the true value.
double ErrorUlp(double found, long double truth) {
  int exponent = 0;
  std::frexp(truth, &exponent);
  constexpr int kDigits = 53;
  constexpr int kLeastExponent = -1074;
  const int ulp_exponent = std::max(exponent - kDigits, kLeastExponent);
  return static_cast<double>(std::fabs(static_cast<long double>(found) - truth) / std::ldexp(1.0L, ulp_exponent));
}

// The greatest error so far, and where.
struct Worst {
  double error_ulp = 0.0;
  double at = 0.0;
  void Take(double found, long double truth, double argument) {
    const double error = ErrorUlp(found, truth);
    if (error <= error_ulp) return;
    error_ulp = error;
    at = argument;
  }
};

// Multiples of an eighth turn and what is next to them, both signs.
std::vector<double> NearSeams(double eighth, int num_eighths) {
  std::vector<double> seams;
  for (int i = -num_eighths; i <= num_eighths; ++i) {
    const double seam = i * eighth;
    for (const double number : {seam, std::nextafter(seam, kInfinity), std::nextafter(seam, -kInfinity), seam + 1e-9, seam - 1e-9})
      seams.push_back(number);
  }
  return seams;
}

TEST(SinCosOf, IsWithinOneUlpNearAndFar) {
  Random random;
  Worst sine;
  Worst cosine;
  const auto check = [&](double angle_rad) {
    const auto found = SinCosOf(angle_rad);
    sine.Take(found.sin, std::sin(static_cast<long double>(angle_rad)), angle_rad);
    cosine.Take(found.cos, std::cos(static_cast<long double>(angle_rad)), angle_rad);
  };
  for (int i = 0; i < 300'000; ++i) check(random.Between(-1.0, 1.0));
  for (int i = 0; i < 300'000; ++i) check(random.Between(-8.0, 8.0));
  for (int i = 0; i < 300'000; ++i) check(random.Between(-2000.0, 2000.0));  // over the bound between both reductions
  for (int i = 0; i < 300'000; ++i) check(random.Any());
  for (const double angle_rad : NearSeams(kPi / 4.0, 6000)) check(angle_rad);
  // The double that is nearest to a multiple of a quarter turn (J.-M. Muller, "Elementary Functions", table 11.1), and others far away.
  for (const double angle_rad : {6381956970095103.0 * 0x1p+797, 0x1p+1023, kGreatest, 1e22, 710.0, 1000.0, 1000.0000000000001, 1e5, 1e-8, 0x1p-27}) {
    check(angle_rad);
    check(-angle_rad);
  }
  EXPECT_LT(sine.error_ulp, 1.0) << "at " << sine.at;
  EXPECT_LT(cosine.error_ulp, 1.0) << "at " << cosine.at;
  std::printf("sine %.3f ulp, cosine %.3f ulp\n", sine.error_ulp, cosine.error_ulp);
}

TEST(SinCosOf, KeepsTheSignOfZeroAndTinyAngles) {
  EXPECT_EQ(Bits(Sin(0.0)), Bits(0.0));
  EXPECT_EQ(Bits(Sin(-0.0)), Bits(-0.0));
  EXPECT_EQ(Cos(-0.0), 1.0);
  for (const double tiny : {kLeastNumber, kLeastNormal, -kLeastNumber}) {
    EXPECT_EQ(Sin(tiny), tiny);
    EXPECT_EQ(Cos(tiny), 1.0);
  }
}

TEST(SinCosOf, GivesTheOneNaNForWhatIsNoAngle) {
  for (const double angle : {kInfinity, -kInfinity, kNan, -kNan}) {
    EXPECT_EQ(Bits(Sin(angle)), Bits(kNan));
    EXPECT_EQ(Bits(Cos(angle)), Bits(kNan));
    EXPECT_EQ(Bits(SinCosOfDegrees(angle).sin), Bits(kNan));
  }
}

TEST(SinCosOfDegrees, IsExactAtQuarters) {
  for (const double turns : {-3.0, -1.0, 0.0, 1.0, 1000.0}) {
    const auto expect = [&](double angle_deg, double sine, double cosine) {
      const auto found = SinCosOfDegrees(360.0 * turns + angle_deg);
      EXPECT_EQ(found.sin, sine) << turns << " turns and " << angle_deg;
      EXPECT_EQ(found.cos, cosine) << turns << " turns and " << angle_deg;
    };
    expect(0.0, 0.0, 1.0);
    expect(90.0, 1.0, 0.0);
    expect(180.0, 0.0, -1.0);
    expect(270.0, -1.0, 0.0);
  }
}

TEST(SinCosOfDegrees, IsWithinTwoUlp) {
  constexpr long double kRadPerDeg = 3.14159265358979323846264338327950288L / 180.0L;
  Random random;
  Worst worst;
  const auto check = [&](double angle_deg) {
    const auto found = SinCosOfDegrees(angle_deg);
    // Off the seams, where the sine of the rounded product of long doubles is no truth.
    if (std::abs(found.sin) > 1e-3) worst.Take(found.sin, std::sin(angle_deg * kRadPerDeg), angle_deg);
    if (std::abs(found.cos) > 1e-3) worst.Take(found.cos, std::cos(angle_deg * kRadPerDeg), angle_deg);
  };
  for (int i = 0; i < 500'000; ++i) check(random.Between(-180.0, 180.0));
  for (const double angle_deg : NearSeams(45.0, 8)) check(angle_deg);
  EXPECT_LT(worst.error_ulp, 2.0) << "at " << worst.at;
  std::printf("%.3f ulp\n", worst.error_ulp);
}

TEST(Atan2, IsWithinTwoUlpAllRound) {
  Random random;
  Worst worst;
  // Arguments are drawn one after the other: compilers evaluate those of a call in any order.
  const auto check = [&](double y, double x) {
    worst.Take(Atan2(y, x), std::atan2(static_cast<long double>(y), static_cast<long double>(x)), y / x);
  };
  for (int i = 0; i < 500'000; ++i) {
    const double y = random.Between(-1.0, 1.0);
    check(y, random.Between(-1.0, 1.0));
  }
  for (int i = 0; i < 300'000; ++i) {
    const double y = random.Between(-1e-3, 1e-3);
    check(y, random.Between(-1.0, 1.0));
  }
  for (int i = 0; i < 300'000; ++i) {
    const double y = random.Any();
    check(y, random.Any());
  }
  // Where the result is just above 1/8 an ulp is small beside the rounding error of the quotient.
  for (int i = 0; i < 300'000; ++i) {
    const double x = random.Between(0.5, 1.0);
    check(x * random.Between(0.1247, 0.1255), x);
  }
  check(0.12506119868572022, 1.0);
  for (const double bound : {7.0 / 16.0, 0.5, 11.0 / 16.0, 1.0, 19.0 / 16.0, 1.5, 2.0, 39.0 / 16.0}) {
    for (const double y : {bound, std::nextafter(bound, 0.0), std::nextafter(bound, 9.0)}) {
      for (const double scale : {1.0, -1.0, 0x1p+1020, 0x1p-1060, -0x1p-1000}) {
        check(y * scale, scale);
        check(-y * scale, scale);
      }
    }
  }
  check(kGreatest, kGreatest);
  check(kLeastNumber, kLeastNumber);
  check(kLeastNumber, -kGreatest);
  check(-kGreatest, kLeastNumber);
  EXPECT_LT(worst.error_ulp, 2.0) << "at " << worst.at;
  std::printf("%.3f ulp\n", worst.error_ulp);
}

// ISO C, annex F.10.1.4.
TEST(Atan2, TakesZerosAndInfinitiesAsTheCLibraryDoes) {
  const double numbers[] = {0.0, -0.0, 1.0, -1.0, kInfinity, -kInfinity, kLeastNumber, -kLeastNumber, kGreatest, -kGreatest};
  for (const double y : numbers) {
    for (const double x : numbers) {
      SCOPED_TRACE(testing::Message() << y << ", " << x);
      EXPECT_DOUBLE_EQ(Atan2(y, x), std::atan2(y, x));
      EXPECT_EQ(std::signbit(Atan2(y, x)), std::signbit(y));
    }
    EXPECT_EQ(Bits(Atan2(y, kNan)), Bits(kNan));
    EXPECT_EQ(Bits(Atan2(-kNan, y)), Bits(kNan));
  }
  EXPECT_EQ(Atan2(0.0, -1.0), kPi);
  EXPECT_EQ(Atan2(1.0, 0.0), kPi / 2.0);
  EXPECT_EQ(Atan2(1.0, 1.0), kPi / 4.0);
}

TEST(AsinAndAcos, AreWithinThreeUlp) {
  Random random;
  Worst sine;
  Worst cosine;
  const auto check = [&](double number) {
    sine.Take(Asin(number), std::asin(static_cast<long double>(number)), number);
    cosine.Take(Acos(number), std::acos(static_cast<long double>(number)), number);
  };
  for (int i = 0; i < 500'000; ++i) check(random.Between(-1.0, 1.0));
  // Where the result is just above 1/8 an ulp is small beside the rounding errors of square root and quotient.
  for (int i = 0; i < 300'000; ++i) check(random.Between(0.124, 0.1245));
  for (int i = 0; i < 300'000; ++i) check(random.Between(0.9922, 0.9924));
  for (const double number : {0.12423544569808977, 0.12418264671347694, 0.99227136608626776}) check(number);
  for (int i = 0; i < 100'000; ++i) check(1.0 - random.Between(0.0, 1e-6));
  for (int i = 0; i < 100'000; ++i) check(random.Between(0.0, 1e-6) - 1.0);
  for (const double number : {0.0, 0.5, 1.0, std::nextafter(1.0, 0.0), kLeastNumber, kLeastNormal}) {
    check(number);
    check(-number);
  }
  EXPECT_LT(sine.error_ulp, 3.0) << "at " << sine.at;
  EXPECT_LT(cosine.error_ulp, 3.0) << "at " << cosine.at;
  std::printf("%.3f and %.3f ulp\n", sine.error_ulp, cosine.error_ulp);
  EXPECT_EQ(Bits(Asin(-0.0)), Bits(-0.0));
  for (const double beyond : {std::nextafter(1.0, 2.0), -2.0, kInfinity, kNan, -kNan}) {
    EXPECT_EQ(Bits(Asin(beyond)), Bits(kNan));
    EXPECT_EQ(Bits(Acos(beyond)), Bits(kNan));
  }
}

TEST(Exp, IsWithinOneUlpDownToTheLeastNumber) {
  Random random;
  Worst worst;
  const auto check = [&](double x) { worst.Take(Exp(x), std::exp(static_cast<long double>(x)), x); };
  for (int i = 0; i < 300'000; ++i) check(random.Between(-1.0, 1.0));
  for (int i = 0; i < 300'000; ++i) check(random.Between(-20.0, 20.0));
  for (int i = 0; i < 300'000; ++i) check(random.Between(-745.0, 709.7));
  for (const double x : {0.0, -0.0, 1e-300, -1e-9, 0.34657359027997264, -0.34657359027997264, 709.782712893384, -708.4, -745.1, -746.0}) check(x);
  EXPECT_LT(worst.error_ulp, 1.0) << "at " << worst.at;
  std::printf("%.3f ulp\n", worst.error_ulp);
  EXPECT_EQ(Exp(0.0), 1.0);
  EXPECT_EQ(Exp(709.79), kInfinity);
  EXPECT_EQ(Exp(kInfinity), kInfinity);
  EXPECT_EQ(Exp(-745.2), 0.0);
  EXPECT_EQ(Exp(-kInfinity), 0.0);
  EXPECT_EQ(Bits(Exp(-kNan)), Bits(kNan));
}

TEST(Log, IsWithinOneUlp) {
  Random random;
  Worst worst;
  const auto check = [&](double x) { worst.Take(Log(x), std::log(static_cast<long double>(x)), x); };
  for (int i = 0; i < 300'000; ++i) check(random.Between(0.5, 2.0));
  for (int i = 0; i < 300'000; ++i) check(1.0 + 1e-6 * random.Between(-1.0, 1.0));
  for (int i = 0; i < 300'000; ++i) check(std::ldexp(random.Between(0.5, 1.0), static_cast<int>(random.Between(-1070.0, 1020.0))));
  EXPECT_LT(worst.error_ulp, 1.0) << "at " << worst.at;
  EXPECT_EQ(Log(1.0), 0.0);
  EXPECT_EQ(Log(0.0), -kInfinity);
  EXPECT_EQ(Log(kInfinity), kInfinity);
  EXPECT_EQ(Bits(Log(-1.0)), Bits(kNan));
  EXPECT_EQ(Bits(Log(-kNan)), Bits(kNan));
}

TEST(Hypot, IsWithinOneAndAHalfUlp) {
  Random random;
  Worst worst;
  for (int i = 0; i < 500'000; ++i) {
    const double scale = std::ldexp(1.0, static_cast<int>(random.Between(-400.0, 400.0)));
    const double a = random.Between(-1.0, 1.0) * scale;
    const double b = random.Between(-1.0, 1.0) * scale;
    worst.Take(Hypot(a, b), std::hypot(static_cast<long double>(a), static_cast<long double>(b)), a / b);
  }
  EXPECT_LT(worst.error_ulp, 1.5) << "at " << worst.at;
  EXPECT_EQ(Hypot(3.0, -4.0), 5.0);
  EXPECT_EQ(Hypot(0.0, -0.0), 0.0);
  for (const double none : {kNan, -kNan}) {
    EXPECT_TRUE(std::isnan(Hypot(none, 1.0)));
    EXPECT_TRUE(std::isnan(Hypot(1.0, none)));
  }
}

// Bit by bit what all computers give, whatever their bounds of error: another processor, compiler or option that does not is seen here. The digest is
// FNV-1a over the results' bits.
TEST(ElementaryFunctions, GiveTheSameBitsOnEveryComputer) {
  constexpr std::uint64_t kDigest = 0xd078e6debc8feb84;
  Random random;
  std::uint64_t digest = 0xcbf29ce484222325;
  const auto take = [&](std::initializer_list<double> results) {
    for (const double result : results) digest = (digest ^ Bits(result)) * 0x100000001b3;
  };
  for (int i = 0; i < 400'000; ++i) {
    const double near = random.Between(-10.0, 10.0);
    const double far = random.Any();
    const double share = random.Between(-1.0, 1.0);
    const auto [near_sin, near_cos] = SinCosOf(near);
    const auto [far_sin, far_cos] = SinCosOf(far);
    const auto [deg_sin, deg_cos] = SinCosOfDegrees(100.0 * near);
    take({near_sin, near_cos, far_sin, far_cos, deg_sin, deg_cos, Atan2(near, share), Atan2(far, near), Asin(share), Acos(share), Exp(near),
          Exp(70.0 * near), Hypot(near, share)});
  }
  EXPECT_EQ(digest, kDigest) << std::hex << "0x" << digest;
}

}  // namespace
}  // namespace lookout
