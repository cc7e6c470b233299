#include "app/guard/guard.h"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "app/base/shipped_files.h"
#include "app/base/text.h"
#include "app/commands/commands.h"
#include "app/commands/output.h"
#include "app/commands/progress.h"
#include "app/commands/suggestion.h"
#include "app/guard/control_state.h"
#include "app/guard/live_setup.h"
#include "app/guard/motion_log.h"
#include "app/setup/ini_file.h"
#include "app/setup/linuxcnc_kinematics.h"
#include "app/setup/program_settings.h"
#include "app/setup/setup_file.h"
#include "core/base/file_reads.h"
#include "core/base/platform.h"
#include "core/base/text.h"

namespace app {
namespace {

using Clock = std::chrono::steady_clock;
constexpr auto pause = std::chrono::microseconds(100);

struct GuardOptions {
    std::string setup, ini, log, status;
    double tolerance = 0.01, feed_tolerance = 0.1;
    double wait = 60.0;
};

bool is_trivial(const IniFile& ini) { return ini.kinematics == "trivkins"; }

/// Those whose joints are the axes, as trivkins has them by its setting coordinates=XYZ.
gcode::SwitchableKinematics trivial_kinematics(const IniFile& ini) {
    gcode::SwitchableKinematics kinematics;
    kinematics.module = ini.kinematics;
    kinematics.types = {gcode::SwitchableKinematics::Type::axes};
    kinematics.coordinates = core::axis_letters;
    for (const std::string& word : words_of_line(core::upper_case(ini.kinematics_settings)))
        if (constexpr std::string_view name = "COORDINATES="; word.starts_with(name))
            kinematics.coordinates = word.substr(name.size());
    return kinematics;
}

/// The ini file, if its machine is one that the guard can follow.
core::Result<IniFile> known_ini(const std::string& path) {
    FEELER_TRY(IniFile ini, read_ini(path));
    if (!is_trivial(ini) && !is_known_kinematics(ini.kinematics))
        return core::fail_file(path,
                               fmt::format("the guard does not know the kinematics {}: the manual "
                                           "has those that it knows, under \"The guard\"",
                                           ini.kinematics));
    if (has_slow_servo(ini))
        return core::fail_file(path, "[EMCMOT] SERVO_PERIOD is longer than 1,000,000 ns, and only "
                                     "up to that it is known how LinuxCNC rounds corners");
    return ini;
}

/// The set-up, with the rotary axes of the ini file if its kinematics need them.
core::Result<SetupFile> setup_for(const GuardOptions& options, const IniFile& ini) {
    ProgramSettings settings;
    if (!is_trivial(ini)) {
        settings.ini = options.ini;
        settings.ignores_tables = true; // the control's own are compared with the set-up
    }
    FEELER_TRY(SetupFile setup, read_setup(options.setup, settings));
    if (std::string why = why_incomplete(setup, "the guard"); !why.empty())
        return core::fail_file(options.setup, std::move(why));
    if (is_trivial(ini)) return setup;
    const auto& kinematics = setup.environment.kinematics;
    if (!kinematics || !kinematics->machine)
        return core::fail_file(options.ini,
                               fmt::format("where the rotary axes of {} are is not known: state "
                                           "the values of its pins under [program.values] in the "
                                           "set-up, as \"#<_hal[{}.x-rot-point]>\" = 0",
                                           ini.kinematics, ini.kinematics));
    if (!has_axes_of_kinematics(setup.setup.machine, setup.environment))
        return core::fail_file(options.setup,
                               fmt::format("the rotary axes are not where {} in {} has them",
                                           ini.kinematics, options.ini));
    return setup;
}

/// Gives the axes the speeds and accelerations with which LinuxCNC plans: corners of rapids depend
/// on them.
void take_speeds(core::Machine& machine, const IniFile& ini, double unit) {
    for (size_t i = 0; i < core::axis_count; ++i) {
        const char letter = static_cast<char>(std::tolower(core::axis_letters[i]));
        const double scale = core::is_rotary(i) ? 1.0 : unit;
        const auto value = [&](const char* name) -> std::optional<double> {
            const auto found = ini.values.find(fmt::format("_ini[axis_{}]{}", letter, name));
            if (found == ini.values.end() || !(found->second > 0.0)) return {};
            return found->second;
        };
        // External offsets get a part of both; LinuxCNC takes 0.1 in place of more than 0.9.
        const double stated = value("offset_av_ratio").value_or(0.0);
        const double share = scale * (1.0 - (stated > 0.9 ? 0.1 : stated));
        if (const auto speed = value("max_velocity")) machine.axes[i].rapid = 60.0 * share * *speed;
        if (const auto most = value("max_acceleration"))
            machine.axes[i].acceleration = share * *most;
    }
    if (is_trivial(ini)) return;
    // Limits along X, Y and Z of the tip are others along the axes: what counts is how fast the tip
    // can be, and how slowly it may brake.
    double square = 0.0;
    std::optional<double> least;
    for (size_t i = 0; i < 3; ++i) {
        const core::MachineAxis& axis = machine.axes[i];
        square += axis.rapid ? *axis.rapid * *axis.rapid : core::infinity;
        if (axis.acceleration) least = std::min(least.value_or(core::infinity), *axis.acceleration);
    }
    for (size_t i = 0; i < 3; ++i) {
        machine.axes[i].rapid.reset();
        if (square < core::infinity) machine.axes[i].rapid = std::sqrt(square);
        machine.axes[i].acceleration = least;
    }
}

/// Waits for LinuxCNC to load feeler_tp.
core::Result<feeler_ring*> awaited_ring(double seconds) {
    const auto end = Clock::now() + std::chrono::duration<double>(seconds); // clock: gives up
    while (!is_interrupted()) {
        auto* const ring = static_cast<feeler_ring*>(
            // Of an older version, it may be smaller: why_unknown() says so.
            core::platform::shared_memory(FEELER_RING_KEY, offsetof(feeler_ring, session)));
        const std::string why = ring ? why_unknown(*ring) : "feeler_tp is not loaded";
        if (why.empty()) return ring;
        if (Clock::now() > end) // clock: as above
            return core::fail(core::ErrorCode::unsupported,
                              why + ": LinuxCNC must run with TPMOD = feeler_tp under [TRAJ]");
        std::this_thread::sleep_for(std::chrono::milliseconds(100)); // clock: polls
    }
    return core::fail(core::ErrorCode::unsupported, "interrupted before LinuxCNC was there");
}

/// LinuxCNC's status, from a program that asks for it.
class ControlStatus {
public:
    static core::Result<ControlStatus> start(const std::string& script) {
        const std::filesystem::path shipped = "linuxcnc/feeler_status.py";
        const std::filesystem::path folder = shipped_files_with(shipped);
        const std::string path = !script.empty()   ? script
                                 : !folder.empty() ? (folder / shipped).string()
                                                   : std::string();
        if (path.empty())
            return core::fail(core::ErrorCode::io,
                              "feeler_status.py is not there: name it with --status");
        auto companion = core::platform::Companion::start({"python3", path});
        if (!companion)
            return core::fail(core::ErrorCode::unsupported, "python3 cannot be started");
        return ControlStatus(*std::move(companion));
    }

