#include "tests/fuzz/chosen_program.h"

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace test_support {
namespace {

/// A formatted text. In braces, the arguments are evaluated in the order written, so that all
/// compilers choose the same program.
struct Text {
    template <typename... Arguments>
    Text(fmt::format_string<Arguments...> form, Arguments&&... arguments)
        : text(fmt::format(form, std::forward<Arguments>(arguments)...)) {}

    std::string text;
};

class Writer {
public:
    explicit Writer(std::span<const uint8_t> choices) : choices_(choices) {}

    ChosenProgram program() {
        constexpr size_t dialects = 6;
        dialect_ = static_cast<gcode::DialectId>(below(dialects));
        const bool block_delete = below(2) == 1;
        while (at_ < choices_.size()) {
            block();
            text_ += '\n';
        }
        return {std::move(text_), dialect_, block_delete};
    }

private:
    size_t below(size_t count) {
        const size_t choice = at_ < choices_.size() ? choices_[at_] : 0;
        ++at_;
        return choice % count;
    }

    std::string_view one_of(std::initializer_list<std::string_view> these) {
        return these.begin()[below(these.size())];
    }

    bool has_o_words() const { return gcode::dialect(dialect_).has_o_words; }
    bool is_klartext() const { return dialect_ == gcode::DialectId::heidenhain; }

    std::string value() {
        switch (below(8)) {
        case 0:
            return std::string(one_of({"0", "-0", "1", "-1", ".5", "0.0001", "1e9", "99999999999",
                                       "-999999999999999", "2147483648", "4294967296",
                                       "0.00000000001", "123456789012345678901234567890", "-.",
                                       "18446744073709551616", "360", "1000000"}));
        case 1:
            return has_o_words() || !is_klartext() ? Text{"[{}]", expression(0)}.text
                                                   : Text{"Q{}", below(10)}.text;
        case 2:
            return is_klartext() ? Text{"Q{}", below(10)}.text : Text{"#{}", parameter()}.text;
        default:
            return Text{"{}", (static_cast<double>(below(256)) - 128.0) / 4.0}.text;
        }
    }

    std::string parameter() {
        return std::string(one_of({"1",    "2",       "3",    "33",    "100",  "500",  "#1",
                                   "3000", "5061",    "5220", "5221",  "5400", "4001", "<x>",
                                   "<_y>", "<_feed>", "5601", "[1+1]", "0",    "99999"}));
    }

    std::string expression(int depth) {
        switch (depth > 6 ? 0 : below(6)) {
        case 0:
            return Text{"{}", static_cast<double>(below(256)) / 8.0 - 16.0}.text;
        case 1:
            return Text{"#{}", parameter()}.text;
        case 2:
            return Text{"{}[{}]",
                        one_of({"SIN", "ATAN", "SQRT", "EXP", "LN", "ABS", "ROUND", "FIX", "FUP",
                                "ACOS", "BCD", "EXISTS", "POW", "MAX"}),
                        expression(depth + 1)}
                .text;
        case 3:
            return Text{"ATAN[{}]/[{}]", expression(depth + 1), expression(depth + 1)}.text;
        default:
            return Text{"[{}] {} [{}]", expression(depth + 1),
                        one_of({"+", "-", "*", "/", "**", "MOD", "EQ", "LT", "AND", "XOR"}),
                        expression(depth + 1)}
                .text;
        }
    }

    void words(std::string_view letters) {
        for (size_t count = below(6); count-- > 0;)
            text_ += Text{" {}{}", letters[below(letters.size())], value()}.text;
    }

    void block() {
        if (is_klartext()) return klartext_block();
        switch (below(12)) {
        case 0:
        case 1:
            return motion();
        case 2:
            return mode();
        case 3:
            text_ += Text{"G{}.{}", below(190), below(6)}.text;
            return words("XYZABCUVWIJKPQRLHDEFS");
        case 4:
            text_ += Text{"M{}", below(200)}.text;
            return words("PQLSRED");
        case 5:
            return cycle();
        case 6:
            text_ += Text{"#{}={}", parameter(), value()}.text;
            return;
        case 7:
            return has_o_words() ? o_word() : macro_flow();
        case 8:
            text_ += Text{"G10 L{} P{} R{}", below(22), below(12), value()}.text;
            return words("XYZABCIJQ");
        case 9:
            text_ += Text{"{} D{} ", one_of({"G41", "G42", "G41.1", "G40", "G42.1"}), value()}.text;
            return words("XYIJL");
        case 10:
            text_ += one_of({"/", "/2", "(MSG, #1)", "(DEBUG, #<x> %d)", "%", "M30", "T1 M6", "N10",
                             "N#1", "M99", "M98 P1 L3", "O1", "G80", "(", ";", "M3 S1000"});
            return;
        default:
            words("XYZABCUVWFSTHDGMNOIJKPQRLE@^,");
            return;
        }
    }

    void motion() {
        text_ += one_of({"G0", "G1", "G2", "G3", "", "G53 G0", "G1 F100", "G33", "G38.2", "G5",
                         "G5.1", "G5.2", "G5.3", "G28", "G30"});
        words("XYZABCUVWIJKRPF");
        if (below(6) == 0) text_ += Text{" ,{}{}", one_of({"R", "C"}), value()}.text;
    }

    void mode() {
        text_ += one_of({"G17",        "G18",           "G19",           "G20",      "G21",
                         "G90",        "G91",           "G90.1",         "G93",      "G94",
                         "G95",        "G54",           "G59",           "G92 X1",   "G92.1",
                         "G92.2",      "G92.3",         "G52 X1 Y-2",    "G43",      "G43.1 Z5",
                         "G49",        "G98",           "G99",           "G7",       "G8",
                         "G61",        "G64 P.1",       "G96 S100 D99",  "G97 S50",  "M70",
                         "M72",        "M73",           "G68 X1 R7",     "G69",      "G15",
                         "G16",        "G51 X1 Y1 P2.", "G50",           "G51.1 X0", "G50.1",
                         "G68.2 I30.", "G54.1 P3",      "G10 L20 P0 X0", "M4 S100"});
    }

    void cycle() {
        text_ += Text{"G{} Z{} R{} ",
                      one_of({"73", "74", "76", "81", "82", "83", "84", "85", "86", "87", "88",
                              "89", "70", "71", "72", "12", "13", "150"}),
                      value(), value()}
                     .text;
        words("XYZQPLKIJFDE");
    }

    void o_word() {
        const size_t label = below(4);
        text_ +=
            Text{"o{} {}", label,
                 one_of({"sub", "endsub", "call", "return", "if", "elseif", "else", "endif",
                         "while", "endwhile", "do", "repeat", "endrepeat", "break", "continue"})}
                .text;
        if (below(2) == 1) text_ += Text{" [{}]", expression(0)}.text;
    }

    void macro_flow() {
        const size_t label = below(4);
        switch (below(6)) {
        case 0:
            text_ += Text{"IF[{}]GOTO{}", expression(0), label * 10}.text;
            return;
        case 1:
            text_ += Text{"WHILE[{}]DO{}", expression(0), label}.text;
            return;
        case 2:
            text_ += Text{"END{}", label}.text;
            return;
        case 3:
            text_ += Text{"GOTO{}", label * 10}.text;
            return;
        case 4:
            text_ += Text{"IF[{}]THEN #{}={}", expression(0), parameter(), value()}.text;
            return;
        default:
            text_ +=
                Text{"{} P{}", one_of({"G65", "G66", "M98", "M97", "G66.1", "G67"}), label}.text;
            return words("ABCDIJKL");
        }
    }

    void klartext_block() {
        text_ += Text{"{} ", at_ % 1000}.text;
        switch (below(8)) {
        case 0:
            text_ += "L";
            break;
        case 1:
            text_ += one_of({"CC", "CR", "C", "CT", "LP", "CP PA+90", "RND R2", "CHF 1"});
            break;
        case 2:
            text_ +=
                one_of({"LBL 1", "LBL 0", "CALL LBL 1 REP 3", "CALL LBL 1", "M30", "STOP",
                        "TOOL CALL 1 Z S1000", "BLK FORM 0.1 Z X0 Y0 Z-1", "END PGM A MM",
                        "BEGIN PGM A MM", "CYCL CALL M3", "M91", "CYCL DEF 7.0", "PLANE RESET"});
            return;
        case 3:
            text_ += Text{"FN {}: Q{} = {} {} {}",
                          below(20),
                          below(10),
                          value(),
                          one_of({"+", "*", "DIV", "SQRT", "IF"}),
                          value()}
                         .text;
            return;
        case 4:
            text_ += Text{"CYCL DEF {} Q200={} Q201={} Q206={} Q202={} Q203={} Q204={}",
                          200 + below(10),
                          value(),
                          value(),
                          value(),
                          value(),
                          value(),
                          value()}
                         .text;
            return;
        case 5:
            text_ += Text{"Q{} = {}", below(10), expression(0)}.text;
            return;
        default:
            text_ += "L";
            break;
        }
        for (size_t count = below(5); count-- > 0;)
            text_ +=
                Text{" {}{}", one_of({"X", "Y", "Z", "IX", "IY", "F", "R", "PR", "PA"}), value()}
                    .text;
        text_ += one_of({"", " FMAX", " R0", " RL", " DR+", " DR-", " M3", " M99"});
    }

    std::span<const uint8_t> choices_;
    size_t at_ = 0;
    std::string text_;
    gcode::DialectId dialect_ = gcode::DialectId::linuxcnc;
};

} // namespace

ChosenProgram chosen_program(std::span<const uint8_t> choices) { return Writer(choices).program(); }

} // namespace test_support
