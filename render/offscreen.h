#pragma once

#include <memory>

#include "core/base/result.h"

namespace render {

/// An OpenGL 3.3 core context without a window or screen; current in the thread that creates it,
/// until it is destroyed.
class Offscreen {
public:
    /// Errors: unsupported, naming what is missing and the package to install.
    static core::Result<Offscreen> make();

    /// Makes it current again after another context.
    core::Result<void> make_current();

private:
    struct Context;
    explicit Offscreen(std::shared_ptr<Context> context) : context_(std::move(context)) {}

    std::shared_ptr<Context> context_;
};

} // namespace render
