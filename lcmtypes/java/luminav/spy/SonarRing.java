package luminav.spy;

import java.io.IOException;
import java.nio.file.Files;
import java.nio.file.Path;
import java.util.ArrayList;
import java.util.List;
import java.util.regex.Matcher;
import java.util.regex.Pattern;

/** Where the sonar discs stand: the [[sonar]] tables of the robot's file, in the robot frame [m, rad]. */
final class SonarRing {
  private static final Pattern TABLE = Pattern.compile("^\\s*(\\[+[^\\]]*\\]+)");
  private static final Pattern VALUE = Pattern.compile("^\\s*(x|y|theta)\\s*=\\s*([-+0-9.eE]+)");

  static final class Disc {
    double x;
    double y;
    double theta;
  }

  private SonarRing() {}

  /** Empty when there is no file, or it cannot be read. */
  static List<Disc> of(String robotFile) {
    final List<Disc> discs = new ArrayList<>();
    if (robotFile == null || robotFile.isEmpty()) {
      return discs;
    }
    try {
      boolean inDisc = false;
      for (String line : Files.readAllLines(Path.of(robotFile))) {
        final Matcher table = TABLE.matcher(line);
        final Matcher value = VALUE.matcher(line);
        if (table.find()) {
          inDisc = table.group(1).replace(" ", "").equals("[[sonar]]");
          if (inDisc) {
            discs.add(new Disc());
          }
        } else if (inDisc && value.find()) {
          set(discs.get(discs.size() - 1), value.group(1), Double.parseDouble(value.group(2)));
        }
      }
    } catch (IOException | NumberFormatException unreadable) {
      discs.clear();
    }
    return discs;
  }

  private static void set(Disc disc, String key, double value) {
    switch (key) {
      case "x":
        disc.x = value;
        break;
      case "y":
        disc.y = value;
        break;
      default:
        disc.theta = value;
    }
  }
}
