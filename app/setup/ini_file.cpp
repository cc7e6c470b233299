#include "app/setup/ini_file.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <set>
#include <sstream>

#include <fmt/format.h>

#include "app/base/text.h"
#include "app/setup/linuxcnc_kinematics.h"
#include "core/base/platform.h"
#include "core/base/text.h"
#include "core/base/units.h"
#include "core/motion/kinematics.h"
#include "core/motion/machine.h"
#include "gcode/language/environment.h"

namespace app {
namespace {

/// Splits a list of folders. On Windows, the ':' of a drive separates nothing.
std::vector<std::string> split_folders(const std::string& text, char separator) {
    const bool has_drives = separator == ':' && core::platform::list_separator() != ':';
    std::istringstream stream(text);
    std::vector<std::string> folders;
    bool after_drive = false;
    for (std::string folder; std::getline(stream, folder, separator);) {
        if (after_drive && (folder.starts_with('/') || folder.starts_with('\\')))
            folders.back() += ":" + folder;
        else if (!folder.empty())
            folders.push_back(folder);
        after_drive = has_drives && folder.size() == 1;
    }
    return folders;
}

/// A value of LINEAR_UNITS as LinuxCNC interprets it: a name, or units per millimetre.
std::optional<gcode::LengthUnit> unit_named(const std::string& name) {
    const auto per_mm = number_in(name);
    const auto is_near = [&](double wanted) {
        return per_mm && std::abs(*per_mm - wanted) < 1e-4 * wanted;
    };
    if (name == "mm" || name == "metric" || is_near(1.0)) return gcode::LengthUnit::mm;
    if (name == "inch" || name == "in" || name == "imperial" || is_near(1.0 / core::mm_per_inch))
        return gcode::LengthUnit::inch;
    return std::nullopt;
}

/// Reads the file line by line.
struct IniReader {
    std::filesystem::path folder;
    IniFile file{};
    std::string section{};
    std::set<std::string> read{}; // keys with their sections; LinuxCNC takes the first of several

    std::string resolved(const std::string& name) const { return (folder / name).generic_string(); }

    /// Stores a number. Programs can read only numbers whose section and key have no lower-case
    /// letters.
    void note_number(const std::string& key, const std::string& value);

    /// Stores TOOL_CHANGE_POSITION, of which LinuxCNC reads the first 9, 6 or 3 numbers.
    std::string take_change_position(const std::string& value);

    /// Stores REMAP = M428 modalgroup=10 ngc=428remap.
    void take_remap(const std::string& value);

    /// Stores a setting of which there may be several; whether it is one.
    bool take_repeated(const std::string& name, const std::string& value);

    /// Reads the files with HAL commands, in the order in which LinuxCNC does.
    void read_hal();

    std::vector<std::string> hal_files{}, hal_commands{}, late_hal_files{}, panels{};
    std::map<std::string, double> numbers{}; // for HAL commands: those with small letters, too

