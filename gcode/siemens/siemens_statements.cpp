#include <algorithm>

#include <fmt/format.h>

#include "core/base/text.h"
#include "gcode/language/expression_parser.h"
#include "gcode/siemens/siemens_reader.h"

namespace gcode {
namespace {

using core::ErrorCode;
using enum FlowKind;

struct Jump {
    std::string_view name;
    JumpDirection way;
};

constexpr Jump jump_ways[] = {{"GOTO", JumpDirection::either},
                              {"GOTOB", JumpDirection::backward},
                              {"GOTOC", JumpDirection::no_alarm},
                              {"GOTOF", JumpDirection::forward},
                              {"GOTOS", JumpDirection::to_start}};

/// Statements of a single word.
struct Mark {
    std::string_view name;
    FlowKind kind;
};

constexpr Mark marks[] = {{"ELSE", otherwise},
                          {"ENDIF", end_if},
                          {"ENDFOR", end_for},
                          {"ENDWHILE", end_while},
                          {"LOOP", endless_loop},
                          {"ENDLOOP", end_endless},
                          {"RET", FlowKind::return_statement}};

struct TypeName {
    std::string_view name;
    VariableType type;
};

constexpr TypeName types[] = {{"BOOL", VariableType::truth},  {"CHAR", VariableType::whole},
                              {"INT", VariableType::whole},   {"REAL", VariableType::real},
                              {"STRING", VariableType::text}, {"AXIS", VariableType::text},
                              {"FRAME", VariableType::text}};

const Jump* jump_of(std::string_view name) {
    const auto found = std::find_if(std::begin(jump_ways), std::end(jump_ways),
                                    [&](const Jump& some) { return some.name == name; });
    return found != std::end(jump_ways) ? &*found : nullptr;
}

/// Reads a statement after its name.
class Statements {
public:
    Statements(SiemensReader& reader, size_t begin)
        : reader_(reader), block_(reader.block), begin_(begin) {}

    core::Result<bool> read(const std::string& name) {
        if (const Jump* way = jump_of(name)) return done(jump(*way, {}));
        for (const Mark& mark : marks)
            if (name == mark.name) return done(alone(mark.kind));
        if (name == "IF") return done(branch());
        if (name == "WHILE") return done(condition(while_loop));
        if (name == "UNTIL") return done(condition(until));
        if (name == "FOR") return done(counting_loop());
        if (name == "REPEAT") return done(repeat());
        if (name == "DEF") return done(definition());
        if (name == "PROC") return done(procedure());
        if (name == "CALL") return done(call_by_text());
        if (name == "MCALL") return done(modal_call());
        if (name == "EXTERN") return done(rest());
        return false;
    }

private:
    static core::Result<bool> done(core::Result<void> read) {
        if (!read) return tl::unexpected(std::move(read).error());
        return true;
    }

    /// Only a block number, a label and `/` may come before a statement.
    core::Result<void> flow(FlowKind kind) {
        const auto numbers = [](const Word& word) { return word.letter == 'N'; };
        const bool clean =
            std::all_of(block_.words.begin(), block_.words.end(), numbers)
            && block_.assignments.empty() && reader_.siemens.keywords.empty()
            && (block_.flow.kind == none || (block_.flow.kind == jumps && kind == jumps));
        block_.flow.kind = kind;
        block_.flow.span = reader_.lexer.span_from(begin_);
        if (clean) return {};
        return reader_.refuse(fmt::format("'{}' must be in a block by itself",
                                          core::stripped(reader_.lexer.written_from(begin_))),
                              begin_);
    }

    core::Result<void> rest() {
        if (auto begun = flow(declaration); !begun) return begun;
        reader_.lexer.at = reader_.lexer.line.size();
        return {};
    }

