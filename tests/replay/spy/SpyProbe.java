import java.awt.Component;
import java.awt.Container;
import java.awt.Frame;
import java.awt.Rectangle;
import java.awt.Robot;
import java.awt.Window;
import java.awt.event.MouseEvent;
import java.awt.image.BufferedImage;
import java.io.File;
import java.lang.instrument.Instrumentation;
import java.lang.reflect.InvocationTargetException;
import java.nio.file.Files;
import java.nio.file.Path;
import java.util.ArrayList;
import java.util.HashMap;
import java.util.HashSet;
import java.util.List;
import java.util.Map;
import java.util.Set;
import java.util.concurrent.Callable;
import java.util.concurrent.ExecutionException;
import java.util.concurrent.FutureTask;
import javax.imageio.ImageIO;
import javax.swing.JInternalFrame;
import javax.swing.JTable;
import javax.swing.SwingUtilities;
import javax.swing.table.TableModel;

/**
 * Looks at lcm-spy from inside its own process (-javaagent:spy-probe.jar=CHANNELS,FOLDER) and ends it with a verdict.
 * First every channel named in the file CHANNELS must stand in lcm-spy's table, with a type and nothing undecodable; then
 * FOLDER/decoded is made. Then the viewers are opened, as by double click, and must draw what is published in that time;
 * FOLDER/lcm-spy.png shows the screen with them.
 */
public final class SpyProbe {
  private static final long PATIENCE = 90_000;  // [ms] for each step
  private static final long PAUSE = 200;  // [ms] between two looks
  private static final int CHANNEL = 0;  // columns of lcm-spy's table
  private static final int TYPE = 1;
  private static final int COUNT = 2;
  private static final int UNDECODABLE = 7;

  private SpyProbe() {}

  public static void premain(String argument, Instrumentation unused) {
    final String[] words = argument.split(",");
    final Thread thread = new Thread(() -> System.exit(judge(Path.of(words[0]), Path.of(words[1]))), "probe");
    thread.setDaemon(true);
    thread.start();
  }

  private static int judge(Path channels, Path folder) {
    try {
      final Set<String> wanted = new HashSet<>(Files.readAllLines(channels));
      if (!within("the window of lcm-spy", () -> table() != null)) {
        return 1;
      }
      final boolean decoded = within("every channel decoded", () -> missing(wanted).isEmpty());
      System.out.print(onSwing(SpyProbe::rows));
      if (!decoded) {
        System.out.println("not decoded: " + onSwing(() -> missing(wanted)));
        return 1;
      }
      System.out.println("all " + wanted.size() + " channels decode");
      Files.createFile(folder.resolve("decoded"));
      onSwing(() -> {
        window(table()).setBounds(0, 0, 660, 480);
        return null;
      });
      final Map<String, String> viewers = new HashMap<>();
      viewers.put("POSE", "Pose and path over the map");
      viewers.put("CAMERA_IMAGE", "Camera picture with detections");
      viewers.put("SONAR", "Sonar ring");
      for (Map.Entry<String, String> viewer : viewers.entrySet()) {
        onSwing(() -> {
          doubleClick(viewer.getKey());
          return null;
        });
        if (!within("a window \"" + viewer.getValue() + "\"", () -> frame(viewer.getValue()) != null)) {
          return 1;
        }
      }
      onSwing(() -> {
        window(frame("Pose and path over the map")).setLocation(0, 485);
        window(frame("Camera picture with detections")).setLocation(665, 0);
        window(frame("Sonar ring")).setLocation(665, 395);
        return null;
      });
      final boolean drawn = within("the pose drawn", () -> shows("Pose and path over the map", SpyProbe::isBlue, 50))
          && within("the path drawn", () -> shows("Pose and path over the map", SpyProbe::isRed, 50))
          && within("the walls drawn", () -> shows("Pose and path over the map", SpyProbe::isDark, 500))
          && within("a detection drawn", () -> shows("Camera picture with detections", SpyProbe::isOrange, 50))
          && within("the picture drawn", () -> shows("Camera picture with detections", SpyProbe::isGrey, 5000))
          && within("an echo drawn", () -> shows("Sonar ring", SpyProbe::isReddish, 200));
      ImageIO.write(new Robot().createScreenCapture(new Rectangle(0, 0, 1160, 935)), "png",
          folder.resolve("lcm-spy.png").toFile());
      final boolean still = onSwing(() -> missing(wanted).isEmpty());
      System.out.println(drawn && still ? "passed" : "FAILED");
      return drawn && still ? 0 : 1;
    } catch (Exception error) {
      error.printStackTrace();
      return 1;
    }
  }

  private static <T> T onSwing(Callable<T> task) throws Exception {
    final FutureTask<T> future = new FutureTask<>(task);
    SwingUtilities.invokeLater(future);
    return future.get();
  }

