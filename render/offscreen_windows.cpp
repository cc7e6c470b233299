#define WIN32_LEAN_AND_MEAN
#include <windows.h>

// After windows.h.
#include <epoxy/gl.h>
#include <epoxy/wgl.h>

#include "render/offscreen.h"

namespace render {
namespace {

constexpr const wchar_t* class_name = L"feeler-offscreen";

tl::unexpected<core::Error> unsupported(const char* why) {
    return core::fail(core::ErrorCode::unsupported, why);
}

/// A window that is never shown: OpenGL on Windows needs one, even to draw into textures.
HWND make_window() {
    const HINSTANCE program = ::GetModuleHandleW(nullptr);
    WNDCLASSW kind{};
    kind.style = CS_OWNDC;
    kind.lpfnWndProc = ::DefWindowProcW;
    kind.hInstance = program;
    kind.lpszClassName = class_name;
    ::RegisterClassW(&kind); // fails where an earlier context did so: no matter
    return ::CreateWindowExW(0, class_name, L"", WS_OVERLAPPED, 0, 0, 16, 16, nullptr, nullptr,
                             program, nullptr);
}

bool set_pixel_format(HDC device) {
    PIXELFORMATDESCRIPTOR wanted{};
    wanted.nSize = sizeof wanted;
    wanted.nVersion = 1;
    wanted.dwFlags = PFD_DRAW_TO_WINDOW | PFD_SUPPORT_OPENGL;
    wanted.iPixelType = PFD_TYPE_RGBA;
    wanted.cColorBits = 32;
    const int format = ::ChoosePixelFormat(device, &wanted);
    return format != 0 && ::SetPixelFormat(device, format, &wanted);
}

} // namespace

struct Offscreen::Context {
    HWND window = nullptr;
    HDC device = nullptr;
    HGLRC context = nullptr;

    Context() = default;
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;
    ~Context() {
        if (context && ::wglGetCurrentContext() == context) ::wglMakeCurrent(nullptr, nullptr);
        if (context) ::wglDeleteContext(context);
        if (window) ::DestroyWindow(window);
    }
};

core::Result<Offscreen> Offscreen::make() {
    auto made = std::make_shared<Context>();
    made->window = make_window();
    made->device = made->window ? ::GetDC(made->window) : nullptr;
    if (!made->device || !set_pixel_format(made->device))
        return unsupported("OpenGL is not available: install the driver of the graphics card");
    // Contexts of newer versions are created by a function that only an older context has.
    const HGLRC first = ::wglCreateContext(made->device);
    if (!first || !::wglMakeCurrent(made->device, first))
        return unsupported("OpenGL cannot start: install the driver of the graphics card");
    const int version[] = {WGL_CONTEXT_MAJOR_VERSION_ARB,
                           3,
                           WGL_CONTEXT_MINOR_VERSION_ARB,
                           3,
                           WGL_CONTEXT_PROFILE_MASK_ARB,
                           WGL_CONTEXT_CORE_PROFILE_BIT_ARB,
                           0};
    if (epoxy_has_wgl_extension(made->device, "WGL_ARB_create_context_profile"))
        made->context = wglCreateContextAttribsARB(made->device, nullptr, version);
    ::wglMakeCurrent(nullptr, nullptr);
    ::wglDeleteContext(first);
    if (!made->context)
        return unsupported("the graphics driver has no OpenGL 3.3: install a newer one");
    Offscreen offscreen(std::move(made));
    FEELER_TRY([[maybe_unused]] const bool current,
               offscreen.make_current().map([] { return true; }));
    return offscreen;
}

core::Result<void> Offscreen::make_current() {
    if (!::wglMakeCurrent(context_->device, context_->context))
        return unsupported("OpenGL cannot draw without a window: install a newer graphics driver");
    return {};
}

} // namespace render
