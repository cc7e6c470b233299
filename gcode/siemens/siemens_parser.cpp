#include "gcode/siemens/siemens_parser.h"

#include <algorithm>

#include <fmt/format.h>

#include "gcode/language/expression_parser.h"
#include "gcode/language/modal_state.h"
#include "gcode/siemens/siemens_reader.h"

namespace gcode {
namespace {

using core::ErrorCode;

bool begins_name(char c) { return is_letter(c) || c == '_'; }

/// Reads the words of a line.
class SiemensParser {
public:
    explicit SiemensParser(SiemensReader& reader)
        : reader_(reader), lexer_(reader.lexer), block_(reader.block), siemens_(reader.siemens) {}

    core::Result<void> parse() {
        while (const char c = reader_.next()) {
            if (block_.tape_mark) return {};
            if (auto done = item(c); !done) return done;
        }
        if (lexer_.peek() == ';') block_.comments.push_back(lexer_.line_comment());
        return check_flow();
    }

private:
    /// A jump, loop or declaration may only have a block number and a label in its block.
    core::Result<void> check_flow() const {
        if (block_.flow.kind == FlowKind::none) return {};
        const auto numbers = [](const Word& some) { return some.letter == 'N'; };
        const size_t own = block_.flow.kind == FlowKind::for_loop ? 1 : 0;
        if (std::all_of(block_.words.begin(), block_.words.end(), numbers)
            && block_.assignments.size() == own && siemens_.keywords.empty()
            && siemens_.tool_name.kind == SiemensArgument::Kind::nothing)
            return {};
        const core::SourceSpan span = block_.flow.span;
        return core::fail(ErrorCode::syntax,
                          fmt::format("'{}' must be in a block by itself: move the other words to "
                                      "the block before or after it",
                                      lexer_.line.substr(span.column - 1, span.length)),
                          span);
    }

    core::Result<void> item(char c) {
        if (c == '/') return block_delete();
        if (c == '%') return header();
        if (c == ':' && block_.is_empty()) return word('N', lexer_.at++);
        if (begins_name(c)) return lettered();
        if (c == '$')
            return stray(lexer_.at, siemens_name_at(lexer_).size(),
                         "writing system variables is not supported yet");
        if (c == '(')
            return stray(lexer_.at, 1, "brackets are not allowed here; comments start with ';'");
        if (lexer_.is_at_number()) {
            const size_t begin = lexer_.at;
            if (!lexer_.number()) ++lexer_.at;
            return reader_.refuse(
                fmt::format("'{}' has no letter before it", lexer_.written_from(begin)), begin);
        }
        return lexer_.unexpected_character();
    }

    core::Result<void> stray(size_t begin, size_t length, std::string_view why) {
        return core::fail(ErrorCode::unsupported,
                          fmt::format("'{}': {}", lexer_.line.substr(begin, length), why),
                          lexer_.span(begin, begin + length));
    }

    /// `/`, `/0` to `/9`: first, or after the block number.
    core::Result<void> block_delete() {
        const size_t begin = lexer_.at++;
        int number = number_of_plain_slash(reader_.dialect.block_delete);
        if (lexer_.at < lexer_.line.size() && is_digit(lexer_.line[lexer_.at]))
            number = lexer_.line[lexer_.at++] - '0';
        const bool after_number = block_.words.size() == 1 && block_.words[0].letter == 'N';
        if (!(block_.is_empty() || after_number) || block_.block_delete)
            return reader_.refuse("'/' must be at the start of the block", begin);
        block_.block_delete = number;
        return {};
    }

    /// `%_N_NAME_MPF`
    core::Result<void> header() {
        if (!block_.is_empty())
            return reader_.refuse("'%' must be at the start of the line", lexer_.at);
        block_.tape_mark = true;
        return {};
    }

    /// A letter with a value, or a name.
    core::Result<void> lettered() {
        const size_t begin = lexer_.at;
        const char c = upper(lexer_.line[begin]);
        const char next = begin + 1 < lexer_.line.size() ? lexer_.line[begin + 1] : '\0';
        if (c == '_' || begins_name(next)) return named();
        if (c == 'R' && (is_digit(next) || next == '[')) return parameter();
        if (c == 'L' && is_digit(next)) {
            std::string name = siemens_name_at(lexer_);
            lexer_.at += name.size();
            return read_siemens_call(reader_, std::move(name), begin);
        }
        ++lexer_.at;
        if (is_digit(next) && is_extended()) return extended(c, begin);
        return word(c, begin);
    }

