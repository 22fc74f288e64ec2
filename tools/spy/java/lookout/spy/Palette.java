package lookout.spy;

import java.awt.Color;

/** Colours, all readable on white. A segment has the colour that it has in the pictures of lookout-export (tools/export/colour.cpp). */
final class Palette {
  static final Color BACKGROUND = Color.WHITE;
  static final Color INK = new Color(28, 36, 48);
  static final Color FAINT_INK = new Color(120, 130, 144);
  static final Color GRID = new Color(222, 227, 233);
  static final Color ALERT = new Color(190, 20, 20);
  static final Color CAUTION = new Color(200, 110, 0);
  static final Color TRACK = new Color(20, 70, 170);
  /** Land that the tracker remembers, where free water meets it. */
  static final Color WATERLINE = new Color(120, 92, 40);
  /** No return. */
  static final Color NOTHING = new Color(244, 246, 249);
  static final Color OWN_VESSEL = new Color(200, 148, 96);
  static final Color IN_NO_SEGMENT = new Color(176, 186, 198);

  private static final double GOLDEN_RATIO = 0.61803398874989485;
  private static final double[] LIGHTNESS = {0.42, 0.52, 0.34};
  private static final double MAX_LUMA = 140.0;

  private Palette() {}

  /** @param label 1 and more */
  static Color ofSegment(int label) {
    // Steps of the golden ratio never come close to a hue of late; lightness tells the next round apart.
    double turns = 0.58 + label * GOLDEN_RATIO;
    double hue = turns - Math.floor(turns);
    double lightness = LIGHTNESS[Math.floorMod(label, LIGHTNESS.length)];
    double amplitude = 0.78 * Math.min(lightness, 1.0 - lightness);
    double[] channel = new double[3];
    int[] offset = {0, 8, 4};  // CSS Color 4, "hslToRgb"
    for (int i = 0; i < 3; ++i) {
      double k = (offset[i] + hue * 12.0) % 12.0;
      channel[i] = Math.round(255.0 * (lightness - amplitude * Math.max(-1.0, Math.min(1.0, Math.min(k - 3.0, 9.0 - k)))));
    }
    // Yellow and green look brighter than blue of the same lightness (weights: ITU-R BT.601).
    double luma = 0.299 * channel[0] + 0.587 * channel[1] + 0.114 * channel[2];
    double scale = Math.min(1.0, MAX_LUMA / luma);
    return new Color((int) Math.round(channel[0] * scale), (int) Math.round(channel[1] * scale), (int) Math.round(channel[2] * scale));
  }

  /** @param label of segments_t: above 0 a segment, 0 not labelled, below 0 in none, minus the reason */
  static Color ofLabel(int label) {
    if (label > 0) return ofSegment(label);
    return label == -lookout.segments_t.REASON_OWN_VESSEL ? OWN_VESSEL : IN_NO_SEGMENT;
  }

  /** From red (near) over green to blue (far), by the logarithm of the range, since near matters more. */
  static Color ofRange(double range_m) {
    double share = Math.log(Math.max(NEAR_M, Math.min(FAR_M, range_m)) / NEAR_M) / Math.log(FAR_M / NEAR_M);
    return Color.getHSBColor((float) (0.68 * share), 0.85f, 0.9f);
  }

  /** Ends of the colours of range. VLP-16 User Manual 63-9243: measures up to 100 m. */
  static final double NEAR_M = 1.0;
  static final double FAR_M = 100.0;
}