  private static boolean within(String what, Callable<Boolean> condition) throws Exception {
    for (long end = System.currentTimeMillis() + PATIENCE; System.currentTimeMillis() < end; Thread.sleep(PAUSE)) {
      try {
        if (onSwing(condition)) {
          return true;
        }
      } catch (ExecutionException error) {
        // lcm-spy adds rows on a thread of its own, and its sorter knows them a moment later
        if (!(error.getCause() instanceof IndexOutOfBoundsException)) {
          throw error;
        }
      }
    }
    System.out.println("FAILED: waited in vain for " + what);
    return false;
  }

  private static <T> void collect(Component from, Class<T> type, List<T> found) {
    if (type.isInstance(from)) {
      found.add(type.cast(from));
    }
    if (from instanceof Container) {
      for (Component child : ((Container) from).getComponents()) {
        collect(child, type, found);
      }
    }
  }

  private static <T> List<T> all(Class<T> type) {
    final List<T> found = new ArrayList<>();
    for (Frame frame : Frame.getFrames()) {
      collect(frame, type, found);
    }
    return found;
  }

  /** lcm-spy's table of channels. */
  private static JTable table() {
    for (JTable table : all(JTable.class)) {
      if (table.getColumnCount() > UNDECODABLE && table.getColumnName(CHANNEL).equals("Channel")) {
        return table;
      }
    }
    return null;
  }

  private static JInternalFrame frame(String title) {
    for (JInternalFrame frame : all(JInternalFrame.class)) {
      if (frame.getTitle().equals(title)) {
        return frame;
      }
    }
    return null;
  }

  private static Window window(Component component) {
    return SwingUtilities.getWindowAncestor(component);
  }

  private static Set<String> missing(Set<String> wanted) {
    final Set<String> missing = new HashSet<>(wanted);
    final TableModel model = table().getModel();
    for (int row = 0; row < model.getRowCount(); row++) {
      final boolean typed = !String.valueOf(model.getValueAt(row, TYPE)).startsWith("?");
      final boolean clean = Integer.parseInt(String.valueOf(model.getValueAt(row, UNDECODABLE)).trim()) == 0;
      if (typed && clean) {
        missing.remove(String.valueOf(model.getValueAt(row, CHANNEL)).trim());
      }
    }
    return missing;
  }

  private static String rows() {
    final TableModel model = table().getModel();
    final StringBuilder text = new StringBuilder();
    for (int row = 0; row < model.getRowCount(); row++) {
      text.append(String.format("%-28s %-28s %6s messages, %s undecodable%n", model.getValueAt(row, CHANNEL),
          model.getValueAt(row, TYPE), model.getValueAt(row, COUNT), model.getValueAt(row, UNDECODABLE)));
    }
    return text.toString();
  }

  private static void doubleClick(String channel) {
    final JTable table = table();
    for (int row = 0; row < table.getRowCount(); row++) {
      if (String.valueOf(table.getValueAt(row, CHANNEL)).trim().equals(channel)) {
        final Rectangle cell = table.getCellRect(row, CHANNEL, true);
        table.dispatchEvent(new MouseEvent(table, MouseEvent.MOUSE_CLICKED, System.currentTimeMillis(), 0, cell.x + 5,
            cell.y + cell.height / 2, 2, false, MouseEvent.BUTTON1));
      }
    }
  }

  private interface Colour {
    boolean is(int red, int green, int blue);
  }

  private static boolean shows(String title, Colour colour, int pixels) {
    final Container content = frame(title).getContentPane();
    final BufferedImage image =
        new BufferedImage(content.getWidth(), content.getHeight(), BufferedImage.TYPE_INT_RGB);
    content.paint(image.getGraphics());
    int count = 0;
    for (int y = 20; y < image.getHeight(); y++) {  // below the line of text
      for (int x = 0; x < image.getWidth(); x++) {
        final int rgb = image.getRGB(x, y);
        count += colour.is(rgb >> 16 & 255, rgb >> 8 & 255, rgb & 255) ? 1 : 0;
      }
    }
    return count >= pixels;
  }

  private static boolean isBlue(int red, int green, int blue) {
    return blue > 180 && red < 80 && green < 150;
  }

  private static boolean isRed(int red, int green, int blue) {
    return red > 190 && green < 80 && blue < 80;
  }

  private static boolean isDark(int red, int green, int blue) {
    return red < 70 && green < 70 && blue < 70;
  }

  private static boolean isOrange(int red, int green, int blue) {
    return red > 220 && green > 80 && green < 170 && blue < 90;
  }

  private static boolean isGrey(int red, int green, int blue) {
    return red == green && green == blue && red > 20 && red < 245;
  }

  private static boolean isReddish(int red, int green, int blue) {
    return red > 200 && green < 200 && blue < 200 && red - green > 40;
  }
}
