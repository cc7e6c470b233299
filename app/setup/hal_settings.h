#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace app {

/// What the HAL commands of a LinuxCNC configuration say about pins: `setp`, `sets`, `net`,
/// `linksp`, `linkps`; `loadrt sum2`; the initial values of a PyVCP panel. Names are in lower case.
class HalSettings {
public:
    /// Adds one command. `ini_values`: numbers of the ini file by names such as _ini[kins]x, for
    /// values such as [KINS]X.
    void add(const std::string& command, const std::map<std::string, double>& ini_values);

    /// Adds the commands of a HAL file. Errors: io, with the file.
    core::Result<void> add_file(const std::string& path,
                                const std::map<std::string, double>& ini_values);

    /// Adds the initial values of the scales, spin boxes and dials of a PyVCP panel. Errors: io, or
    /// syntax without a line, with the file.
    core::Result<void> add_panel(const std::string& path);

    /// The value of a pin; 0 if nothing is connected to it. Empty if it is not known.
    ///
    /// `without`: a pin that counts as 0, such as the tool length.
    std::optional<double> value(const std::string& pin, const std::string& without = {}) const;

    /// All values that are known, by names such as _hal[motion.switchkins-type].
    std::map<std::string, double> values() const;

    /// Whether a pin receives, directly or as a term of a sum2, the value of another.
    bool is_fed_by(const std::string& pin, const std::string& source) const;

    /// The first pin with this beginning that is on the same signal; empty if there is none.
    std::string joined(const std::string& pin, const std::string& beginning) const;

    /// Commands in files that are not read here may set any pin that is not set otherwise.
    void note_more_commands() { is_whole_ = false; }

private:
    std::optional<double> value(const std::string& pin, const std::string& without,
                                int depth) const;
    std::vector<std::string> on_signal(const std::string& pin) const;

    // setp and values of a panel; sets. Empty: set to something that is not understood.
    std::map<std::string, std::optional<double>> pins_, signals_;
    std::map<std::string, std::string> signal_of_; // of a pin
    std::set<std::string> sums_;                   // names of sum2 components
    bool is_whole_ = true;
};

} // namespace app
