package lookout.spy;

import java.awt.BorderLayout;
import java.awt.Window;
import java.awt.event.ActionEvent;
import java.awt.event.WindowAdapter;
import java.awt.event.WindowEvent;
import java.io.IOException;
import java.util.stream.Stream;
import javax.swing.AbstractAction;
import javax.swing.Action;
import javax.swing.JDesktopPane;
import javax.swing.JFrame;
import javax.swing.JOptionPane;
import javax.swing.SwingUtilities;
import lcm.spy.ChannelData;
import lcm.spy.SpyPlugin;
import lookout.alerts_t;
import lookout.lidar_scan_t;
import lookout.obstacles_t;
import lookout.segments_t;
import lookout.tracks_t;

/**
 * Plugin of lcm-spy, which finds it on its class path: a double click on LIDAR_SCAN, SEGMENTS, OBSTACLES, TRACKS or ALERTS opens the picture
 * of all. */
public final class SpyView implements SpyPlugin {
  /** "true": the picture opens at the start, without a click. */
  private static final String OPEN_AT_START = "lookout.spy.view";

  public SpyView() {
    if (Boolean.getBoolean(OPEN_AT_START)) {
      SwingUtilities.invokeLater(() -> {
        JFrame frame = new JFrame();
        // The spy's own window ends the program; this one only itself.
        frame.setDefaultCloseOperation(JFrame.DISPOSE_ON_CLOSE);
        show(frame);
      });
    }
  }

  @Override
  public boolean canHandle(long fingerprint) {
    return Stream.of(lidar_scan_t.LCM_FINGERPRINT, segments_t.LCM_FINGERPRINT, obstacles_t.LCM_FINGERPRINT, tracks_t.LCM_FINGERPRINT,
        alerts_t.LCM_FINGERPRINT).anyMatch(handled -> handled == fingerprint);
  }

  /** @param desktop of a window that the spy has just made; null where it only asks for the name of the action */
  @Override
  public Action getAction(JDesktopPane desktop, ChannelData channel) {
    return new AbstractAction("Range image and map") {
      private static final long serialVersionUID = 1L;

      @Override
      public void actionPerformed(ActionEvent event) {
        Window window = desktop == null ? null : SwingUtilities.getWindowAncestor(desktop);
        if (window instanceof JFrame) show((JFrame) window);
      }
    };
  }

  private static void show(JFrame frame) {
    Feed feed;
    try {
      feed = new Feed();
    } catch (IOException error) {
      JOptionPane.showMessageDialog(frame, "LCM cannot be opened: " + error.getMessage());
      return;
    }
    ViewPanel panel = new ViewPanel(feed);
    frame.setTitle("Lookout");
    // The whole window: a desktop of windows within it would only cost room.
    frame.getContentPane().removeAll();
    frame.getContentPane().add(panel, BorderLayout.CENTER);
    frame.addWindowListener(new WindowAdapter() {
      @Override
      public void windowClosing(WindowEvent event) {
        panel.stop();
      }
    });
    frame.pack();
    frame.setVisible(true);
    panel.requestFocusInWindow();
  }
}