    /// The target of a jump: a name or a block number.
    core::Result<std::string> target(std::string_view after) {
        reader_.next();
        const size_t begin = reader_.lexer.at;
        if (reader_.next() == '"' || reader_.next() == '(')
            return reader_.refuse(
                "a string as jump target is not supported yet: use the label itself", begin,
                ErrorCode::unsupported);
        reader_.lexer.accept(':');
        std::string name = siemens_name_at(reader_.lexer);
        reader_.lexer.at += name.size();
        if (name.empty() || name.front() == '$')
            return reader_.refuse(
                fmt::format("'{}' must be followed by a label or a block number", after), begin_);
        if (is_digit(name.front())) name.insert(0, 1, 'N');
        return name;
    }

    core::Result<void> jump(const Jump& way, SiemensArgument condition) {
        SiemensJump entry{.condition = condition, .direction = way.way};
        if (way.way != JumpDirection::to_start) {
            FEELER_TRY(entry.target, target(way.name));
        }
        entry.span = reader_.lexer.span_from(begin_);
        if (auto begun = flow(jumps); !begun) return begun;
        reader_.siemens.jumps.push_back(std::move(entry));
        return {};
    }

    core::Result<SiemensArgument> truth(std::string_view after) {
        if (reader_.next() == '\0')
            return reader_.refuse(fmt::format("'{}' must be followed by a condition", after),
                                  begin_);
        return reader_.argument();
    }

    core::Result<void> branch() {
        FEELER_TRY(const SiemensArgument holds, truth("IF"));
        reader_.next();
        const std::string name = siemens_name_at(reader_.lexer);
        if (const Jump* way = jump_of(name)) {
            reader_.lexer.at += name.size();
            return jump(*way, holds);
        }
        reader_.siemens.arguments.push_back(holds);
        return alone(if_branch);
    }

    core::Result<void> alone(FlowKind kind) {
        if (auto begun = flow(kind); !begun) return begun;
        if (reader_.next() == '\0') return {};
        return reader_.refuse(
            fmt::format("nothing may follow '{}' in its block", reader_.lexer.written_from(begin_)),
            reader_.lexer.at);
    }

    core::Result<void> condition(FlowKind kind) {
        FEELER_TRY(const SiemensArgument holds, truth(kind == while_loop ? "WHILE" : "UNTIL"));
        reader_.siemens.arguments.push_back(holds);
        return alone(kind);
    }

    /// `FOR I = 1 TO 10`: the first value of the variable is an assignment of the block.
    core::Result<void> counting_loop() {
        if (auto begun = flow(for_loop); !begun) return begun;
        reader_.next();
        const size_t begin = reader_.lexer.at;
        Assignment entry;
        Number plain;
        FEELER_TRY(const Expression variable,
                   parse_value(reader_.lexer, reader_.dialect.expressions, block_.pool, plain));
        const auto& steps = block_.pool.instructions;
        const bool is_name = variable.count == 1 && steps.back().operation == Operation::named;
        const bool is_r = variable && steps.back().operation == Operation::numbered;
        if (!is_name && !is_r)
            return reader_.refuse("'FOR' must be followed by a variable, as in FOR I=1 TO 10",
                                  begin_);
        entry.is_named = is_name;
        if (is_name) entry.name = steps.back().name;
        block_.pool.instructions.pop_back();
        if (is_r) entry.number = {variable.first, variable.count - 1};
        if (!reader_.is_at_equals())
            return reader_.refuse("'FOR' needs '=' after its variable, as in FOR I=1 TO 10",
                                  begin_);
        ++reader_.lexer.at;
        FEELER_TRY(entry.value,
                   parse_sum(reader_.lexer, reader_.dialect.expressions, block_.pool, plain));
        entry.plain = plain.value;
        entry.span = reader_.lexer.span_from(begin);
        if (!reader_.accept_name("TO"))
            return reader_.refuse("'FOR' needs TO and its last value, as in FOR I=1 TO 10", begin_);
        FEELER_TRY(const SiemensArgument last, reader_.argument());
        block_.assignments.push_back(entry);
        reader_.siemens.arguments.push_back(last);
        block_.flow.span = reader_.lexer.span_from(begin_);
        return {};
    }

