#include <dlfcn.h>
#include <epoxy/egl.h>

#include "render/offscreen.h"

namespace render {
namespace {

tl::unexpected<core::Error> unsupported(const char* why) {
    return core::fail(core::ErrorCode::unsupported, why);
}

bool has_extension(const char* list, const char* name) {
    return list != nullptr && std::string(list).find(name) != std::string::npos;
}

/// Whether the system has a library. libepoxy and ImGui end the program where one is missing.
bool has_library(const char* name) {
    return dlopen(name, RTLD_LAZY | RTLD_LOCAL) != nullptr; // stays open for them
}

core::Result<EGLDisplay> open_display() {
    // ImGui draws through libGL.
    if (!has_library("libEGL.so.1") || !has_library("libGL.so.1"))
        return unsupported(
            "libEGL or libGL is missing: install libegl1, libgl1 and libgl1-mesa-dri");
    if (!has_extension(eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS),
                       "EGL_MESA_platform_surfaceless"))
        return unsupported(
            "EGL cannot draw without a screen: install libegl-mesa0 and libgl1-mesa-dri. If they "
            "are installed, EGL_LOG_LEVEL=debug in the environment says why they cannot be loaded");
    const EGLDisplay display =
        eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr);
    EGLint major = 0, minor = 0;
    if (display == EGL_NO_DISPLAY || eglInitialize(display, &major, &minor) != EGL_TRUE)
        return unsupported("EGL cannot start without a screen: install libgl1-mesa-dri");
    return display;
}

} // namespace

struct Offscreen::Context {
    EGLDisplay display = EGL_NO_DISPLAY;
    EGLContext context = EGL_NO_CONTEXT;

    Context() = default;
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;
    ~Context() {
        if (context == EGL_NO_CONTEXT) return;
        if (eglGetCurrentContext() == context)
            eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        // The display is kept: other contexts of this program share it.
        eglDestroyContext(display, context);
    }
};

core::Result<Offscreen> Offscreen::make() {
    FEELER_TRY(const EGLDisplay display, open_display());
    if (eglBindAPI(EGL_OPENGL_API) != EGL_TRUE)
        return unsupported("EGL does not support OpenGL: install libgl1-mesa-dri");
    const EGLint wanted[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
    EGLConfig config = nullptr;
    EGLint count = 0;
    if (eglChooseConfig(display, wanted, &config, 1, &count) != EGL_TRUE || count == 0)
        config = nullptr; // EGL_KHR_no_config_context: none is needed without a surface
    const EGLint version[] = {EGL_CONTEXT_MAJOR_VERSION,
                              3,
                              EGL_CONTEXT_MINOR_VERSION,
                              3,
                              EGL_CONTEXT_OPENGL_PROFILE_MASK,
                              EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                              EGL_NONE};
    auto context = std::make_shared<Context>();
    context->display = display;
    context->context = eglCreateContext(display, config, EGL_NO_CONTEXT, version);
    if (context->context == EGL_NO_CONTEXT)
        return unsupported(
            "EGL cannot create an OpenGL 3.3 context: install a newer libgl1-mesa-dri");
    Offscreen offscreen(std::move(context));
    FEELER_TRY([[maybe_unused]] const bool current,
               offscreen.make_current().map([] { return true; }));
    return offscreen;
}

core::Result<void> Offscreen::make_current() {
    if (eglMakeCurrent(context_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, context_->context)
        != EGL_TRUE)
        return unsupported("EGL cannot draw without a surface: install a newer libegl-mesa0");
    return {};
}

} // namespace render