    /// Takes in what the status program has written.
    void look() {
        text_ += companion_.read();
        for (size_t end = text_.find('\n'); end != std::string::npos; end = text_.find('\n')) {
            if (auto state = read_control_state(text_.substr(0, end))) {
                state_ = *state;
                is_fresh_ = true;
            }
            text_.erase(0, end + 1);
        }
    }
    /// What is known from now on must be newer than now.
    void ask_anew() {
        is_fresh_ = false;
        asked_ = core::platform::steady_milliseconds();
        companion_.write("?\n");
    }
    /// Asks again if there is no answer for a second.
    void ask_again() {
        if (!is_fresh_ && core::platform::steady_milliseconds() - asked_ > 1000) ask_anew();
    }
    const std::optional<ControlState>& state() const { return state_; }
    bool is_fresh() const { return is_fresh_; }
    bool is_open() const { return companion_.is_open(); }
    void say(const std::string& text) { companion_.write("say " + text + "\n"); }

private:
    explicit ControlStatus(core::platform::Companion companion)
        : companion_(std::move(companion)) {}

    core::platform::Companion companion_;
    std::string text_;
    std::optional<ControlState> state_;
    bool is_fresh_ = false;
    int64_t asked_ = 0; // milliseconds
};

/// Runs the guard until LinuxCNC ends or the user interrupts.
class GuardRun {
public:
    GuardRun(const GuardOptions& options, const SetupFile& setup, feeler_ring& ring,
             ControlStatus status, double unit, ControlKinematics kinematics,
             std::optional<std::string> setup_text)
        : options_(options),
          setup_(setup),
          ring_(ring),
          status_(std::move(status)),
          guard_(setup.setup, ring, unit, options.feed_tolerance, std::move(kinematics),
                 setup.speed_by_hand),
          setup_text_(std::move(setup_text)),
          unit_(unit) {}

