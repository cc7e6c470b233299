#include "app/setup/ini_machine.h"

#include <cctype>

#include <fmt/format.h>

#include "core/base/units.h"

namespace app {
namespace {

/// The numbers of an ini file about one axis, in mm or degrees.
class AxisNumbers {
public:
    AxisNumbers(const gcode::Environment& environment, size_t axis, size_t joint)
        : values_(environment.ini_values) {
        const bool inch = environment.machine_unit == gcode::LengthUnit::inch;
        unit_ = inch && !core::is_rotary(axis) ? 25.4 : 1.0;
        const int letter = std::tolower(static_cast<unsigned char>(core::axis_letters[axis]));
        sections_ = {fmt::format("axis_{}", static_cast<char>(letter)),
                     fmt::format("axis_{}", axis), fmt::format("joint_{}", joint)};
    }

    /// What the first section that knows it says.
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

/// Takes a number that the axis lacks; whether it did.
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

std::string complete_machine(core::Machine& machine, const gcode::Environment& environment,
                             bool places) {
    std::string taken, without_place;
    size_t joint = 0;
    for (size_t i = 0; i < core::axis_count; ++i) {
        const AxisNumbers numbers(environment, i, joint);
        const bool named = AxisNumbers(environment, i, core::axis_count).is_there();
        core::MachineAxis& axis = machine.axes[i];
        if (!axis.present) {
            if (named) without_place += core::axis_letters[i];
            joint += named ? 1 : 0;
            continue;
        }
        bool some = places && take(axis.min, numbers.number("min_limit"));
        some = (places && take(axis.max, numbers.number("max_limit"))) || some;
        some = (places && take(axis.home, numbers.number("home"))) || some;
        some = take_above_zero(axis.rapid, numbers.number("max_velocity"), core::seconds_per_minute)
               || some;
        some = take_above_zero(axis.acceleration, numbers.number("max_acceleration"), 1.0) || some;
        if (some) taken += core::axis_letters[i];
        ++joint;
    }
    std::string note;
    if (!taken.empty())
        note = fmt::format("{} of {} are those of the ini file",
                           places ? "limits, speeds and homes" : "speeds", taken);
    if (!without_place.empty())
        note += fmt::format("{}the ini file has axis {}, but does not say where it turns: add it "
                            "as [[machine.axis]] if the program moves it",
                            note.empty() ? "" : "; ", without_place);
    return note;
}

} // namespace app
