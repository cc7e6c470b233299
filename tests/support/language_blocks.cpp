#include "tests/support/program_generator.h"

namespace test_support {
namespace {

std::string parameter(ProgramText& text) {
    switch (text.whole(0, 4)) {
    case 0:
        return fmt::format("#{}", text.whole(1, 30));
    case 1:
        return fmt::format("#<local{}>", text.whole(1, 3));
    case 2:
        return fmt::format("#<_global{}>", text.whole(1, 3));
    case 3:
        return fmt::format("#[{}+{}]", text.whole(1, 9), text.whole(0, 9));
    default:
        return fmt::format("#{}", text.whole(31, 400));
    }
}

/// An expression in brackets with a value that is usually some thousands at most.
std::string expression(ProgramText& text, int depth);

std::string operand(ProgramText& text, int depth) {
    if (depth <= 0 || text.once_in(3)) return fmt::format("{}", text.length(9));
    switch (text.whole(0, 8)) {
    case 0:
        return parameter(text);
    case 1:
        return text.one_of({"ABS", "SIN", "COS", "TAN", "ROUND", "FIX", "FUP"})
               + expression(text, depth - 1);
    case 2:
        return fmt::format("SQRT[ABS{}]", expression(text, depth - 1));
    case 3:
        return fmt::format("ATAN{}/{}", expression(text, depth - 1), expression(text, depth - 1));
    case 4:
        return fmt::format("{}[{}]", text.one_of({"ASIN", "ACOS"}), text.whole(-100, 100) / 100.0);
    case 5:
        return fmt::format("EXP[{}]", text.whole(-30, 30) / 10.0);
    case 6:
        return fmt::format("LN[{}]", text.positive());
    case 7:
        return fmt::format("[{}**{}]", text.positive(3), text.whole(-3, 3));
    default:
        return expression(text, depth - 1);
    }
}

std::string expression(ProgramText& text, int depth) {
    std::string all = "[" + operand(text, depth);
    for (int i = text.whole(0, 3); i > 0; --i)
        all += " "
               + text.one_of({"+", "-", "*", "/", "+", "-", "MOD", "AND", "OR", "XOR", "EQ", "NE",
                              "GT", "GE", "LT", "LE"})
               + " " + (text.once_in(3) ? "-" : "") + operand(text, depth);
    return all + "]";
}

void give_values(ProgramText& text) {
    for (int i = 1; i <= 3; ++i) {
        text.line("#<local{}>={} #<_global{}>={}", i, text.length(9), i, text.length(9));
        text.line("#{}={}", text.whole(1, 30), text.length(9));
    }
}

void expressions(ProgramText& text) {
    give_values(text);
    std::string value = expression(text, 2);
    while (value.size() > 200) value = expression(text, 2); // a line has 255 characters
    text.line("#1={}", value);
    text.line("G1 X[#1 MOD 50]");
}

void parameters(ProgramText& text) {
    give_values(text);
    text.line("{0}={1} {2}=[{0}+1]", parameter(text), text.length(9), parameter(text));
    text.line("#{0}={1}", text.whole(6, 9), text.whole(10, 20));
    text.line("#6=11");
    text.line("#[#6+1]=7 #5=##6 #6=[#6+1]");
    text.line("G1 X{} Y-{} Z#[1+{}] ", parameter(text), parameter(text), text.whole(1, 20));
    text.line("#1=EXISTS[#<local{}>] #2=EXISTS[#<_nothing>]", text.whole(1, 5));
    text.line("G1 X#1 Y#2 Z#5");
}

void positions(ProgramText& text) {
    text.line("G{} G0{}", text.whole(54, 56), text.axis_words("XYZABC"));
    if (text.once_in(3)) text.line("G10 L2 P{}{}", text.whole(1, 3), text.axis_words("XYZ"));
    if (text.once_in(3)) text.line("G10 L2 P{} R{}", text.whole(1, 3), text.whole(0, 90));
    if (text.once_in(3)) text.line("G92{}", text.axis_words("XYZ"));
    if (text.once_in(4)) text.line("G{}.1", text.one_of({28, 30}));
    if (text.once_in(4)) text.line("G49 G0\nT{} M6\nG43", text.whole(1, 9));
    if (text.once_in(5)) text.line("G49\nG{}", text.whole(20, 21));
    text.line("G1 X[#{}+1] Y[#{}-1] Z[#{}/2]", text.whole(5420, 5425),
              5161 + 20 * text.whole(0, 1) + text.whole(0, 5),
              5221 + 20 * text.whole(0, 8) + text.whole(0, 9));
    text.line("G1 X#{} Y#{} Z#{}", text.whole(5210, 5219), text.whole(5400, 5413), 5220);
}

constexpr const char* predefined[] = {"_line",
                                      "_motion_mode",
                                      "_plane",
                                      "_ccomp",
                                      "_metric",
                                      "_imperial",
                                      "_absolute",
                                      "_incremental",
                                      "_inverse_time",
                                      "_units_per_minute",
                                      "_units_per_rev",
                                      "_coord_system",
                                      "_tool_offset",
                                      "_retract_r_plane",
                                      "_retract_old_z",
                                      "_spindle_rpm_mode",
                                      "_spindle_css_mode",
                                      "_ijk_absolute_mode",
                                      "_lathe_diameter_mode",
                                      "_lathe_radius_mode",
                                      "_spindle_on",
                                      "_spindle_cw",
                                      "_mist",
                                      "_flood",
                                      "_speed_override",
                                      "_feed_override",
                                      "_adaptive_feed",
                                      "_feed_hold",
                                      "_rpm",
                                      "_x",
                                      "_y",
                                      "_z",
                                      "_a",
                                      "_b",
                                      "_c",
                                      "_u",
                                      "_current_tool",
                                      "_selected_tool",
                                      "_call_level",
                                      "_value",
                                      "_value_returned"};

void predefined_names(ProgramText& text) {
    text.line(
        "{}",
        text.one_of({"G91",   "G90", "G20",    "G21",      "G18",    "G93",    "G95",   "S100 M3",
                     "M5",    "M7",  "M8",     "M9",       "G61",    "G64",    "G99",   "G98",
                     "T3 M6", "G55", "G43 H2", "G41.1 D1", "G40",    "G90.1",  "G91.1", "M49",
                     "M48",   "G7",  "G8",     "G96 S9",   "G97 S9", "M51 P0", "F33"}));
    const std::string name =
        predefined[static_cast<size_t>(text.whole(0, std::size(predefined) - 1))];
    text.line("#1=#<{}>\nG49", name);
    text.line("G21 G90 G17 G40 G94 F100 G8 G97 G91.1 G54 G0");
    text.line("G0 Z#1");
}

void formats(ProgramText& text) {
    text.line("{}", text.one_of({"g0x1y2z3",
                                 "G00X+01.500Y-.25Z5.",
                                 "G 1 X 1 2 . 5 Y - 0 . 5",
                                 "N10 G1 X1",
                                 "n0020g1y2",
                                 "G1 (words) X3 (more) Y4",
                                 "G1 X1 ; the rest",
                                 "x 0.000 y +.5",
                                 "G01 X-0 Y+0",
                                 "g1 x#[ 1 + 2 ]",
                                 "G1 X[1+[2*3]]Y[-4]",
                                 "N1.5 G1 Y1",
                                 "  G1   X7 ",
                                 "G1\tX8",
                                 "G1 X1Y1Z1F100",
                                 "G1X1.Y1.",
                                 "m9",
                                 "G1.0 X1",
                                 "G 5 4",
                                 "x[ 1.0 2 ]",
                                 "G1 X1 2 3",
                                 "Y1 X2 G1",
                                 "M09 G001 X3",
                                 ""}));
}

} // namespace

std::vector<ProgramFeature> language_features() {
    return {{"expressions", expressions},
            {"parameters", parameters},
            {"positions", positions},
            {"predefined_names", predefined_names},
            {"formats", formats}};
}

} // namespace test_support
