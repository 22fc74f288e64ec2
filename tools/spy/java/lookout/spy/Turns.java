package lookout.spy;

import java.util.ArrayList;
import java.util.Comparator;
import java.util.HashMap;
import java.util.Iterator;
import java.util.LinkedHashMap;
import java.util.List;
import java.util.Map;
import lookout.lidar_scan_t;
import lookout.obstacle_t;
import lookout.obstacles_t;
import lookout.pose_t;
import lookout.segment_t;
import lookout.segments_t;

/** Puts turns together from messages that come in parts. What contradicts itself is refused and counted; nothing throws. Not for several threads. */
final class Turns {
  /** A turn waits for its labels until so many newer ones have begun; live they come within a turn or two. */
  private static final int MAX_WAITING = 4;

  // Wide enough for any spinning lidar; beyond is a corrupt message, or memory without end.
  private static final int MAX_PARTS = 64;
  private static final int MAX_RINGS = 256;
  private static final int MAX_TURN_COLUMNS = 100_000;

  /** A turn in the making, or a whole one. Parts by their index. */
  private static final class Gathering {
    final Map<Integer, lidar_scan_t> scan = new HashMap<>();
    final Map<Integer, segments_t> segments = new HashMap<>();
    final Map<Integer, obstacles_t> obstacles = new HashMap<>();
    boolean isDrawn;

    static <T> boolean isWhole(Map<Integer, T> parts, int num_parts) {
      return num_parts > 0 && parts.size() == num_parts;
    }
    boolean hasScan() {
      return !scan.isEmpty() && isWhole(scan, scan.values().iterator().next().num_parts);
    }
    boolean hasSegments() {
      return !segments.isEmpty() && isWhole(segments, segments.values().iterator().next().num_parts);
    }
    boolean hasObstacles() {
      return !obstacles.isEmpty() && isWhole(obstacles, obstacles.values().iterator().next().num_parts);
    }
  }

  private record Key(long utime_us, long seq) {}

  private final LinkedHashMap<Key, Gathering> waiting = new LinkedHashMap<>();
  private Picture picture = Picture.EMPTY;
  private long num_refused = 0;

  Picture picture() {
    return picture;
  }

  /** Messages that did not decode or contradicted themselves. */
  long num_refused() {
    return num_refused;
  }

  void refuse() {
    ++num_refused;
  }

  void add(lidar_scan_t part, long now_ms) {
    if (!isGood(part)) {
      refuse();
      return;
    }
    Key key = new Key(part.utime_us, part.seq);
    Gathering gathering = gatheringOf(key, part.part_index == 0 && hasScanPart(key, 0));
    if (!gathering.scan.isEmpty() && !fits(gathering.scan.values().iterator().next(), part)) {
      refuse();
      return;
    }
    gathering.scan.put(part.part_index, part);
    draw(gathering, now_ms);
  }

  void add(segments_t part, long now_ms) {
    if (!isGood(part)) {
      refuse();
      return;
    }
    Gathering gathering = gatheringOf(new Key(part.utime_us, part.seq), false);
    gathering.segments.put(part.part_index, part);
    draw(gathering, now_ms);
  }

  void add(obstacles_t part, long now_ms) {
    if (!isPart(part.part_index, part.num_parts)) {
      refuse();
      return;
    }
    Gathering gathering = gatheringOf(new Key(part.utime_us, part.seq), false);
    gathering.obstacles.put(part.part_index, part);
    if (!gathering.hasObstacles()) return;

    List<obstacle_t> obstacles = new ArrayList<>();
    for (obstacles_t each : gathering.obstacles.values()) obstacles.addAll(List.of(each.obstacles));
    obstacles.removeIf(obstacle -> !Float.isFinite(obstacle.range_m) || !Float.isFinite(obstacle.bearing_rad));
    obstacles.sort(Comparator.<obstacle_t>comparingDouble(obstacle -> obstacle.range_m).thenComparingInt(obstacle -> obstacle.id));
    // The mounting does not change: one that was good stays until the next good one.
    Mounting estimate = gathering.hasSegments() ? Mounting.estimate(segmentsOf(gathering), obstacles) : null;
    Mounting mounting = estimate == null ? picture.mounting : estimate;
    picture = new Picture(picture.turn, List.copyOf(obstacles), mounting, picture.heading_rad, picture.scanTime_ms, now_ms);
  }