    /// Whether an `=` follows the digits here: S1=500.
    bool is_extended() {
        SiemensReader ahead = reader_;
        while (ahead.lexer.at < ahead.lexer.line.size()
               && is_digit(ahead.lexer.line[ahead.lexer.at]))
            ++ahead.lexer.at;
        return ahead.is_at_equals();
    }

    /// A word with the number of a spindle, an axis or a direction: M1=3, X1=0, I1=10.
    core::Result<void> extended(char letter, size_t begin) {
        const std::string name = siemens_name_at({.line = lexer_.line, .at = begin});
        lexer_.at = begin + name.size();
        const SiemensKeyword* keyword = siemens_keyword(name);
        if (keyword && keyword->action == SiemensAction::address)
            return address(keyword->text.front(), begin);
        if (keyword) return use(*keyword, begin);
        const bool first = name.size() == 2 && name[1] == '1';
        const bool is_machine_axis = first && (letter >= 'X' && letter <= 'Z');
        const bool is_master = first && (letter == 'S' || letter == 'M' || letter == 'T');
        if (is_master || (is_machine_axis && names_machine_axes())) {
            reader_.is_at_equals();
            ++lexer_.at;
            return value(letter, begin, false);
        }
        if (letter == 'S' || letter == 'M' || letter == 'H' || letter == 'T') {
            ++lexer_.at;
            static constexpr SiemensKeyword other_spindle{
                "a word with the number of a spindle", SiemensAction::warning,
                "it is not for spindle 1, which holds the tool, and is ignored"};
            siemens_.keywords.push_back({&other_spindle, lexer_.span_from(begin)});
            block_.has_command = true;
            if (auto skipped = reader_.argument(); !skipped)
                return tl::unexpected(std::move(skipped).error());
            return {};
        }
        return reader_.refuse(fmt::format("'{}=': there is no such axis or address here", name),
                              begin, ErrorCode::unsupported);
    }

    /// G74 and G75 take machine axes.
    bool names_machine_axes() const {
        return std::any_of(block_.words.begin(), block_.words.end(), [](const Word& some) {
            return some.letter == 'G' && (some.value == 74.0 || some.value == 75.0);
        });
    }

    core::Result<void> word(char letter, size_t begin) {
        if (std::string_view("ELOPQR").find(letter) != std::string_view::npos)
            return stray(begin, 1, "there is no such axis or address here");
        if (reader_.is_at_equals()) {
            ++lexer_.at;
            return value(letter, begin, true);
        }
        if (!lexer_.is_at_number())
            return core::fail(
                ErrorCode::syntax,
                fmt::format(
                    "'{}' must be followed by a number; a computed value needs '=', as in {}=R1",
                    lexer_.line[begin], letter),
                lexer_.span(begin, begin + 1));
        FEELER_TRY(const Number number, lexer_.number());
        return add({.letter = letter,
                    .value = number.value,
                    .span = lexer_.span_from(begin),
                    .has_point = true});
    }

    /// The value after `=`.
    core::Result<void> value(char letter, size_t begin, bool may_be_text) {
        Word entry{.letter = letter, .has_point = true};
        if (may_be_text && letter == 'T' && lexer_.peek() == '"') {
            FEELER_TRY(siemens_.tool_name, reader_.argument());
            block_.has_command = true;
            return {};
        }
        const bool addresses = axis_letters.find(letter) != std::string_view::npos
                               || (letter >= 'I' && letter <= 'K') || letter == '^'
                               || letter == '@';
        bool closes = false;
        if (addresses) closes = take_addressing(entry);
        Number plain;
        FEELER_TRY(entry.expression,
                   parse_sum(lexer_, reader_.dialect.expressions, block_.pool, plain));
        entry.value = plain.value;
        if (closes)
            if (auto done = reader_.expect(')', lexer_.written_from(begin)); !done) return done;
        entry.span = lexer_.span_from(begin);
        return add(entry);
    }

    struct AddressingName {
        std::string_view name;
        Addressing addressing;
    };
    static constexpr AddressingName addressings[] = {{"AC", Addressing::absolute},
                                                     {"IC", Addressing::incremental},
                                                     {"DC", Addressing::shortest},
                                                     {"ACP", Addressing::positive},
                                                     {"ACN", Addressing::negative}};