    void open_log();
    void run();
    uint64_t refused() const { return guard_.refused(); }
    std::string summary() const;

private:
    static constexpr const char* awaits_status = "the status of LinuxCNC is awaited.";

    std::string objection(const feeler_segment& motion);
    bool has_status();
    void look_at_setup();
    void write_log();
    void tell(const std::string& text);

    const GuardOptions& options_;
    const SetupFile& setup_;
    feeler_ring& ring_;
    ControlStatus status_;
    Guard guard_;
    std::optional<MotionLog> log_;
    std::optional<std::string> setup_text_; // as it was read
    bool setup_has_changed_ = false;
    int64_t setup_seen_ = 0; // milliseconds
    double unit_ = 1.0;
    bool was_idle_ = true, said_disk_ = false;
    feeler_segment asked_for_{}; // the motion for which the status was asked for anew
    int64_t log_written_ = 0, status_started_ = 0; // milliseconds
};

void GuardRun::open_log() {
    if (options_.log.empty()) return;
    if (auto log = MotionLog::begin(options_.log, setup_))
        log_.emplace(*std::move(log));
    else
        tell("Feeler: the log cannot be written: " + options_.log);
}

void GuardRun::tell(const std::string& text) {
    print_note(text + "\n");
    for (const std::string& part : messages_of(text)) status_.say(part);
}

/// Whether the program that asks for the status runs. It is started again if it has ended.
bool GuardRun::has_status() {
    constexpr int64_t interval = 1000; // milliseconds
    if (status_.is_open()) return true;
    const int64_t now = core::platform::steady_milliseconds();
    if (now - status_started_ < interval) return false;
    status_started_ = now;
    auto anew = ControlStatus::start(options_.status);
    if (!anew) return false;
    status_ = *std::move(anew);
    return true;
}

std::string GuardRun::objection(const feeler_segment& motion) {
    status_.look();
    if (!has_status()) return "the status of LinuxCNC is not known (feeler_status.py has ended).";
    // Only a fresh status counts before the first motion after a pause, as after touching off, and
    // before one with another tool or work offset.
    if (was_idle_ || motion.tool != asked_for_.tool || motion.offset != asked_for_.offset) {
        was_idle_ = false;
        asked_for_ = motion;
        look_at_setup();
        status_.ask_anew();
    }
    status_.ask_again();
    if (!status_.is_fresh() || !status_.state()) return awaits_status;
    if (setup_has_changed_) look_at_setup();
    if (setup_has_changed_)
        return "The set-up file has changed since the guard has read it: start the guard again.";
    if (motion.tool >= 0 && motion.tool != status_.state()->tool)
        return fmt::format(
            "LinuxCNC has tool {} in the spindle, and feeler-tp.tool-number says {}.",
            status_.state()->tool, motion.tool);
    std::string why = difference(setup_, *status_.state(), unit_, options_.tolerance);
    if (!why.empty() && status_.state()->is_homed)
        why += " Set it right on the control, or correct the set-up and start the guard again.";
    return why;
}

/// Whether the set-up file was edited; looks at most ten times a second.
void GuardRun::look_at_setup() {
    constexpr int64_t interval = 100; // milliseconds
    const int64_t now = core::platform::steady_milliseconds();
    if (now - setup_seen_ < interval) return;
    setup_seen_ = now;
    setup_has_changed_ = core::file_bytes(options_.setup) != setup_text_;
}

void GuardRun::write_log() {
    constexpr int64_t interval = 500; // milliseconds
    const int64_t now = core::platform::steady_milliseconds();
    if (!log_ || now - log_written_ < interval) return;
    log_written_ = now;
    log_->flush();
    if (!log_->is_whole() && !std::exchange(said_disk_, true))
        tell("Feeler: the log cannot be written any more: " + options_.log);
}

void GuardRun::run() {
    guard_.objection = [this](const feeler_segment& motion) { return objection(motion); };
    guard_.is_mdi = [this] { return status_.state() && status_.state()->is_mdi; };
    guard_.tell = [this](const std::string& text) { tell(text); };
    guard_.after_motion = [this](const LiveMotion& motion) {
        if (log_) log_->add(motion);
    };
    guard_.after_refusal = [this](const LiveMotion& motion, const LiveAnswer& answer) {
        if (log_) log_->add_refused(motion, answer.reason);
    };
    const uint64_t session = ring_.session;
    int idle = 0;
    while (!is_interrupted() && ring_.magic == FEELER_RING_MAGIC && ring_.session == session) {
        if (guard_.step()) {
            idle = 0;
            continue;
        }
        if (guard_.is_disturbed())
            return tell("Feeler: the guard ends, since another process has written to its memory. "
                        "Nothing is permitted any more.");
        if (!guard_.has_motion() && ++idle > 100) was_idle_ = true;
        write_log();
        status_.look();
        std::this_thread::sleep_for(pause); // clock: polls
    }
}

std::string GuardRun::summary() const {
    std::string text =
        fmt::format("{} motions permitted, {} refused\n", guard_.permitted(), guard_.refused());
    if (guard_.permitted() > 0)
        text +=
            fmt::format("half of the checks took up to {:.3f} ms of CPU, 99.9 % up to {:.3f} ms\n",
                        1000.0 * guard_.times().within(0.5), 1000.0 * guard_.times().within(0.999));
    return text;
}

core::Result<ExitCode> guard_machine(const GuardOptions& options) {
    FEELER_TRY(const IniFile ini, known_ini(options.ini));
    std::optional<std::string> setup_text = core::file_bytes(options.setup);
    FEELER_TRY(SetupFile setup, setup_for(options, ini));
    const double unit = ini.machine_unit == gcode::LengthUnit::inch ? 25.4 : 1.0;
    take_speeds(setup.setup.machine, ini, unit);
    FEELER_TRY(feeler_ring* const ring, awaited_ring(options.wait));
    if (!claim(*ring))
        return core::fail(core::ErrorCode::unsupported,
                          fmt::format("another guard runs: process {}", ring->process));
    FEELER_TRY(ControlStatus status, ControlStatus::start(options.status));
    ControlKinematics kinematics(
        unit, is_trivial(ini) ? trivial_kinematics(ini) : *setup.environment.kinematics,
        setup.setup.machine, options.tolerance);
    GuardRun run(options, setup, *ring, std::move(status), unit, std::move(kinematics),
                 std::move(setup_text));
    run.open_log();
    print_note("watching LinuxCNC\n");
    for (const std::string& assumption : setup.assumptions)
        if (assumption != setup.start_assumption) print_note(assumption + "\n");
    run.run();
    print_note(run.summary());
    return run.refused() == 0 ? ExitCode::clear : ExitCode::findings;
}

ExitCode guard(const GuardOptions& options) {
    stop_on_interrupt();
    const auto done = guard_machine(options);
    return done ? *done : failed(done.error());
}

constexpr const char* guard_examples = R"(
An assistant, never a safety function. In the ini file of LinuxCNC:
  [TRAJ]
  TPMOD = feeler_tp
  [APPLICATIONS]
  APP = feeler guard --setup /home/me/mill.toml --ini /home/me/mill.ini)";

} // namespace