    /// Stores a setting. Returns why its value is invalid; empty if it is valid or irrelevant.
    std::string take(const std::string& key, const std::string& value);
};

void IniReader::note_number(const std::string& key, const std::string& value) {
    const std::string name = "_ini[" + section + "]" + key;
    if (const auto any = number_in(value)) numbers.insert_or_assign(core::lower_case(name), *any);
    const auto is_small = [](unsigned char letter) { return std::islower(letter) != 0; };
    if (std::any_of(name.begin() + 5, name.end(), is_small)) return;
    const auto number = number_in(value);
    if (!number) return;
    file.values.insert_or_assign(core::lower_case(name), *number);
}

std::string IniReader::take_change_position(const std::string& value) {
    std::istringstream stream(value);
    std::vector<double> numbers;
    for (double number = 0.0; numbers.size() < core::axis_count && stream >> number;)
        numbers.push_back(number);
    numbers.resize(numbers.size() / 3 * 3);
    if (numbers.empty()) return "TOOL_CHANGE_POSITION must have 3, 6 or 9 numbers";
    file.tool_change_position = std::move(numbers);
    return {};
}

/// The first word of a value; some values end with a comment.
std::string first_word(const std::string& value) {
    return value.substr(0, value.find_first_of(" \t#;"));
}

bool is_on(const std::string& value) {
    const std::string word = core::lower_case(first_word(value));
    return word == "yes" || word == "true" || word == "on" || number_in(word).value_or(0.0) != 0.0;
}

/// Kinematics under which straight moves of the program are straight moves of X, Y and Z.
bool keeps_linear_axes(const std::string& module) {
    for (const char* one : {"trivkins", "gantrykins", "corexykins", "lineardeltakins", "rotatekins",
                            "rotarydeltakins", "scarakins", "tripodkins"})
        if (module == one) return true;
    return false;
}

/// The letter of [AXIS_A], or of [AXIS_3] in older files.
std::string axis_of_section(const std::string& section) {
    const std::string axis = section.substr(5);
    if (axis.size() != 1 || axis[0] < '0' || axis[0] > '8') return axis;
    return std::string(1, core::axis_letters[static_cast<size_t>(axis[0] - '0')]);
}

void IniReader::take_remap(const std::string& value) {
    std::istringstream stream(value);
    std::string code, subprogram;
    bool is_plain = true;
    stream >> code;
    for (std::string word; stream >> word;) {
        const size_t equals = std::min(word.find('='), word.size());
        const std::string key = core::lower_case(word.substr(0, equals));
        if (key == "ngc" && equals < word.size())
            subprogram = word.substr(equals + 1);
        else if (key != "modalgroup")
            is_plain = false; // argspec, prolog, epilog, python
    }
    code = core::upper_case(code);
    if (is_plain && !subprogram.empty())
        file.remaps.emplace(code, subprogram);
    else
        file.other_remaps.push_back(code);
}

bool IniReader::take_repeated(const std::string& name, const std::string& value) {
    if (name == "RS274NGC REMAP")
        take_remap(value);
    else if (name == "HAL HALCMD")
        hal_commands.push_back(value);
    else if (name == "HAL HALFILE")
        hal_files.push_back(value);
    else if (name == "HAL POSTGUI_HALFILE")
        late_hal_files.push_back(value);
    else if (name == "DISPLAY PYVCP")
        panels.push_back(value);
    else
        return false;
    return true;
}

void IniReader::read_hal() {
    const auto add = [&](const std::vector<std::string>& names) {
        for (const std::string& name : names) {
            const std::string word = first_word(name);
            if (word.starts_with("LIB:")) continue; // of LinuxCNC itself: joints and motors
            if (word.ends_with(".tcl")) file.hal.note_more_commands();
            if (word.ends_with(".tcl") || !file.hal.add_file(resolved(word), numbers))
                file.unread_files.push_back(resolved(word));
        }
    };
    add(hal_files);
    for (const std::string& command : hal_commands) file.hal.add(command, numbers);
    for (const std::string& panel : panels)
        if (!file.hal.add_panel(resolved(first_word(panel))))
            file.unread_files.push_back(resolved(first_word(panel)));
    add(late_hal_files);
}

std::string IniReader::take(const std::string& key, const std::string& value) {
    const std::string name = section + " " + key;
    if (value.empty()) return {};
    if (take_repeated(name, value) || !read.insert(name).second) return {};
    note_number(key, value);
    if (name == "TRAJ LINEAR_UNITS") {
        file.machine_unit = unit_named(value);
        if (!file.machine_unit) return "LINEAR_UNITS must be mm or inch";
    } else if (name == "TRAJ ANGULAR_UNITS") {
        const std::string unit = core::lower_case(value);
        if (unit != "deg" && unit != "degree" && number_in(value) != 1.0)
            return "ANGULAR_UNITS must be degree: Feeler takes the angles of the machine as "
                   "degrees";
    } else if (name == "RS274NGC PARAMETER_FILE") {
        file.parameters = resolved(value);
    } else if (name == "EMCIO TOOL_TABLE") {
        file.tool_table = resolved(value);
    } else if (name == "EMCIO TOOL_CHANGE_POSITION") {
        return take_change_position(value);
    } else if (name == "EMCIO TOOL_CHANGE_QUILL_UP") {
        file.quill_up = is_on(value);
    } else if (name == "EMCIO TOOL_CHANGE_AT_G30") {
        file.tool_change_at_g30 = is_on(value);
    } else if (name == "EMCIO TOOL_CHANGE_WITH_SPINDLE_ON") {
        file.tool_change_with_spindle_on = is_on(value);
    } else if (name == "KINS KINEMATICS") {
        file.kinematics = first_word(value);
        file.kinematics_settings = core::stripped(value.substr(file.kinematics.size()));
    } else if (name == "TRAJ COORDINATES") {
        for (const char letter : core::upper_case(value))
            if (core::axis_letters.find(letter) != std::string_view::npos)
                file.coordinates.push_back(letter);
    } else if (name == "DISPLAY PROGRAM_PREFIX") {
        file.search_path.insert(file.search_path.begin(), resolved(value));
    } else if (name == "RS274NGC SUBROUTINE_PATH") {
        // The file belongs to the machine, so this is the separator of LinuxCNC on every system.
        for (const std::string& each : split_folders(value, ':'))
            file.search_path.push_back(resolved(each));
    } else if (name == "RS274NGC RS274NGC_STARTUP_CODE") {
        file.startup_code = value;
    } else if (key == "WRAPPED_ROTARY" && is_on(value) && section.starts_with("AXIS_")) {
        file.wrapped_axes += axis_of_section(section);
    } else if (key == "LOCKING_INDEXER_JOINT" && section.starts_with("AXIS_")) {
        file.locking_indexers += axis_of_section(section);
    } else if (key == "LOCKING_INDEXER" && is_on(value)) {
        file.locking_indexers += file.locking_indexers.empty() ? section : " " + section;
    }
    return {};
}

} // namespace

core::Result<IniFile> read_ini(const std::string& path) {
    FEELER_TRY(const std::vector<std::string> lines, lines_of_file(path));
    IniReader reader{std::filesystem::path(path).parent_path()};
    for (size_t line = 1; line <= lines.size(); ++line) {
        const std::string_view text = core::stripped(lines[line - 1]);
        if (text.starts_with("#INCLUDE"))
            return tl::unexpected(core::Error{core::ErrorCode::unsupported,
                                              {.line = static_cast<uint32_t>(line)},
                                              "#INCLUDE is not supported; give the file that "
                                              "LinuxCNC writes when it starts, with the included "
                                              "ones in it: "
                                                  + path + ".expanded",
                                              path});
        if (text.empty() || text[0] == '#' || text[0] == ';') continue;
        if (text[0] == '[') {
            reader.section = core::stripped(text.substr(1, text.find(']') - 1));
            continue;
        }
        const size_t equals = text.find('=');
        if (equals == std::string::npos) continue; // LinuxCNC ignores such lines, too
        const std::string wrong = reader.take(std::string(core::stripped(text.substr(0, equals))),
                                              std::string(core::stripped(text.substr(equals + 1))));
        if (!wrong.empty()) return tl::unexpected(line_error(path, line, wrong));
    }
    const std::string& module = reader.file.kinematics;
    reader.read_hal();
    if (!module.empty() && !keeps_linear_axes(module) && !is_known_kinematics(module))
        return tl::unexpected(core::Error{
            core::ErrorCode::unsupported,
            {},
            fmt::format(
                "KINEMATICS = {} is not supported: it can move the linear axes while rotary "
                "axes turn. If the program moves no rotary axis, state in the set-up what "
                "it needs of this file instead",
                module),
            path});
    return std::move(reader.file);
}

gcode::ToolChangeMotion tool_change_motion(const IniFile& ini, gcode::LengthUnit machine_unit) {
    gcode::ToolChangeMotion motion{.quill_up = ini.quill_up,
                                   .goes_to_second_home = ini.tool_change_at_g30,
                                   .keeps_spindle_running = ini.tool_change_with_spindle_on,
                                   .is_stated = true};
    for (size_t i = 0; i < ini.tool_change_position.size(); ++i) {
        const double value = ini.tool_change_position[i];
        motion.position[i] = core::is_rotary(i) ? value : gcode::to_mm(value, machine_unit);
    }
    return motion;
}

namespace {

/// The numbers of an ini file for one axis, in mm or degrees.
///
/// `joint_first`: limits of joints count more than those of axes, which are then positions of the
/// tip.
class AxisNumbers {
public:
    AxisNumbers(const gcode::Environment& environment, size_t axis, size_t joint,
                bool joint_first = false)
        : values_(environment.ini_values) {
        const bool inch = environment.machine_unit == gcode::LengthUnit::inch;
        unit_ = inch && !core::is_rotary(axis) ? core::mm_per_inch : 1.0;
        sections_ = {fmt::format("axis_{}", core::lower(core::axis_letters[axis])),
                     fmt::format("axis_{}", axis), fmt::format("joint_{}", joint)};
        if (joint_first) std::swap(sections_[0], sections_[2]);
    }

