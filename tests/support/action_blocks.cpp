#include "tests/support/program_generator.h"

namespace test_support {
namespace {

void tools(ProgramText& text) {
    switch (text.whole(0, 3)) {
    case 0:
        text.line("T{}", text.whole(0, 9));
        break;
    case 1:
        text.line("T{} M6", text.whole(0, 9));
        break;
    case 2:
        text.line("G4 P0"); // a straight feed directly before M61 is not made
        text.line("M61 Q{}", text.whole(0, 9));
        break;
    default:
        text.line("T{}", text.whole(1, 9));
        text.line("M6");
    }
}

void spindle(ProgramText& text) {
    switch (text.whole(0, 5)) {
    case 0:
        text.line("S{}", text.positive(3000));
        break;
    case 1:
        text.line("M{}", text.whole(3, 5));
        break;
    case 2:
        text.line("S{} M{}", text.whole(0, 3000), text.whole(3, 4));
        break;
    case 3:
        text.line("G96 {}S{} M3", text.once_in(2) ? "D2000 " : "", text.whole(10, 300));
        break;
    case 4:
        text.line("G97 S{}", text.whole(0, 3000));
        break;
    default:
        text.line("M19 R{}", text.whole(0, 360));
    }
}

void coolant(ProgramText& text) {
    text.line("M{}", text.whole(7, 9));
    if (text.once_in(3)) text.line("G4 P{}", text.positive(3));
}

void stops(ProgramText& text) {
    text.line("{}", text.one_of({"M0", "M1", "M60", "G4 P0", "G4 P1.25"}));
}

void path_modes(ProgramText& text) {
    text.line("{}", text.one_of({"G61", "G61.1", "G64", "G64 P0.05", "G64 P0.1 Q0.02", "G64 P0"}));
}

void overrides(ProgramText& text) {
    text.line("{}", text.one_of({"M48", "M49", "M50", "M50 P0", "M50 P1", "M51", "M51 P0", "M51 P1",
                                 "M52", "M52 P0", "M52 P1", "M53", "M53 P0", "M53 P1"}));
}

void outputs(ProgramText& text) {
    switch (text.whole(0, 2)) {
    case 0:
        text.line("M{} P{}", text.whole(62, 65), text.whole(0, 10));
        break;
    case 1:
        text.line("M{} E{} Q{}", text.whole(67, 68), text.whole(0, 3), text.length());
        break;
    default:
        text.line("M66 {}", text.one_of({"P0 L0", "P1 L1 Q1", "E0 L0", "P2 L3 Q0.5"}));
        text.line("G1 X#5399");
    }
}

void messages(ProgramText& text) {
    switch (text.whole(0, 3)) {
    case 0:
        text.line("(MSG, words {})", text.whole(0, 99));
        break;
    case 1:
        text.line("#1={}", text.length());
        text.line("(DEBUG, value #1 and #5420 and #<_feed>)");
        break;
    case 2:
        text.line("(PRINT, value #1 %f #2 %d #3)");
        break;
    default:
        text.line("G1 X1 (a comment)(MSG,last one counts)");
    }
}

/// Several words on a line, whose order of execution is fixed.
void crowded_lines(ProgramText& text) {
    text.line("{}{}{}{}{} {}{}", text.once_in(2) ? "G54 " : "G55 ",
              text.once_in(2) ? fmt::format("F{} ", text.positive(500)) : "",
              text.once_in(2) ? fmt::format("S{} ", text.whole(1, 999)) : "",
              text.one_of({"M3 ", "M4 ", "M5 ", ""}), text.one_of({"M7 ", "M8 ", "M9 ", ""}),
              text.one_of({"G0", "G1"}), text.axis_words("XYZ"));
    switch (text.whole(0, 4)) {
    case 0:
        text.line("G4 P{} M{} S{}", text.positive(2), text.whole(3, 5), text.whole(1, 999));
        break;
    case 1:
        text.line("T{} M6 {}{}", text.whole(1, 9), text.one_of({"G0", "G1"}),
                  text.axis_words("XYZ"));
        break;
    case 2:
        text.line("G91 G1{} M0", text.axis_words("XYZ"));
        text.line("G90");
        break;
    case 3:
        text.line("G20 G1{} F{} M1", text.axis_words("XYZ"), text.positive(9));
        text.line("G21");
        break;
    default:
        text.line("G90 G80 G55 G61 G40 G49 G94 F{}", text.positive(500));
        text.line("G1 G64 G54{}", text.axis_words("XYZ"));
    }
}

void saved_modes(ProgramText& text) {
    text.line("M70");
    text.line("{}", text.one_of({"G91", "G20", "G55", "F77", "S55 M3", "G61", "G18", "G90.1", "M8",
                                 "G93", "M49", "G99", "G64 P0.2"}));
    text.line("G1 X1 F30");
    text.line("M{}", text.one_of({72, 72, 71}));
    text.line("F100");
    const int sub = text.label();
    text.line("O{} sub", sub);
    text.line("{}", text.one_of({"M73", "M73", "M70", "G4 P1"}));
    text.line("{}", text.one_of({"G91", "G20", "G55", "F77", "G61", "G18", "M8"}));
    text.line("G1 X[#1]");
    text.line("O{} endsub", sub);
    text.line("O{} call [{}]", sub, text.length());
    text.line("G1 X2");
    text.line("G21 G90 G17 G54 G94 F200 G91.1");
}

} // namespace

std::vector<ProgramFeature> action_features() {
    return {{"tools", tools},
            {"spindle", spindle},
            {"coolant", coolant},
            {"stops", stops},
            {"path_modes", path_modes},
            {"overrides", overrides},
            {"outputs", outputs},
            {"messages", messages},
            {"crowded_lines", crowded_lines},
            {"saved_modes", saved_modes}};
}

} // namespace test_support
