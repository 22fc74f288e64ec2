// Motion and extent of one thing: two motion hypotheses over its parts.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <vector>

#include "services/tracker/core/outline.hpp"
#include "services/tracker/core/surface_motion.hpp"

namespace lookout::tracker {

/// Which sides of a seen outline are edges of the thing, and not edges of its visible part.
struct Sides {
  Eigen::Vector2d from_m = Eigen::Vector2d::Zero();  // the lidar, on the map
  bool is_left_hidden = false;                       // as seen from the lidar
  bool is_right_hidden = false;
  double before_s = 0.0;  // how long before the state's time the outline was seen: a moving thing has gone on since
};

/// A thing that stands, or moves and turns. Its outline is counted from its position: the hidden far side is as it was seen before, or assumed.
///
/// A measurement is compared side by side: in each direction from which the thing is seen, the reach of the seen outline against that of the known
/// outline at the predicted position. So a larger or smaller visible part is no motion, and the side that is seen does not draw the centre towards
/// the boat. Where the sides do not agree, the measurement counts less.
///
/// A thing has parts that are seen by turns, as the bow of a kayak and its paddler. Each part has its own sides, counted from the one position. A
/// measurement is compared with the part that it fits best, so a change of part is no motion. The outline is that around all parts. A part that was
/// not seen for 6 s, while others were, is forgotten.
///
/// The visible part changes over seconds, not from scan to scan. So errors of the outline last, and the covariance counts them as lasting.
class Body {
 public:
  /// @param seen_m  outline, map
  /// @param noise_m2  covariance of its position relative to the own boat
  Body(const std::vector<Eigen::Vector2d>& seen_m, const Sides& sides, const Eigen::Matrix2d& noise_m2, double range_m);

  void Predict(double dt_s);

  /// The measurement of the position by a seen outline: its distance from the predicted position, with a covariance that is large along directions
  /// that the outline does not show.
  struct Shift {
    Eigen::Vector2d shift_m = Eigen::Vector2d::Zero();
    Eigen::Matrix2d covariance_m2 = Eigen::Matrix2d::Zero();
    double off = 0.0;  // square of the shift, in deviations of the predicted position and of the shift: 2 in the mean

    double misfit = 0.0;   // mean square of what is left of each side, in its deviations: 1 in the mean where it is the same thing
    bool is_part = false;  // less of the thing is seen than is known
  };
  Shift ShiftOf(const std::vector<Eigen::Vector2d>& seen_m, const Sides& sides, const Eigen::Matrix2d& noise_m2, double range_m) const;

  /// @param grows  false where the seen outline may hold another thing too: then it changes the position alone, not the sides
  void Update(const std::vector<Eigen::Vector2d>& seen_m, const Sides& sides, const Eigen::Matrix2d& noise_m2, double range_m, bool grows);

  /// Motion by the surface, which tells it sooner and more exactly than the outline.
  /// @param sides     from where the surface was seen
  /// @param noise_m2  covariance of its position relative to the own boat
  void Update(const SurfaceShift& surface, const Sides& sides, const Eigen::Matrix2d& noise_m2, double range_m);

  /// The whole outline, at the predicted position.
  std::vector<Eigen::Vector2d> Outline() const;
  double SeenShare() const;
  /// The frame fixed to the thing, on the map: it moves and turns with the thing, even where the middle of the known outline does not.
  Eigen::Isometry2d Frame() const;
  /// Motion of Frame() since the thing was seen first.
  double moved_m() const { return (Frame().translation() - first_m_).norm(); }

  /// The own position became better known: all positions may be off together, by this variance.
  void Loosen(double variance_m2);
  /// The own position was off by so much, and all places on the map with it.
  void Translate(const Eigen::Vector2d& by_m);
  /// The thing was seen together with land only: nobody sees where it comes to rest, so its velocity fades.
  void Fade(double dt_s);
  /// A segment beside it belongs to it, too.
  void Include(const std::vector<Eigen::Vector2d>& outline_m);
  /// The thing was followed as another track before: place and size stay, the motion is that of the other track, less sure.
  void MoveAs(const Body& before);
  /// Another part of the same thing is seen: place and motion stay, since another part says nothing of them.
  /// @param has_jumped  the part is not where the thing was expected: the velocity is less sure
  void AddPart(const std::vector<Eigen::Vector2d>& seen_m, const Sides& sides, double range_m, bool has_jumped);
  /// Forgets all parts but the one that was seen last.
  void KeepSeenPart() { others_.clear(); }

