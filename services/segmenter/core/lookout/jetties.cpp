#include "services/segmenter/core/lookout/jetties.hpp"

#include <algorithm>
#include <cmath>

namespace lookout::segmenter {

namespace {

constexpr int kLeastJettyReturns = 14;  // of a run that has a jetty and its shore
constexpr int kBeyondColumns = 3;       // beyond the tip
constexpr float kBeyondM = 1.5F;
constexpr Reach kStraightOff{0.05, 0.003};
constexpr int kMostAstray = 2;  // returns off the line, one after the other
constexpr float kLeastJettyM = 3.0F;
constexpr float kGreatestJettyM = 14.0F;
constexpr int kLeastSideReturns = 4;
constexpr float kLeastFaceM = 0.5F;
constexpr float kLeastSeenFaceM = 0.8F;
constexpr float kGreatestFaceM = 3.5F;
constexpr float kLeastStandingOutM = 2.0F;
constexpr float kShoreM = 2.0F;  // of the shore after the foot that is looked at
constexpr float kLeastShoreM = 1.5F;
constexpr float kLeastLandM = 15.0F;  // after the foot, where open water follows
// Angles by their cosine.
constexpr float kFootCosine = 0.825F;        // 34 degrees
constexpr float kFaceCosine = 0.765F;        // 40 degrees
constexpr float kSquareFaceCosine = 0.454F;  // 63 degrees

struct PlanVector {
  float x_m = 0.0F;
  float y_m = 0.0F;

  float Length() const { return std::sqrt(x_m * x_m + y_m * y_m); }
};

float Cross(const PlanVector& one, const PlanVector& other) { return one.x_m * other.y_m - one.y_m * other.x_m; }
float Cosine(const PlanVector& one, const PlanVector& other) { return (one.x_m * other.x_m + one.y_m * other.y_m) / (one.Length() * other.Length()); }

// A run from one of its ends.
class RunEnd {
 public:
  RunEnd(const ScanGrid& grid, const Run& run, bool from_end) : grid_(grid), run_(run), from_end_(from_end) {
    off_m_ = static_cast<float>(kStraightOff.At(At(0).range_m));
  }

  int size() const { return run_.length; }
  const LevelPoint& At(int place) const { return grid_.PointOf(ReturnOf(grid_, run_, from_end_ ? run_.length - 1 - place : place)); }
  PlanVector Between(int from, int to) const { return {At(to).x_m - At(from).x_m, At(to).y_m - At(from).y_m}; }

  // Nearly all runs are shorter: what is 3 m long has one of these places 1.5 m from its tip.
  bool MayBeLong() const {
    const auto is_off = [this](int place) { return SquaredPlanDistance(At(0), At(place)) >= kLeastJettyM * kLeastJettyM / 4.0F; };
    return is_off(size() - 1) || is_off(size() / 2) || is_off(size() / 4);
  }

  bool IsFree() const {
    const int column = from_end_ ? run_.first + run_.length - 1 : run_.first;
    for (int step = 1; step <= kBeyondColumns; ++step) {
      const int beyond = grid_.Wrap(grid_.Wrap(column + (from_end_ ? step : -step)));
      if (grid_.RangeAt(run_.line, beyond) < At(0).range_m + kBeyondM) return false;
    }
    return true;
  }

  // The last return from which a straight line to this one passes all between them within off_m_: each return leaves a cone of such lines.
  int EndOfStraight(int from) const {
    int last = from;
    PlanVector left;
    PlanVector right;
    bool is_open = true;  // no return has been far enough off to narrow the cone
    int num_astray = 0;
    for (int place = from + 1; place < size(); ++place) {
      const PlanVector to = Between(from, place);
      const float length_m = to.Length();
      if (length_m > kGreatestJettyM) break;
      if (length_m <= 2.0F * off_m_) {
        last = place;
        continue;
      }
      if (is_open || (Cross(right, to) >= 0.0F && Cross(to, left) >= 0.0F)) {
        last = place;
        num_astray = 0;
      } else if (++num_astray > kMostAstray) {
        break;
      }
      const float sine = off_m_ / length_m;
      const float cosine = std::sqrt(1.0F - sine * sine);
      const PlanVector new_left{cosine * to.x_m - sine * to.y_m, cosine * to.y_m + sine * to.x_m};
      const PlanVector new_right{cosine * to.x_m + sine * to.y_m, cosine * to.y_m - sine * to.x_m};
      if (is_open || Cross(left, new_left) < 0.0F) left = new_left;
      if (is_open || Cross(right, new_right) > 0.0F) right = new_right;
      is_open = false;
      if (Cross(right, left) < 0.0F) break;
    }
    return last;
  }

  // A side from `corner` to `foot`, at which the run turns into the shore: not into the other side of a boat, which is short and has open water
  // beyond.
  bool HasFoot(int corner, int foot, bool is_afloat) const {
    if (foot - corner < kLeastSideReturns || Between(corner, foot).Length() < kLeastJettyM || Between(0, foot).Length() > kGreatestJettyM) {
      return false;
    }
    if (is_afloat && Between(foot, size() - 1).Length() < kLeastLandM) return false;
    int along = foot;
    while (along + 1 < size() && Between(foot, along).Length() < kShoreM) ++along;
    const PlanVector shore = Between(foot, along);
    if (shore.Length() < kLeastShoreM || Cosine(Between(corner, foot), shore) > kFootCosine) return false;
    return std::abs(Cross(shore, Between(foot, corner))) >= kLeastStandingOutM * shore.Length();
  }

 private:
  const ScanGrid& grid_;
  const Run& run_;
  bool from_end_ = false;
  float off_m_ = 0.0F;
};

}  // namespace

int JettyReturns(const ScanGrid& grid, const Run& run, bool from_end) {
  if (run.length < kLeastJettyReturns || run.length > grid.num_columns() / 2) return 0;
  const RunEnd end(grid, run, from_end);
  if (!end.MayBeLong() || !end.IsFree()) return 0;
  const bool is_afloat = RunEnd(grid, run, !from_end).IsFree();
  const int corner = end.EndOfStraight(0);
  if (end.HasFoot(0, corner, is_afloat)) return corner;
  if (corner == 0) return 0;
  const PlanVector face = end.Between(0, corner);
  const float face_m = face.Length();
  if (face_m < kLeastFaceM || face_m > kGreatestFaceM) return 0;
  const int foot = end.EndOfStraight(corner);
  if (foot == corner) return 0;
  const PlanVector side = end.Between(corner, foot);
  const float cosine = std::abs(Cosine(face, side));
  if (foot - corner < kLeastSideReturns || cosine > kFaceCosine) return 0;
  if (end.HasFoot(corner, foot, is_afloat)) return foot;
  const bool is_whole_run = foot >= run.length - 2 && !is_afloat;
  const bool is_square = corner > 2 && face_m >= kLeastSeenFaceM && cosine <= kSquareFaceCosine;
  const bool is_long = side.Length() >= kLeastJettyM && end.Between(0, foot).Length() <= kGreatestJettyM;
  return is_whole_run && is_square && is_long ? run.length : 0;
}

}  // namespace lookout::segmenter
