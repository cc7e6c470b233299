#include <array>
#include <cmath>

#include "tests/support/program_generator.h"

namespace test_support {
namespace {

constexpr double degree = 3.14159265358979323846 / 180.0;

void straight(ProgramText& text) {
    text.line("{}", text.one_of({"G90", "G91", "G90", "G0", "G1", "G20", "G21"}));
    if (text.once_in(3)) text.line("F{}", text.positive(900));
    text.move();
    if (text.once_in(4))
        text.line("G90 G53 {}{}", text.one_of({"G0", "G1"}), text.axis_words("XYZ"));
    text.line("G90");
}

void rotary_axes(ProgramText& text) {
    text.line("{} {}{}", text.one_of({"G90", "G91"}), text.one_of({"G0", "G1"}),
              text.axis_words("XYZABC", 400));
    text.line("G90");
    text.move("ABC");
}

void secondary_axes(ProgramText& text) {
    text.line("{} {}{}", text.one_of({"G90", "G91"}), text.one_of({"G0", "G1"}),
              text.axis_words("XYZABCUVW"));
    text.line("G90");
    if (text.once_in(3)) text.line("G92{}", text.axis_words("UVW"));
    if (text.once_in(3)) text.line("G10 L2 P1{}", text.axis_words("XUVW"));
    text.move("UVW");
}

struct ArcWords {
    char plane_code;            // of G17 ...
    const char *ends, *centres; // letters
};

ArcWords arc_words(ProgramText& text) {
    return text.one_of(
        {ArcWords{'7', "XYZ", "IJK"}, ArcWords{'8', "ZXY", "KIJ"}, ArcWords{'9', "YZX", "JKI"}});
}

/// A circle through the current position and an end point on it.
struct Circle {
    std::array<double, 2> from, centre, to;
    double radius;
    bool is_full;
};

Circle circle(ProgramText& text, bool can_be_full) {
    Circle c{};
    c.is_full = can_be_full && text.once_in(4);
    c.centre = {text.length(), text.length()};
    c.radius = 0.5 + text.positive();
    const double first = text.whole(0, 359) * degree;
    const double last = first + text.whole(10, 350) * degree;
    c.from = {c.centre[0] + c.radius * std::cos(first), c.centre[1] + c.radius * std::sin(first)};
    c.to = {c.centre[0] + c.radius * std::cos(last), c.centre[1] + c.radius * std::sin(last)};
    if (c.is_full) c.to = c.from;
    return c;
}

std::string helix(ProgramText& text, const ArcWords& letters) {
    return text.once_in(2) ? fmt::format(" {}{}", letters.ends[2], text.length()) : "";
}

void begin_arc(ProgramText& text, const ArcWords& letters, const Circle& c) {
    text.line("G1{}", letters.plane_code);
    text.line("G1 {}{:.7f} {}{:.7f}", letters.ends[0], c.from[0], letters.ends[1], c.from[1]);
}

void centre_arcs(ProgramText& text) {
    const ArcWords letters = arc_words(text);
    const Circle c = circle(text, true);
    begin_arc(text, letters, c);
    const bool incremental = text.once_in(3), absolute_centre = text.once_in(3);
    text.line("{}", incremental ? "G91" : "G90");
    text.line("{}", absolute_centre ? "G90.1" : "G91.1");
    const int direction = text.whole(2, 3);
    std::string words;
    for (size_t i = 0; i < 2; ++i)
        if (!c.is_full || text.once_in(3))
            words += fmt::format(" {}{:.7f}", letters.ends[i],
                                 incremental ? c.to[i] - c.from[i] : c.to[i]);
    for (size_t i = 0; i < 2; ++i)
        words += fmt::format(" {}{:.7f}", letters.centres[i],
                             absolute_centre ? c.centre[i] : c.centre[i] - c.from[i]);
    const std::string turns = text.once_in(4) ? fmt::format(" P{}", text.whole(1, 4)) : "";
    text.line("G{}{}{}{}", direction, words, helix(text, letters), turns);
    text.line("G1 G90 G91.1 G17");
}

void radius_arcs(ProgramText& text) {
    const ArcWords letters = arc_words(text);
    const Circle c = circle(text, false);
    begin_arc(text, letters, c);
    const double chord = std::hypot(c.to[0] - c.from[0], c.to[1] - c.from[1]);
    const double radius = chord / 2.0 * text.one_of({1.0, 1.5, 1.001, 4.0, 1.0000001});
    text.line("G{} {}{:.7f} {}{:.7f} R{}{:.7f}{}{}", text.whole(2, 3), letters.ends[0], c.to[0],
              letters.ends[1], c.to[1], text.once_in(2) ? "-" : "", radius, helix(text, letters),
              text.once_in(6) ? " P2" : "");
    text.line("G1 G17");
}

/// A centre with one word, one end word, an end a little off the circle.
void odd_arcs(ProgramText& text) {
    const double radius = text.positive();
    text.line("G1 X0 Y0");
    switch (text.whole(0, 4)) {
    case 0:
        text.line("G{} X{} I{}", text.whole(2, 3), 2 * radius, radius);
        break;
    case 1:
        text.line("G{} Y{} J{}", text.whole(2, 3), -2 * radius, -radius);
        break;
    case 2:
        text.line("G{} X{:.4f} Y{:.4f} I{}", text.whole(2, 3), radius,
                  radius + text.one_of({0.0005, -0.0005, 0.001, 0.0015, 0.01}), radius);
        break;
    case 3:
        text.line("G{} I{} Z{} P{}", text.whole(2, 3), radius, text.length(), text.whole(1, 3));
        break;
    default:
        text.line("G{} X{} Y{} I{} A{}", text.whole(2, 3), radius, radius, radius, text.length());
        break;
    }
    text.line("G1");
}

void feed_modes(ProgramText& text) {
    switch (text.whole(0, 2)) {
    case 0:
        text.line("G93 G1{} F{}", text.axis_words("XYZ"), text.positive(5));
        if (text.once_in(2))
            text.line("X{} A{} F{}", text.length(), text.length(), text.positive());
        text.line("G1 X0 Y0 F1");
        text.line("G3 X{0} Y{0} I{0} F{1}", text.positive(), text.positive());
        text.line("G94 G1 F{}", text.positive(500));
        break;
    case 1:
        text.line("S{} M3", text.whole(100, 2000));
        text.line("G95 F{}", text.positive(1));
        text.line("G1{}", text.axis_words("XYZ"));
        text.line("G94 F{}", text.positive(500));
        break;
    default:
        text.line("G94 F{}", text.positive(500));
        text.line("G1 A{}", text.length());
    }
}

/// Entries, corners and exits of cutter radius compensation around a polygon.
void compensation(ProgramText& text) {
    const int sides = text.whole(3, 7);
    const double size = 20.0 + text.positive(30), first = text.whole(0, 359);
    const bool left = text.once_in(2), turns_left = text.once_in(2);
    text.line("G21 G0 X{} Y{} Z5", 3 * size, 3 * size);
    if (text.once_in(2))
        text.line("G4{} D{}", left ? 1 : 2, text.whole(1, 3));
    else
        text.line("G4{}.1 D{}", left ? 1 : 2, text.positive(6));
    for (int side = 0; side <= sides; ++side) {
        const double angle = (first + (turns_left ? 360.0 : -360.0) * side / sides) * degree;
        const double x = size * std::cos(angle), y = size * std::sin(angle);
        if (side > 1 && side < sides && text.once_in(3))
            text.line("G{} X{:.5f} Y{:.5f} R{:.5f}", turns_left ? 3 : 2, x, y, size);
        else
            text.line("G1 X{:.5f} Y{:.5f}{}", x, y, text.once_in(4) ? " Z-1" : "");
        if (text.once_in(12)) text.line("G1 Z{}", text.length());
    }
    text.line("G40");
    text.line("G1 X{} Y{}", -3 * size, 3 * size);
}

void splines(ProgramText& text) {
    const auto control = [&] { return fmt::format("X{} Y{}", text.length(), text.length()); };
    switch (text.whole(0, 2)) {
    case 0:
        text.line("G5 {} I{} J{} P{} Q{}", control(), text.length(), text.length(), text.length(),
                  text.length());
        break;
    case 1:
        text.line("G5.1 {} I{} J{}", control(), text.length(), text.length());
        break;
    default:
        text.line("G5.2 {} P1 L3", control());
        for (int i = 0; i < text.whole(3, 5); ++i) text.line("{} P{}", control(), text.whole(1, 3));
        text.line("G5.3");
    }
    text.line("G1");
}

void polar(ProgramText& text) {
    text.line("G0 X{} Y{}", text.positive(), text.positive());
    text.line("{} @{} ^{}", text.one_of({"G0", "G1"}), text.positive(), text.length(180));
    text.line("{}",
              text.one_of({"@5", "^45", "@-3", "^-90 Z1", "G91 ^30", "G91 @1", "G91 @2 ^15"}));
    text.line("G90");
}

void threads(ProgramText& text) {
    text.line("S{} M{}", text.whole(100, 900), text.whole(3, 4));
    if (text.once_in(2))
        text.line("G33 Z{} K{}", text.length(), text.positive(3));
    else
        text.line("G33.1 Z{} K{}", text.length(), text.positive(3));
    text.line("G1");
}

void probes(ProgramText& text) {
    text.line("G38.{}{} F{}", text.whole(2, 5), text.axis_words("XYZ"), text.positive(200));
    text.line("G1 X#5061 Y#5062 Z[#5063+1]");
}

} // namespace

std::vector<ProgramFeature> motion_features() {
    return {{"straight", straight},
            {"rotary_axes", rotary_axes},
            {"secondary_axes", secondary_axes},
            {"centre_arcs", centre_arcs},
            {"radius_arcs", radius_arcs},
            {"odd_arcs", odd_arcs},
            {"feed_modes", feed_modes},
            {"compensation", compensation},
            {"splines", splines},
            {"polar", polar},
            {"threads", threads},
            {"probes", probes}};
}

} // namespace test_support
