#include "tests/support/program_generator.h"

namespace test_support {
namespace {

std::string any_work_offset(ProgramText& text) {
    return text.one_of({"G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3"});
}

void work_offsets(ProgramText& text) {
    switch (text.whole(0, 3)) {
    case 0:
        text.line("{}", any_work_offset(text));
        break;
    case 1:
        text.line("G10 L2 P{}{}", text.whole(0, 9), text.axis_words("XYZ"));
        break;
    case 2:
        text.line("G10 L20 P{}{}", text.whole(0, 9), text.axis_words("XYZ"));
        break;
    default:
        text.line("{} {}{}", any_work_offset(text), text.one_of({"G0", "G1"}),
                  text.axis_words("XYZ"));
    }
}

void rotated_offsets(ProgramText& text) {
    switch (text.whole(0, 3)) {
    case 0:
        text.line("G10 L2 P{}{} R{}", text.whole(0, 9), text.axis_words("XYZ"), text.length(360));
        break;
    case 1:
        text.line("G10 L20 P{}{}", text.whole(0, 9), text.axis_words("XYZ"));
        break;
    case 2:
        text.line("{}", any_work_offset(text));
        break;
    default:
        text.line("G53 G0{}", text.axis_words("XYZ"));
    }
    if (text.once_in(3)) text.line("G10 L2 P{} R{}", text.whole(0, 2), text.whole(-180, 180));
}

void axis_offsets(ProgramText& text) {
    switch (text.whole(0, 4)) {
    case 0:
        text.line("G52{}", text.axis_words("XYZ"));
        break;
    case 1:
        text.line("G92{}", text.axis_words("XYZABC"));
        break;
    case 2:
        text.line("G92.1");
        break;
    case 3:
        text.line("G92.2");
        break;
    default:
        text.line("G92.3");
    }
    if (text.once_in(3)) text.line("{}", any_work_offset(text));
    if (text.once_in(4)) text.line("G10 L20 P0{}", text.axis_words("XYZ"));
}

void tool_offsets(ProgramText& text) {
    switch (text.whole(0, 5)) {
    case 0:
        text.line("T{} M6", text.whole(1, 9));
        text.line("G43");
        break;
    case 1:
        text.line("G43 H{}", text.whole(0, 9));
        break;
    case 2:
        text.line("G43.1{}", text.axis_words("XYZA"));
        break;
    case 3:
        text.line("G43.2 H{}", text.whole(1, 9));
        break;
    case 4:
        text.line("G49");
        break;
    default:
        text.line("T{} M6", text.whole(1, 9));
    }
    if (text.once_in(4)) text.line("{} G0{}", any_work_offset(text), text.axis_words("XYZ"));
    if (text.once_in(4)) text.line("G92{}", text.axis_words("XYZ"));
}

/// Writes to the tool table while other offsets are active.
void tool_table(ProgramText& text) {
    const int tool = text.whole(1, 9);
    switch (text.whole(0, 2)) {
    case 0:
        text.line("G10 L1 P{}{}{}", tool, text.axis_words("XYZ"),
                  text.once_in(2) ? fmt::format(" R{}", text.positive()) : "");
        break;
    case 1:
        text.line("G10 L10 P{}{}", tool, text.axis_words("XYZ"));
        break;
    default:
        text.line("G10 L11 P{}{}", tool, text.axis_words("XYZ"));
    }
    text.line("G43 H{}", text.once_in(2) ? tool : text.whole(1, 9));
    if (text.once_in(3)) text.line("G92{}", text.axis_words("XYZ"));
    if (text.once_in(3)) text.line("G10 L2 P1{} R{}", text.axis_words("XYZ"), text.whole(0, 90));
}

void home(ProgramText& text) {
    const int code = text.one_of({28, 30});
    switch (text.whole(0, 3)) {
    case 0:
        text.line("G{}.1", code);
        break;
    case 1:
        text.line("G{}", code);
        break;
    case 2:
        text.line("G{}{}", code, text.axis_words("XYZA"));
        break;
    default:
        text.line("G91 G{}{}", code, text.axis_words("XYZ"));
        text.line("G90");
    }
    if (text.once_in(4)) text.line("G92{}", text.axis_words("XYZ"));
    if (text.once_in(4)) text.line("G10 L2 P1{}", text.axis_words("XYZ"));
    if (text.once_in(4)) text.line("G43 H{}", text.whole(1, 9));
}

} // namespace

std::vector<ProgramFeature> offset_features() {
    return {{"work_offsets", work_offsets}, {"rotated_offsets", rotated_offsets},
            {"axis_offsets", axis_offsets}, {"tool_offsets", tool_offsets},
            {"tool_table", tool_table},     {"home", home}};
}

} // namespace test_support
