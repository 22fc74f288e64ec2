#include "common/core/elementary.hpp"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>

namespace lookout {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Numbers that are not themselves doubles, as a sum of two.
constexpr double kPiHigh = 0x1.921fb54442d18p+1;
constexpr double kPiLow = 0x1.1a62633145c07p-53;
constexpr double kQuarterHighRad = kPiHigh / 2.0;
constexpr double kQuarterLowRad = kPiLow / 2.0;

template <std::size_t kSize>
constexpr double Horner(double x, const std::array<double, kSize>& coefficients) {
  double sum = coefficients[kSize - 1];
  for (std::size_t i = kSize - 1; i-- > 0;) sum = coefficients[i] + x * sum;
  return sum;
}

// A number as a sum, the second no greater than the rounding error of the first.
struct Pair {
  double high = 0.0;
  double low = 0.0;
};

// Exact (D. Knuth).
Pair TwoSum(double a, double b) {
  const double sum = a + b;
  const double of_b = sum - a;
  return {sum, (a - (sum - of_b)) + (b - of_b)};
}

// Exact where |a| >= |b| (T. Dekker).
Pair FastTwoSum(double a, double b) {
  const double sum = a + b;
  return {sum, b - (sum - a)};
}

// Halves of 26 bits; of magnitudes that do not overflow 2^27 times over.
Pair Split(double a) {
  const double scaled = 134217729.0 * a;  // 2^27 + 1
  const double high = scaled - (scaled - a);
  return {high, a - high};
}

// Exact (T. Dekker, G. Veltkamp).
Pair TwoProduct(double a, double b) {
  const double product = a * b;
  const Pair a_halves = Split(a);
  const Pair b_halves = Split(b);
  const double error =
      ((a_halves.high * b_halves.high - product) + a_halves.high * b_halves.low + a_halves.low * b_halves.high) + a_halves.low * b_halves.low;
  return {product, error};
}

// 2^exponent, of a normal number.
double PowerOfTwo(int exponent) {
  constexpr std::int64_t kBias = 1023;
  constexpr int kMantissaBits = 52;
  return std::bit_cast<double>(static_cast<std::uint64_t>(kBias + exponent) << kMantissaBits);
}

// An angle as so many quarter turns, modulo 4, and a rest of at most an eighth turn (and a rounding error).
struct Reduced {
  unsigned quarter = 0;
  Pair rest_rad;
};

constexpr double kNearRad = 1000.0;

// Of |angle_rad| <= kNearRad. The quarter turn in three parts, the first two of 43 bits: their products with a number of 10 bits are exact.
Reduced ReduceNear(double angle_rad) {
  constexpr double kQuartersPerRad = 0x1.45f306dc9c883p-1;
  constexpr double kFirstRad = 0x1.921fb54442c00p+0;
  constexpr double kSecondRad = 0x1.18469898cc400p-44;
  constexpr double kThirdRad = 0x1.1701b839a2520p-88;
  const double quarters = std::nearbyint(angle_rad * kQuartersPerRad);
  const Pair rest_rad = TwoSum(angle_rad - quarters * kFirstRad, -quarters * kSecondRad);
  return {static_cast<unsigned>(static_cast<int>(quarters)) & 3U, FastTwoSum(rest_rad.high, rest_rad.low - quarters * kThirdRad)};
}

// 2 / pi, binary, the highest bits first.
constexpr std::array<std::uint64_t, 19> kTwoOverPi{0xA2F9836E4E441529, 0xFC2757D1F534DDC0, 0xDB6295993C439041, 0xFE5163ABDEBBC561, 0xB7246E3A424DD2E0,
                                                   0x06492EEA09D1921C, 0xFE1DEB1CB129A73E, 0xE88235F52EBB4484, 0xE99C7026B45F7E41, 0x3991D639835339F4,
                                                   0x9C845F8BBDF9283B, 0x1FF897FFDE05980F, 0xEF2F118B5A0A6D1F, 0x6D367ECF27CB09B7, 0x4F463F669E5FEA2D,
                                                   0x7527BAC7EBE5F17B, 0x3D0739F78A5292EA, 0x6BFB5FB11F8D5D08, 0x56033046FC7B6BAB};

// 64 of its bits from this one on; 0 before the first.
std::uint64_t TwoOverPiFrom(int bit) {
  constexpr int kWordBits = 64;
  const auto word = [](int index) { return index >= 0 ? kTwoOverPi[static_cast<std::size_t>(index)] : 0; };
  const int index = (bit + 4 * kWordBits) / kWordBits - 4;
  const int offset = bit - index * kWordBits;
  return offset == 0 ? word(index) : word(index) << offset | word(index + 1) >> (kWordBits - offset);
}

__extension__ using Unsigned128 = unsigned __int128;

// A number of 192 bits, the highest word first.
using Bits192 = std::array<std::uint64_t, 3>;

Bits192 Times(std::uint64_t factor, const Bits192& bits) {
  Bits192 product{};
  std::uint64_t carry = 0;
  for (std::size_t i = bits.size(); i-- > 0;) {
    const Unsigned128 partial = static_cast<Unsigned128>(factor) * bits[i] + carry;
    product[i] = static_cast<std::uint64_t>(partial);
    carry = static_cast<std::uint64_t>(partial >> 64);
  }
  return product;  // modulo 2^192
}

Bits192 Negated(const Bits192& bits) {
  Bits192 negated{};
  std::uint64_t carry = 1;
  for (std::size_t i = bits.size(); i-- > 0;) {
    negated[i] = ~bits[i] + carry;
    carry = carry != 0 && negated[i] == 0 ? 1 : 0;
  }
  return negated;
}

Bits192 ShiftedLeft(const Bits192& bits, int count) {
  Bits192 shifted = bits;
  for (; count >= 64; count -= 64) shifted = {shifted[1], shifted[2], 0};
  if (count == 0) return shifted;
  return {shifted[0] << count | shifted[1] >> (64 - count), shifted[1] << count | shifted[2] >> (64 - count), shifted[2] << count};
}

int LeadingZeros(const Bits192& bits) {
  int count = 0;
  for (const std::uint64_t word : bits) {
    count += std::countl_zero(word);
    if (word != 0) break;
  }
  return count;
}

// Of |angle_rad| > kNearRad, finite. angle = mantissa * 2^exponent, times 2 / pi modulo 4: bits of 2 / pi that are worth 4 or more there do not
// count, nor those below 2^-137. No double of this size is nearer than 2^-62 to a whole number of quarter turns.
Reduced ReduceFar(double angle_rad) {
  constexpr int kMantissaBits = 52;
  constexpr int kExponentOfLastBit = 1023 + kMantissaBits;
  const auto bits = std::bit_cast<std::uint64_t>(std::abs(angle_rad));
  const std::uint64_t mantissa = (bits & ((std::uint64_t{1} << kMantissaBits) - 1)) | std::uint64_t{1} << kMantissaBits;
  const int first_bit = static_cast<int>(bits >> kMantissaBits) - kExponentOfLastBit - 2;
  // In units of 2^-190 quarter turns, modulo 4.
  const Bits192 quarters = Times(mantissa, {TwoOverPiFrom(first_bit), TwoOverPiFrom(first_bit + 64), TwoOverPiFrom(first_bit + 128)});
  auto quarter = static_cast<unsigned>(quarters[0] >> 62);
  Bits192 share = ShiftedLeft(quarters, 2);  // of a quarter turn, in units of 2^-192
  const bool is_above_half = share[0] >> 63 != 0;
  if (is_above_half) {
    ++quarter;
    share = Negated(share);
  }
  const int num_zeros = LeadingZeros(share);
  const Bits192 digits = ShiftedLeft(share, num_zeros);
  const double high = static_cast<double>(digits[0] >> 11) * PowerOfTwo(-53 - num_zeros);
  const double low = static_cast<double>((digits[0] & 0x7FF) << 42 | digits[1] >> 22) * PowerOfTwo(-106 - num_zeros);
  const Pair product_rad = TwoProduct(high, kQuarterHighRad);
  const Pair rest_rad = FastTwoSum(product_rad.high, product_rad.low + (high * kQuarterLowRad + low * kQuarterHighRad));
  const bool is_negative = is_above_half != (angle_rad < 0.0);
  return {angle_rad < 0.0 ? 0U - quarter : quarter, is_negative ? Pair{-rest_rad.high, -rest_rad.low} : rest_rad};
}

// Of an angle of at most an eighth turn, given as a pair: `low` is beyond the last bit of `high`.
SinCos OfSmall(const Pair& angle_rad) {
  static constexpr std::array<double, 6> kSine{-1.66666666666666324348e-01, 8.33333333332248946124e-03,  -1.98412698298579493134e-04,
                                               2.75573137070700676789e-06,  -2.50507602534068634195e-08, 1.58969099521155010221e-10};
  static constexpr std::array<double, 6> kCosine{4.16666666666666019037e-02,  -1.38888888888741095749e-03, 2.48015872894767294178e-05,
                                                 -2.75573143513906633035e-07, 2.08757232129817482790e-09,  -1.13596475577881948265e-11};
  // Below it they are the angle and 1 to the last bit; zero keeps its sign.
  constexpr double kTinyRad = 0x1p-27;
  const auto [x, low] = angle_rad;
  if (std::abs(x) < kTinyRad) return {x, 1.0};
  const double x2 = x * x;
  // Terms that are small beside the first are rounded where they matter least; the low part goes in by its derivative.
  const double sine = x + (x * x2 * Horner(x2, kSine) + low * (1.0 - 0.5 * x2));
  const Pair one_less = FastTwoSum(1.0, -0.5 * x2);
  const double cosine = one_less.high + (one_less.low + (x2 * x2 * Horner(x2, kCosine) - x * low));
  return {sine, cosine};
}

SinCos TurnedBy(unsigned quarter, const SinCos& small) {
  switch (quarter & 3U) {
    case 0:
      return small;
    case 1:
      return {small.cos, -small.sin};
    case 2:
      return {-small.sin, -small.cos};
    default:
      return {-small.cos, small.sin};
  }
}

// Arc tangent of the quotient of two numbers that are not negative, the first no greater than the second; as a sum, the second part rounded.
Pair ArcTangent(double numerator, double denominator) {
  static constexpr std::array<double, 11> kArcTangent{3.33333333333329318027e-01,  -1.99999999998764832476e-01, 1.42857142725034663711e-01,
                                                      -1.11111104054623557880e-01, 9.09088713343650656196e-02,  -7.69187620504482999495e-02,
                                                      6.66107313738753120669e-02,  -5.83357013379057348645e-02, 4.97687799461593236017e-02,
                                                      -3.65315727442169155270e-02, 1.62858201153657823623e-02};
  // Where it is turned back by the arc tangent of 1/2 and of 1, so that little is left for the polynomial.
  constexpr double kFromHalf = 7.0 / 16.0;
  constexpr double kFromOne = 11.0 / 16.0;
  constexpr Pair kOfHalfRad{0x1.dac670561bb4fp-2, 0x1.a2b7f222f65e2p-56};
  constexpr Pair kOfOneRad{kQuarterHighRad / 2.0, kQuarterLowRad / 2.0};
  Pair turned_rad;
  double tangent = numerator / denominator;
  if (tangent >= kFromOne) {
    turned_rad = kOfOneRad;
    tangent = (numerator - denominator) / (denominator + numerator);
  } else if (tangent >= kFromHalf) {
    turned_rad = kOfHalfRad;
    tangent = (numerator - 0.5 * denominator) / (denominator + 0.5 * numerator);
  }
  const double tangent2 = tangent * tangent;
  const double beyond = -tangent * tangent2 * Horner(tangent2, kArcTangent);
  if (turned_rad.high == 0.0) return {tangent, beyond};
  return {turned_rad.high, turned_rad.low + (tangent + beyond)};
}

}  // namespace

