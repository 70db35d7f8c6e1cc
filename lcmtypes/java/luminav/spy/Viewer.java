package luminav.spy;

import java.awt.Color;
import java.awt.Dimension;
import java.awt.Graphics;
import java.awt.Graphics2D;
import java.awt.RenderingHints;
import java.awt.Window;
import java.awt.event.ActionEvent;
import java.awt.event.WindowAdapter;
import java.awt.event.WindowEvent;
import java.beans.PropertyVetoException;
import java.io.IOException;
import java.util.function.Supplier;
import javax.swing.AbstractAction;
import javax.swing.Action;
import javax.swing.JDesktopPane;
import javax.swing.JInternalFrame;
import javax.swing.JPanel;
import javax.swing.SwingUtilities;
import lcm.lcm.LCM;
import lcm.lcm.LCMDataInputStream;
import lcm.lcm.LCMSubscriber;

/**
 * A drawing of some channels in a window of lcm-spy. Messages come in on LCM's thread and are drawn on Swing's: a
 * viewer touches its state on Swing's thread only.
 */
abstract class Viewer extends JPanel {
  private final String[] channels;
  private final LCMSubscriber subscriber = this::receive;

  /** @param channels that `take` gets; each must be a plain name */
  Viewer(int width, int height, String... channels) {
    this.channels = channels;
    setPreferredSize(new Dimension(width, height));
    setBackground(Color.WHITE);
  }

  /** Decodes on LCM's thread; the result, run on Swing's thread, changes what is drawn. */
  abstract Runnable take(String channel, LCMDataInputStream data) throws IOException;

  abstract void draw(Graphics2D g);

  /** Once, when the viewer listens. */
  void opened() {}

  private void receive(LCM lcm, String channel, LCMDataInputStream data) {
    try {
      final Runnable change = take(channel, data);
      SwingUtilities.invokeLater(() -> {
        change.run();
        repaint();
      });
    } catch (IOException | RuntimeException damaged) {
      // another version of the type, or damaged; lcm-spy itself counts it as undecodable
    }
  }

  @Override
  protected void paintComponent(Graphics g) {
    super.paintComponent(g);
    final Graphics2D copy = (Graphics2D) g.create();
    copy.setRenderingHint(RenderingHints.KEY_ANTIALIASING, RenderingHints.VALUE_ANTIALIAS_ON);
    draw(copy);
    copy.dispose();
  }

  /** A line of text at the top. */
  static void label(Graphics2D g, String text) {
    g.setColor(Color.WHITE);
    g.fillRect(0, 0, g.getFontMetrics().stringWidth(text) + 12, 18);
    g.setColor(Color.BLACK);
    g.drawString(text, 6, 14);
  }

  /** What lcm-spy's menu shows under `name`; `pane` is null when lcm-spy only asks for the name. */
  static Action action(String name, JDesktopPane pane, Supplier<Viewer> maker) {
    return new AbstractAction(name) {
      @Override
      public void actionPerformed(ActionEvent event) {
        maker.get().open(name, pane);
      }
    };
  }

  /** lcm-spy gives each viewer a window of its own with nothing but `pane` in it. */
  private void open(String name, JDesktopPane pane) {
    final JInternalFrame frame = new JInternalFrame(name, true, false, true, false);
    frame.add(this);
    frame.pack();
    pane.setPreferredSize(frame.getSize());
    pane.add(frame);
    frame.setVisible(true);
    final LCM lcm = LCM.getSingleton();
    final Window window = SwingUtilities.getWindowAncestor(pane);
    if (window != null) {
      window.pack();
      window.addWindowListener(new WindowAdapter() {
        @Override
        public void windowClosing(WindowEvent event) {
          for (String channel : channels) {
            lcm.unsubscribe(channel, subscriber);
          }
          window.dispose();
        }
      });
    }
    try {
      frame.setMaximum(true);
    } catch (PropertyVetoException refused) {
      // then it keeps its size
    }
    for (String channel : channels) {
      lcm.subscribe(channel, subscriber);
    }
    opened();
  }
}
