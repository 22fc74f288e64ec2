// The conditional random field behind SqueezeSeg's network: neighbours that lie close together agree on a class.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lookout::learned {

enum class Class : std::uint8_t { kClutter, kThing, kLand };
inline constexpr int kNumClasses = 3;

/// Values of the classes at a pixel: log odds up to a constant, or probabilities.
using OfClasses = std::array<float, kNumClasses>;

/// The probabilities that log odds stand for.
OfClasses Softmax(const OfClasses& log_odds);

/// How much a neighbour that is of one class (column) speaks for another (row); trained.
using Compatibility = std::array<OfClasses, kNumClasses>;

/// A pixel that holds a return.
struct CrfPixel {
  int row = 0;
  int column = 0;
  std::array<float, 3> position{};  // normalised coordinates
  OfClasses log_odds{};
};

/// Mean field in three steps, each: the probabilities of the up to 14 neighbours (3 rows x 5 columns) that hold a return, weighted by two Gaussians,
/// one of the angle between the beams (in pixels) and one of that and of the distance; both made compatible; their sum and the pixel's own
/// probabilities are its new log odds. Empty pixels say nothing.
///
/// Source: Wu et al., ICRA 2018, section III-D; deviations as in the authors' program for cars.
class RecurrentCrf {
 public:
  static constexpr int kSteps = 3;
  static constexpr int kRowsAround = 1;
  static constexpr int kColumnsAround = 2;
  static constexpr float kDeviationOfAngle = 0.9F;       // pixels
  static constexpr float kDeviationOfPosition = 0.015F;  // normalised

  RecurrentCrf(const Compatibility& of_angle, const Compatibility& of_position) : of_angle_(of_angle), of_position_(of_position) {}

  /// Replaces the log odds of each pixel. Precondition: each (row, column) stands there once, inside of num_rows x num_columns.
  void Refine(std::span<CrfPixel> pixels, int num_rows, int num_columns) const;

 private:
  Compatibility of_angle_;
  Compatibility of_position_;
};

}  // namespace lookout::learned
