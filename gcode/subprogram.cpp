#include "gcode/subprogram.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "gcode/codes.h"

namespace gcode {
namespace {

constexpr std::array<std::string_view, 11> endings = {
    "", ".nc", ".NC", ".ngc", ".tap", ".TAP", ".txt", ".TXT", ".cnc", ".CNC", ".gcode"};

/// O1234.nc, O1234, 1234.nc ..., also with zeros before the number.
std::vector<std::string> file_names(int number) {
    std::vector<std::string> digits;
    for (const int width : {1, 4, 5, 8}) {
        std::string written = fmt::format("{:0{}}", number, width);
        if (std::find(digits.begin(), digits.end(), written) == digits.end())
            digits.push_back(std::move(written));
    }
    std::vector<std::string> names;
    for (const std::string& some : digits)
        for (const std::string_view prefix : {"O", "o", ""})
            for (const std::string_view ending : endings)
                names.push_back(fmt::format("{}{}{}", prefix, some, ending));
    return names;
}

/// The first line behind a tape mark and a program number.
uint32_t first_line(const Program& program, const FlowIndex& index) {
    uint32_t line = 1;
    for (; line <= program.line_count(); ++line) {
        const std::string_view text = program.line(line);
        const size_t first = text.find_first_not_of(" \t");
        if (first != std::string_view::npos && text[first] != '%') break;
    }
    const FlowMark* mark = index.at(line);
    return mark && mark->kind == FlowKind::program_number ? line + 1 : line;
}

std::optional<Place> place_in(ProgramLibrary& library, uint32_t source, int number) {
    const FlowMark* mark = library.index(source).first(FlowKind::program_number, label_of(number));
    if (!mark) return std::nullopt;
    return Place{source, mark->line + 1};
}

std::optional<Place> place_in_programs(ProgramLibrary& library, uint32_t source, int number) {
    if (const auto own = place_in(library, source, number)) return own;
    return source == 0 ? std::nullopt : place_in(library, 0, number);
}

/// A file that is named for the program may leave its number out, where O words do not need it.
core::Result<std::optional<Place>> place_in_files(ProgramLibrary& library, int number) {
    FEELER_TRY(const std::optional<uint32_t> source, library.find(file_names(number)));
    if (!source) return std::nullopt;
    if (const auto numbered = place_in(library, *source, number)) return numbered;
    if (library.dialect().has_o_words) return std::nullopt;
    return Place{*source, first_line(library.program(*source), library.index(*source))};
}

} // namespace

core::Result<std::optional<Place>> find_program(ProgramLibrary& library, uint32_t source,
                                                int number, bool files_first) {
    if (!files_first)
        if (const auto place = place_in_programs(library, source, number)) return place;
    FEELER_TRY(const std::optional<Place> place, place_in_files(library, number));
    if (place || !files_first) return place;
    return place_in_programs(library, source, number);
}

std::string missing_program(ProgramLibrary& library, uint32_t source, int number) {
    constexpr size_t most_named = 8;
    const FlowIndex& index = library.index(source);
    std::vector<std::string> others;
    for (const FlowMark& mark : index.marks)
        if (mark.kind == FlowKind::program_number && others.size() < most_named)
            others.push_back("O" + mark.name);
    std::string message = fmt::format(
        "there is no program O{} in this file, and no file such as O{}.nc in ", number, number);
    if (library.search_path().empty())
        message += "a search path, for there is none";
    else
        message += fmt::format("{}", fmt::join(library.search_path(), ", "));
    if (!others.empty()) message += fmt::format("; this file has {}", fmt::join(others, ", "));
    if (index.line_of_number(number, 1, UINT32_MAX))
        message += fmt::format("; N{} is a block of it, which {} calls", number,
                               find_code('M', 97.0, library.dialect().id)
                                   ? fmt::format("M97 P{}", number)
                                   : fmt::format("M98 Q{}", number));
    return message;
}

} // namespace gcode
