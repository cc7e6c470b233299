#include "tests/support/program_generator.h"

namespace test_support {
namespace {

struct CyclePlane {
    int code;
    const char* in_plane;
    char normal;
};

CyclePlane plane(ProgramText& text, bool any) {
    if (!any) return {17, "XY", 'Z'};
    return text.one_of(
        {CyclePlane{17, "XY", 'Z'}, CyclePlane{18, "XZ", 'Y'}, CyclePlane{19, "YZ", 'X'}});
}

/// The words that a cycle needs besides its position.
std::string own_words(ProgramText& text, int code) {
    const std::string dwell = fmt::format(" P{}", text.positive(2));
    const std::string peck = fmt::format(" Q{}", 0.3 + text.positive(5));
    if (code == 73 || code == 83) return peck;
    if (code == 82 || code == 86 || code == 89) return dwell;
    return {};
}

void cycle(ProgramText& text, int code, const CyclePlane& plane) {
    const bool incremental = text.once_in(3);
    const double r = text.length(10);
    const double bottom = incremental ? -text.positive(15) : r - text.positive(15);
    text.line("G{} G{} G0 {}{}", plane.code, text.whole(98, 99), plane.normal, text.length(20));
    const bool taps = code == 74 || code == 84; // these do not repeat
    const std::string repeats =
        !taps && text.once_in(3) ? fmt::format(" L{}", text.whole(1, 3)) : "";
    text.line("{} G{}{} {}{} R{}{}{}", incremental ? "G91" : "G90", code,
              text.axis_words(plane.in_plane), plane.normal, bottom, r, own_words(text, code),
              repeats);
    for (int i = text.whole(0, 3); i > 0; --i) {
        if (text.once_in(5)) text.line("G{}", text.whole(98, 99));
        text.line("{}{}", text.axis_words(plane.in_plane),
                  text.once_in(6) ? fmt::format(" R{}", incremental ? r : r + text.positive(5))
                                  : "");
    }
    text.line("{}", text.one_of({"G80", "G80", "G0", "G1"}));
    text.line("G90 G98 G17 {}", text.one_of({"G0", "G1"}));
}

void drilling(ProgramText& text) {
    cycle(text, text.one_of({81, 82, 83, 73, 85, 89}), plane(text, false));
}

void drilling_in_all_planes(ProgramText& text) {
    cycle(text, text.one_of({81, 82, 83, 73, 85, 89}), plane(text, true));
}

void boring(ProgramText& text) {
    text.line("S{} M{}", text.whole(100, 900), text.whole(3, 4));
    cycle(text, 86, plane(text, true));
}

void tapping(ProgramText& text) {
    const int code = text.one_of({74, 84});
    text.line("S{} M{}", text.whole(100, 900), code == 84 ? 3 : 4);
    cycle(text, code, plane(text, true));
}

/// Depth above the retract plane, missing Z, L0, mode changes within a cycle.
void odd_cycles(ProgramText& text) {
    text.line("G0 X0 Y0 Z{}", text.length(10));
    const double r = text.positive(5);
    switch (text.whole(0, 5)) {
    case 0:
        text.line("G81 X1 Z-3 R{}", r);
        text.line("G99 X2 Z-4");
        break;
    case 1:
        text.line("G83 X1 Z-3 R1 Q{}", text.one_of({0.1, 1.0, 1.5, 4.0, 50.0}));
        break;
    case 2:
        text.line("G91 G81 X1 Y2 Z-3 R-1 L{}", text.whole(1, 4));
        text.line("G90 X5 Z-20 R-5");
        break;
    case 3:
        text.line("G82 X1 Z-3 R1 P1");
        text.line("G81 X5 Z-4 R2");
        text.line("G85 Y5 Z-4 R1");
        break;
    case 4:
        text.line("G81 X1 Z-3 R1");
        text.line("{} X3", text.one_of({"G55", "G20", "G21", "M8", "G52 Y2", "F50", "G98"}));
        break;
    default:
        text.line("G73 X1 Z-3 R1 Q1");
        text.line("X2 Q{} L2", text.positive(2));
    }
    text.line("G80 G90 G98 G54 G1");
}

/// The thread turning cycle.
void turned_threads(ProgramText& text) {
    text.line("S{} M3 G18", text.whole(100, 900));
    text.line("G0 X{} Z{}", 10 + text.positive(), text.length());
    text.line("G76 P{} Z{} I{} J{} K{} R{} Q{} H{} E{} L{}", 0.5 + text.positive(2), text.length(),
              text.one_of({-1.0, 1.0, -2.5}), 0.2 + text.positive(1), 2 + text.positive(3),
              text.one_of({1.0, 1.5, 2.0}), text.whole(0, 30), text.whole(0, 3), text.positive(1),
              text.whole(0, 3));
    text.line("G17 G1");
}

} // namespace

std::vector<ProgramFeature> cycle_features() {
    return {{"drilling", drilling},     {"drilling_in_all_planes", drilling_in_all_planes},
            {"boring", boring},         {"tapping", tapping},
            {"odd_cycles", odd_cycles}, {"turned_threads", turned_threads}};
}

} // namespace test_support
