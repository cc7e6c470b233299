#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/ids.h"
#include "core/base/result.h"
#include "gcode/canonical.h"

namespace gcode {

enum class Severity : uint8_t { note, warning };

/// Something a person should know about a block that does not stop the program.
struct Warning {
    Severity severity;
    core::SourceSpan where;
    std::string message;
    std::string_view rule = "program"; // the stable name of what it is about
    std::string cure{};                // what would make it go away; may be empty
};

/// One block as executed.
struct BlockResult {
    core::BlockIndex block{};
    uint32_t line = 0;
    std::string_view text{};       // the line, as long as the library stays where it is; of a
                                   // program that is read in windows, until the next block
    std::string_view file{};       // of a subprogram's file; empty for the main program
    std::vector<uint32_t> calls{}; // lines that called it, the outermost first
    bool is_cycle = false;         // a canned cycle, G28 or G30: one block, several motions
    bool goes_home = false;        // G28 or G30
    std::vector<CanonicalCommand> commands{};
    std::vector<uint32_t> columns{}; // of the words that the commands come from
    std::vector<Warning> warnings{};
    std::shared_ptr<const std::string> own_text{}; // what `text` refers to where windows moved on
};

} // namespace gcode
