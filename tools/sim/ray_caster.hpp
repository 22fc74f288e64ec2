// Finds what a ray meets among many parts. Parts are sorted into sectors of azimuth as seen from the sensor, nearest first.
#pragma once

#include <vector>

#include "tools/sim/scene.hpp"

namespace lookout::sim {

struct Echo {
  Hit hit;
  int object_id = kNoObject;
  Material material{0.0};
};

class RayCaster {
 public:
  /// A set of parts with one frame.
  struct Body {
    int object_id = kNoObject;
    Track track;
    const std::vector<Part>* parts = nullptr;  // outlives the caster
  };
  explicit RayCaster(const std::vector<Body>& bodies);

  /// Moves the bodies to where they are at `time_s`, and sorts anew when the last sorting is older than kSortPeriodS.
  ///
  /// @param eye_m  where rays start from now on, within kMarginM
  void MoveTo(double time_s, const Eigen::Vector2d& eye_m);

  /// @return up to two surfaces, nearest first: the second only behind a porous first one. Farther than `max_range_m` counts as nothing.
  struct Echoes {
    int count = 0;
    Echo echo[2];
  };
  Echoes Cast(const Ray& ray, double max_range_m, bool wants_second) const;

  static constexpr double kSortPeriodS = 0.01;
  // Way of the eye and a body towards each other between two sortings: 10 m/s for 10 ms.
  static constexpr double kMarginM = 0.1;

 private:
  struct Place {  // of a body: p_object = R (p_map - origin)
    Eigen::Vector2d origin_m;
    double sine = 0.0;
    double cosine = 1.0;
  };
  struct Item {
    const Part* part = nullptr;
    PlanBounds bounds;
    std::size_t body = 0;
    double nearest_m = 0.0;  // from the eye, less kMarginM
  };
  // From the first bin, clockwise round to the last.
  struct Bins {
    int first;
    int count;
  };

  void Sort(const Eigen::Vector2d& eye_m);
  Bins BinsOf(Item& item, const Eigen::Vector2d& eye_m) const;
  std::optional<Hit> IntersectItem(const Item& item, const Ray& ray) const;

  std::vector<Body> bodies_;
  std::vector<Place> places_;
  std::vector<Item> items_;
  std::vector<std::vector<const Item*>> bins_;  // by direction, counter-clockwise from the x axis
  std::vector<std::size_t> order_;
  double sorted_at_s_ = -1e9;
};

}  // namespace lookout::sim
