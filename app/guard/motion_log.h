#pragma once

#include <memory>
#include <string>

#include "app/guard/live_check.h"
#include "core/base/result.h"

namespace app {

struct SetupFile;

/// Writes what a machine did as a program for LinuxCNC, which every command of feeler reads with
/// the set-up of the machine: feeler view shows the motions again. Its coordinates are those of the
/// first work offset that the set-up states, without length offsets but where the control follows
/// the tip.
///
/// The last motion may be one that was refused, which the machine did not make.
class MotionLog {
public:
    /// Begins a new file.
    ///
    /// Errors: io, with the path.
    static core::Result<MotionLog> begin(const std::string& path, const SetupFile& setup);

    MotionLog(MotionLog&&) noexcept;
    MotionLog& operator=(MotionLog&&) noexcept;
    ~MotionLog();

    /// Adds a motion, in mm.
    void add(const LiveMotion& motion);
    /// Notes a motion that was refused, with the reason. It is written as a comment once the
    /// motions before it are there, and as the last motion if the log ends with it.
    void add_refused(const LiveMotion& motion, const std::string& reason);
    /// Writes to the disk what is there.
    void flush();
    /// Whether everything so far could be written, for example because the disk is full. The guard
    /// works without its log.
    bool is_whole() const;

private:
    struct State;
    explicit MotionLog(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

} // namespace app