    /// The number in the first section that has the key.
    std::optional<double> number(const std::string& key) const {
        for (const std::string& section : sections_)
            if (const auto found = values_.find("_ini[" + section + "]" + key);
                found != values_.end())
                return found->second * unit_;
        return std::nullopt;
    }

    bool is_there() const {
        for (const char* key : {"min_limit", "max_limit", "max_velocity"})
            if (number(key)) return true;
        return false;
    }

private:
    const std::map<std::string, double>& values_;
    double unit_ = 1.0;
    std::array<std::string, 3> sections_;
};

/// Sets a value that the axis lacks. Whether it was set.
bool take(std::optional<double>& value, std::optional<double> stated) {
    if (value || !stated) return false;
    value = stated;
    return true;
}

bool take_above_zero(std::optional<double>& value, std::optional<double> stated, double times) {
    if (!stated || !(*stated > 0.0)) return false;
    return take(value, *stated * times);
}

} // namespace

namespace {

/// Forgets W of the set-up if it does not move the tip along the tool as 5axiskins has it. Returns
/// what to report.
std::string check_quill(core::Machine& machine, const core::Machine& known,
                        const gcode::Environment& environment) {
    if (!known.length_axis) return {};
    const size_t w = *known.length_axis;
    core::MachineAxis& own = machine.axes[w];
    if (!own.present) return {};
    // A quill: the tip is farther from the pivot by W.
    const bool is_quill = own.side == core::Side::tool && machine.spindle == core::link_of(w)
                          && own.carrier == core::link_of(core::axis_letters.find('B'))
                          && glm::distance(own.direction, core::Vec3(0.0, 0.0, -1.0)) < 1e-9;
    if (is_quill) return {};
    own.present = false;
    return fmt::format(
        "W of the set-up does not move the tool as {} has it, so blocks that move it "
        "are refused: a quill has direction [0, 0, -1] and parent B",
        environment.kinematics->module);
}

/// Whether two machines put the tool and the work the same way.
bool are_same(const core::Machine& a, const core::Machine& b) {
    constexpr double slack = 1e-6; // mm
    for (int sample = 0; sample < 4; ++sample) {
        core::AxisValues values{};
        for (size_t axis = 3; axis < 6; ++axis)
            values[axis] = sample == 0 ? 0.0 : 17.0 * sample * static_cast<double>(axis) - 70.0;
        const core::Mount no_body_a{a.table, {}}, tool_a{a.spindle, {}};
        const core::Mount no_body_b{b.table, {}}, tool_b{b.spindle, {}};
        const core::Transform in_a = core::target_from_mover(a, no_body_a, tool_a, values);
        const core::Transform in_b = core::target_from_mover(b, no_body_b, tool_b, values);
        for (const core::Vec3& point : {core::Vec3(0.0), core::Vec3(0.0, 0.0, -100.0)})
            if (glm::length(in_a * point - in_b * point) > slack) return false;
    }
    return true;
}

} // namespace

bool has_axes_of_kinematics(const core::Machine& machine, const gcode::Environment& environment) {
    return are_same(machine, *environment.kinematics->machine);
}

std::string take_rotary_axes(core::Machine& machine, const gcode::Environment& environment) {
    if (!environment.kinematics || !environment.kinematics->machine) return {};
    const core::Machine& known = *environment.kinematics->machine;
    const std::string& module = environment.kinematics->module;
    const std::string about_w = check_quill(machine, known, environment);
    if (machine.has_rotary()) {
        if (has_axes_of_kinematics(machine, environment)) return about_w;
        return fmt::format("the rotary axes of the set-up are not where {} of the ini file has "
                           "them: the control is assumed to know those of the set-up",
                           module);
    }
    const auto is_turned = [](core::LinkId link) {
        return core::is_rotary(static_cast<size_t>(link));
    };
    for (size_t axis = 3; axis < 6; ++axis) {
        if (!known.axes[axis].present) continue;
        core::MachineAxis& own = machine.axes[axis] = known.axes[axis];
        // The first of each side is carried by what was the last link of that side.
        if (!is_turned(own.carrier))
            own.carrier = own.side == core::Side::table ? machine.table : machine.spindle;
    }
    if (is_turned(known.table)) machine.table = known.table;
    if (is_turned(known.spindle)) machine.spindle = known.spindle;
    return about_w;
}

std::string complete_machine(core::Machine& machine, const gcode::Environment& environment,
                             bool with_positions) {
    const std::string rotary = take_rotary_axes(machine, environment);
    const bool has_tip = environment.kinematics.has_value();
    std::string taken, without_position, not_described;
    size_t joint = 0;
    for (size_t i = 0; i < core::axis_count; ++i) {
        if (has_tip) {
            const size_t at = environment.kinematics->coordinates.find(core::axis_letters[i]);
            joint = at == std::string::npos ? core::axis_count : at;
        }
        const AxisNumbers numbers(environment, i, joint, has_tip);
        const bool named = AxisNumbers(environment, i, core::axis_count).is_there();
        core::MachineAxis& axis = machine.axes[i];
        if (!axis.present) {
            if (named)
                (core::is_rotary(i) ? without_position : not_described) += core::axis_letters[i];
            joint += named ? 1 : 0;
            continue;
        }
        bool some = with_positions && take(axis.min, numbers.number("min_limit"));
        some = (with_positions && take(axis.max, numbers.number("max_limit"))) || some;
        some = (with_positions && take(axis.home, numbers.number("home"))) || some;
        some = take_above_zero(axis.rapid, numbers.number("max_velocity"), core::seconds_per_minute)
               || some;
        some = take_above_zero(axis.acceleration, numbers.number("max_acceleration"), 1.0) || some;
        if (some) taken += core::axis_letters[i];
        ++joint;
    }
    std::string note = rotary;
    if (!taken.empty())
        note += (note.empty() ? "" : "; ")
                + fmt::format("{} of {} are from the ini file",
                              with_positions ? "limits, speeds and homes" : "speeds", taken);
    if (!without_position.empty())
        note += fmt::format("{}the ini file has axis {} but not the position of its rotation axis: "
                            "add it as [[machine.axis]] if the program moves it",
                            note.empty() ? "" : "; ", without_position);
    if (not_described.empty()) return note;
    note += fmt::format("{}the ini file has axis {}, which the set-up does not describe: add it as "
                        "[[machine.axis]] if the program moves it",
                        note.empty() ? "" : "; ", not_described);
    if (has_tip && environment.kinematics->machine && environment.kinematics->machine->length_axis)
        note += ", or state \"5axiskins W\" = \"no motor\" under [control] if the other axes move "
                "the tip along the tool instead";
    return note;
}

bool has_slow_servo(const IniFile& ini) {
    constexpr double longest = 1e6; // ns
    const auto period = ini.values.find("_ini[emcmot]servo_period");
    return period != ini.values.end() && period->second > longest;
}

std::vector<std::string> split_search_path(const std::string& text) {
    return split_folders(text, core::platform::list_separator());
}

} // namespace app
