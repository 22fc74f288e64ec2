package lookout.spy;

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
  double vesselX(double x_lidar_m, double y_lidar_m) {
    return x_m + Math.cos(yaw_rad) * x_lidar_m - Math.sin(yaw_rad) * y_lidar_m;
  }

  double vesselY(double x_lidar_m, double y_lidar_m) {
    return y_m + Math.sin(yaw_rad) * x_lidar_m + Math.cos(yaw_rad) * y_lidar_m;
  }

  /** So far apart the points must be for 0.1 m of tilt and height to rotate the picture by less than a degree. */
  private static final double MIN_SPREAD_M = 6.0;
  /** Roll and pitch of a mounting, which are left out here, move points by so much; a lidar upside down by far more. */
  private static final double MAX_RESIDUAL_M = 0.5;

  /** @return null where the pairs are too few, too close to each other, or do not fit (a lidar that hangs upside down) */
  static Mounting estimate(List<segment_t> segments, List<obstacle_t> obstacles) {
    double[][] pairs = new double[Math.min(segments.size(), obstacles.size())][];
    int num_pairs = 0;
    java.util.HashMap<Integer, segment_t> byId = new java.util.HashMap<>();
    for (segment_t segment : segments) byId.put(segment.id, segment);
    for (obstacle_t obstacle : obstacles) {
      segment_t segment = byId.remove(obstacle.id);
      if (segment == null) continue;
      double[] pair = {segment.nearest_m[0], segment.nearest_m[1], obstacle.nearest_vessel_m[0], obstacle.nearest_vessel_m[1]};
      if (Double.isFinite(pair[0] + pair[1] + pair[2] + pair[3])) pairs[num_pairs++] = pair;
    }
    if (num_pairs < 2) return null;

    // Least squares in the plane: rotate about the means, then shift (Umeyama 1991, without scale).
    double[] mean = new double[4];
    for (int i = 0; i < num_pairs; ++i) {
      for (int k = 0; k < 4; ++k) mean[k] += pairs[i][k] / num_pairs;
    }
    double dot = 0.0;
    double cross = 0.0;
    double spread_m = 0.0;
    for (int i = 0; i < num_pairs; ++i) {
      double[] d = new double[4];
      for (int k = 0; k < 4; ++k) d[k] = pairs[i][k] - mean[k];
      dot += d[0] * d[2] + d[1] * d[3];
      cross += d[0] * d[3] - d[1] * d[2];
      spread_m = Math.max(spread_m, Math.hypot(d[0], d[1]));
    }
    if (spread_m < MIN_SPREAD_M) return null;
    double yaw_rad = Math.atan2(cross, dot);
    Mounting turned = new Mounting(yaw_rad, 0.0, 0.0);
    Mounting mounting = new Mounting(yaw_rad, mean[2] - turned.vesselX(mean[0], mean[1]), mean[3] - turned.vesselY(mean[0], mean[1]));
    for (int i = 0; i < num_pairs; ++i) {
      double[] pair = pairs[i];
      double residual_m = Math.hypot(mounting.vesselX(pair[0], pair[1]) - pair[2], mounting.vesselY(pair[0], pair[1]) - pair[3]);
      if (!(residual_m <= MAX_RESIDUAL_M)) return null;
    }
    return mounting;
  }
}