SinCos SinCosOf(double angle_rad) {
  const double size_rad = std::abs(angle_rad);
  if (size_rad <= kPiHigh / 4.0) return OfSmall({angle_rad, 0.0});
  if (!(size_rad < kInfinity)) return {kNan, kNan};
  const Reduced reduced = size_rad <= kNearRad ? ReduceNear(angle_rad) : ReduceFar(angle_rad);
  return TurnedBy(reduced.quarter, OfSmall(reduced.rest_rad));
}

SinCos SinCosOfDegrees(double angle_deg) {
  constexpr double kQuarterDeg = 90.0;
  constexpr double kTurnDeg = 360.0;
  constexpr double kRadPerDegHigh = 0x1.1df46a2529d39p-6;
  constexpr double kRadPerDegLow = 0x1.5c1d8becdd291p-62;
  if (!(std::abs(angle_deg) < kInfinity)) return {kNan, kNan};
  const double in_turn_deg = std::fmod(angle_deg, kTurnDeg);  // exact
  const double quarters = std::nearbyint(in_turn_deg / kQuarterDeg);
  const double rest_deg = in_turn_deg - quarters * kQuarterDeg;  // exact
  const Pair rest_rad = TwoProduct(rest_deg, kRadPerDegHigh);
  return TurnedBy(static_cast<unsigned>(static_cast<int>(quarters)), OfSmall(FastTwoSum(rest_rad.high, rest_rad.low + rest_deg * kRadPerDegLow)));
}