    bool take_addressing(Word& entry) {
        const size_t before = lexer_.at;
        lexer_.peek();
        const std::string name = siemens_name_at(lexer_);
        const auto found = std::ranges::find(addressings, name, &AddressingName::name);
        if (found == std::end(addressings)) return false;
        lexer_.at += name.size();
        if (!lexer_.accept('(')) {
            lexer_.at = before;
            return false;
        }
        entry.addressing = found->addressing;
        return true;
    }

    core::Result<void> add(const Word& entry) {
        const bool repeatable = entry.letter == 'G' || entry.letter == 'M';
        const auto same = [&](const Word& some) { return some.letter == entry.letter; };
        if (!repeatable && std::any_of(block_.words.begin(), block_.words.end(), same))
            return core::fail(
                ErrorCode::syntax,
                fmt::format("'{}' appears twice in this block",
                            lexer_.line.substr(entry.span.column - 1, entry.span.length)),
                entry.span);
        block_.words.push_back(entry);
        return {};
    }

    core::Result<void> parameter() {
        const size_t begin = lexer_.at;
        Assignment entry;
        Number plain;
        FEELER_TRY(entry.number,
                   parse_value(lexer_, reader_.dialect.expressions, block_.pool, plain));
        // The expression read so far gives the value of the parameter; without its last step it
        // gives the number of the parameter.
        block_.pool.instructions.pop_back();
        --entry.number.count;
        return assignment(entry, begin);
    }

    core::Result<void> assignment(Assignment& entry, size_t begin) {
        if (!reader_.is_at_equals())
            return reader_.refuse(fmt::format("'{}' alone has no effect: set the parameter with "
                                              "'=', or use it as the value of a word, as in X={}",
                                              lexer_.written_from(begin),
                                              lexer_.written_from(begin)),
                                  begin);
        ++lexer_.at;
        if (lexer_.peek() == '"')
            return stray(lexer_.at, 1, "string variables are not supported yet");
        Number plain;
        FEELER_TRY(entry.value, parse_sum(lexer_, reader_.dialect.expressions, block_.pool, plain));
        entry.plain = plain.value;
        entry.span = lexer_.span_from(begin);
        block_.assignments.push_back(entry);
        return {};
    }

    core::Result<void> named() {
        const size_t begin = lexer_.at;
        std::string name = siemens_name_at(lexer_);
        lexer_.at += name.size();
        if (reader_.next() == ':' && is_at_start()) {
            ++lexer_.at;
            siemens_.label = std::move(name);
            return {};
        }
        if (const SiemensKeyword* keyword = siemens_keyword(name)) return use(*keyword, begin);
        FEELER_TRY(const bool is_statement, read_siemens_statement(reader_, name, begin));
        if (is_statement) return {};
        if (reader_.is_at_equals()) {
            Assignment entry{.name = static_cast<uint32_t>(block_.pool.names.size()),
                             .is_named = true};
            for (char& c : name) c = lower(c);
            block_.pool.names.push_back(std::move(name));
            return assignment(entry, begin);
        }
        if (reader_.next() == '[')
            return reader_.refuse(fmt::format("'{}[': arrays are not supported yet: use R "
                                              "parameters, R[...]",
                                              name),
                                  begin, ErrorCode::unsupported);
        return read_siemens_call(reader_, std::move(name), begin);
    }

    bool is_at_start() const {
        const bool numbered = block_.words.size() == 1 && block_.words[0].letter == 'N';
        return (block_.words.empty() || numbered) && block_.assignments.empty()
               && siemens_.label.empty() && siemens_.keywords.empty();
    }

    core::Result<void> address(char letter, size_t begin) {
        if (!reader_.is_at_equals())
            return reader_.refuse(
                fmt::format("'{}' must be followed by '=' and a value", lexer_.written_from(begin)),
                begin);
        ++lexer_.at;
        if (auto done = value(letter, begin, false); !done) return done;
        if (letter != 'P') return {};
        // TURN gives the number of full turns before the arc itself; P of other controls includes
        // the arc.
        Word& turns = block_.words.back();
        if (!turns.expression) {
            turns.value += 1.0;
            return {};
        }
        const auto column = turns.span.column;
        block_.pool.instructions.push_back({Operation::number, column, 1.0});
        block_.pool.instructions.push_back({Operation::add, column});
        turns.expression.count += 2;
        return {};
    }