void add_guard(CLI::App& cli, ExitCode& exit_code) {
    const auto options = std::make_shared<GuardOptions>();
    CLI::App& command = *cli.add_subcommand(
        "guard", "Watch LinuxCNC while it runs, and hold it before a motion that is not clear");
    add_path(command, "--setup", options->setup, "The set-up of the machine")->required();
    add_path(command, "--ini", options->ini, "The ini file of LinuxCNC")->required();
    command
        .add_option("--tolerance", options->tolerance,
                    "How far the control's work offset and tool length may differ from the set-up, "
                    "mm or degrees")
        ->check(CLI::Range(0.0, 10.0))
        ->capture_default_str();
    command
        .add_option("--feed-tolerance", options->feed_tolerance,
                    "Tolerance with which LinuxCNC blends feeds where a program states none, mm")
        ->check(CLI::Range(0.001, 10.0))
        ->capture_default_str();
    add_path(command, "--log", options->log,
             "Write what the machine did as a program, which feeler view shows");
    add_path(command, "--status", options->status,
             "The program that asks LinuxCNC for its status, instead of the one that is installed");
    command.add_option("--wait", options->wait, "How long to wait for LinuxCNC, seconds")
        ->check(CLI::Range(0.0, 86400.0))
        ->capture_default_str();
    command.footer(guard_examples);
    command.callback([options, &exit_code] { exit_code = guard(*options); });
}

} // namespace app
