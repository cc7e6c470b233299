#include "gcode/language/flow_index.h"

#include <algorithm>

#include <fmt/format.h>

#include "gcode/language/lexer.h"

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

} // namespace gcode