    core::Result<void> use(const SiemensKeyword& keyword, size_t begin);
    core::Result<SiemensArgument> read_value(size_t begin);
    core::Result<void> skip_brackets(size_t begin);

    SiemensReader& reader_;
    Lexer& lexer_;
    Block& block_;
    SiemensLine& siemens_;
};

/// Reads the value of an address that is no axis: `OVR=50`, `ACC[X]=80`.
core::Result<SiemensArgument> SiemensParser::read_value(size_t begin) {
    if (lexer_.accept('[')) {
        const size_t end = lexer_.line.find(']', lexer_.at);
        if (end == std::string_view::npos) {
            auto closed = reader_.expect(']', lexer_.written_from(begin));
            return tl::unexpected(std::move(closed).error());
        }
        lexer_.at = end + 1;
    }
    if (!reader_.is_at_equals())
        return reader_.refuse(
            fmt::format("'{}' must be followed by '=' and a value", lexer_.written_from(begin)),
            begin);
    ++lexer_.at;
    Word spindle; // SPOS=DC(90): how the spindle turns there does not matter
    const bool closes = take_addressing(spindle);
    FEELER_TRY(const SiemensArgument value, reader_.argument());
    if (closes)
        if (auto done = reader_.expect(')', lexer_.written_from(begin)); !done)
            return tl::unexpected(std::move(done).error());
    return value;
}

/// Skips brackets whose contents have no effect here, such as names of axes in `FGROUP(X,Y)`.
core::Result<void> SiemensParser::skip_brackets(size_t begin) {
    int depth = 0;
    for (; lexer_.at < lexer_.line.size(); ++lexer_.at) {
        const char c = lexer_.line[lexer_.at];
        if (c == '(') ++depth;
        if (c != ')' || --depth > 0) continue;
        ++lexer_.at;
        return {};
    }
    return reader_.expect(')', lexer_.written_from(begin));
}

core::Result<void> SiemensParser::use(const SiemensKeyword& keyword, size_t begin) {
    using enum SiemensAction;
    const core::SourceSpan span = lexer_.span_from(begin);
    switch (keyword.action) {
    case refusal:
    case refused_address:
        return core::fail(ErrorCode::unsupported,
                          fmt::format("'{}': {}", keyword.name, keyword.text), span);
    case address:
        return SiemensParser::address(keyword.text.front(), begin);
    case noted_address:
    case normal_vector:
    case angle_to_path:
    case orient_spindle:
        if (auto value = read_value(begin); !value) return tl::unexpected(std::move(value).error());
        break;
    case tolerance:
    case corner_shape:
    case fixed_point: {
        FEELER_TRY(const SiemensArgument value, read_value(begin));
        siemens_.keywords.push_back({&keyword, lexer_.span_from(begin), value});
        block_.has_command = true;
        return {};
    }
    case machine_position:
        block_.words.push_back({.letter = 'G', .value = 53.0, .span = span});
        return {};
    default:
        break;
    }
    const bool calls = keyword.action >= message;
    if (calls && !siemens_.arguments.empty())
        return reader_.refuse(fmt::format("'{}' must be in a block by itself", keyword.name),
                              begin);
    std::vector<SiemensArgument> passed_over;
    if (keyword.action == note && reader_.next() == '(') {
        if (auto skipped = skip_brackets(begin); !skipped) return skipped;
    } else if (reader_.next() == '(') {
        const bool keeps = calls || keyword.action == transformation;
        auto read = reader_.arguments(keeps ? siemens_.arguments : passed_over);
        if (!read) return read;
    }
    siemens_.keywords.push_back({&keyword, lexer_.span_from(begin)});
    block_.has_command = true;
    return {};
}

} // namespace

core::Result<void> parse_siemens(std::string_view text, uint32_t line, const Dialect& dialect,
                                 Block& block) {
    SiemensLine& siemens = block.language_line.write<SiemensLine>();
    siemens.clear();
    SiemensReader reader{.lexer = {.line = text,
                                   .line_number = line,
                                   .blanks_end_numbers = true,
                                   .has_exponents = true},
                         .dialect = dialect,
                         .block = block,
                         .siemens = siemens};
    return SiemensParser(reader).parse();
}

} // namespace gcode