    /// REPEAT alone starts a loop; with labels it repeats a part of the program.
    core::Result<void> repeat() {
        if (reader_.next() == '\0') return alone(FlowKind::repeat);
        if (auto begun = flow(repeat_part); !begun) return begun;
        for (int i = 0; i < 2 && reader_.next() != '\0' && !is_at_count(); ++i) {
            FEELER_TRY(std::string name, target("REPEAT"));
            reader_.siemens.jumps.push_back(
                {.target = std::move(name), .span = reader_.lexer.span_from(begin_)});
        }
        if (reader_.siemens.jumps.empty())
            return reader_.refuse("'REPEAT' needs a label before P", begin_);
        return read_count();
    }

    bool is_at_count() const {
        SiemensReader ahead = reader_;
        return ahead.accept_name("P") && ahead.is_at_equals();
    }

    core::Result<void> read_count() {
        if (!is_at_count()) return {};
        reader_.accept_name("P");
        reader_.lexer.accept('=');
        FEELER_TRY(reader_.siemens.repeats, reader_.argument());
        return {};
    }

    core::Result<VariableType> type() {
        reader_.next();
        const size_t begin = reader_.lexer.at;
        const std::string name = siemens_name_at(reader_.lexer);
        reader_.lexer.at += name.size();
        for (const TypeName& some : types) {
            if (name != some.name) continue;
            if (some.type == VariableType::text)
                return reader_.refuse(fmt::format("'{}': variables of this type are not supported "
                                                  "yet",
                                                  name),
                                      begin, ErrorCode::unsupported);
            return some.type;
        }
        return reader_.refuse(fmt::format("'{}' is not a type: use REAL, INT or BOOL", name),
                              begin);
    }

    /// A name, optionally with `= value`.
    core::Result<void> declare(VariableType type, bool by_reference) {
        reader_.next();
        const size_t begin = reader_.lexer.at;
        SiemensDeclaration entry{.type = type, .by_reference = by_reference};
        entry.name = siemens_name_at(reader_.lexer);
        reader_.lexer.at += entry.name.size();
        const bool two_letters =
            entry.name.size() > 1 && !is_digit(entry.name[0]) && !is_digit(entry.name[1]);
        if (!two_letters)
            return reader_.refuse("the name of a variable must start with two letters or '_'",
                                  begin);
        if (siemens_keyword(entry.name) || jump_of(entry.name))
            return reader_.refuse(
                fmt::format("'{}' is a keyword of the language and cannot be a variable",
                            entry.name),
                begin);
        if (reader_.next() == '[')
            return reader_.refuse(fmt::format("'{}[': arrays are not supported yet: use R "
                                              "parameters, R[...]",
                                              entry.name),
                                  begin, ErrorCode::unsupported);
        for (char& c : entry.name) c = lower(c);
        if (reader_.is_at_equals()) {
            ++reader_.lexer.at;
            FEELER_TRY(entry.initial, reader_.argument());
        }
        entry.span = reader_.lexer.span_from(begin);
        reader_.siemens.declarations.push_back(std::move(entry));
        return {};
    }

    core::Result<void> definition() {
        if (auto begun = flow(declaration); !begun) return begun;
        while (reader_.accept_name("NCK") || reader_.accept_name("CHAN")
               || reader_.accept_name("SYNR") || reader_.accept_name("SYNW")
               || reader_.accept_name("SYNRW")) {
        }
        FEELER_TRY(const VariableType declared, type());
        do {
            if (auto read = declare(declared, false); !read) return read;
        } while (reader_.lexer.accept(','));
        block_.flow.span = reader_.lexer.span_from(begin_);
        return {};
    }

    core::Result<void> parameters_of_procedure() {
        if (reader_.lexer.accept(')')) return {};
        do {
            const bool by_reference = reader_.accept_name("VAR");
            FEELER_TRY(const VariableType declared, type());
            if (auto read = declare(declared, by_reference); !read) return read;
        } while (reader_.lexer.accept(','));
        return reader_.expect(')', reader_.lexer.written_from(begin_));
    }

