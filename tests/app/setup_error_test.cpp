#include <algorithm>

#include <gtest/gtest.h>

#include "app/report/text/text_report.h"
#include "app/setup/program_settings.h"
#include "app/setup/setup_file.h"
#include "tests/support/scoped_folder.h"
#include "tests/support/setup_writer.h"

namespace app {
namespace {

using test_support::flat_10;
using test_support::SetupWriter;

/// The error of a set-up, as printed; empty if it is valid.
std::string error_of(const std::string& text) {
    const test_support::ScopedFolder folder;
    const auto read = read_setup(folder.write("setup.toml", text), {});
    return read ? std::string() : error_text(read.error());
}

void expect_error(const SetupWriter& setup, const std::vector<std::string>& words) {
    const std::string error = error_of(setup.text());
    for (const std::string& word : words)
        EXPECT_NE(error.find(word), std::string::npos) << word << " in: " << error;
    EXPECT_NE(error.find("setup.toml:"), std::string::npos) << error;
}

/// Expects that the error's position is the line that contains `what`.
void expect_at_line_of(const std::string& text, const std::string& what) {
    const auto line =
        1 + std::count(text.begin(), text.begin() + static_cast<long>(text.find(what)), '\n');
    const std::string error = error_of(text);
    EXPECT_NE(error.find("setup.toml:" + std::to_string(line) + ":"), std::string::npos)
        << line << " in: " << error;
}

std::string fixture(const std::string& keys) { return "[[fixture]]\nname = \"vise\"\n" + keys; }

const std::string box = "box = [[0, 0, 0], [1, 1, 1]]\n";

/// A length offset with a replaced value for one key.
std::string length_offset_with(const std::string& key, const std::string& is) {
    std::string text = "[[length_offset]]\n";
    for (const char* each : {"number", "length", "wear", "diameter"})
        text += each + (each == key ? is : std::string(" = 1\n"));
    return text;
}

TEST(SetupFile, IsReadAsTheBuilderWritesIt) { EXPECT_EQ(error_of(SetupWriter().text()), ""); }

TEST(SetupFile, NamesTheLineOfAMistake) {
    expect_at_line_of(SetupWriter().stock(box + "tolerence = 1\n").text(), "tolerence");
    expect_at_line_of(SetupWriter().tool(flat_10 + "spindle = 5\n").text(), "spindle");
    expect_at_line_of(SetupWriter().also(fixture(box + "frame = \"G53\"\n")).text(), "\"G53\"");
    expect_at_line_of(SetupWriter().root("mesh_size = 0.5\nmesh_size = 1\n").text(),
                      "mesh_size = 1");
}

TEST(SetupFile, RefusesAFixtureWithTheNameOfAFrame) {
    for (const char* name : {"G54", "g55", " G59.3 ", "G54.1 P12", "G154 P3", "G505", "machine",
                             "Stock", "part", "holder", "fixture"}) {
        const std::string text =
            SetupWriter().also("[[fixture]]\nname = \"" + std::string(name) + "\"\n" + box).text();
        expect_at_line_of(text, "name = \"" + std::string(name) + "\"");
        EXPECT_NE(error_of(text).find("choose another name"), std::string::npos) << name;
    }
    for (const char* name : {"G54-1", "G53", "G60", "vise", "Holder 2", "table"})
        EXPECT_EQ(error_of(SetupWriter()
                               .also("[[fixture]]\nname = \"" + std::string(name) + "\"\n" + box)
                               .text()),
                  "")
            << name;
}

TEST(SetupFile, RefusesABodyInAWorkOffsetThatNothingStates) {
    const std::string offsets = "[offsets]\nG54 = { X = 300, Z = -450 }\n";
    const std::string stock = "[stock]\n" + box, in_g55 = fixture(box + "frame = \"G55\"\n");
    EXPECT_EQ(error_of(offsets + stock), "");
    expect_at_line_of(offsets + stock + in_g55, "frame = \"G55\"");
    EXPECT_NE(error_of(offsets + stock + in_g55).find("add G55 to [offsets]"), std::string::npos);
    EXPECT_EQ(error_of(offsets + "G55 = { Z = -1 }\n" + stock + in_g55), "");
    EXPECT_EQ(error_of(offsets + "G55 = {}\n" + stock + in_g55), "");
    // Without any, only the places of the bodies relative to each other count.
    EXPECT_EQ(error_of(stock + fixture(box)), "");
    EXPECT_EQ(error_of("[stock]\n" + box + "frame = \"G55\"\n" + in_g55), "");
    expect_at_line_of(stock + in_g55, "frame = \"G55\"");
    EXPECT_NE(error_of(stock + in_g55).find("such as G54, in which other bodies are"),
              std::string::npos);
    // A frame that is not given is G54.
    const std::string other = "[offsets]\nG55 = { X = 300, Z = -450 }\n";
    expect_at_line_of(other + stock + fixture(box), "[stock]");
    expect_at_line_of(other + "[stock]\n" + box + "frame = \"G55\"\n" + fixture(box),
                      "[[fixture]]");
    // The only body of a set-up that is to be completed stands where the program has G54.
    EXPECT_EQ(error_of(other + stock), "");
}

TEST(SetupFile, CountsTheAssumedPlaceOfBodiesAsAssumed) {
    const auto bodies_of = [](const std::string& text) {
        const auto read = read_setup_text(text, "setup.toml", {});
        EXPECT_TRUE(read) << (read ? "" : error_text(read.error()));
        return read ? read->offsets_of_bodies : std::set<size_t>{};
    };
    const std::string stock = "[stock]\n" + box;
    EXPECT_EQ(bodies_of("[offsets]\nG54 = { Z = -450 }\n" + stock), std::set<size_t>{});
    EXPECT_EQ(bodies_of(stock + fixture(box)), std::set<size_t>{0});
    EXPECT_EQ(bodies_of("[offsets]\nG55 = { Z = -450 }\n" + stock), std::set<size_t>{0});
}

TEST(SetupFile, RefusesBodiesWithoutSize) {
    expect_error(SetupWriter().stock("box = [[0, 0, 0], [10, 10, 0]]\n"), {"opposite corners"});
    expect_error(SetupWriter().stock("cylinder = { radius = -5, height = 10 }\n"), {"above 0"});
    expect_error(SetupWriter().tool("shape = \"flat\"\ndiameter = -10\nflute_length = 20\n"),
                 {"setup.toml:"});
}

TEST(SetupFile, RefusesPlacesThatNoMachineReaches) {
    for (const char* value : {"1e300", "-1e300", "1000001", "-1e7"}) {
        const std::string v = value;
        expect_error(SetupWriter().also(fixture(box + "at = [0, " + v + ", 0]\n")),
                     {"at ", "out of range", "1 km"});
        expect_error(SetupWriter().also(fixture(box + "rotate_deg = [0, 0, " + v + "]\n")),
                     {"rotate_deg"});
        expect_error(SetupWriter().stock("box = [[-2e9, -2e9, -2e9], [1, 1, " + v + "]]\n"),
                     {"box", "out of range"});
        expect_error(SetupWriter().offsets("G54 = { X = " + v + " }\n"), {"out of range"});
        expect_error(SetupWriter().tool(flat_10 + "stick_out = " + v + "\n"), {"stick_out"});
        EXPECT_NE(error_of("[program]\nstart = { X = " + v + " }\n").find("out of range"),
                  std::string::npos);
    }
    EXPECT_EQ(error_of(SetupWriter().also(fixture(box + "at = [1e6, -1e6, 0]\n")).text()), "");
    expect_at_line_of(SetupWriter().also(fixture(box + "at = [1,\n 2e8, 3]\n")).text(), " 2e8");
}

TEST(SetupFile, SuggestsTheKeyThatWasMeant) {
    expect_error(SetupWriter().root("mesh_sise = 1\n"),
                 {"mesh_sise", "did you mean \"mesh_size\""});
    expect_error(SetupWriter().stock(box + "tolerence = 1\n"), {"did you mean \"tolerance\""});
    expect_error(SetupWriter().tool(flat_10 + "cut_at_centre = true\n"),
                 {"did you mean \"cuts_at_centre\""});
    expect_error(SetupWriter().also(fixture(box + "rotate = [0, 0, 9]\n")), {"\"rotate\""});
    expect_error(SetupWriter().offsets("G45 = { X = 1 }\n"), {"unknown key \"G45\""});
    expect_error(SetupWriter().also("[colour]\nx = 1\n"), {"unknown key \"colour\""});
    expect_error(SetupWriter().also("[rules]\nair-cuts = \"off\"\n"), {"air-cut"});
}

TEST(SetupFile, RefusesTextThatIsNotToml) {
    expect_error(SetupWriter().stock("box = [[0, 0,\n"), {"setup.toml:"});
    expect_error(SetupWriter().root("mesh_size == 1\n"), {"setup.toml:1:"});
    expect_error(SetupWriter().also("[stock]\n" + box), {"stock"});
}

TEST(SetupFile, RefusesAWrongTypeOfEveryKey) {
    for (const char* value : {"\"1\"", "true", "[1]", "nan", "inf", "{}"}) {
        const std::string is = std::string(" = ") + value + "\n";
        expect_error(SetupWriter().root("mesh_size" + is), {"mesh_size"});
        expect_error(SetupWriter().root("allowance" + is), {"allowance"});
        expect_error(SetupWriter().stock(box + "tolerance" + is), {"tolerance"});
        expect_error(SetupWriter().program("start = { X" + is.substr(0, is.size() - 1) + " }\n"),
                     {"X must be a number"});
        expect_error(SetupWriter().offsets("G54 = { Z" + is.substr(0, is.size() - 1) + " }\n"),
                     {"Z must be a number"});
        for (const char* key : {"min", "max", "home", "rapid", "acceleration"})
            expect_error(SetupWriter().machine(SetupWriter::axis("X", key + is)), {key});
        for (const char* key : {"number", "length", "wear", "diameter"})
            expect_error(SetupWriter().lengths(length_offset_with(key, is)), {key, "must be"});
    }
}

TEST(SetupFile, RefusesANumberWhereATextOrATableIsMeant) {
    for (const char* keys : {"dialect = 1\n", "block_delete = 1\n", "start = 1\n"})
        expect_error(SetupWriter().program(keys), {"must be"});
    for (const char* keys : {"file = 1\n", "rapid = 1\n", "axis = 1\n"})
        expect_error(SetupWriter().machine(keys), {"must be"});
    for (const char* keys : {"at = 1\n", "rotate_deg = [1, 2]\n", "frame = 1\n",
                             "expendable = \"yes\"\n", "at = [1, 2, \"3\"]\n"})
        expect_error(SetupWriter().also(fixture(box + keys)), {"must be"});
    for (const char* shape : {"mesh = 1\n", "cylinder = 1\n", "box = 1\n", "box = [1, 2, 3]\n",
                              "box = [[1, 2, 3]]\n", "box = [[1, 2], [3, 4]]\n"})
        expect_error(SetupWriter().also(fixture(shape)), {"must"});
    for (const char* keys : {"name = 1\n", "shank = 1\n", "holder = [[1, 2]]\n", "spindle = 1\n",
                             "cuts_at_centre = 1\n", "corner_radius = \"1\"\n"})
        expect_error(SetupWriter().tool(flat_10 + keys), {"setup.toml:"});
    for (const char* root : {"fixture", "rules", "part"})
        expect_error(SetupWriter().root(root + std::string(" = 1\n")), {root, "must be"});
}

TEST(SetupFile, NeedsExactlyOneShape) {
    const std::string cylinder = "cylinder = { radius = 1, height = 1 }\n";
    expect_error(SetupWriter().stock(box + cylinder), {"a single shape"});
    expect_error(SetupWriter().also(fixture(box + cylinder)), {"a single shape"});
    expect_error(SetupWriter().also(fixture("")), {"one of box, cylinder, mesh"});
}

TEST(SetupFile, NamesTheFramesItKnows) {
    expect_error(SetupWriter().also(fixture(box + "frame = \"G53\"\n")),
                 {"\"G53\" is not known", "G54", "machine"});
    expect_error(SetupWriter().stock(box + "frame = \"vise\"\n"), {"\"vise\" is not known"});
}

TEST(SetupFile, NamesTheShapesOfTools) {
    expect_error(SetupWriter().tool("number = 1\nshape = \"round\"\n"),
                 {"\"round\"", "flat ball bull"});
    expect_error(SetupWriter().tool("number = 1\nprofile = [[0, 0], [1, 5]]\n"), {"profile"});
    expect_error(SetupWriter().tool("shape = \"flat\"\n"), {"number is missing"});
}

TEST(SetupFile, RefusesSizesThatAreNotAboveZero) {
    for (const char* size : {"0", "-1", "-0.0"}) {
        const std::string is = std::string(" = ") + size + "\n";
        expect_error(SetupWriter().root("mesh_size" + is), {"mesh_size"});
        expect_error(
            SetupWriter().tool("number = 1\nshape = \"flat\"\nflute_length = 5\ndiameter" + is),
            {"diameter"});
        expect_error(
            SetupWriter().tool("number = 1\nshape = \"flat\"\ndiameter = 5\nflute_length" + is),
            {"flute_length"});
        expect_error(SetupWriter().also(
                         fixture(std::string("cylinder = { height = 1, radius = ") + size + " }")),
                     {"radius"});
        expect_error(SetupWriter().machine(SetupWriter::axis("X", "rapid" + is)), {"rapid"});
    }
    expect_error(SetupWriter().also(fixture("box = [[0, 0, 0], [1, 1, 0]]\n")),
                 {"two opposite corners"});
    expect_error(SetupWriter().root("allowance = -1\n"), {"allowance"});
    expect_error(SetupWriter().stock(box + "tolerance = -0.1\n"), {"tolerance"});
    for (const char* row : {"[10, 10, 0]", "[10, 10, -1]", "[-1, 10, 5]"})
        expect_error(SetupWriter().tool("number = 1\nshape = \"flat\"\ndiameter = 10\n"
                                        "flute_length = 5\nshank = ["
                                        + std::string(row) + "]\n"),
                     {"shank"});
}

TEST(SetupFile, RefusesTwoOfOneName) {
    expect_error(SetupWriter().also(fixture(box)).also(fixture(box)),
                 {"\"vise\" is defined twice"});
    expect_error(SetupWriter().also_tool(flat_10), {"1 is defined twice"});
    expect_error(SetupWriter().lengths("[[length_offset]]\nnumber = 1\nlength = 1\n"
                                       "[[length_offset]]\nnumber = 1\nlength = 2\n"),
                 {"1 is defined twice"});
}

TEST(SetupFile, RefusesWordsOfItsOwnAsNames) {
    for (const char* name : {"stock", "flutes", "shank", "holder", "nose", "fixture", "machine"})
        expect_error(SetupWriter().fixture(name, box), {"reserved word"});
}

TEST(SetupFile, RefusesAllowancesOfBodiesThatAreNotThere) {
    expect_error(SetupWriter().also("[[allowance]]\nbetween = [\"holder\", \"vise\"]\n"
                                    "distance = 5\n"),
                 {"no body \"vise\""});
    expect_error(SetupWriter().also("[[allowance]]\nbetween = [\"holder\"]\ndistance = 5\n"),
                 {"between"});
    expect_error(SetupWriter().also("[[allowance]]\n"), {"distance is missing"});
    expect_error(SetupWriter().also("[[allowance]]\ndistance = -1\n"), {"distance"});
}

TEST(SetupFile, RefusesToSwitchCollisionsOff) {
    expect_error(SetupWriter().also("[rules]\ncollision = \"off\"\n"), {"collision"});
    expect_error(SetupWriter().also("[rules]\nnear-miss = \"maybe\"\n"), {"near-miss"});
}

TEST(SetupFile, RefusesAMachineThatCannotBe) {
    using W = SetupWriter;
    expect_error(W().machine(W::axis("X", "direction = [1, 1, 0]\n")), {"direction"});
    expect_error(W().machine(W::axis("X", "direction = [0, 1, 0]\n")), {"perpendicular"});
    expect_error(W().machine(W::axis("X", "min = 5\nmax = 5\n")), {"min must be below max"});
    expect_error(W().machine(W::axis("A", "kind = \"linear\"\n")), {"A, B and C are the rotary"});
    expect_error(W().machine(W::axis("A", "") + W::axis("A", "")), {"defined twice"});
    expect_error(W().machine(W::axis("A", "parent = \"Q\"\n")), {"neither another axis"});
    expect_error(W().machine(W::axis("A", "parent = \"Z\"\n")), {"other side"});
    expect_error(W().machine(W::axis("A", "parent = \"C\"\n") + W::axis("C", "parent = \"A\"\n")),
                 {"is a loop"});
    expect_error(W().machine(W::axis("A", "") + W::axis("C", "parent = \"base\"\n")),
                 {"are both at the end of the table side"});
    expect_error(W().machine("[[machine.body]]\nname = \"bed\"\naxis = \"A\"\n"
                             "box = [[0, 0, 0], [1, 1, 1]]\n"),
                 {"neither an axis of this machine"});
    expect_error(W().machine("[[machine.body]]\naxis = \"Z\"\nbox = [[0, 0, 0], [1, 1, 1]]\n"),
                 {"name"});
    EXPECT_NE(error_of(W().machine("file = \"nope.toml\"\n").text()).find("nope.toml: there is"),
              std::string::npos);
}

} // namespace
} // namespace app