  void add(pose_t pose) {
    picture = new Picture(picture.turn, picture.obstacles, picture.mounting, pose.heading_rad, picture.scanTime_ms, picture.obstaclesTime_ms);
  }

  private boolean hasScanPart(Key key, int part_index) {
    Gathering gathering = waiting.get(key);
    return gathering != null && gathering.scan.containsKey(part_index);
  }

  /** @param isAgain the same turn begins once more (a log that is played again) */
  private Gathering gatheringOf(Key key, boolean isAgain) {
    if (isAgain) waiting.remove(key);
    Gathering gathering = waiting.computeIfAbsent(key, unused -> new Gathering());
    Iterator<Gathering> oldest = waiting.values().iterator();
    while (waiting.size() > MAX_WAITING) {
      oldest.next();
      oldest.remove();
    }
    return gathering;
  }

  // A labelled turn is drawn when it is whole; without a segmenter, the scan when the next but one begins.
  private void draw(Gathering gathering, long now_ms) {
    if (gathering.hasScan() && gathering.hasSegments()) {
      show(gathering, now_ms);
      return;
    }
    Gathering[] all = waiting.values().toArray(new Gathering[0]);
    int num_newer = 0;
    for (int i = all.length - 1; i >= 0; --i) {
      if (all[i].isDrawn) return;
      if (all[i].hasScan() && num_newer >= 2) {
        show(all[i], now_ms);
        return;
      }
      if (all[i].hasScan()) ++num_newer;
    }
  }

  private void show(Gathering gathering, long now_ms) {
    gathering.isDrawn = true;
    List<lidar_scan_t> scan = inOrder(gathering.scan);
    List<segments_t> segments = gathering.hasSegments() && gathering.segments.size() >= scan.size() ? inOrder(gathering.segments) : null;
    picture = new Picture(new Turn(scan, segments), picture.obstacles, picture.mounting, picture.heading_rad, now_ms, picture.obstaclesTime_ms);
  }

  private static <T> List<T> inOrder(Map<Integer, T> parts) {
    List<T> ordered = new ArrayList<>();
    for (int i = 0; i < parts.size(); ++i) ordered.add(parts.get(i));
    return ordered;
  }

  private static List<segment_t> segmentsOf(Gathering gathering) {
    List<segment_t> segments = new ArrayList<>();
    for (segments_t part : inOrder(gathering.segments)) segments.addAll(List.of(part.segments));
    return segments;
  }

  private static boolean isPart(int part_index, int num_parts) {
    return num_parts >= 1 && num_parts <= MAX_PARTS && part_index >= 0 && part_index < num_parts;
  }

  private static boolean isGrid(int num_rings, int num_returns, int first_column, int num_columns, int num_cells) {
    return num_rings >= 1 && num_rings <= MAX_RINGS && num_returns >= 1 && num_returns <= 2 && first_column >= 0 && first_column <= MAX_TURN_COLUMNS
        && num_columns >= 0 && num_columns <= MAX_TURN_COLUMNS && num_cells == num_columns * num_rings * num_returns;
  }

  private static boolean isGood(lidar_scan_t part) {
    boolean is_good = isPart(part.part_index, part.num_parts)
        && isGrid(part.num_rings, part.num_returns, part.first_column, part.num_columns, part.num_cells) && part.range_unit_m > 0.0
        && part.range_unit_m <= 1.0;
    for (int i = 0; is_good && i < part.num_rings; ++i) is_good = Float.isFinite(part.elevation_rad[i]) && Float.isFinite(part.azimuth_offset_rad[i]);
    for (int i = 0; is_good && i < part.num_columns; ++i) is_good = Float.isFinite(part.azimuth_rad[i]);
    return is_good;
  }

  private static boolean isGood(segments_t part) {
    return isPart(part.part_index, part.num_parts) && isGrid(part.num_rings, part.num_returns, part.first_column, part.num_columns, part.num_cells);
  }

  private static boolean fits(lidar_scan_t first, lidar_scan_t part) {
    return first.num_parts == part.num_parts && first.num_rings == part.num_rings;
  }
}
