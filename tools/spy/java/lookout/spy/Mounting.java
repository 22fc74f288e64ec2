package lookout.spy;

import java.awt.geom.AffineTransform;
import java.awt.geom.Point2D;
import java.util.ArrayList;
import java.util.HashMap;
import java.util.List;
import lookout.obstacle_t;
import lookout.segment_t;

/**
 * Where the lidar sits in the vessel, seen from above. SEGMENTS hold the nearest return of each segment in the lidar frame, OBSTACLES the same
 * return in the vessel frame, under the same id: the rotation and shift between them are the mounting, so that no config is needed here.
 *
 * @param yaw_rad from the vessel's x axis (bow) to the lidar's, counter-clockwise
 * @param x_m of the lidar in the vessel frame (x forward, y port)
 */
record Mounting(double yaw_rad, double x_m, double y_m) {
  /** From the lidar frame to the vessel's. */
  AffineTransform toVessel() {
    AffineTransform transform = AffineTransform.getTranslateInstance(x_m, y_m);
    transform.rotate(yaw_rad);
    return transform;
  }

  /** So far apart the points must be for 0.1 m of tilt and height to rotate the picture by less than a degree. */
  private static final double MIN_SPREAD_M = 6.0;
  /** Roll and pitch of a mounting, which are left out here, move points by so much; a lidar upside down by far more. */
  private static final double MAX_RESIDUAL_M = 0.5;

  /** @return null where the pairs are too few, too close to each other, or do not fit (a lidar that hangs upside down) */
  static Mounting estimate(List<segment_t> segments, List<obstacle_t> obstacles) {
    List<double[]> pairs = new ArrayList<>();
    HashMap<Integer, segment_t> byId = new HashMap<>();
    for (segment_t segment : segments) byId.put(segment.id, segment);
    for (obstacle_t obstacle : obstacles) {
      segment_t segment = byId.remove(obstacle.id);
      if (segment == null) continue;
      double[] pair = {segment.nearest_m[0], segment.nearest_m[1], obstacle.nearest_vessel_m[0], obstacle.nearest_vessel_m[1]};
      if (Double.isFinite(pair[0] + pair[1] + pair[2] + pair[3])) pairs.add(pair);
    }
    if (pairs.size() < 2) return null;

    // Least squares in the plane: rotate about the means, then shift (Umeyama 1991, without scale).
    double[] mean = new double[4];
    for (double[] pair : pairs) {
      for (int k = 0; k < 4; ++k) mean[k] += pair[k] / pairs.size();
    }
    double dot = 0.0;
    double cross = 0.0;
    double spread_m = 0.0;
    for (double[] pair : pairs) {
      double[] d = new double[4];
      for (int k = 0; k < 4; ++k) d[k] = pair[k] - mean[k];
      dot += d[0] * d[2] + d[1] * d[3];
      cross += d[0] * d[3] - d[1] * d[2];
      spread_m = Math.max(spread_m, Math.hypot(d[0], d[1]));
    }
    if (spread_m < MIN_SPREAD_M) return null;
    double yaw_rad = Math.atan2(cross, dot);
    Point2D rotated = AffineTransform.getRotateInstance(yaw_rad).transform(new Point2D.Double(mean[0], mean[1]), null);
    Mounting mounting = new Mounting(yaw_rad, mean[2] - rotated.getX(), mean[3] - rotated.getY());
    for (double[] pair : pairs) {
      Point2D place = mounting.toVessel().transform(new Point2D.Double(pair[0], pair[1]), null);
      if (!(place.distance(pair[2], pair[3]) <= MAX_RESIDUAL_M)) return null;
    }
    return mounting;
  }
}
