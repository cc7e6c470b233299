#include <algorithm>

#include "gcode/language/lexer.h"
#include "gcode/siemens/siemens_parser.h"
#include "gcode/siemens/siemens_reader.h"
#include "gcode/text/source.h"

namespace gcode {
namespace {

using enum FlowKind;

/// Whether a line may hold a label or a statement, that is, a name after its number.
bool may_hold_mark(std::string_view rest) {
    if (rest.size() < 2) return false;
    const auto names = [](char c) { return is_letter(c) || c == '_'; };
    return names(rest[0]) && names(rest[1]);
}

/// Matches the starts and ends of statements line by line.
class Matching {
public:
    explicit Matching(FlowIndex& index) : index_(index) {}

    void add(FlowKind kind, uint32_t line) {
        index_.marks.push_back({.kind = kind, .line = line});
        const size_t self = index_.marks.size() - 1;
        switch (kind) {
        case if_branch:
        case while_loop:
        case for_loop:
        case endless_loop:
        case repeat:
            open_.push_back(self);
            return;
        case otherwise:
            if (!close(self, {if_branch})) return;
            index_.marks[self].partner = 0; // until its ENDIF is found
            open_.push_back(self);
            return;
        case end_if:
            close(self, {if_branch, otherwise});
            return;
        case end_while:
            close(self, {while_loop});
            return;
        case end_for:
            close(self, {for_loop});
            return;
        case end_endless:
            close(self, {endless_loop});
            return;
        default: // until
            close(self, {repeat});
            return;
        }
    }
    void forget_open() { open_.clear(); }

private:
    bool close(size_t self, std::initializer_list<FlowKind> kinds) {
        if (open_.empty()) return false;
        FlowMark& head = index_.marks[open_.back()];
        if (std::find(kinds.begin(), kinds.end(), head.kind) == kinds.end()) return false;
        head.partner = index_.marks[self].line;
        index_.marks[self].partner = head.line;
        open_.pop_back();
        return true;
    }

    FlowIndex& index_;
    std::vector<size_t> open_;
};

bool is_structure(FlowKind kind) {
    for (const FlowKind some : {if_branch, otherwise, end_if, while_loop, end_while, for_loop,
                                end_for, endless_loop, end_endless, repeat, until})
        if (kind == some) return true;
    return false;
}

/// NAME of `%_N_NAME_MPF`.
std::string program_name(std::string_view header) {
    std::string name;
    for (const char c : header.substr(header.find('%') + 1))
        if (is_name_part(c))
            name.push_back(upper(c));
        else
            break;
    if (name.starts_with("_N_")) name.erase(0, 3);
    if (name.ends_with("_MPF") || name.ends_with("_SPF")) name.resize(name.size() - 4);
    return name;
}

} // namespace

FlowIndex siemens_index(const Program& program, const Dialect& dialect) {
    FlowIndex index;
    Matching matching(index);
    Block block;
    for (size_t number = 1; program.has_line(number).value_or(false); ++number) {
        const auto line = static_cast<uint32_t>(number);
        Lexer lexer{.line = program.line(number), .line_number = line, .blanks_end_numbers = true};
        if (lexer.peek() == '%') {
            index.marks.push_back(
                {.kind = program_number, .name = program_name(lexer.line), .line = line});
            matching.forget_open();
            continue;
        }
        if (lexer.peek() == ':') {
            ++lexer.at;
            if (const auto main_block = lexer.number())
                index.numbers.push_back({main_block->value, line});
        } else if (const auto block_number = take_block_number(lexer)) {
            index.numbers.push_back({*block_number, line});
        }
        lexer.peek();
        if (!may_hold_mark(lexer.line.substr(lexer.at))) continue;
        block.clear();
        const auto parsed = parse_siemens(lexer.line, line, dialect, block);
        if (!siemens_of(block).label.empty())
            index.marks.push_back({.kind = label, .name = siemens_of(block).label, .line = line});
        if (parsed && is_structure(block.flow.kind)) matching.add(block.flow.kind, line);
    }
    return index;
}

} // namespace gcode
