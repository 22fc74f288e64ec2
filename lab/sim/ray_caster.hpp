// Finds what a beam meets among many parts. Parts are sorted into sectors of azimuth as seen from the sensor, nearest first.
#pragma once

#include <array>
#include <vector>

#include "lab/sim/scene.hpp"

namespace lookout::sim {

struct Echo {
  Hit hit;
  int object_id = kNoObject;
  Material material{0.0};
  ReturnReason reason = ReturnReason::kObject;
  double share = 1.0;              // of the beam's light
  bool is_behind_foliage = false;  // the echo before comes from foliage
};

/// Nearest first.
struct Echoes {
  static constexpr int kMaxCount = 3;
  int count = 0;
  std::array<Echo, kMaxCount> echo;
};

/// Half angles of a beam with an elliptic section; 0 and 0 = a ray.
struct BeamWidth {
  double half_horizontal_rad = 0.0;
  double half_vertical_rad = 0.0;

  bool is_ray() const { return half_horizontal_rad == 0.0 && half_vertical_rad == 0.0; }
};

class RayCaster {
 public:
  /// @param objects  outlive the caster
  /// @param sea      what floats rides it; outlives the caster; may be nullptr where nothing does
  RayCaster(const std::vector<SceneObject>& objects, const BeamWidth& width, const Sea* sea);

  /// Moves the objects to where they are at `time_s`, and sorts anew when the last sorting is older than kSortPeriodS.
  ///
  /// @param eye_m  where rays start from now on, within kMarginM
  void MoveTo(double time_s, const Eigen::Vector2d& eye_m);

  /// Along a ray, whatever the width of the beam.
  ///
  /// @return up to two surfaces, nearest first: the second only behind a porous first one. Farther than `max_range_m` counts as nothing.
  Echoes Cast(const Ray& ray, double max_range_m, bool wants_second);

  /// Casts a beam: the surfaces that its rays meet. Surfaces within kMergeM behind each other give one echo between them.
  Echoes CastBeam(const Ray& axis, double max_range_m, bool wants_second);

  static constexpr double kSortPeriodS = 0.01;
  // Way of the eye and an object towards each other between two sortings: 10 m/s for 10 ms.
  static constexpr double kMarginM = 0.1;
  // A pulse of 6 ns is 0.9 m long there and back: echoes that are closer run into each other.
  static constexpr double kMergeM = 1.0;

 private:
  struct Place {  // of an object: p_object = R_tilt^T (Rz (p_map - origin))
    Eigen::Vector2d origin_m;
    double sine = 0.0;
    double cosine = 1.0;
    bool is_tilted = false;
    double height_m = 0.0;
    Eigen::Matrix3d R_tilt = Eigen::Matrix3d::Identity();
  };
  struct Item {
    const Part* part = nullptr;
    Bounds bounds;  // frame of its object
    std::size_t object = 0;
    // As of the last sorting, from the eye, widened by kMarginM.
    double nearest_m = 0.0;
    double farthest_m = 0.0;
    double low_map_m = 0.0;
    double high_map_m = 0.0;
    Eigen::Vector2d middle = Eigen::Vector2d::Zero();  // unit vector to the middle of the object's sector
    double cosine_half = -1.0;                         // cosine of half the object's sector
  };
  // From the first bin, counter-clockwise round to the last.
  struct Bins {
    int first;
    int count;
  };
  struct Meeting {
    const Item* item = nullptr;
    Hit hit;
  };

  void Move(std::size_t object, double time_s);
  void Tilt(double time_s);
  void Sort(const Eigen::Vector2d& eye_m);
  Bins BinsOf(Item& item, const Eigen::Vector2d& eye_m) const;
  std::optional<Hit> IntersectItem(const Item& item, const Ray& ray) const;
  void Gather(const Ray& axis, double max_range_m, double slope_margin);
  Meeting NearestOf(const Ray& ray, double max_range_m, const Item* skipped) const;
  Echo ToEcho(const Meeting& meeting) const;
  Echoes ToEchoes(const Meeting& first, const Ray& ray, double max_range_m, bool wants_second) const;
  Echo Merge(const Meeting* begin, const Meeting* end, int num_rays) const;

  const std::vector<SceneObject>& objects_;
  BeamWidth width_;
  const Sea* sea_;
  std::vector<Place> places_;
  std::vector<Item> items_;
  std::vector<std::vector<const Item*>> bins_;  // by direction, counter-clockwise from the x axis
  std::vector<std::size_t> order_;
  std::vector<const Item*> near_;  // parts that the beam of this call may meet, nearest first
  double sorted_at_s_ = -1e9;
  double tilted_at_s_ = -1e9;
};

}  // namespace lookout::sim
