package lookout.spy;

import java.util.ArrayList;
import java.util.Comparator;
import java.util.Iterator;
import java.util.LinkedHashMap;
import java.util.List;
import java.util.TreeMap;
import lookout.alerts_t;
import lookout.lidar_scan_t;
import lookout.obstacle_t;
import lookout.obstacles_t;
import lookout.pose_t;
import lookout.segments_t;
import lookout.tracks_t;

/** Merges the messages of scans, which come in parts. What contradicts itself is refused and counted; nothing throws. Not for several threads. */
final class Scans {
  /** A scan waits for its labels until so many newer ones have begun; live they come within a scan or two. */
  private static final int MAX_WAITING = 4;

  // Wide enough for any spinning lidar; beyond is a corrupt message, or memory without end.
  private static final int MAX_PARTS = 64;
  private static final int MAX_RINGS = 256;
  private static final int MAX_SCAN_COLUMNS = 100_000;

  /** The messages of one scan, by part_index. */
  private static final class Messages {
    final TreeMap<Integer, lidar_scan_t> scan = new TreeMap<>();
    final TreeMap<Integer, segments_t> segments = new TreeMap<>();
    final TreeMap<Integer, obstacles_t> obstacles = new TreeMap<>();
    boolean isDrawn;

    boolean hasScan() {
      return !scan.isEmpty() && scan.size() == scan.firstEntry().getValue().num_parts;
    }

    boolean hasSegments() {
      return !segments.isEmpty() && segments.size() == segments.firstEntry().getValue().num_parts;
    }

    boolean hasObstacles() {
      return !obstacles.isEmpty() && obstacles.size() == obstacles.firstEntry().getValue().num_parts;
    }
  }

  private record Key(long utime_us, long seq) {}

  private final LinkedHashMap<Key, Messages> waiting = new LinkedHashMap<>();
  private final Tracks tracks = new Tracks();
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
    Key key = new Key(part.utime_us, part.seq);
    Messages known = waiting.get(key);
    // The same scan begins once more: a log that is played again.
    boolean isAgain = part.part_index == 0 && known != null && known.scan.containsKey(0);
    boolean fits = isAgain || known == null || known.scan.isEmpty() || fits(known.scan.firstEntry().getValue(), part);
    if (!isGood(part) || !fits) {
      refuse();
      return;
    }
    if (isAgain) waiting.remove(key);
    Messages messages = messagesOf(key);
    messages.scan.put(part.part_index, part);
    draw(messages, now_ms);
  }

  void add(segments_t part, long now_ms) {
    if (!isGood(part)) {
      refuse();
      return;
    }
    Messages messages = messagesOf(new Key(part.utime_us, part.seq));
    messages.segments.put(part.part_index, part);
    draw(messages, now_ms);
  }

  void add(obstacles_t part, long now_ms) {
    if (!isPart(part.part_index, part.num_parts)) {
      refuse();
      return;
    }
    Messages messages = messagesOf(new Key(part.utime_us, part.seq));
    messages.obstacles.put(part.part_index, part);
    if (!messages.hasObstacles()) return;

    List<obstacle_t> obstacles = new ArrayList<>();
    for (obstacles_t each : messages.obstacles.values()) obstacles.addAll(List.of(each.obstacles));
    obstacles.removeIf(obstacle -> !Float.isFinite(obstacle.range_m) || !Float.isFinite(obstacle.bearing_rad));
    obstacles.sort(Comparator.<obstacle_t>comparingDouble(obstacle -> obstacle.range_m).thenComparingInt(obstacle -> obstacle.id));
    // The mounting does not change: one that was good stays until the next good one.
    Mounting estimate = messages.hasSegments() ? Mounting.estimate(Scan.segmentsOf(messages.segments.values()), obstacles) : null;
    Mounting mounting = estimate == null ? picture.mounting() : estimate;
    picture = new Picture(picture.scan(), List.copyOf(obstacles), mounting, picture.heading_rad(), picture.scanTime_ms(), now_ms, picture.lookOut());
  }

  void add(pose_t pose) {
    tracks.add(pose);
    picture = new Picture(picture.scan(), picture.obstacles(), picture.mounting(), pose.heading_rad, picture.scanTime_ms(), picture.obstaclesTime_ms(),
        picture.lookOut());
  }

  void add(tracks_t part, long now_ms) {
    if (!isPart(part.part_index, part.num_parts)) {
      refuse();
      return;
    }
    tracks.add(part, now_ms);
    picture = picture.with(tracks.lookOut());
  }

  void add(alerts_t message, long now_ms) {
    tracks.add(message, now_ms);
    picture = picture.with(tracks.lookOut());
  }

  private Messages messagesOf(Key key) {
    Messages messages = waiting.computeIfAbsent(key, unused -> new Messages());
    Iterator<Messages> oldest = waiting.values().iterator();
    while (waiting.size() > MAX_WAITING) {
      oldest.next();
      oldest.remove();
    }
    return messages;
  }

  // A labelled scan is drawn when it is whole; without a segmenter, a scan when the next but one begins.
  private void draw(Messages newest, long now_ms) {
    if (newest.hasScan() && newest.hasSegments()) {
      show(newest, now_ms);
      return;
    }
    Messages[] all = waiting.values().toArray(new Messages[0]);
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

  private void show(Messages messages, long now_ms) {
    messages.isDrawn = true;
    boolean isLabelled = messages.hasSegments() && messages.segments.size() >= messages.scan.size();
    Scan scan = new Scan(List.copyOf(messages.scan.values()), isLabelled ? List.copyOf(messages.segments.values()) : null);
    picture = new Picture(scan, picture.obstacles(), picture.mounting(), picture.heading_rad(), now_ms, picture.obstaclesTime_ms(), picture.lookOut());
  }

  private static boolean isPart(int part_index, int num_parts) {
    return num_parts >= 1 && num_parts <= MAX_PARTS && part_index >= 0 && part_index < num_parts;
  }

  private static boolean isGrid(int num_rings, int num_returns, int first_column, int num_columns, int num_cells) {
    return num_rings >= 1 && num_rings <= MAX_RINGS && num_returns >= 1 && num_returns <= 2 && first_column >= 0 && first_column <= MAX_SCAN_COLUMNS
        && num_columns >= 0 && num_columns <= MAX_SCAN_COLUMNS && num_cells == num_columns * num_rings * num_returns;
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
