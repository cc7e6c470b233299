#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace test_support {

/// X Y Z A B C U V W in mm and degrees.
using Axes = std::array<double, 9>;

/// The state during a command, from either interpreter.
struct PlainState {
    double feed = 0.0;          // mm/min, or mm/rev
    double turning_feed = -1.0; // of rotary axes alone; below 0: not known
    double pitch = 0.0;         // mm/rev of threads
    int work_offset = 1;        // 1 is G54
    Axes work{};                // its origin
    Axes axis{};                // G92 and G52
    Axes tool_offset{};
    double rotation_deg = 0.0;
    std::string plane = "XY"; // XY ZX YZ UV WU VW
    int selected_tool = 0, tool = 0;
    std::string spindle = "stopped"; // clockwise counterclockwise
    double speed = 0.0;              // rev/min, or m/min
    double fastest_speed = 0.0;      // rev/min, of G96
    bool mist = false, flood = false;
    std::string path = "continuous"; // exact_path exact_stop
    double tolerance = 0.0, naive_tolerance = 0.0;
    bool feed_override = true, speed_override = true, adaptive_feed = false, feed_hold = true;
};

/// A command that moves, waits, stops or switches something.
struct PlainCommand {
    size_t line = 0;
    std::string kind;           // as in traces: straight_feed, arc_feed, dwell ...
    Axes end{};                 // of motions
    double centre[2]{};         // of arcs
    int turns = 0;              // of arcs
    std::vector<double> values; // of all other commands
    PlainState state;
};

/// The result of an interpreter for a program.
struct PlainRun {
    std::vector<PlainCommand> commands;
    std::vector<std::string> messages, prints;
    bool has_actions = true;       // whether spindle, coolant, outputs and modes are reported
    bool is_endless = false;       // had to be stopped
    std::optional<size_t> refused; // the line
    std::string message;           // why
    std::string doubt;             // its two sources disagree
    std::string problem;           // the reference contradicts itself, or crashed
};

} // namespace test_support
