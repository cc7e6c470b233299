#include <random>

#include <gtest/gtest.h>

#include "app/report/text/text_report.h"
#include "app/setup/autodesk_machine.h"
#include "app/setup/program_settings.h"
#include "app/setup/setup_file.h"
#include "tests/support/scoped_folder.h"

namespace app {
namespace {

const test_support::ScopedFolder& machine_folder() {
    static const test_support::ScopedFolder kept;
    return kept;
}

/// A set-up with this machine file.
core::Result<SetupFile> setup_of(const std::string& name, const std::string& bytes,
                                 const std::string& more = "") {
    machine_folder().write(name, bytes);
    return read_setup(machine_folder().write("s.toml", "[offsets]\nG54 = { X = 1 }\n[stock]\nbox = "
                                                       "[[0,0,0],[1,1,1]]\n[machine]\nfile = \""
                                                           + name + "\"\n" + more),
                      {});
}

SetupFile setup_in(const std::string& name, const std::string& bytes,
                   const std::string& more = "") {
    auto read = setup_of(name, bytes, more);
    EXPECT_TRUE(read.has_value()) << error_text(read.error());
    return read.value_or(SetupFile{});
}

bool says(const SetupFile& file, const std::string& words) {
    return std::any_of(
        file.assumptions.begin(), file.assumptions.end(),
        [&](const std::string& text) { return text.find(words) != std::string::npos; });
}

// Autodesk's generic machine, with the travels and speeds of a real one.
std::string xml_of(const std::string& axes) {
    return "<?xml version=\"1.0\" encoding=\"UTF-8\" standalone=\"no\" ?>\n"
           "<machine xmlns=\"http://www.hsmworks.com/xml/2009/machine\">\n"
           "  <vendor>Autodesk</vendor>\n  <model>Generic 3-axis</model>\n"
           "  <machining additive=\"no\" milling=\"yes\" turning=\"no\"/>\n"
           + axes
           + "  <spindle axis=\"0 0 1\" maximumSpeed=\"0rpm\" "
             "minimumSpeed=\"0rpm\"/>\n</machine>\n";
}

const std::string linear_axes =
    "<axis actuator=\"linear\" coordinate=\"X\" homePosition=\"0mm\" id=\"X\" link=\"table\" "
    "maximumFeed=\"0mm/min\" name=\"\" offset=\"0mm 0mm 0mm\" range=\"-30in 0in\" "
    "rapidFeed=\"25400mm/min\" resolution=\"0mm\"/>\n"
    "<axis actuator=\"linear\" coordinate=\"Y\" homePosition=\"50mm\" id=\"Y\" link=\"table\" "
    "name=\"\" "
    "range=\"-406mm 0mm\" rapidFeed=\"0.4m/s\"/>\n"
    "<axis actuator=\"linear\" coordinate=\"Z\" homePosition=\"0mm\" id=\"Z\" link=\"head\" "
    "name=\"\" "
    "range=\"0mm 0mm\" rapidFeed=\"0mm/min\"/>\n";
const std::string rotary_axes =
    "<axis actuator=\"rotational\" axis=\"1 0 0\" coordinate=\"X\" homePosition=\"0deg\" id=\"r0\" "
    "link=\"table\" name=\"\" offset=\"0mm 0mm 0mm\" range=\"-120deg 30deg\"/>\n"
    "<axis actuator=\"rotational\" axis=\"0 0 1\" coordinate=\"Z\" cyclic=\"yes\" id=\"r1\" "
    "link=\"table\" name=\"C\"/>\n";

TEST(AutodeskMachine, ReadsTheLinearAxesOfXml) {
    const SetupFile file = setup_in("mill.machine", xml_of(linear_axes));
    const auto& axes = file.setup.machine.axes;
    EXPECT_DOUBLE_EQ(axes[0].min.value_or(0.0), -762.0);
    EXPECT_EQ(axes[0].max, 0.0);
    EXPECT_EQ(axes[0].home, 0.0);
    EXPECT_EQ(axes[0].rapid, 25400.0);
    EXPECT_EQ(axes[0].side, core::Side::table);
    EXPECT_DOUBLE_EQ(axes[1].rapid.value_or(0.0), 24000.0);
    EXPECT_FALSE(axes[1].home);
    EXPECT_EQ(axes[1].carrier, core::link_of(0));
    EXPECT_FALSE(axes[2].min);
    EXPECT_FALSE(axes[2].rapid);
    EXPECT_EQ(axes[2].side, core::Side::tool);
    EXPECT_TRUE(file.has_axes);
    EXPECT_TRUE(says(file, "the home position of Y, 50, is outside its travel"));
    EXPECT_TRUE(says(file, "states no travel of Z"));
}

TEST(AutodeskMachine, NamesRotaryAxesUntilTheirCentresAreStated) {
    const SetupFile bare = setup_in("five.machine", xml_of(linear_axes + rotary_axes));
    EXPECT_FALSE(bare.setup.machine.has_rotary());
    EXPECT_FALSE(bare.has_axes); // so that blocks with A and C are undecided
    EXPECT_TRUE(says(bare, "A (side = \"table\", -120 to 30 degrees), C (side = \"table\", without "
                           "limits)"));
    const std::string a = "[[machine.axis]]\nname = \"A\"\npoint = [0, 0, -100]\n";
    const std::string c = "[[machine.axis]]\nname = \"C\"\npoint = [0, 0, -100]\n";
    EXPECT_FALSE(setup_in("five.machine", xml_of(linear_axes + rotary_axes), a).has_axes);
    const SetupFile whole = setup_in("five.machine", xml_of(linear_axes + rotary_axes), a + c);
    EXPECT_TRUE(whole.has_axes);
    EXPECT_EQ(whole.setup.machine.axes[0].rapid, 25400.0);
    EXPECT_EQ(whole.setup.machine.table, core::link_of(5));
}

// The keys of a machine that Autodesk's library holds as JSON.
const char* const tree = R"({
  "general": {"vendor": "DMG MORI", "model": "CMX 50 U", "minimumRevision": 45805},
  "controller": {"default": {"parts": {
    "X": {"coordinate": 0, "max_normal_speed": 60000, "max_rapid_speed": 30000, "tcp": false},
    "Y": {"coordinate": 1, "max_rapid_speed": 30000},
    "Z": {"coordinate": 2, "max_rapid_speed": 0},
    "rotary_0": {"coordinate": 1}, "rotary_1": {"coordinate": 2}}}},
  "kinematics": {"default": {"parts": [
    {"id": "static", "type": "static", "parts": [
      {"id": "Y", "type": "linear", "min": -450, "max": 0, "direction": [0, 1, 0], "parts": [
        {"id": "rotary_0", "type": "rotary", "min": -5, "max": 110, "parts": [
          {"id": "rotary_1", "type": "rotary", "parts": [{"id": "table", "type": "table"}]}]}]},
      {"id": "X", "type": "linear", "name": "X", "min": -500, "max": 0, "parts": [
        {"id": "Z", "type": "linear", "min": -400, "max": 0, "parts": [
          {"id": "head", "type": "head"}]}]}]}]}}})";