  /// State of the hypothesis that holds: moving where its probability is above the threshold.
  bool IsMoving(double threshold) const { return moving_probability_ > threshold; }
  double moving_probability() const { return moving_probability_; }
  Eigen::Vector2d center_m() const;  // middle of the outline
  Eigen::Vector2d velocity_mps() const { return moving_.segment<2>(2); }
  Eigen::Matrix4d covariance() const;  // of centre and velocity, relative to the own boat
  /// Clockwise; NaN where it is not known: of a track that has not moved for long, or too slowly.
  double turn_rate_radps() const;

 private:
  using Motion = Eigen::Matrix<double, 5, 1>;  // position, velocity, turn rate counter-clockwise
  using MotionCovariance = Eigen::Matrix<double, 5, 5>;
  struct Side {
    double reach_m = 0.0;
    double variance_m2 = 0.0;
    bool is_seen = false;
  };
  using Reaches = std::array<Side, kDirections>;
  // A part of a thing that is seen by itself, as the bow, or the crew.
  struct Part {
    Reaches sides;
    double unseen_s = 0.0;  // for how long other parts were seen, and this one not
  };
  struct Measured;
  Measured Measure(const std::vector<Eigen::Vector2d>& seen_m, const Sides& sides, double range_m) const;
  Measured MeasuredBy(Measured measured, const Reaches& known) const;
  Shift ShiftOf(const Measured& measured, const Reaches& known, const Eigen::Matrix2d& noise_m2, double range_m) const;
  // Index in others_ of the part that is seen; nullopt: the part that was seen last.
  std::optional<std::size_t> PartOf(const Measured& measured, const Eigen::Matrix2d& noise_m2, double range_m) const;
  Reaches WholeSides() const;
  void ForgetParts(double dt_s);
  struct First;
  First FirstOutline(const Measured& measured, const std::vector<Eigen::Vector2d>& seen_m) const;
  Eigen::Vector2d position_m() const;
  Eigen::Vector2d middle_m() const;  // from the position to the middle of the outline
  Directions SideDirections() const;
  Support SupportFrom(const std::vector<Eigen::Vector2d>& corners_m) const;  // from the origin of the map
  void Center();
  double size_m() const;
  double outline_sd_m() const;
  Eigen::Matrix2d velocity_covariance() const;
  void Weigh(double log_ratio);
  void CorrectMoving(Eigen::Index first, const Eigen::Vector2d& off, const Eigen::Matrix2d& spread);
  void Decide(const Eigen::Vector2d& measured_m, const Eigen::Matrix2d& covariance_m2, double dt_s);
  void AssumeBy(const Measured& measured);
  void TakePart(const Measured& measured, double dt_s);

  Reaches sides_;                                          // of the part that was seen last, from the position
  std::vector<Part> others_;                               // parts that were seen earlier
  Eigen::Matrix2d turned_ = Eigen::Matrix2d::Identity();   // of the sides' directions, from those of the compass: a boat that turns takes them along
  Eigen::Vector2d first_m_ = Eigen::Vector2d::Zero();      // the position at first
  Eigen::Vector2d last_jump_m_ = Eigen::Vector2d::Zero();  // of the last new part: from the expected middle to the seen one
  double since_jump_s_ = 0.0;
  bool goes_on_ = false;                                  // the last two jumps went the same way
  Eigen::Vector2d centered_m_ = Eigen::Vector2d::Zero();  // way of the position by Center() since the beginning, in the thing's own frame
  Eigen::Vector2d standing_ = Eigen::Vector2d::Zero();
  Eigen::Matrix2d standing_m2_ = Eigen::Matrix2d::Zero();
  Motion moving_ = Motion::Zero();
  MotionCovariance moving_covariance_ = MotionCovariance::Zero();
  double surface_scatter_ = 1.0;       // of speeds by the surface: mean square, in their deviations
  double log_likelihood_ratio_ = 0.0;  // of moving over standing, by the last seconds
  double moving_probability_ = 0.0;    // one half at most where the speed does not stand out
  bool prefers_moving_ = false;        // the moving filter says where the thing is, not the standing one
  bool stands_out_ = false;            // the speed is well above its deviation
  double moved_s_ = 0.0;               // for how long without a break it moved
  double since_update_s_ = 0.0;
  double parts_s_ = 0.0;                                  // for how long only parts were seen
  std::array<double, kDirections> parts_reach_m_{};       // how far those parts reach, from the position
  double age_s_ = 0.0;                                    // since the outline was first seen
  Eigen::Vector2d mean_off_m_ = Eigen::Vector2d::Zero();  // of the measured position from the moving filter's, mean of the last second
  // Jitter of the measured position from scan to scan, by second differences: steady motion has none.
  std::array<Eigen::Vector2d, 2> last_measured_{};
  int num_measured_ = 0;
  double jitter_m2_ = 0.0;
};

}  // namespace lookout::tracker
