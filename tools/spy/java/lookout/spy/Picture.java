package lookout.spy;

import java.util.List;
import lookout.obstacle_t;

/**
 * What there is to draw: never changed once made, so that it may go from one thread to another.
 *
 * @param scan null: none yet
 * @param obstacles of the newest whole scan, nearest first
 * @param mounting where the lidar sits in the vessel; null while it is not known
 * @param heading_rad from true north, clockwise; NaN = not known
 * @param scanTime_ms host time of the last scan; 0 = none yet
 * @param obstaclesTime_ms of the last obstacles
 * @param lookOut what the tracker says
 */
record Picture(Scan scan, List<obstacle_t> obstacles, Mounting mounting, double heading_rad, long scanTime_ms, long obstaclesTime_ms,
    LookOut lookOut) {
  static final Picture EMPTY = new Picture(null, List.of(), null, Double.NaN, 0, 0, LookOut.NONE);

  Picture with(LookOut newer) {
    return new Picture(scan, obstacles, mounting, heading_rad, scanTime_ms, obstaclesTime_ms, newer);
  }

  /** What is older says nothing about the water of now. */
  static final long MAX_AGE_MS = 2000;

  boolean hasObstacles(long now_ms) {
    return obstaclesTime_ms != 0 && now_ms - obstaclesTime_ms <= MAX_AGE_MS;
  }

  boolean hasScan(long now_ms) {
    return scan != null && now_ms - scanTime_ms <= MAX_AGE_MS;
  }

  /** Azimuth of the bow in the lidar frame, clockwise from its x axis; 0 while the mounting is not known. */
  double bowAzimuth_rad() {
    return mounting == null ? 0.0 : mounting.yaw_rad();
  }
}
