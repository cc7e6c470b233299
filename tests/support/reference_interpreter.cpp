#include "tests/support/reference_interpreter.h"

#include <charconv>
#include <map>
#include <sstream>

#include <fmt/format.h>

#include "tests/support/shell.h"

namespace test_support {
namespace {

constexpr size_t programs_at_once = 200; // in one process
constexpr int seconds_for_each = 180;    // for a program that never ends

std::string tool_table() {
    std::string text;
    for (const ReferenceTool& tool : reference_tools()) {
        text += fmt::format("T{} P{}", tool.number, tool.number);
        for (size_t axis = 0; axis < 9; ++axis)
            text += fmt::format(" {}{}", "XYZABCUVW"[axis], tool.offset[axis]);
        text += fmt::format(" D{} I{} J{} Q{} ;\n", tool.diameter, tool.front_deg, tool.back_deg,
                            tool.orientation);
    }
    return text;
}

/// The words of a line of the output.
class Words {
public:
    explicit Words(const std::string& line) : stream_(line) {}

    std::string word() {
        std::string text;
        stream_ >> text;
        return text;
    }
    double number() { return std::strtod(word().c_str(), nullptr); }
    Axes axes() {
        Axes values;
        for (double& value : values) value = number();
        return values;
    }
    std::vector<double> rest() {
        std::vector<double> values;
        for (std::string text; stream_ >> text;)
            values.push_back(std::strtod(text.c_str(), nullptr));
        return values;
    }
    std::string text() {
        std::string all;
        std::getline(stream_ >> std::ws, all);
        return all;
    }

private:
    std::istringstream stream_;
};

void take_offset(const std::string& key, Words& words, PlainState& state) {
    if (key == "work") {
        state.work_offset = static_cast<int>(words.number());
        state.work = words.axes();
    } else if (key == "axis") {
        state.axis = words.axes();
    } else if (key == "tool_offset") {
        state.tool_offset = words.axes();
    }
}

void take_state(Words& words, PlainState& state) {
    const std::map<std::string, double*> numbers = {{"feed", &state.feed},
                                                    {"turning_feed", &state.turning_feed},
                                                    {"pitch", &state.pitch},
                                                    {"speed", &state.speed},
                                                    {"fastest_speed", &state.fastest_speed},
                                                    {"tolerance", &state.tolerance},
                                                    {"naive_tolerance", &state.naive_tolerance},
                                                    {"rotation", &state.rotation_deg}};
    const std::map<std::string, std::string*> names = {
        {"plane", &state.plane}, {"spindle", &state.spindle}, {"path", &state.path}};
    const std::map<std::string, int*> counts = {{"selected", &state.selected_tool},
                                                {"tool", &state.tool}};
    const std::map<std::string, bool*> switches = {{"mist", &state.mist},
                                                   {"flood", &state.flood},
                                                   {"feed_override", &state.feed_override},
                                                   {"speed_override", &state.speed_override},
                                                   {"adaptive_feed", &state.adaptive_feed},
                                                   {"feed_hold", &state.feed_hold}};
    const std::string key = words.word();
    if (numbers.contains(key))
        *numbers.at(key) = words.number();
    else if (names.contains(key))
        *names.at(key) = words.word();
    else if (counts.contains(key))
        *counts.at(key) = static_cast<int>(words.number());
    else if (switches.contains(key))
        *switches.at(key) = words.number() != 0.0;
    else
        take_offset(key, words, state);
}

void take_event(const std::string& line, Words& words, const PlainState& state, PlainRun& run) {
    PlainCommand command;
    command.line = std::stoul(line);
    command.kind = words.word();
    command.state = state;
    if (command.kind == "message") {
        run.messages.push_back(words.text());
        return;
    }
    const bool is_motion = command.kind.ends_with("_feed") || command.kind.starts_with("straight_");
    if (is_motion) command.end = words.axes();
    command.values = words.rest();
    if (command.kind == "arc_feed") {
        command.centre[0] = command.values.at(0);
        command.centre[1] = command.values.at(1);
        command.turns = static_cast<int>(command.values.at(2));
        command.values.clear();
    }
    run.commands.push_back(command);
}

std::vector<PlainRun> runs_of(const std::string& answer) {
    std::vector<PlainRun> runs;
    PlainState state;
    std::istringstream lines(answer);
    for (std::string line; std::getline(lines, line);) {
        Words words(line);
        const std::string first = words.word();
        if (first == "program") {
            runs.emplace_back();
            state = PlainState{};
        } else if (first == "state") {
            take_state(words, state);
        } else if (first == "print") {
            runs.back().prints.push_back(words.text());
        } else if (first == "problem") {
            runs.back().problem = words.text();
        } else if (first == "doubt") {
            runs.back().doubt = words.text();
        } else if (first == "no_actions") {
            runs.back().has_actions = false;
        } else if (first == "refused") {
            runs.back().refused = static_cast<size_t>(words.number());
            runs.back().message = words.text();
        } else if (first == "endless") {
            runs.back().is_endless = true;
        } else if (first == "crashed") {
            runs.back().problem = line;
        } else if (first != "accepted" && !first.empty()) {
            take_event(first, words, state, runs.back());
        }
    }
    return runs;
}

} // namespace

const std::vector<ReferenceTool>& reference_tools() {
    static const std::vector<ReferenceTool> tools = {
        {1, {0, 0, 51}, 3, 0, 0, 0},
        {2, {0, 0, 52.5}, 4, 0, 0, 0},
        {3, {0, 0, 40.25}, 6, 0, 0, 0},
        {4, {1, -2, 30}, 8, 0, 0, 0},
        {5, {0.5, 1.5, 25, 3, -4, 5, 0.25, -0.75, 2}, 10, 0, 0, 0},
        {6, {-3, 0, 12}, 0.8, 95, 155, 2},
        {7, {0, 0, 0}, 0.5, 0, 0, 0},
        {8, {0, 0, -7}, 1.5, 0, 0, 0},
        {9, {0, 0, 77.7}, 12, 0, 0, 0}};
    return tools;
}

bool reference_is_installed() {
    static const bool installed = run({"test", "-x", "/usr/bin/rs274"}).status == 0
                                  && run({"/usr/bin/python3", "-c", "import gcode"}).status == 0;
    return installed;
}

std::vector<PlainRun> run_reference(const std::vector<std::string>& programs) {
    const std::string script = FEELER_SOURCE_DIR "/tests/support/reference_interpreter.py";
    const ScopedFolder folder;
    const std::string table = folder.write("tools.tbl", tool_table());
    std::vector<PlainRun> runs;
    for (size_t first = 0; first < programs.size(); first += programs_at_once) {
        std::vector<std::string> words = {"/usr/bin/python3", script, table,
                                          std::to_string(seconds_for_each)};
        const size_t last = std::min(first + programs_at_once, programs.size());
        for (size_t i = first; i < last; ++i)
            words.push_back(folder.write(fmt::format("{}.ngc", i), programs[i]));
        const Ran ran = run(words);
        std::vector<PlainRun> some = runs_of(ran.out);
        some.resize(last - first);
        if (ran.status != 0) some.back().problem += "the script failed: " + ran.err;
        runs.insert(runs.end(), some.begin(), some.end());
    }
    return runs;
}

} // namespace test_support
