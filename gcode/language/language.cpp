#include "gcode/language/language.h"

#include "gcode/language/block.h"
#include "gcode/language/dialect.h"
#include "gcode/language/flow_index.h"

namespace gcode {

void Block::clear() {
    words.clear();
    comments.clear();
    assignments.clear();
    pool.clear();
    flow.arguments.clear();
    flow = Flow{.arguments = std::move(flow.arguments)};
    block_delete.reset();
    tape_mark = false;
    is_program_name = prints = false;
    words_before_slash.reset();
    has_message = has_command = false;
}

core::Result<void> parse_line(std::string_view text, uint32_t line, const Dialect& dialect,
                              Block& block) {
    block.clear();
    block.line = line;
    block.text = text;
    return functions_of(dialect.language).parse(text, line, dialect, block);
}

FlowIndex index_of(const Program& program, const Dialect& dialect) {
    return functions_of(dialect.language).index(program, dialect);
}

} // namespace gcode
