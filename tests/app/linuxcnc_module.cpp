#include "tests/app/linuxcnc_module.h"

#include <cstdarg>
#include <cstdio>
#include <deque>
#include <stdexcept>
#include <vector>

#include <dlfcn.h>

namespace {

/// The pins that the loaded module has created.
std::map<std::string, double*>& pins() {
    static std::map<std::string, double*> all;
    return all;
}

std::string formatted(const char* format, va_list arguments) {
    char text[128];
    std::vsnprintf(text, sizeof text, format, arguments);
    return text;
}

} // namespace

// What a module takes from LinuxCNC.
extern "C" {

int hal_init(const char*) { return 1; }
int hal_exit(int) { return 0; }
int hal_ready(int) { return 0; }
int hal_set_unready(int) { return 0; }

void* hal_malloc(long size) {
    static std::deque<std::vector<double>> blocks;
    return blocks.emplace_back(static_cast<size_t>(size) / sizeof(double) + 1).data();
}

int hal_pin_float_newf(int, double** address, int, const char* format, ...) {
    va_list arguments;
    va_start(arguments, format);
    const std::string name = formatted(format, arguments);
    va_end(arguments);
    *address = static_cast<double*>(hal_malloc(sizeof(double)));
    pins()[name] = *address;
    return 0;
}

int hal_pin_bit_new(const char*, int, void** address, int) {
    *address = hal_malloc(sizeof(double));
    return 0;
}

int hal_pin_s32_new(const char*, int, void** address, int) {
    *address = hal_malloc(sizeof(double));
    return 0;
}

int hal_pin_s32_newf(int, void** address, int, const char*, ...) {
    *address = hal_malloc(sizeof(double));
    return 0;
}

void rtapi_print(const char*, ...) {}
void rtapi_print_msg(int, const char*, ...) {}

int rtapi_snprintf(char* text, unsigned long size, const char* format, ...) {
    va_list arguments;
    va_start(arguments, format);
    const int length = std::vsnprintf(text, size, format, arguments);
    va_end(arguments);
    return length;
}

} // extern "C"

namespace test_support {

LinuxcncModule::LinuxcncModule(const std::string& name) {
    pins().clear();
    const std::string path = "/usr/lib/linuxcnc/modules/" + name + ".so";
    handle_ = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!handle_) throw std::runtime_error(dlerror());
    if (function<int (*)()>("rtapi_app_main")() != 0)
        throw std::runtime_error(name + " does not start");
    function<int (*)()>("kinematicsType")(); // some create their pins here
}

LinuxcncModule::~LinuxcncModule() {
    if (handle_) dlclose(handle_);
}

template <typename F>
F LinuxcncModule::function(const char* name) const {
    void* const found = dlsym(handle_, name);
    if (!found) throw std::runtime_error(std::string("no function ") + name);
    return reinterpret_cast<F>(found);
}

bool LinuxcncModule::has(const std::string& pin) const { return pins().contains(pin); }

void LinuxcncModule::set(const std::string& pin, double value) {
    const auto found = pins().find(pin);
    if (found == pins().end()) throw std::runtime_error("no pin " + pin);
    *found->second = value;
}

void LinuxcncModule::use(int type) { function<int (*)(int)>("kinematicsSwitch")(type); }

EmcPose LinuxcncModule::forward(const double* joints) const {
    using Forward = int (*)(const double*, EmcPose*, const unsigned long*, unsigned long*);
    EmcPose pose;
    const unsigned long forward_flags = 0;
    unsigned long inverse_flags = 0;
    function<Forward>("kinematicsForward")(joints, &pose, &forward_flags, &inverse_flags);
    return pose;
}

void LinuxcncModule::inverse(const EmcPose& pose, double* joints) const {
    using Inverse = int (*)(const EmcPose*, double*, const unsigned long*, unsigned long*);
    const unsigned long inverse_flags = 0;
    unsigned long forward_flags = 0;
    function<Inverse>("kinematicsInverse")(&pose, joints, &inverse_flags, &forward_flags);
}

} // namespace test_support
