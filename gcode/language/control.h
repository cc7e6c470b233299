#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "gcode/language/modal_state.h"

namespace gcode {

enum class ControlQuestion : uint8_t;
enum class DialectId : uint8_t;
struct Environment;

/// A value of a parameter, as the maker counts it, and what it means.
struct ParameterValue {
    double number;              // as written in [control]
    double answer;              // to the question; 1 is yes and 0 is no
    std::string_view text;      // what the control does
    std::string_view word = {}; // written instead of the number, such as "INCH"; may be empty
};

/// The numbers that a parameter can have besides its listed values. They are the answer themselves.
struct ParameterRange {
    double lowest = 0.0, highest = 0.0; // equal: only the listed values
    std::string_view unit = {};

    bool contains(double number) const {
        return lowest < highest && number >= lowest && number <= highest;
    }
};

/// What a check does where a parameter matters and nothing states it.
enum class IfNotStated : uint8_t {
    follow_all, // the first value is assumed and each other listed one is followed, too
    assume,     // the first value is assumed, which the report says
    go_on,      // as if the control did not have the parameter
};

/// A parameter or setting of a control, under the number of its maker.
struct ControlParameter {
    ControlQuestion question;
    std::span<const DialectId> dialects;
    std::string_view key;  // in [control], such as "5006#6"; empty if it is stated elsewhere
    std::string_view name; // such as "parameter 5006#6 (TOS)"
    std::span<const ParameterValue> values; // may be empty if any number of the range is meant
    IfNotStated if_not_stated;
    std::string_view source;
    std::string_view statement = {}; // how to state a parameter without a key
    ParameterRange range = {};

    bool is_open() const { return if_not_stated == IfNotStated::follow_all; }

    /// The answer that a number gives; empty if the parameter cannot have this number.
    std::optional<double> answer_of(double number) const;

    /// "INCH or MM", "1 or 0": what can be written.
    std::string choices() const;
};

/// All parameters that Feeler knows.
std::span<const ControlParameter> control_parameters();

/// The parameter that answers a question on controls of this dialect; null if all of them do the
/// same.
const ControlParameter* find_parameter(ControlQuestion question, DialectId dialect);

/// The parameter with a key; null if this dialect has none.
const ControlParameter* find_parameter(std::string_view key, DialectId dialect);

enum class SettingKind : uint8_t { flag, number, length, position, text };

/// Lengths and coordinates are mm and degrees; those of LinuxCNC are in the unit of its machine.
using SettingValue = std::variant<bool, double, Position, std::string>;

/// A setting of a control that is not a way of reading programs but a part of what they run on.
struct ControlSetting {
    std::span<const DialectId> dialects;
    std::string_view key;
    std::string_view text; // what it is
    SettingKind kind;
    /// Puts a value, of the kind above, into the environment.
    void (*set)(Environment& environment, const SettingValue& value);
    std::string_view source;
};

std::span<const ControlSetting> control_settings();

/// The setting with a key; null if this dialect has none.
const ControlSetting* find_setting(std::string_view key, DialectId dialect);

/// A control with known parameters, by name.
struct ControlPreset {
    std::string_view name; // such as "fanuc-0i-mf"
    DialectId dialect;
    std::string_view description;
    struct Value {
        std::string_view key;
        double number;
    };
    std::span<const Value> values; // as delivered
};

std::span<const ControlPreset> control_presets();

/// The preset with a name; null if there is none.
const ControlPreset* find_preset(std::string_view name);

} // namespace gcode
