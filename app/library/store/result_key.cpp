#include "app/library/store/result_key.h"

#include <algorithm>
#include <random>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/base/sha256.h"
#include "app/base/text.h"
#include "app/base/version.h"
#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/setup/program_settings.h"
#include "core/base/platform.h"
#include "core/cad/cad_file.h"

namespace app {
namespace {

using KeyJson = nlohmann::ordered_json;

template <typename T>
KeyJson optional_json(const std::optional<T>& value) {
    return value ? KeyJson(*value) : KeyJson(nullptr);
}

template <typename T>
KeyJson enum_json(const std::optional<T>& value) {
    return value ? KeyJson(static_cast<int>(*value)) : KeyJson(nullptr);
}

/// A path byte by byte if necessary: JSON allows only UTF-8, but file names can be any bytes.
KeyJson path_json(const std::string& path) {
    if (utf8_text(path) == path) return path;
    KeyJson bytes = KeyJson::array();
    for (const char byte : path) bytes.push_back(static_cast<unsigned char>(byte));
    return bytes;
}

KeyJson settings_json(const ProgramSettings& settings) {
    // This does not compile after a member was added: add it to the key below.
    const auto& [dialect, block_delete, start, machine_unit, units_at_start, max_blocks,
                 counts_smallest_steps, ini, parameters, tool_table, ignores_tables, search_path,
                 machine_codes, tool_at_start, spindle_at_start, values, named_values,
                 measured_offsets_are_stated, speed_by_hand] = settings;
    KeyJson variables = KeyJson::array();
    for (const auto& [number, value] : values) variables.push_back({number, value});
    for (const auto& [name, value] : named_values)
        variables.push_back({name, optional_json(value)});
    KeyJson positions = KeyJson::array(), folders = KeyJson::array();
    for (const auto& position : start) positions.push_back(optional_json(position));
    for (const std::string& folder : search_path) folders.push_back(path_json(folder));
    return {{"dialect", enum_json(dialect)},
            {"block_delete", optional_json(block_delete)},
            {"start", positions},
            {"machine_unit", enum_json(machine_unit)},
            {"units_at_start", enum_json(units_at_start)},
            {"max_blocks", optional_json(max_blocks)},
            {"counts_smallest_steps", optional_json(counts_smallest_steps)},
            {"ini", path_json(ini)},
            {"parameters", path_json(parameters)},
            {"tool_table", path_json(tool_table)},
            {"ignores_tables", ignores_tables},
            {"search_path", folders},
            {"machine_codes", machine_codes},
            {"tool_at_start", enum_json(tool_at_start)},
            {"spindle_at_start", enum_json(spindle_at_start)},
            {"values", variables},
            {"measured_offsets_are_stated", optional_json(measured_offsets_are_stated)},
            {"speed_by_hand", optional_json(speed_by_hand)}};
}

} // namespace

std::optional<std::string> options_text(const CheckJob& job) {
    // memory_limit is left out: it only decides whether there is a result. So are the threads.
    const auto& [program, setup, allowance, mesh_size, memory_limit, detail, needs_surface,
                 before_model, after_block, is_stopped, start_line, settings, engine, threads,
                 setup_text, rules, setup_was_found] = job;
    if (setup_text) return std::nullopt;
    KeyJson severities = KeyJson::object();
    for (const auto& [rule, severity] : rules) severities[rule] = core::name_of(severity);
    const KeyJson json = {{"rules", severities},
                          {"setup_was_found", setup_was_found},
                          {"allowance", optional_json(allowance)},
                          {"mesh_size", optional_json(mesh_size)},
                          {"detail", static_cast<int>(detail)},
                          {"needs_surface", needs_surface},
                          {"start_line", path_json(start_line)},
                          {"engine", name_of(engine)},
                          {"settings", settings_json(settings)}};
    return json.dump();
}

std::string result_key(const std::string& build, const CheckJob& job, const std::string& sha256,
                       const std::string& options) {
    const KeyJson parts =
        KeyJson::array({build, path_json(job.program), sha256, path_json(job.setup), options});
    return sha256_of(parts.dump());
}

namespace {

std::string build_name() {
    std::string id = core::platform::build_id();
    if (id.empty()) id = sha256_of_file(core::platform::program_path().generic_string());
    // A program with an unknown build must not use the results of other builds.
    return id.empty() ? fmt::format("unknown {:x}", std::random_device()()) : id;
}

} // namespace

const std::string& build_version() {
    static const std::string known =
        fmt::format("{} {} {}", version, build_name(), core::cad_library());
    return known;
}

} // namespace app
