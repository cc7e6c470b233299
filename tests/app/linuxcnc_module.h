#pragma once

#include <map>
#include <string>

namespace test_support {

/// A position of LinuxCNC: its EmcPose.
struct EmcPose {
    double x = 0.0, y = 0.0, z = 0.0, a = 0.0, b = 0.0, c = 0.0, u = 0.0, v = 0.0, w = 0.0;
};

/// A kinematics module of LinuxCNC as it is installed, without LinuxCNC: the functions of its HAL
/// that the module needs are in linuxcnc_module.cpp. Only one module can be loaded at a time.
class LinuxcncModule {
public:
    /// Throws std::runtime_error if the module is not installed or refuses to start.
    explicit LinuxcncModule(const std::string& name);
    ~LinuxcncModule();
    LinuxcncModule(const LinuxcncModule&) = delete;
    LinuxcncModule& operator=(const LinuxcncModule&) = delete;

    /// Sets a pin, by its whole name. Throws if the module has no such pin.
    void set(const std::string& pin, double value);
    bool has(const std::string& pin) const;

    /// Selects one of its kinematics.
    void use(int type);

    EmcPose forward(const double* joints) const;
    void inverse(const EmcPose& pose, double* joints) const;

private:
    template <typename F>
    F function(const char* name) const;

    void* handle_ = nullptr;
};

} // namespace test_support
