#include "services/common/configuration/toml_table.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "tests/support/temporary_folder.hpp"

namespace luminav {
namespace {

std::string error_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const ConfigurationError& error) {
    return error.what();
  }
  return "";
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(TomlTable, ReadsWhatIsThereAndFallsBackWhereItIsNot) {
  const TemporaryFolder folder;
  const TomlTable table = TomlTable::load(folder.write(
      "a.toml",
      "speed = 2\nname = \"x\"\non = true\nlist = [1, 2.5]\n[inner]\nk = 3\n[[row]]\nx = 1\n[[row]]\nx = 2\n"));
  EXPECT_DOUBLE_EQ(table.number("speed"), 2.0);
  EXPECT_DOUBLE_EQ(table.number("other", 7.0), 7.0);
  EXPECT_EQ(table.text("name"), "x");
  EXPECT_TRUE(table.boolean("on", false));
  EXPECT_EQ(table.numbers("list", 2), (std::vector<double>{1.0, 2.5}));
  EXPECT_EQ(table.table("inner").integer("k"), 3);
  ASSERT_EQ(table.tables("row").size(), 2U);
  EXPECT_EQ(table.tables("row")[1].integer("x"), 2);
  EXPECT_EQ(table.table("absent").number("x", 4.0), 4.0);
  EXPECT_NO_THROW(table.reject_unknown());
}

TEST(TomlTable, ReadsIntoAFieldThatKeepsItsValueWhereTheKeyIsAbsent) {
  const TemporaryFolder folder;
  const TomlTable table = TomlTable::load(folder.write("r.toml", "speed = 2\ncount = 3\non = true\nfar = 9.0\n"));
  struct {
    double speed = 1.0;
    double other = 7.0;
    double far = 0.5;
    int count = 1;
    bool on = false;
  } fields;
  table.read("speed", fields.speed, {0.0, 5.0});
  table.read("other", fields.other, {0.0, 5.0});
  table.read("count", fields.count, {1, 10});
  table.read("on", fields.on);
  EXPECT_EQ(fields.speed, 2.0);
  EXPECT_EQ(fields.other, 7.0);
  EXPECT_EQ(fields.count, 3);
  EXPECT_TRUE(fields.on);
  EXPECT_TRUE(has(error_of([&] { table.read("far", fields.far, {0.0, 5.0}); }), "far = 9, must be between 0 and 5"));
  EXPECT_EQ(fields.far, 0.5);
}

TEST(TomlTable, NamesFileLineKeyAndWhatIsAllowed) {
  const TemporaryFolder folder;
  const auto file =
      folder.write("b.toml", "\nspeed = 9.0\nmode = \"fast\"\ncount = 1.5\ntypo = 1\n[camera]\nfx = \"wide\"\n");
  const TomlTable table = TomlTable::load(file);
  EXPECT_TRUE(has(error_of([&] {
                    (void)table.number("speed", Range{0.0, 2.0});
                  }),
                  "b.toml:2: speed = 9, must be between 0 and 2"));
  EXPECT_TRUE(has(error_of([&] {
                    (void)table.choice("mode", "paper", {"paper", "modern"});
                  }),
                  "b.toml:3: mode = \"fast\", must be one of paper, modern"));
  EXPECT_TRUE(has(error_of([&] { (void)table.integer("count"); }), "b.toml:4: count must be a whole number"));
  EXPECT_TRUE(has(error_of([&] { (void)table.number("missing"); }), "missing is missing"));
  EXPECT_TRUE(has(error_of([&] { (void)table.table("camera").number("fx"); }), "b.toml:7: camera.fx must be a number"));
  EXPECT_TRUE(has(error_of([&] { table.reject_unknown(); }), "b.toml:5: unknown key \"typo\""));
}

TEST(TomlTable, RefusesNumbersThatAreNone) {
  const TemporaryFolder folder;
  const TomlTable table = TomlTable::load(folder.write("c.toml", "a = nan\nb = inf\nc = [1, nan]\n"));
  EXPECT_TRUE(has(error_of([&] { (void)table.number("a"); }), "finite"));
  EXPECT_TRUE(has(error_of([&] { (void)table.number("b"); }), "finite"));
  EXPECT_TRUE(has(error_of([&] { (void)table.numbers("c"); }), "finite"));
}

TEST(TomlTable, SaysWhereAFileIsNoToml) {
  const TemporaryFolder folder;
  EXPECT_TRUE(has(error_of([&] { (void)TomlTable::load(folder.write("d.toml", "a = 1\nb = = 2\n")); }), "d.toml:2:"));
  EXPECT_TRUE(has(error_of([&] { (void)TomlTable::load(folder.path() / "none.toml"); }), "no such file"));
}

TEST(TomlTable, RefusesKeysOfThousandsOfParts) {
  const TemporaryFolder folder;
  std::string key = "a";
  for (int i = 0; i < 50'000; ++i) {
    key += ".a";
  }
  for (const std::string& text :
       {key + " = 1\n", "[" + key + "]\n", "x = {" + key + " = 1}\n", "\"#\"." + key + " = 1\n"}) {
    EXPECT_TRUE(has(error_of([&] { TomlTable::load(folder.write("a.toml", "first = 1\n" + text)); }),
                    "a.toml:2: a key of more than 32 parts"))
        << text.substr(0, 20);
  }
  const std::string dots(1000, '.');
  const TomlTable table = TomlTable::load(folder.write("b.toml", "# " + dots + "\ntext = \"" + dots + "\"\n"));
  EXPECT_EQ(table.text("text"), dots);
}

TEST(TomlTable, ReadsListsOfTexts) {
  const TemporaryFolder folder;
  const TomlTable table = TomlTable::load(folder.write("a.toml", "some = [\"x\", \"y\"]\nbad = [1]\nworse = \"x\"\n"));
  EXPECT_EQ(table.texts("some"), (std::vector<std::string>{"x", "y"}));
  EXPECT_TRUE(table.texts("none").empty());
  EXPECT_TRUE(has(error_of([&] { (void)table.texts("bad"); }), "a.toml:2: bad must be a list of texts"));
  EXPECT_TRUE(has(error_of([&] { (void)table.texts("worse"); }), "must be a list of texts"));
}

TEST(TomlTable, TakesPathsRelativeToTheFile) {
  const TemporaryFolder folder;
  const TomlTable table = TomlTable::load(folder.write("e.toml", "map = \"maps/../m.yaml\"\n"));
  EXPECT_EQ(table.path("map"), (folder.path() / "m.yaml").string());
  EXPECT_EQ(table.path("none"), "");
}

}  // namespace
}  // namespace luminav
