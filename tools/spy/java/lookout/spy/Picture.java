package lookout.spy;

import java.util.List;
import lookout.obstacle_t;

/** What there is to draw: never changed once made, so that it may go from one thread to another. */
final class Picture {
  /** null: none yet. */
  final Turn turn;
  /** Of the newest whole turn, nearest first. */
  final List<obstacle_t> obstacles;
  /** Where the lidar sits in the vessel; null while nothing told of it. */
  final Mounting mounting;
  /** From true north, clockwise; NaN = not known. */
  final double heading_rad;
  /** Host times of the last scan and the last obstacles, ms; 0 = none yet. */
  final long scanTime_ms;
  final long obstaclesTime_ms;

  static final Picture EMPTY = new Picture(null, List.of(), null, Double.NaN, 0, 0);

  Picture(Turn turn, List<obstacle_t> obstacles, Mounting mounting, double heading_rad, long scanTime_ms, long obstaclesTime_ms) {
    this.turn = turn;
    this.obstacles = obstacles;
    this.mounting = mounting;
    this.heading_rad = heading_rad;
    this.scanTime_ms = scanTime_ms;
    this.obstaclesTime_ms = obstaclesTime_ms;
  }

  /** What is older says nothing about the water of now. */
  static final long MAX_AGE_MS = 2000;

  boolean hasObstacles(long now_ms) {
    return obstaclesTime_ms != 0 && now_ms - obstaclesTime_ms <= MAX_AGE_MS;
  }

  boolean hasScan(long now_ms) {
    return turn != null && now_ms - scanTime_ms <= MAX_AGE_MS;
  }

  /** Azimuth of the bow in the lidar frame, clockwise from its x axis; 0 while the mounting is not known. */
  double bowAzimuth_rad() {
    return mounting == null ? 0.0 : mounting.yaw_rad;
  }
}
