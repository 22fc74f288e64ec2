// Elementary functions whose results do not depend on the processor or on the C library.
//
// IEEE 754 fixes sums, products, quotients and square roots to the last bit, and with them std::sqrt, fabs, floor, ceil, nearbyint, lround and fmod.
// It does not fix sine, arc tangent or exponential: a C library picks another variant of them by what the processor can do. Whatever reaches a
// message takes those from here. They are made of sums, products, quotients and square roots alone, and this project is compiled without contraction
// to fused multiply-adds. Error bounds are held by the unit test elementary_test.cpp against long double; an ulp is the distance of neighbouring
// doubles at the true value.
//
// What is not a number gives kNan, always with the same bits; of Hypot a NaN of any bits, as sums have it.
#pragma once

#include <cmath>
#include <limits>

namespace lookout {

/// Not a number; elsewhere also what is not known.
inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// The value; of whatever is not a number kNan, so that it goes out in the same bytes whatever made it.
inline double Canonical(double value) { return std::isnan(value) ? kNan : value; }

struct SinCos {
  double sin = 0.0;
  double cos = 1.0;
};

/// Sine and cosine at once, of any finite angle; NaN of others. Error: below 1 ulp.
/// Source: the range is reduced after W. Cody and W. Waite ("Software Manual for the Elementary Functions", 1980), for angles beyond 1000 rad after
/// M. Payne and R. Hanek ("Radian Reduction for Trigonometric Functions", SIGNUM Newsletter 18, 1983); coefficients of Sun's fdlibm (k_sin.c,
/// k_cos.c).
SinCos SinCosOf(double angle_rad);

/// SinCosOf an angle in degrees: exact at whole quarters of a circle, where zeros have either sign. Error: below 2 ulp.
SinCos SinCosOfDegrees(double angle_deg);

inline double Sin(double angle_rad) { return SinCosOf(angle_rad).sin; }
inline double Cos(double angle_rad) { return SinCosOf(angle_rad).cos; }

/// Angle of the point (x, y) from the x axis, counter-clockwise, in [-pi, pi]; signed zeros and infinities as std::atan2. Error: below 2 ulp.
/// Source: coefficients of Sun's fdlibm (s_atan.c).
double Atan2(double y, double x);

/// In [-pi/2, pi/2] and [0, pi]; NaN beyond [-1, 1]. Error: below 3 ulp.
double Asin(double sine);
double Acos(double cosine);

/// e^x; 0 where that is below half of the least double, infinite above the greatest. Error: below 1 ulp.
/// Source: coefficients of Sun's fdlibm (e_exp.c).
double Exp(double x);

/// Natural logarithm; -infinity of 0, NaN below. Error: below 1 ulp. Source: coefficients of Sun's fdlibm (e_log.c).
double Log(double x);

/// sqrt(a^2 + b^2), where neither square overflows or vanishes beside the other: magnitudes of 1e-150 to 1e150. Error: below 1.5 ulp.
inline double Hypot(double a, double b) { return std::sqrt(a * a + b * b); }

}  // namespace lookout