    core::Result<void> procedure() {
        if (auto begun = flow(FlowKind::procedure); !begun) return begun;
        reader_.next();
        reader_.siemens.name = siemens_name_at(reader_.lexer);
        if (reader_.siemens.name.empty())
            return reader_.refuse("'PROC' must be followed by the name of the program", begin_);
        reader_.lexer.at += reader_.siemens.name.size();
        if (reader_.lexer.accept('('))
            if (auto read = parameters_of_procedure(); !read) return read;
        while (reader_.next() != '\0') {
            const size_t begin = reader_.lexer.at;
            const std::string name = siemens_name_at(reader_.lexer);
            reader_.lexer.at += std::max<size_t>(name.size(), 1);
            constexpr std::string_view known[] = {"SAVE",    "SBLOF",     "SBLON", "DISPLOF",
                                                  "DISPLON", "ACTBLOCNO", "PREPRO"};
            if (std::find(std::begin(known), std::end(known), name) == std::end(known))
                return reader_.refuse(fmt::format("'{}' is not allowed after PROC",
                                                  reader_.lexer.written_from(begin)),
                                      begin);
            reader_.siemens.saves_modes |= name == "SAVE";
        }
        return {};
    }

    /// `CALL "NAME"`
    core::Result<void> call_by_text() {
        FEELER_TRY(const SiemensArgument named, truth("CALL"));
        if (named.kind != SiemensArgument::Kind::text)
            return reader_.refuse("'CALL' with a program name from a variable is not supported "
                                  "yet: write the name in quotation marks",
                                  begin_, ErrorCode::unsupported);
        return read_siemens_call(reader_, std::string(named.text), begin_);
    }

    /// `MCALL CYCLE81(...)`, `MCALL L100`, or MCALL alone, which cancels it.
    core::Result<void> modal_call() {
        reader_.siemens.is_modal_call = true;
        block_.has_command = true;
        reader_.next();
        const std::string name = siemens_name_at(reader_.lexer);
        const SiemensKeyword* keyword = siemens_keyword(name);
        if (name.empty() || (keyword && keyword->action == SiemensAction::drill)) return {};
        if (keyword)
            return reader_.refuse(
                fmt::format("'MCALL {}': only drilling cycles and programs can be called modally",
                            name),
                begin_, ErrorCode::unsupported);
        reader_.lexer.at += name.size();
        return read_siemens_call(reader_, name, begin_);
    }

    SiemensReader& reader_;
    Block& block_;
    const size_t begin_;
};

} // namespace

core::Result<bool> read_siemens_statement(SiemensReader& reader, const std::string& name,
                                          size_t begin) {
    return Statements(reader, begin).read(name);
}

core::Result<void> read_siemens_call(SiemensReader& reader, std::string name, size_t begin) {
    Block& block = reader.block;
    const auto numbers = [](const Word& word) { return word.letter == 'N'; };
    if (!std::all_of(block.words.begin(), block.words.end(), numbers) || !block.assignments.empty()
        || !reader.siemens.name.empty() || block.flow.kind != none)
        return reader.refuse(
            fmt::format(
                "'{}' is not a word of this control; a program call must be in a block by itself",
                name),
            begin);
    reader.siemens.name = std::move(name);
    reader.siemens.name_span = reader.lexer.span_from(begin);
    if (reader.next() == '(')
        if (auto read = reader.arguments(reader.siemens.arguments); !read) return read;
    // P or P=: number of repetitions
    if (reader.next() != '\0' && upper(reader.next()) == 'P') {
        ++reader.lexer.at;
        if (reader.is_at_equals()) ++reader.lexer.at;
        FEELER_TRY(reader.siemens.repeats, reader.argument());
    }
    if (reader.next() != '\0')
        return reader.refuse(
            fmt::format(
                "'{}' is called here; only P with the number of repetitions may follow a call",
                reader.siemens.name),
            begin);
    if (reader.siemens.is_modal_call) return {};
    block.flow.kind = call_program;
    block.flow.span = reader.siemens.name_span;
    return {};
}

} // namespace gcode
