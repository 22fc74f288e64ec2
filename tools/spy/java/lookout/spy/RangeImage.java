package lookout.spy;

import java.awt.Graphics2D;
import java.awt.Rectangle;
import java.awt.image.BufferedImage;

/** A scan as the lidar saw it: a row per ring, the highest on top; from astern over port, ahead (in the middle) and starboard to astern again. */
final class RangeImage {
  private RangeImage() {}

  /** Two strips of the same size: colours of range, and colours of segments. */
  static void paint(Graphics2D g, Picture picture, Rectangle ranges, Rectangle segments) {
    int num_rings = picture.scan() == null ? 1 : picture.scan().numRings();
    BufferedImage range_image = blank(ranges.width, num_rings);
    BufferedImage segment_image = blank(segments.width, num_rings);
    if (picture.scan() != null) fill(picture, range_image, segment_image);
    g.drawImage(range_image, ranges.x, ranges.y, ranges.width, ranges.height, null);
    g.drawImage(segment_image, segments.x, segments.y, segments.width, segments.height, null);
  }

  /** @param bearing_rad from the bow, clockwise */
  static int xOf(double bearing_rad, int width) {
    double circles = bearing_rad / (2.0 * Math.PI) + 0.5;
    return Math.min(width - 1, (int) ((circles - Math.floor(circles)) * width));
  }

  private static void fill(Picture picture, BufferedImage range_image, BufferedImage segment_image) {
    int width = range_image.getWidth();
    int num_rings = range_image.getHeight();
    int num_columns = 0;
    for (lookout.lidar_scan_t part : picture.scan().scanParts) num_columns += part.num_columns;
    // Where there are fewer columns than pixels, each takes several.
    int pixels_per_column = Math.max(1, (int) Math.ceil((double) width / Math.max(1, num_columns)));
    double[] nearest_m = new double[width * num_rings];
    picture.scan().forEachReturn((ring, azimuth_rad, elevation_rad, range_m, label) -> {
      int x = xOf(azimuth_rad - picture.bowAzimuth_rad(), width);
      int y = num_rings - 1 - ring;
      for (int i = x; i < Math.min(width, x + pixels_per_column); ++i) {
        int pixel = y * width + i;
        if (nearest_m[pixel] != 0.0 && nearest_m[pixel] <= range_m) continue;
        nearest_m[pixel] = range_m;
        range_image.setRGB(i, y, Palette.ofRange(range_m).getRGB());
        segment_image.setRGB(i, y, Palette.ofLabel(label).getRGB());
      }
    });
  }

  private static BufferedImage blank(int width, int height) {
    BufferedImage image = new BufferedImage(Math.max(1, width), height, BufferedImage.TYPE_INT_RGB);
    Graphics2D g = image.createGraphics();
    g.setColor(Palette.NOTHING);
    g.fillRect(0, 0, image.getWidth(), height);
    g.dispose();
    return image;
  }
}
