#include "app/setup/ini_file.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "app/setup/search_path.h"
#include "app/setup/text_lines.h"

namespace app {
namespace {

std::string trimmed(const std::string& text) {
    const size_t first = text.find_first_not_of(" \t");
    if (first == std::string::npos) return {};
    return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// As LinuxCNC takes LINEAR_UNITS: by name, or as units in a millimetre.
std::optional<gcode::LengthUnit> unit_named(const std::string& name) {
    const auto per_mm = number_in(name);
    const auto is_near = [&](double wanted) {
        return per_mm && std::abs(*per_mm - wanted) < 1e-4 * wanted;
    };
    if (name == "mm" || name == "metric" || is_near(1.0)) return gcode::LengthUnit::mm;
    if (name == "inch" || name == "in" || name == "imperial" || is_near(1.0 / 25.4))
        return gcode::LengthUnit::inch;
    return std::nullopt;
}

/// The file line by line.
struct IniReader {
    std::filesystem::path folder;
    IniFile file{};
    std::string section{};

    std::string resolved(const std::string& name) const { return (folder / name).string(); }

    /// Programs see numbers whose section and name have no small letters.
    void note_number(const std::string& key, const std::string& value);

    /// Why a value cannot be taken; empty when it was, or says nothing about programs.
    std::string take(const std::string& key, const std::string& value);
};

void IniReader::note_number(const std::string& key, const std::string& value) {
    std::string name = "_ini[" + section + "]" + key;
    const auto is_small = [](unsigned char letter) { return std::islower(letter) != 0; };
    if (std::any_of(name.begin() + 5, name.end(), is_small)) return;
    const auto number = number_in(value);
    if (!number) return;
    for (char& letter : name)
        letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    file.values.insert_or_assign(name, *number);
}

std::string IniReader::take(const std::string& key, const std::string& value) {
    const std::string name = section + " " + key;
    if (value.empty()) return {};
    note_number(key, value);
    if (name == "TRAJ LINEAR_UNITS") {
        file.machine_unit = unit_named(value);
        if (!file.machine_unit) return "LINEAR_UNITS must be mm or inch";
    } else if (name == "RS274NGC PARAMETER_FILE") {
        file.parameters = resolved(value);
    } else if (name == "EMCIO TOOL_TABLE") {
        file.tool_table = resolved(value);
    } else if (name == "DISPLAY PROGRAM_PREFIX") {
        file.search_path.insert(file.search_path.begin(), resolved(value));
    } else if (name == "RS274NGC SUBROUTINE_PATH") {
        for (const std::string& each : split_search_path(value))
            file.search_path.push_back(resolved(each));
    } else if (name == "RS274NGC RS274NGC_STARTUP_CODE") {
        file.startup_code = value;
    } else if (key == "WRAPPED_ROTARY" && value != "0" && section.starts_with("AXIS_")) {
        file.wrapped_axes += section.substr(5);
    }
    return {};
}

} // namespace

core::Result<IniFile> read_ini(const std::string& path) {
    FEELER_TRY(const std::vector<std::string> lines, lines_of_file(path));
    IniReader reader{std::filesystem::path(path).parent_path()};
    for (size_t line = 1; line <= lines.size(); ++line) {
        const std::string text = trimmed(lines[line - 1]);
        if (text.starts_with("#INCLUDE"))
            return tl::unexpected(core::Error{core::ErrorCode::unsupported,
                                              {.line = static_cast<uint32_t>(line)},
                                              "#INCLUDE is not followed; give the file with the "
                                              "sections RS274NGC, EMCIO and TRAJ in it",
                                              path});
        if (text.empty() || text[0] == '#' || text[0] == ';') continue;
        if (text[0] == '[') {
            reader.section = trimmed(text.substr(1, text.find(']') - 1));
            continue;
        }
        const size_t equals = text.find('=');
        if (equals == std::string::npos) continue; // LinuxCNC passes over it as well
        const std::string wrong =
            reader.take(trimmed(text.substr(0, equals)), trimmed(text.substr(equals + 1)));
        if (!wrong.empty()) return tl::unexpected(line_error(path, line, wrong));
    }
    return std::move(reader.file);
}

} // namespace app