TEST(AutodeskMachine, ReadsTheTreeOfJson) {
    const SetupFile file = setup_in("five.mch", tree);
    const auto& axes = file.setup.machine.axes;
    EXPECT_EQ(axes[0].min, -500.0);
    EXPECT_EQ(axes[0].rapid, 30000.0);
    EXPECT_EQ(axes[0].side, core::Side::tool);
    EXPECT_EQ(axes[1].side, core::Side::table);
    EXPECT_EQ(axes[2].carrier, core::link_of(0));
    EXPECT_EQ(axes[2].max, 0.0);
    EXPECT_FALSE(axes[2].rapid);
    EXPECT_FALSE(file.has_axes);
    EXPECT_TRUE(says(file, "B (side = \"table\", -5 to 110 degrees), C (side = \"table\""));
}

TEST(AutodeskMachine, RefusesOtherFiles) {
    const auto mistake = [](const std::string& bytes) {
        const auto read = setup_of("bad.machine", bytes);
        EXPECT_FALSE(read.has_value()) << bytes;
        return read ? std::string() : error_text(read.error());
    };
    EXPECT_NE(mistake("<machine/>").find("bad.machine: is no machine of Autodesk"),
              std::string::npos)
        << mistake("<machine/>");
    EXPECT_NE(mistake("{}").find("kinematics.default.parts"), std::string::npos);
    EXPECT_NE(mistake("{").find("not valid JSON"), std::string::npos);
    EXPECT_NE(mistake("").find("not valid XML"), std::string::npos);
    EXPECT_NE(
        mistake(xml_of("<axis id=\"Q\" coordinate=\"Q\"/>\n")).find("bad.machine:6: axis \"Q\""),
        std::string::npos)
        << mistake(xml_of("<axis id=\"Q\" coordinate=\"Q\"/>\n"));
    EXPECT_NE(mistake(xml_of("<axis coordinate=\"X\" range=\"0 800\"/>")).find("need a unit"),
              std::string::npos);
    EXPECT_NE(mistake(xml_of("<axis coordinate=\"X\" range=\"8mm 1mm\"/>")).find("range"),
              std::string::npos);
    EXPECT_NE(mistake(xml_of("<axis coordinate=\"X\" rapidFeed=\"nanmm/min\"/>")).find("rapidFeed"),
              std::string::npos);
    EXPECT_NE(mistake(xml_of("<axis coordinate=\"X\"/><axis coordinate=\"X\"/>")).find("twice"),
              std::string::npos);
    std::string deep = R"({"kinematics": {"default": {"parts": )";
    for (int i = 0; i < 5000; ++i) deep += R"([{"type": "x", "parts": )";
    EXPECT_NE(mistake(deep + "1").find("JSON"), std::string::npos);
    std::string closed = deep + "[]";
    for (int i = 0; i < 5000; ++i) closed += "}]";
    EXPECT_NE(mistake(closed + "}}}").find("more than 32 deep"), std::string::npos);
    EXPECT_NE(error_text(
                  read_setup(machine_folder().write("t.toml", "[machine]\nfile = \"no.mch\"\n"), {})
                      .error())
                  .find("no.mch"),
              std::string::npos);
}

TEST(AutodeskMachine, DamagedFilesAreReadOrRefused) {
    const std::string samples[] = {xml_of(linear_axes + rotary_axes), tree};
    std::mt19937 random(3);
    size_t accepted = 0;
    for (int round = 0; round < 300; ++round) {
        std::string text = samples[round % 2];
        for (unsigned change = 0; change < 1 + random() % 3; ++change)
            text[random() % text.size()] = "0123456789.-mxXYZ\"<{[,"[random() % 22];
        const auto read = read_autodesk_machine(machine_folder().write("z.machine", text));
        accepted += read ? 1 : 0;
        EXPECT_EQ(read ? machine_folder() / "z.machine" : read.error().file,
                  machine_folder() / "z.machine");
    }
    EXPECT_GT(accepted, 50u);
}

} // namespace
} // namespace app
