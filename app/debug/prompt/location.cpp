#include "app/debug/prompt/location.h"

#include <charconv>
#include <filesystem>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/check/check_run.h"
#include "core/base/text.h"
#include "gcode/exec/restart.h"
#include "gcode/language/environment.h"
#include "gcode/text/source.h"

namespace app {
namespace {

using core::ErrorCode;

bool are_digits(std::string_view text) {
    return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

/// The path of a subprogram file by its name, with or without folders; empty: main program. The
/// subprogram must have run, or be in the folder of the main program.
core::Result<std::string> file_named(PromptState& state, const std::string& name) {
    const auto of_main = std::filesystem::path(state.session.record().program_file).filename();
    if (name == of_main.generic_string() || name == state.session.record().program_file)
        return std::string();
    std::set<std::string> files;
    for (const CheckedBlock& block : state.session.record().blocks)
        if (!block.file.empty()) files.insert(block.file);
    std::vector<std::string> names{of_main.generic_string()};
    for (const std::string& file : files) {
        const std::string last = std::filesystem::path(file).filename().generic_string();
        if (file == name || last == name) return file;
        names.push_back(last);
    }
    // A subprogram that was not called so far is searched for next to the main program.
    const auto sibling =
        std::filesystem::path(state.session.record().program_file).parent_path() / name;
    std::error_code failure;
    if (std::filesystem::is_regular_file(sibling, failure)) return sibling.generic_string();
    return core::fail(ErrorCode::invalid_value,
                      fmt::format("there is no file {}; the nearest name is {}", name,
                                  core::nearest_name(name, names)));
}

} // namespace

core::Result<size_t> number_in(const std::string& text) {
    size_t number = 0;
    const char* end = text.data() + text.size();
    const auto read = std::from_chars(text.data(), end, number);
    if (text.empty() || read.ec != std::errc() || read.ptr != end)
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("'{}' is not a whole number", text));
    return number;
}

bool is_location(const std::string& text) {
    if (text.find_first_of(" \t\"") != std::string::npos) return false;
    const size_t colon = text.rfind(':');
    if (colon != std::string::npos) return are_digits(std::string_view(text).substr(colon + 1));
    const bool numbered = text.size() > 1 && (text[0] == 'N' || text[0] == 'n');
    return are_digits(std::string_view(text).substr(numbered ? 1 : 0));
}

core::Result<Location> location_in(PromptState& state, const std::string& text) {
    const size_t colon = text.rfind(':');
    if (colon != std::string::npos) {
        FEELER_TRY(const size_t line, number_in(text.substr(colon + 1)));
        FEELER_TRY(std::string file, file_named(state, text.substr(0, colon)));
        FEELER_TRY(const gcode::Program* program, program_of(state, file));
        const auto has = program->has_line(line);
        if (!has || !*has || line == 0)
            return core::fail(ErrorCode::invalid_value,
                              fmt::format("{} has no line {}", text.substr(0, colon), line));
        return Location{static_cast<uint32_t>(line), std::move(file)};
    }
    const gcode::DialectId dialect = state.session.environment().dialect;
    const auto line = gcode::line_meant(state.session.program(), dialect, text);
    if (!line)
        return core::fail(ErrorCode::invalid_value,
                          are_digits(text)
                              ? fmt::format("the program has no line {}; its last line is {}", text,
                                            state.session.program().line_count())
                              : fmt::format("the program has no block {}", text));
    return Location{*line, {}};
}

core::Result<size_t> position_of(PromptState& state, const Location& location) {
    DebugSession& session = state.session;
    const auto is_there = [&](size_t block) {
        const CheckedBlock at = session.record().blocks[block];
        return at.line == location.line && at.file == location.file;
    };
    for (size_t block = session.at();; ++block) {
        FEELER_TRY(const bool is_run, session.reaches(block));
        if (!is_run) break;
        if (is_there(block)) return block;
    }
    for (size_t block = 0; block < session.at(); ++block)
        if (is_there(block)) return block;
    return core::fail(ErrorCode::invalid_value,
                      fmt::format("line {} is never executed", location.line));
}

core::Result<const gcode::Program*> program_of(PromptState& state, const std::string& file) {
    if (file.empty()) return &state.session.program();
    auto& known = state.files[file];
    if (!known) {
        auto read = gcode::read_program(file);
        if (!read) {
            state.files.erase(file);
            return tl::unexpected(read.error());
        }
        known = std::make_shared<const gcode::Program>(*std::move(read));
    }
    return known.get();
}

} // namespace app
