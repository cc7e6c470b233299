#include "app/setup/hal_settings.h"

#include <pugixml.hpp>

#include "app/base/text.h"
#include "core/base/file_reads.h"
#include "core/base/text.h"

namespace app {
namespace {

constexpr int deepest_sum = 8;

/// A number, TRUE or FALSE, or [SECTION]KEY of the ini file; empty for anything else.
std::optional<double> number_of(std::string text, const std::map<std::string, double>& ini_values) {
    const auto is_mark = [](char c) { return c == '"' || c == '\'' || c == '(' || c == ')'; };
    std::erase_if(text, is_mark);
    if (text == "true") return 1.0;
    if (text == "false") return 0.0;
    if (!text.starts_with('[')) return number_in(text);
    const auto found = ini_values.find("_ini" + text);
    return found == ini_values.end() ? std::nullopt : std::optional(found->second);
}

/// "5axisgui.pivot_len" of `loadusr -W 5axisgui pivot_len=300`, and the like.
void take_argument(const std::string& component, const std::string& word,
                   std::map<std::string, std::optional<double>>& pins) {
    const size_t equals = word.find('=');
    if (equals == std::string::npos) return;
    if (const auto number = number_in(word.substr(equals + 1)))
        pins[component + "." + word.substr(0, equals)] = *number;
}

/// The first value of the pin of a scale, spin box or dial of a panel.
void take_control(const pugi::xml_node& control,
                  std::map<std::string, std::optional<double>>& pins) {
    std::string name(core::stripped(control.child_value("halpin")));
    if (name.size() > 2 && name.front() == '"' && name.back() == '"')
        name = name.substr(1, name.size() - 2);
    const auto number = number_in(core::stripped(control.child_value("initval")));
    if (name.empty() || !number) return;
    const bool has_two_pins = std::string_view(control.name()) == "scale"; // -i and -f
    pins["pyvcp." + core::lower_case(name) + (has_two_pins ? "-f" : "")] = *number;
}

} // namespace

void HalSettings::add(const std::string& command, const std::map<std::string, double>& ini_values) {
    std::vector<std::string> words = words_of_line(core::lower_case(command));
    for (size_t i = 0; i < words.size(); ++i)
        if (words[i].starts_with('#')) words.resize(i);
    std::erase_if(words, [](const std::string& word) {
        return word == "=>" || word == "<=" || word == "<=>" || word == "=";
    });
    if (words.size() < 2) return;
    const std::string& verb = words[0];
    if (verb == "net") {
        for (size_t i = 2; i < words.size(); ++i) signal_of_[words[i]] = words[1];
    } else if (words.size() > 2 && (verb == "linksp" || verb == "linkps")) {
        const bool signal_first = verb == "linksp";
        signal_of_[words[signal_first ? 2 : 1]] = words[signal_first ? 1 : 2];
    } else if (words.size() > 2 && (verb == "setp" || verb == "sets")) {
        (verb == "setp" ? pins_ : signals_)[words[1]] = number_of(words[2], ini_values);
    } else if (words.size() == 2 && verb.find('.') != std::string::npos) {
        pins_[verb] = number_of(words[1], ini_values); // pin = value
    } else if (verb == "source") {
        note_more_commands();
    } else if (verb == "loadrt" && words[1] == "sum2") {
        if (words.size() == 2) sums_.insert("sum2.0");
        for (size_t i = 2; i < words.size(); ++i) {
            if (!words[i].starts_with("names=")) continue;
            std::string names = words[i].substr(6) + ",";
            for (size_t at = 0; at < names.size();) {
                const size_t end = names.find(',', at);
                sums_.insert(names.substr(at, end - at));
                at = end + 1;
            }
        }
    } else if (verb == "loadusr") {
        size_t program = 1;
        while (program < words.size() && words[program].starts_with('-')) ++program;
        if (program >= words.size()) return;
        // The model of the bridge mill: its pivot length is 250 unless its command says otherwise.
        if (words[program] == "5axisgui") pins_.emplace("5axisgui.pivot_len", 250.0);
        for (size_t i = program + 1; i < words.size(); ++i)
            take_argument(words[program], words[i], pins_);
    }
}

core::Result<void> HalSettings::add_file(const std::string& path,
                                         const std::map<std::string, double>& ini_values) {
    FEELER_TRY(const std::vector<std::string> lines, lines_of_file(path));
    std::string command;
    for (const std::string& line : lines) {
        command += line;
        if (!command.empty() && command.back() == '\\') {
            command.back() = ' ';
            continue;
        }
        add(command, ini_values);
        command.clear();
    }
    return {};
}

core::Result<void> HalSettings::add_panel(const std::string& path) {
    FEELER_TRY(const std::vector<std::string> lines, lines_of_file(path));
    std::string text;
    for (const std::string& line : lines) text += line + '\n';
    pugi::xml_document document;
    if (!document.load_string(text.c_str()))
        return tl::unexpected(core::Error{core::ErrorCode::syntax, {}, "this is not XML", path});
    for (const char* kind : {"//scale", "//spinbox", "//dial"})
        for (const pugi::xpath_node& found : document.select_nodes(kind))
            take_control(found.node(), pins_);
    return {};
}

std::vector<std::string> HalSettings::on_signal(const std::string& pin) const {
    const auto signal = signal_of_.find(pin);
    std::vector<std::string> pins;
    if (signal == signal_of_.end()) return pins;
    for (const auto& [other, name] : signal_of_)
        if (name == signal->second && other != pin) pins.push_back(other);
    return pins;
}

std::optional<double> HalSettings::value(const std::string& pin, const std::string& without) const {
    return value(pin, without, 0);
}

std::optional<double> HalSettings::value(const std::string& pin, const std::string& without,
                                         int depth) const {
    if (pin == without) return 0.0;
    if (depth > deepest_sum) return std::nullopt;
    if (pin.ends_with(".out") && sums_.contains(pin.substr(0, pin.size() - 4))) {
        const std::string sum = pin.substr(0, pin.size() - 4);
        const auto gain = [&](const char* name) {
            const auto set = pins_.find(sum + name);
            return set == pins_.end() ? 1.0 : set->second.value_or(1.0);
        };
        const auto first = value(sum + ".in0", without, depth + 1);
        const auto second = value(sum + ".in1", without, depth + 1);
        const auto offset = value(sum + ".offset", without, depth + 1);
        if (!first || !second || !offset) return std::nullopt;
        return gain(".gain0") * *first + gain(".gain1") * *second + *offset;
    }
    const auto signal = signal_of_.find(pin);
    if (signal == signal_of_.end()) {
        const auto set = pins_.find(pin);
        if (set != pins_.end()) return set->second;
        return is_whole_ ? std::optional(0.0) : std::nullopt;
    }
    // What drives the signal counts more than a first value from `sets`.
    for (const std::string& other : on_signal(pin)) {
        if (other == without) return 0.0;
        const bool is_sum =
            other.ends_with(".out") && sums_.contains(other.substr(0, other.size() - 4));
        if (is_sum) return value(other, without, depth + 1);
        if (const auto set = pins_.find(other); set != pins_.end()) return set->second;
    }
    const auto first = signals_.find(signal->second);
    return first == signals_.end() ? std::nullopt : first->second;
}

std::map<std::string, double> HalSettings::values() const {
    std::map<std::string, double> known;
    for (const auto& [pin, signal] : signal_of_)
        if (const auto number = value(pin)) known["_hal[" + pin + "]"] = *number;
    for (const auto& [pin, number] : pins_)
        if (number) known.emplace("_hal[" + pin + "]", *number);
    return known;
}

bool HalSettings::is_fed_by(const std::string& pin, const std::string& source) const {
    for (const std::string& other : on_signal(pin)) {
        if (other == source) return true;
        if (!other.ends_with(".out")) continue;
        const std::string sum = other.substr(0, other.size() - 4);
        if (!sums_.contains(sum)) continue;
        if (is_fed_by(sum + ".in0", source) || is_fed_by(sum + ".in1", source)) return true;
    }
    return false;
}

std::string HalSettings::joined(const std::string& pin, const std::string& beginning) const {
    for (const std::string& other : on_signal(pin))
        if (other.starts_with(beginning)) return other;
    return {};
}

} // namespace app