double Atan2(double y, double x) {
  if (std::isnan(x) || std::isnan(y)) return kNan;
  double least = std::abs(x);
  double greatest = std::abs(y);
  const bool is_steep = greatest > least;
  if (!is_steep) std::swap(least, greatest);
  if (greatest == 0.0) {
    greatest = 1.0;  // the quotient is 0
  } else if (least == kInfinity) {
    least = greatest = 1.0;
  } else if (greatest > 0x1p+1000) {
    least *= 0x1p-100;
    greatest *= 0x1p-100;
  } else if (greatest < 0x1p-900) {
    least *= 0x1p+200;
    greatest *= 0x1p+200;
  }
  const Pair slope_rad = ArcTangent(least, greatest);
  const bool is_behind = std::signbit(x);
  double angle_rad = slope_rad.high + slope_rad.low;
  if (is_steep || is_behind) {
    const Pair from_rad = is_steep ? Pair{kQuarterHighRad, kQuarterLowRad} : Pair{kPiHigh, kPiLow};
    const double sign = is_steep == is_behind ? 1.0 : -1.0;
    const Pair sum_rad = FastTwoSum(from_rad.high, sign * slope_rad.high);
    angle_rad = sum_rad.high + (sum_rad.low + (from_rad.low + sign * slope_rad.low));
  }
  return std::signbit(y) ? -angle_rad : angle_rad;
}

