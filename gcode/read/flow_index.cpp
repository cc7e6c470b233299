#include "gcode/read/flow_index.h"

#include <algorithm>

#include <fmt/format.h>

#include "gcode/klartext/klartext_parser.h"
#include "gcode/language/dialect.h"
#include "gcode/language/lexer.h"
#include "gcode/read/flow_parser.h"
#include "gcode/read/parser.h"
#include "gcode/siemens/siemens_parser.h"
#include "gcode/text/source.h"

namespace gcode {
namespace {

bool by_line(const FlowMark& mark, uint32_t line) { return mark.line < line; }

bool is_one_of(FlowKind kind, std::initializer_list<FlowKind> kinds) {
    return std::find(kinds.begin(), kinds.end(), kind) != kinds.end();
}

} // namespace

std::optional<double> take_block_number(Lexer& lexer) {
    while (lexer.accept('/'))
        if (is_digit(lexer.peek())) ++lexer.at;
    if (upper(lexer.peek()) != 'N') return std::nullopt;
    ++lexer.at;
    if (!lexer.is_at_number()) return std::nullopt;
    const auto number = lexer.number();
    lexer.accept('/');
    return number ? std::optional(number->value) : std::nullopt;
}

std::string label_of(double number) { return fmt::format("{:.12g}", number); }

namespace {

bool is_program_number(char c) { return upper(c) == 'O' || c == ':'; }

/// What an O word is whose line goes on with something that cannot be read.
bool parse_head(Lexer lexer, const Dialect& dialect, Block& block) {
    if (!dialect.has_o_words || upper(lexer.peek()) != 'O') return false;
    block = {};
    return parse_flow_head(lexer, dialect, block).value_or(false) && block.flow.has_label;
}

bool may_begin_flow(char c) {
    return std::string_view("OIWDEG:").find(upper(c)) != std::string_view::npos && c != '\0';
}

} // namespace

const FlowMark* FlowIndex::at(uint32_t line) const {
    const auto found = std::lower_bound(marks.begin(), marks.end(), line, by_line);
    return found != marks.end() && found->line == line ? &*found : nullptr;
}

const FlowMark* FlowIndex::next(uint32_t line, uint32_t scope, std::string_view name,
                                std::initializer_list<FlowKind> kinds) const {
    for (auto mark = std::lower_bound(marks.begin(), marks.end(), line + 1, by_line);
         mark != marks.end(); ++mark)
        if (mark->scope == scope && mark->name == name && is_one_of(mark->kind, kinds))
            return &*mark;
    return nullptr;
}

const FlowMark* FlowIndex::previous(uint32_t line, uint32_t scope, std::string_view name,
                                    std::initializer_list<FlowKind> kinds) const {
    for (auto mark = std::lower_bound(marks.begin(), marks.end(), line, by_line);
         mark != marks.begin();) {
        --mark;
        if (mark->scope == scope && mark->name == name && is_one_of(mark->kind, kinds))
            return &*mark;
    }
    return nullptr;
}

const FlowMark* FlowIndex::first(FlowKind kind, std::string_view name) const {
    for (const FlowMark& mark : marks)
        if (mark.kind == kind && mark.name == name) return &mark;
    return nullptr;
}

uint32_t FlowIndex::scope_of(uint32_t line) const {
    auto mark = std::lower_bound(marks.begin(), marks.end(), line, by_line);
    if (mark != marks.end() && mark->line == line) return mark->scope;
    if (mark == marks.begin()) return 0;
    --mark;
    if (mark->kind == FlowKind::sub) return mark->line;
    return mark->kind == FlowKind::end_sub ? 0 : mark->scope;
}

std::optional<uint32_t> FlowIndex::line_of_number(double number, uint32_t from,
                                                  uint32_t up_to) const {
    const auto begin = std::lower_bound(
        numbers.begin(), numbers.end(), from,
        [](const NumberedLine& entry, uint32_t line) { return entry.line < line; });
    for (auto entry = begin; entry != numbers.end() && entry->line < up_to; ++entry)
        if (entry->number == number) return entry->line;
    return std::nullopt;
}

FlowIndex index_of(const Program& program, const Dialect& dialect) {
    if (dialect.language == Language::klartext) return klartext_index(program, dialect);
    if (dialect.language == Language::siemens) return siemens_index(program, dialect);
    FlowIndex index;
    Block block;
    uint32_t scope = 0;
    std::vector<std::string> open_loops;
    for (size_t number = 1; program.has_line(number).value_or(false); ++number) {
        const auto line = static_cast<uint32_t>(number);
        Lexer lexer{.line = program.line(number), .line_number = line};
        if (const auto block_number = take_block_number(lexer))
            index.numbers.push_back({*block_number, line});
        if (!may_begin_flow(lexer.peek())) continue;
        if (is_program_number(lexer.peek()) && !dialect.has_o_words) {
            ++lexer.at;
            if (const auto name = lexer.number()) {
                // Loops and branches do not reach into the next program of the file.
                scope = line;
                index.marks.push_back(
                    {FlowKind::program_number, label_of(name->value), line, scope});
            }
            continue;
        }
        if (!parse_line(program.line(number), line, dialect, block)
            && !parse_head(lexer, dialect, block)) {
            // Refused when it is skipped.
            if (dialect.has_o_words && upper(lexer.peek()) == 'O')
                index.marks.push_back({FlowKind::none, {}, line, scope});
            continue;
        }
        if (block.flow.kind == FlowKind::none) continue;
        FlowMark mark{.kind = block.flow.kind, .line = line, .scope = scope};
        if (block.flow.has_label) mark.name = block.pool.names[block.flow.label_name];
        const auto open = std::find(open_loops.begin(), open_loops.end(), mark.name);
        if (mark.kind == FlowKind::do_loop) {
            open_loops.push_back(mark.name);
        } else if (mark.kind == FlowKind::while_loop && open != open_loops.end()) {
            mark.closes_do_loop = true;
            open_loops.erase(open);
        } else if (mark.kind == FlowKind::sub) {
            scope = line;
            mark.scope = 0;
        } else if (mark.kind == FlowKind::end_sub) {
            scope = 0;
            mark.scope = 0;
            open_loops.clear();
        }
        index.marks.push_back(std::move(mark));
    }
    return index;
}

} // namespace gcode
