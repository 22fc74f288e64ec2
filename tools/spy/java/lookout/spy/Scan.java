package lookout.spy;

import java.util.Arrays;
import java.util.Collection;
import java.util.List;
import lookout.lidar_scan_t;
import lookout.segment_t;
import lookout.segments_t;

/** A whole scan: all its parts and, where the segmenter runs, its labels. Parts are checked; nothing changes them. */
final class Scan {
  final List<lidar_scan_t> scanParts;
  /** Beside each part of the scan its labels; null where they did not come. Parts without columns follow. */
  final List<segments_t> segmentParts;

  Scan(List<lidar_scan_t> scanParts, List<segments_t> segmentParts) {
    this.scanParts = scanParts;
    this.segmentParts = segmentParts;
  }

  boolean isLabelled() {
    return segmentParts != null;
  }

  int numRings() {
    return scanParts.get(0).num_rings;
  }

  List<segment_t> segments() {
    return segmentParts == null ? List.of() : segmentsOf(segmentParts);
  }

  static List<segment_t> segmentsOf(Collection<segments_t> parts) {
    return parts.stream().flatMap(part -> Arrays.stream(part.segments)).toList();
  }

  interface Visitor {
    /**
     * One return.
     *
     * @param ring from the lowest up
     * @param azimuth_rad clockwise from the lidar's x axis
     * @param range_m above 0
     * @param label of segments_t; 0 where there are none
     */
    void visit(int ring, double azimuth_rad, double elevation_rad, double range_m, int label);
  }

  /** Visits every return, column by column; of a firing with two returns both. */
  void forEachReturn(Visitor visitor) {
    for (int i = 0; i < scanParts.size(); ++i) {
      lidar_scan_t scan = scanParts.get(i);
      segments_t labels = segmentParts == null ? null : segmentParts.get(i);
      if (labels != null && labels.num_cells != scan.num_cells) labels = null;
      int cell = 0;
      for (int column = 0; column < scan.num_columns; ++column) {
        for (int ring = 0; ring < scan.num_rings; ++ring) {
          double azimuth_rad = scan.azimuth_rad[column] + scan.azimuth_offset_rad[ring];
          for (int k = 0; k < scan.num_returns; ++k, ++cell) {
            int count = scan.range[cell] & 0xFFFF;  // unsigned on the wire
            if (count == 0) continue;
            visitor.visit(ring, azimuth_rad, scan.elevation_rad[ring], count * scan.range_unit_m, labels == null ? 0 : labels.label[cell]);
          }
        }
      }
    }
  }
}