double Asin(double sine) {
  if (!(std::abs(sine) <= 1.0)) return kNan;
  return Atan2(sine, std::sqrt((1.0 - sine) * (1.0 + sine)));
}

double Acos(double cosine) {
  if (!(std::abs(cosine) <= 1.0)) return kNan;
  return Atan2(std::sqrt((1.0 - cosine) * (1.0 + cosine)), cosine);
}

double Exp(double x) {
  static constexpr std::array<double, 5> kCoefficients{1.66666666666666019037e-01, -2.77777777770155933842e-03, 6.61375632143793436117e-05,
                                                       -1.65339022054652515390e-06, 4.13813679705723846039e-08};
  constexpr double kLeast = -746.0;  // e^-745.14 is half of the least double
  constexpr double kGreatest = 710.0;
  constexpr double kDoublingsPerOne = 0x1.71547652b82fep+0;  // 1 / ln 2
  constexpr double kLn2High = 0x1.62e42fefp-1;               // 32 bits: exact times a number of 11
  constexpr double kLn2Low = 0x1.473de6af278edp-34;
  if (std::isnan(x)) return kNan;
  if (x < kLeast) return 0.0;
  if (x > kGreatest) return kInfinity;
  const double doublings = std::nearbyint(x * kDoublingsPerOne);
  const double high = x - doublings * kLn2High;
  const double low = doublings * kLn2Low;
  const double rest = high - low;
  // e^r = 1 + r + r c / (2 - c), with c = r - r^2 P(r^2) (Remez on [0, ln(2)^2 / 4]).
  const double rest2 = rest * rest;
  const double c = rest - rest2 * Horner(rest2, kCoefficients);
  const double power = 1.0 + (high - (low - rest * c / (2.0 - c)));
  const int exponent = static_cast<int>(doublings);
  // In two steps: the result may be subnormal.
  return power * PowerOfTwo(exponent / 2) * PowerOfTwo(exponent - exponent / 2);
}

double Log(double x) {
  static constexpr std::array<double, 7> kCoefficients{6.666666666666735130e-01, 3.999999999940941908e-01, 2.857142874366239149e-01,
                                                       2.222219843214978396e-01, 1.818357216161805012e-01, 1.531383769920937332e-01,
                                                       1.479819860511658591e-01};
  constexpr double kLn2High = 6.93147180369123816490e-01;
  constexpr double kLn2Low = 1.90821492927058770002e-10;
  if (std::isnan(x) || x < 0.0) return kNan;
  if (x == 0.0) return -kInfinity;
  if (x == kInfinity) return kInfinity;
  int exponent = 0;
  double mantissa = std::frexp(x, &exponent);  // exact
  if (mantissa < std::numbers::sqrt2 / 2.0) {
    mantissa *= 2.0;
    --exponent;
  }
  // ln(1 + f) = f - f^2 / 2 + s (f^2 / 2 + R(s^2)), with s = f / (2 + f) (Remez).
  const double f = mantissa - 1.0;
  const double s = f / (2.0 + f);
  const double s2 = s * s;
  const double rest = s2 * Horner(s2, kCoefficients);
  const double half = 0.5 * f * f;
  return exponent * kLn2High - ((half - (s * (half + rest) + exponent * kLn2Low)) - f);
}

}  // namespace lookout
